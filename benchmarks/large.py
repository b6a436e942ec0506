"""Large parts, each derived, certified, coupled and asked for accelerations in a process of its own: CPU time, memory.

python -m benchmarks.large [--quick] [--json FILE]
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from time import process_time
from typing import Any

from benchmarks.chains import chain, general_rows
from benchmarks.report import keep, options
from substructures import Definition, TreeSpec, couple, derive, evaluate

#: what is kept
FIGURES = ("derive_s", "derive_mb", "forward_s", "all_mb")
#: no limit of operations
ALL = 10**8


def star(count: int) -> Definition:
    """Joints side by side on the base."""
    solid = {"mass": 1, "com": [0.5, 0, 0], "inertia": {"xx": 1, "yy": 1, "zz": 1}}
    bodies = [
        {"name": f"b{k}", "parent": "base", "joint": {"type": "revolute", "coordinate": f"q{k}"}, **solid}
        for k in range(count)
    ]
    return Definition.read({"name": "large", "bodies": bodies})


def measured(kind: str, count: int) -> dict[str, Any]:
    """In this process."""
    definition = star(count) if kind == "star" else chain("large", general_rows(count))
    start = process_time()
    part = derive(definition, ALL)
    derived, peak = process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    spec = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "a", "substructure": "large"}]}
    start = process_time()
    model = couple(TreeSpec.read(spec), {"a": part}, ALL)
    found = {"derive_s": derived, "derive_mb": peak / 1024, "couple_s": process_time() - start}
    start = process_time()
    evaluate(model, "forward_dynamics", [0.1] * count, parameters=dict.fromkeys(model.parameters, 1.0))
    found["forward_s"] = process_time() - start
    found["all_mb"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return found | {"operations": len(part.program), "christoffel": part.has_christoffel}


def main() -> None:
    """Print a table; with --json FILE write the figures."""
    arguments = options(__doc__, "80 joints at most").parse_args()
    figures: dict[str, float] = {}
    columns = f"{'derive s':>9} {'peak MB':>8} {'couple s':>9} {'accel. s':>9} {'peak MB':>8} {'operations':>11}"
    print(f"{'':>12} {columns}  Christoffel symbols")
    for kind, count in (*(("chain", count) for count in (40, 41, 60, 80, 100)), ("star", 160)):
        if arguments.quick and count == 100:
            continue
        code = f"import json, benchmarks.large as large; print(json.dumps(large.measured({kind!r}, {count})))"
        command = [sys.executable, "-c", code]
        row = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
        stored = "stored" if row["christoffel"] else "not stored"
        print(
            f"{kind:>8} {count:>3} {row['derive_s']:>9.2f} {row['derive_mb']:>8.0f} {row['couple_s']:>9.2f}"
            f" {row['forward_s']:>9.2f} {row['all_mb']:>8.0f} {row['operations']:>11,}  {stored}"
        )
        figures |= {f"{name.replace('_', f'_{kind}_{count}_')}": row[name] for name in FIGURES}
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
