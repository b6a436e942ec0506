"""Forward and inverse dynamics and their directional derivatives as compiled formulas, beside Pinocchio.

python -m benchmarks.dynamics [--quick] [--json FILE]

Forward dynamics by formulas (g = L^T D L within the kernel) stands beside metric, bias and forces from a kernel and
Cholesky's factors by numpy, and beside aba called from Python for one state after the other; inverse dynamics beside
rnea. Pinocchio gives all n columns of the derivatives of forward dynamics in one call of computeABADerivatives, ours
is one direction: the time of n directions is given, too. One thread, medians, the Python part of all calls included.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.report import keep, options
from benchmarks.robots import CALLS, Robot, robots
from benchmarks.timing import alternating, ratio
from substructures.compile import Kernel, compile_program
from substructures.mechanics.accelerations import cholesky_solve
from substructures.quantities.formulas import DYNAMICS, derived

FORWARD, DERIVATIVE = "forward_dynamics", "forward_dynamics_derivative"


def values_of(robot: Robot, kernel: Kernel) -> dict[str, Any]:
    """Accelerations and directions of one, everything else as in the other benchmarks."""
    return {name: robot.numbers.get(name, 1.0) for name in kernel.symbols}


def ours(robot: Robot, kernel: Kernel) -> Callable[[], Any]:
    """One batch into arrays that are used again."""
    rates = tuple(f"{name}'" for name in robot.model.coordinates)
    columns = [(robot.model.coordinates, robot.q), (rates, robot.qd)]
    values = values_of(robot, kernel)
    out = {name: np.zeros((len(robot.q), *kernel.shape(name))) for name in kernel.names}
    return lambda: kernel.evaluate_into(out, values, columns=columns, clean=True) or out


def by_numbers(robot: Robot) -> Callable[[], Any]:
    """Metric, bias and forces, then Cholesky."""
    found = ours(robot, compile_program(robot.model.program, DYNAMICS))

    def work() -> Any:
        x = found()
        return cholesky_solve(x["metric"], x["forces"] - x["bias"])

    return work


def theirs(robot: Robot, name: str) -> Callable[[], None]:
    """A function of Pinocchio for the same states one by one."""
    place = np.argsort(robot.peer.order)
    states = list(zip(robot.q[:CALLS, place], robot.qd[:CALLS, place], strict=True))
    model, data, function = robot.peer.model, robot.peer.model.createData(), getattr(pin, name)
    rest = np.zeros(robot.model.dof)

    def work() -> None:
        for q, qd in states:
            function(model, data, q, qd, rest)

    return work


def deviation(robot: Robot, forward: Callable[[], Any]) -> float:
    """Largest relative deviation of accelerations from Pinocchio's, by the residual of inverse dynamics."""
    found, order = forward()[FORWARD][:20], robot.peer.order
    place, data, worst = np.argsort(order), robot.peer.model.createData(), 0.0
    for q, qd, qdd in zip(robot.q, robot.qd, found, strict=False):
        residual = pin.rnea(robot.peer.model, data, q[place], qd[place], qdd[place])
        size = np.abs(pin.crba(robot.peer.model, data, q[place]) * qdd[place]).max()
        worst = max(worst, float(np.abs(residual).max() / size))
    return worst


def dynamics(robot: Robot, key: str, figures: dict[str, float], rounds: int) -> None:
    """The table of a robot."""
    kernels = {}
    for name in (FORWARD, "inverse_dynamics", DERIVATIVE):
        start = perf_counter()
        program = derived(robot.model, name)
        middle = perf_counter()
        kernels[name] = compile_program(program, [name])
        figures |= {f"derive_{name}_{key}_s": middle - start, f"compile_{name}_{key}_s": perf_counter() - middle}
        print(f"{robot.name}, {name}: {program.count([name])['total']:,} operations, formed in", end=" ")
        print(f"{middle - start:.3f} s, compiled in {perf_counter() - middle:.3f} s")
    count = len(robot.q)
    works = {name: (ours(robot, kernel), count) for name, kernel in kernels.items()}
    print(f"largest relative residual by Pinocchio's rnea: {deviation(robot, works[FORWARD][0]):.1e}")
    works["cholesky"] = by_numbers(robot), count
    works |= {name: (theirs(robot, name), CALLS) for name in ("aba", "rnea", "computeABADerivatives")}
    times = alternating(works, rounds)
    for name, some in times.items():
        figures[f"{name}_{key}_us"] = median(some) * 1e6
        print(f"{name:>32} {median(some) * 1e6:>9.3f} us a state")
    figures |= {
        f"ratio_{key}_forward": ratio(times["aba"], times[FORWARD]),
        f"ratio_{key}_inverse": ratio(times["rnea"], times["inverse_dynamics"]),
        f"ratio_{key}_forward_derivative": ratio(times["computeABADerivatives"], times[DERIVATIVE]) / robot.model.dof,
        f"forward_{key}_formulas_over_cholesky": ratio(times["cholesky"], times[FORWARD]),
    }
    for name in (f"ratio_{key}_forward", f"ratio_{key}_inverse", f"forward_{key}_formulas_over_cholesky"):
        print(f"{name:>40} {figures[name]:.1f}")


def main() -> None:
    """Print the tables; with --json FILE write the figures."""
    arguments = options(__doc__, "fewer rounds").parse_args()
    figures: dict[str, float] = {}
    for robot, key in zip(robots(), ("6r", "34"), strict=True):
        dynamics(robot, key, figures, 7 if arguments.quick else 31)
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
