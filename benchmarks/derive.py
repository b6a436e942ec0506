"""Time and operation counts of deriving and of coupling, beside SymPy's KanesMethod in the same run.

python -m benchmarks.derive [--quick] [--json FILE]
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any

from benchmarks.chains import ROWS_14, chain, general_rows, pieces, row_of
from benchmarks.kane import derive_by_kane, operations
from benchmarks.report import keep, options
from substructures import Definition, Part, TreeSpec, catalogue, couple, derive
from substructures.expr.program import Formulas, Program, array, program
from substructures.part.forces.applied_forces import read_loads
from substructures.part.formulas import formulas
from substructures.part.mechanism import mechanism
from substructures.part.one_piece import derive_in_one_piece
from substructures.part.outputs import over_formulas
from substructures.tree.assembly import assemble
from substructures.tree.coupling import couple_parts

GRAVITY = (0, 0, "-g")
EQUATIONS = ("metric", "christoffel", "gravity")


def timed(work: Callable[[], Any], repeat: int = 9) -> tuple[float, Any]:
    """Median wall time in seconds after one warm-up, and the last result."""
    result = work()
    seconds = []
    for _ in range(repeat):
        gc.collect()
        start = perf_counter()
        result = work()
        seconds.append(perf_counter() - start)
    return median(seconds), result


def paired(a: Callable[[], Any], b: Callable[[], Any], repeat: int = 11) -> tuple[float, float, float]:
    """Medians of two works in turn, and the median of their ratio a/b: holds when the machine's speed drifts."""
    a(), b()
    times = []
    for _ in range(repeat):
        gc.collect()
        start = perf_counter()
        a()
        middle = perf_counter()
        gc.collect()
        again = perf_counter()
        b()
        times.append((middle - start, perf_counter() - again))
    return median(x for x, _ in times), median(y for _, y in times), median(x / y for x, y in times)


def coupled_equations(spec: TreeSpec, parts: dict[str, Part]) -> Program:
    """Coupling alone: metric, Christoffel symbols and gravity forces, without kinematics and verification."""
    assembly = assemble(spec, parts)
    result = couple_parts(over_formulas(assembly.scope.graph), assembly.mounted, assembly.gravity)
    n = len(result.gravity)
    outputs = {
        "metric": Formulas((n, n), result.metric, "symmetric"),
        "christoffel": Formulas((n, n, n), result.christoffel, "christoffel"),
        "gravity": array((n,), lambda a: result.gravity[a]),
    }
    return program(assembly.scope.graph, outputs, assembly.scope.symbols)


def beside_kane(sizes: list[int], figures: dict[str, float]) -> None:
    """General nR chains."""
    print("general nR chain, every constant symbolic: M, all Gamma, Q   |   KanesMethod: M and forcing vector")
    print(f"{'n':>3} {'ours ms':>9} {'operations':>11} {'SymPy s':>9} {'operations':>11} {'time ratio':>11}")
    for n in sizes:
        definition = chain(f"general-{n}r", general_rows(n))
        ours, result = timed(lambda d=definition: derive_in_one_piece(d, GRAVITY))
        start = perf_counter()
        mass, forcing = derive_by_kane(general_rows(n))
        theirs = perf_counter() - start
        count = result.count(EQUATIONS)["total"]
        peer = operations(mass, forcing)
        print(f"{n:>3} {ours * 1e3:>9.2f} {count:>11,} {theirs:>9.2f} {peer:>11,} {theirs / ours:>10,.0f}x")
        figures[f"ratio_kane_{n}r"] = theirs / ours


def one_piece(figures: dict[str, float]) -> None:
    """6R and the 34 dof humanoid."""
    seconds, result = timed(lambda: derive_in_one_piece(chain("general-6r", general_rows(6)), GRAVITY))
    figures["derive_6r_ms"] = seconds * 1e3
    counts = {name: result.count([name])["total"] for name in EQUATIONS}
    print(f"\ngeneral 6R in one piece: {seconds * 1e3:.1f} ms; operations {counts}")
    part = derive(chain("arm-14", ROWS_14))
    figures["ops_6r14_metric"] = part.operations["metric"]
    figures["ops_6r14_christoffel"] = part.operations["christoffel"]
    print(f"6R with 14 kinematic parameters: M {part.operations['metric']}, all Gamma {part.operations['christoffel']}")
    print("   (inertial parameters m, s, J as symbols; published generated code: M 1,655; C matrix 6,374)")
    spec, library = humanoid()
    parts = {i.name: derive(library[str(i.substructure)]) for i in spec.instances}
    verified, _ = timed(lambda: [derive(d) for d in library.values()] and couple(spec, parts), 5)
    deriving, _ = timed(lambda: [derived_formulas(d) for d in library.values()], 5)
    coupling, model = timed(lambda: coupled_equations(spec, parts), 5)
    figures["derive_34dof_s"] = deriving + coupling
    figures["derive_verify_34dof_s"] = verified
    total = model.count(EQUATIONS)["total"]
    dof = model.outputs["gravity"].shape[0]
    print(f"humanoid of {len(spec.instances)} parts ({len(library)} different), {dof} dof; {total:,} operations")
    print(f"   formulas derived {deriving:.3f} s, coupled {coupling:.3f} s (M, all Gamma, gravity)")
    print(f"   with kinematics, momenta, operation counts, and everything verified at random states: {verified:.2f} s")


def derived_formulas(definition: Definition) -> Program:
    """All stored formulas of a part, without verification."""
    m = mechanism(definition)
    return program(m.graph, formulas(m, read_loads(m)), m.scope.symbols)


def humanoid() -> tuple[TreeSpec, dict[str, Definition]]:
    """Pelvis, torso, head, two arms and two legs of the catalogue: 34 degrees of freedom."""
    spec = TreeSpec.read(catalogue.load_tree("humanoid"))
    used = dict.fromkeys(str(instance.substructure) for instance in spec.instances)
    return spec, {name: Definition.read(catalogue.load(name)) for name in used}


def coupling(figures: dict[str, float]) -> None:
    """Coupled from stored parts beside derived in one piece: the same chain."""
    print("\ncoupled from stored parts | the same chain in one piece (M, all Gamma, gravity)")
    print(f"{'chain':>16} {'couple ms':>10} {'derive ms':>10} {'time':>6}", end="")
    print(f" {'operations':>11} {'one piece':>10} {'ratio':>6}")
    worst = 0.0
    for name, rows, sizes in (
        ("6R14  3+3", ROWS_14, [3, 3]),
        ("6R14  2+2+2", ROWS_14, [2, 2, 2]),
        ("6R14  1x6", ROWS_14, [1] * 6),
        ("general 3+3", general_rows(6), [3, 3]),
        ("general 6+6", general_rows(12), [6, 6]),
        ("general 4+4+4", general_rows(12), [4, 4, 4]),
        ("general 1x12", general_rows(12), [1] * 12),
    ):
        definitions = pieces(rows, sizes)
        spec = row_of(definitions)
        parts = {f"p{i}": derive(d) for i, d in enumerate(definitions)}
        whole = chain("whole", rows)
        coupled, single = coupled_equations(spec, parts), derive_in_one_piece(whole, GRAVITY)
        seconds, anew, time_ratio = paired(
            lambda spec=spec, parts=parts: coupled_equations(spec, parts),
            lambda whole=whole: derive_in_one_piece(whole, GRAVITY),
        )
        ours, theirs = coupled.count(EQUATIONS)["total"], single.count(EQUATIONS)["total"]
        ratio = ours / theirs
        worst = max(worst, ratio)
        if name == "general 6+6":
            figures["couple_6_6_ms"] = seconds * 1e3
            figures["ratio_couple_derive_time"] = time_ratio
        print(
            f"{name:>16} {seconds * 1e3:>10.1f} {anew * 1e3:>10.1f} {time_ratio:>6.2f}"
            f" {ours:>11,} {theirs:>10,} {ratio:>6.3f}"
        )
    figures["ops_coupled_ratio"] = worst


def main() -> None:
    """Print the tables; with --json FILE write the figures."""
    arguments = options(__doc__, "KanesMethod for n = 2 and 3 only").parse_args()
    figures: dict[str, float] = {}
    beside_kane([2, 3] if arguments.quick else [2, 3, 4, 5], figures)
    one_piece(figures)
    coupling(figures)
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
