"""Many motions of one model at once, beside the same ones one by one and MuJoCo's Runge-Kutta method.

An acrobot swings freely for five seconds from starts and with masses that are drawn; each motion is judged.
``python -m benchmarks.ensembles [--members N] [--json FILE]``
"""

from __future__ import annotations

import resource
from collections.abc import Callable
from time import process_time
from typing import Any

import mujoco
import numpy as np

from benchmarks.report import keep, options
from substructures import MotionColumn, couple, derive, simulate, simulate_ensemble
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.motion.problems.problem import Integrator
from substructures.tree.model import Model

SPAN, ALONE = (0.0, 5.0), 40
HOW = Integrator(relative_tolerance=1e-8, absolute_tolerance=1e-8, drift_limit=1e-5)
COLUMNS = {
    "top": MotionColumn(expression="arm.q1", take="largest"),
    "speed": MotionColumn(expression="arm.q2'", take="largest_absolute"),
    "energy": MotionColumn(quantity="kinetic_energy", take="mean"),
}


def acrobot() -> Model:
    spec = {"name": "one", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "acrobot"}]}
    return couple(spec, {"arm": derive("acrobot")})


def cpu(call: Callable[[], Any]) -> tuple[Any, float]:
    """The result, and seconds of CPU."""
    start = process_time()
    found = call()
    return found, process_time() - start


def peak() -> float:
    """Memory of this process at most, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


WORLD = """<mujoco><compiler angle="radian"/><option gravity="0 0 -9.81" integrator="RK4" timestep="{step}">
<flag contact="disable" constraint="disable"/></option><worldbody>
<body><joint type="hinge" axis="0 1 0"/><inertial pos="0 0 -0.5" mass="1" diaginertia="0.083 0.083 0.083"/>
<body pos="0 0 -1"><joint type="hinge" axis="0 1 0"/><inertial pos="0 0 -0.5" mass="1" diaginertia="0.33 0.33 0.33"/>
</body></body></worldbody></mujoco>"""


def by_mujoco(q: Any, step: float = 2e-3) -> float:
    """Seconds of a motion by steps of RK4, of masses that are not drawn, without a verdict."""
    world = mujoco.MjModel.from_xml_string(WORLD.format(step=step))
    data = mujoco.MjData(world)
    data.qpos[:] = q
    _, seconds = cpu(lambda: [mujoco.mj_step(world, data) for _ in range(round(SPAN[1] / step))])
    return seconds


def main() -> None:
    parser = options(__doc__)
    parser.add_argument("--members", type=int, default=100_000)
    arguments = parser.parse_args()
    count, rng, model = arguments.members, np.random.default_rng(0), acrobot()
    q, masses = rng.uniform(-2, 2, (count, 2)), rng.uniform(0.7, 1.3, count)
    grid = OutputGrid(count=11)

    def together(some: int) -> Any:
        return simulate_ensemble(
            model,
            q[:some],
            SPAN,
            parameters={"arm.m1": masses[:some]},
            columns=COLUMNS,
            grid=grid,
            integrator=HOW,
        )

    together(1000)  # what is compiled is compiled
    _, tenth = cpu(lambda: together(count // 10))
    small = peak()
    found, seconds = cpu(lambda: together(count))
    print(found)
    given = [{"q": q[k], "parameters": {"arm.m1": masses[k]}} for k in range(ALONE)]
    one_by_one = [simulate(model, **each, span=SPAN, integrator=HOW) for each in given]
    _, alone = cpu(lambda: [simulate(model, **each, span=SPAN, integrator=HOW) for each in given])
    figures = {
        "members": count,
        "seconds of CPU": seconds,
        "microseconds of CPU a motion": 1e6 * seconds / count,
        "microseconds an evaluation": 1e6 * seconds / found.evaluations,
        "evaluations a motion": found.evaluations / count,
        "right": int((found.violation <= 1).sum()),
        "times as quick as one by one": alone / ALONE / (seconds / count),
        "memory at a tenth of the members, MB": small,
        "memory at all, MB": peak(),
        "one by one: right": sum(bool(each.is_right) for each in one_by_one),
        "seconds of CPU at a tenth": tenth,
    }
    figures["MuJoCo RK4 at 2 ms, times as slow"] = by_mujoco(q[0]) / (seconds / count)
    for name, x in figures.items():
        print(f"{name:40} {x:,.4g}")
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
