"""Closed loops: error, steps and time of Andrews' squeezer and of other closed mechanisms, by both methods.

python -m benchmarks.loops [--json FILE]
"""

from __future__ import annotations

import json
from statistics import median
from time import process_time
from typing import Any

import numpy as np

from benchmarks.report import options
from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.closed.reductions import REDUCTIONS
from substructures.analysis.from_fields import motion_arguments
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.simulate import simulate
from substructures.compile.motion import CompiledRun

#: F. Mazzia, F. Iavernaro, C. Magherini, Test Set for IVP Solvers: start, and values at t = 0.03 s
SQUEEZER = {
    "beta": (-0.0617138900142764496, 15.81077119629904),
    "Theta": (0.0, -15.75637105984298),
    "gamma": (0.455279819163070380, 0.04082224013073101),
    "Phi": (0.222668390165885885, -0.5347301163226948),
    "delta": (0.487364979543842550, 0.5244099658805304),
    "Omega": (-0.222668390165885885, 0.5347301163226948),
    "epsilon": (1.23054744454982119, 1.048080741042263),
}
PINS = {
    "andrews-squeezer": [("end2", f"end{k}") for k in (3, 4, 6)],
    "four-bar": [("coupler_end", "rocker_end")],
    "slider-crank": [("rod_end", "pin")],
}


def closed(name: str) -> Model:
    """A catalogue entry with its loops closed by pins."""
    pins = [{"name": f"c{k}", "type": "pin", "from": f"x.{a}", "to": f"x.{b}"} for k, (a, b) in enumerate(PINS[name])]
    instance = {"name": "x", "substructure": name}
    gravity = [0, 0 if name == "andrews-squeezer" else "-9.81", 0]
    document = {"name": "loop", "gravity": gravity, "instances": [instance], "closures": pins}
    return couple(TreeSpec.read(document), {"x": derive(Definition.read(catalogue.load(name)))})


def requests(model: Model, name: str) -> dict[str, Any]:
    """What is simulated."""
    if name == "andrews-squeezer":
        return {"q": [SQUEEZER[c[2:]][0] for c in model.coordinates], "span": [0, 0.03], "count": 2}
    start = {"four-bar": [0.7, 0.2, 1.2], "slider-crank": [0.7, -0.2, 0.16]}[name]
    return {"q": start, "qd": [20, 0, 0], "fixed": [model.coordinates[0]], "span": [0, 1], "count": 2}


def per_call(model: Model, request: dict[str, Any], calls: int = 100_000) -> float:
    """Seconds for q'' at one state in machine code: formulas and the linear equations."""
    state = loop_state(model, **{k: v for k, v in request.items() if k in ("q", "qd", "fixed")}).consistent
    s = Constrained(model, Start(request["q"]), (0, 0))
    s.move(0, state.q, state.qd)
    rates = s.compiled(s.equations(s.independent_rows()))
    if rates is None:
        return np.nan
    run, y = CompiledRun(TABLEAUX["DOP853"], rates, (1.0, 1.0)), np.concatenate((state.q, state.qd, (0.0,)))
    evaluations, start = 0, process_time()
    while evaluations < calls:
        run.begin(0.0, y, 1.0, 1e-6)
        run.advance()
        evaluations += run.evaluations
    return (process_time() - start) / evaluations


def measure(name: str, method: str) -> dict[str, Any]:
    """Figures of one mechanism."""
    model = closed(name)
    request = requests(model, name) | {"reduction": method}
    seconds = []
    for _ in range(5):
        start = process_time()
        motion = simulate(model, **motion_arguments(model, **request))
        seconds.append(process_time() - start)
    result: dict[str, Any] = {check.name: check.worst / check.scale for check in motion.checks}
    result |= {"mechanism": name, "method": method, "seconds": median(seconds), "steps": motion.steps}
    result |= {"span": request["span"][1], "per_call": per_call(model, request), "right": motion.is_right}
    if name == "andrews-squeezer":
        end = np.array([SQUEEZER[c[2:]][1] for c in model.coordinates])
        result["error"] = float(np.abs(motion.q[-1] / end - 1).max())
    return result


def at_both_levels(name: str, independent: str, start: dict[str, float]) -> dict[str, Any]:
    """The loop inside of the part: seconds of the same motion in all coordinates and in the independent one."""
    data = catalogue.load(name)
    (first, second), *_ = PINS[name]
    data |= {"closures": [{"name": "loop", "type": "pin", "from": first, "to": second}]}
    data |= {"independent": [independent], "start": start}
    part, found = derive(Definition.read(data)), dict[str, Any]()
    for level in ("full", "reduced"):
        instances = [{"name": "x", "substructure": name, "level": level}]
        model = couple(TreeSpec.read({"name": "t", "gravity": [0, "-9.81", 0], "instances": instances}), {"x": part})
        given = {f"x.{q}": x for q, x in start.items()}
        state = (
            loop_state(model, list(given.values()), qd=[20, 0, 0], fixed=[f"x.{independent}"]).consistent
            if level == "full"
            else None
        )
        q, qd = ([start[independent]], [20]) if state is None else (state.q, state.qd)
        seconds = []
        for _ in range(5):
            begun = process_time()
            motion = simulate(model, q, (0, 1), qd=qd)
            seconds.append(process_time() - begun)
        found |= {level: median(seconds), f"{level}_right": motion.is_right, f"{level}_end": float(motion.q[-1, 0])}
    return found | {"mechanism": name}


def main() -> None:
    """Print a table."""
    arguments = options(__doc__).parse_args()
    both = [
        at_both_levels("four-bar", "crank", {"crank": 0.7, "coupler": 0.2, "rocker": 1.2}),
        at_both_levels("slider-crank", "crank", {"crank": 0.7, "rod": -0.2, "piston": 0.16}),
    ]
    for row in both:
        gain = f"{1e3 * row['full']:.1f} ms with closures, {1e3 * row['reduced']:.1f} ms reduced"
        print(f"{row['mechanism']:17} {gain}, {row['full'] / row['reduced']:.0f} times; right {row['reduced_right']}")
    rows = [measure(name, method) for name in PINS for method in REDUCTIONS]
    for row in rows:
        error = f", relative error at the end {row['error']:.1e}" if "error" in row else ""
        run = f"{row['span']} s in {row['seconds']:.3f} s, {row['steps']} steps, q'' in {1e6 * row['per_call']:.1f} us"
        residuals = f"residuals {row['position residual']:.0e} and {row['velocity residual']:.0e}"
        print(f"{row['mechanism']:17} {row['method']:12} {run}; {residuals}, energy {row['energy']:.0e}{error}")
    if arguments.json:
        arguments.json.write_text(json.dumps([*rows, *both], indent=1))


if __name__ == "__main__":
    main()
