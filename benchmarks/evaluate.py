"""Compiled kernels beside Pinocchio, called state by state from Python for the same robot in the same run.

python -m benchmarks.evaluate [--quick] [--json FILE]

Ours, one thread, Python part of the call included, in three forms: *blocks* (`Kernel.blocks`: independent entries,
vectors of states), *rows* (`evaluate_into`: M and Q as dense arrays of every state, Gamma as its independent entries),
*dense* (Gamma as well: of 34^3 = 39,304 numbers 1,953 are independent). Pinocchio: crba, computeGeneralizedGravity,
computeCoriolisMatrix for one state after the other. What a call from Python costs is measured with an empty model and
given beside ("calls"); "net" leaves it out. The ratios are those of blocks, and of the other forms beside. Rounds
alternate and take about the same time each; medians of the time that the thread has computed. Beside MuJoCo, where it
is installed, in the same way: metric (mj_crb), gravity and velocity forces (mj_rne) beside M, Q and bias.
"""

from __future__ import annotations

import gc
from collections.abc import Callable
from statistics import median
from time import thread_time
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.batches import one_position, parameters, ten_million, threads
from benchmarks.first_answer import first_answer
from benchmarks.mujoco_robots import beside_mujoco
from benchmarks.report import keep, options
from benchmarks.robots import CALLS, EVERYTHING, METRIC_FORCES, Robot, robots
from benchmarks.timing import alternating, ratio
from substructures.compile import compile_program
from substructures.compile.engine import shared_runtime
from substructures.compile.target import host

Array = Any
ONE = ("crba", "computeGeneralizedGravity")
ALL = (*ONE, "computeCoriolisMatrix")


def empty_calls(functions: tuple[str, ...]) -> Callable[[], None]:
    """As many calls as for a batch, for a model without joints."""
    model = pin.Model()
    data, none = model.createData(), np.zeros(0)

    def work() -> None:
        for name in functions:
            function = getattr(pin, name)
            given = (none, none) if name == "computeCoriolisMatrix" else (none,)
            for _ in range(CALLS):
                function(model, data, *given)

    return work


def compiling(robot: Robot, key: str, figures: dict[str, float], repeat: int) -> None:
    """Lowering, LLVM and loading, for metric, forces and Christoffel symbols."""
    seconds = []
    for _ in range(repeat):
        # a program read anew has no remembered order of operations
        fresh = type(robot.model.program).from_bytes(robot.model.program.to_bytes())
        gc.collect()
        start = thread_time()
        compile_program(fresh, EVERYTHING)
        seconds.append(thread_time() - start)
    figures[f"compile_{key}_s"] = median(seconds)
    size = robot.model.program.count(EVERYTHING)["total"]
    print(f"{robot.name}: {size:,} operations compiled in {median(seconds):.3f} s")


def beside_pinocchio(robot: Robot, key: str, figures: dict[str, float], rounds: int) -> None:
    """The table."""
    for names, functions, figure in ((METRIC_FORCES, ONE, "metric_forces"), (EVERYTHING, ALL, "all")):
        kernel = robot.kernel(names)
        count, gamma = len(robot.q), "christoffel" in names
        works = {
            "blocks": (robot.in_blocks(kernel), count),
            "rows": (robot.ours(kernel), count),
            "dense": (robot.ours(kernel, packed=()), count),
            "theirs": (robot.theirs(functions), CALLS),
            "calls": (empty_calls(functions), CALLS),
        }
        times = alternating(works, rounds)
        name = f"ratio_{key}_{figure}"
        figures[name] = ratio(times["theirs"], times["blocks"])
        figures[f"{name}_rows"] = ratio(times["theirs"], times["rows"])
        figures[f"{name}_dense"] = ratio(times["theirs"], times["dense"])
        net = [t - e for t, e in zip(times["theirs"], times["calls"], strict=True)]
        figures[f"{name}_net"] = ratio(net, times["blocks"])
        us = [median(some) * 1e6 for some in times.values()]
        cells = " ".join(f"{x:>9.3f}" for x in us)
        ratios = " ".join(f"{figures[name + form]:>6.1f}" for form in ("", "_rows", "_dense", "_net"))
        print(f"{robot.name + (': M, Q, all Gamma' if gamma else ': M, Q'):>34} {cells} {ratios}")


def one_state(robot: Robot, key: str, figures: dict[str, float]) -> None:
    """Latency of a single state: prepared call, and evaluate."""
    kernel = robot.kernel(EVERYTHING)
    state = robot.q[:1].copy()
    columns = [(robot.model.coordinates, state)]
    out = {n: np.zeros((1, *kernel.shape(n, packed=True))) for n in kernel.names}
    prepared = kernel.bind(out, robot.numbers, columns=columns, packed=True)

    def evaluate() -> Any:
        return kernel.evaluate(robot.numbers, columns=columns, packed=True)

    times = alternating({"bound": (prepared, 1), "evaluate": (evaluate, 1)}, 15)
    for name, some in times.items():
        figures[f"one_state_{key}_{name}_us"] = median(some) * 1e6
    print(f"one state, {robot.name}: prepared call {median(times['bound']) * 1e6:.1f} us, ", end="")
    print(f"evaluate {median(times['evaluate']) * 1e6:.1f} us")


def main() -> None:
    """Print the tables; with --json FILE write the figures."""
    arguments = options(__doc__, "fewer rounds").parse_args()
    rounds = 7 if arguments.quick else 31
    figures: dict[str, float] = {}
    small, large = robots()
    start = thread_time()
    shared_runtime(host().width)
    figures["compile_shared_s"] = thread_time() - start
    print(f"{host().cpu}, {host().width} doubles in a vector, {host().compiler}; Pinocchio {pin.__version__}")
    print(f"functions shared by all kernels, once in a process: {figures['compile_shared_s']:.3f} s")
    compiling(small, "6r", figures, 7)
    compiling(large, "34", figures, 3)
    for robot in (small, large):
        print(f"{robot.name}: largest relative deviation from Pinocchio {robot.check():.1e}")
    titles = ("blocks", "rows", "dense", "Pinocchio", "(calls)")
    print(f"\n{'us per state':>34} {' '.join(f'{x:>9}' for x in titles)}  ratio   rows  dense    net")
    beside_pinocchio(small, "6r", figures, rounds)
    beside_pinocchio(large, "34", figures, rounds)
    print()
    titles = ("blocks", "rows", "MuJoCo", "(calls)")
    print(f"{'us per state':>34} {' '.join(f'{x:>9}' for x in titles)}  ratio   rows    net")
    beside_mujoco(small, "6r", figures, rounds)
    beside_mujoco(large, "34", figures, rounds)
    print()
    parameters(small, figures, rounds)
    one_position(small, "one_position", figures, rounds)
    one_position(large, "one_position_34", figures, rounds)
    threads(small, figures, rounds)
    one_state(small, "6r", figures)
    one_state(large, "34", figures)
    first_answer(figures, rounds)
    ten_million(figures)
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
