"""Compiled kernels beside Pinocchio, called state by state from Python for the same robot in the same run.

python -m benchmarks.evaluate [--quick] [--json FILE]

Ours, one thread, Python part of the call included, in three forms: *blocks* (`Kernel.blocks`: independent entries,
vectors of states), *rows* (`evaluate_into`: M and Q as dense arrays of every state, Gamma as its independent entries),
*dense* (Gamma as well: of 34^3 = 39,304 numbers 1,953 are independent). Pinocchio: crba, computeGeneralizedGravity,
computeCoriolisMatrix for one state after the other. What a call from Python costs is measured with an empty model and
given beside ("calls"); "net" leaves it out. The ratios are those of blocks, and of the other forms beside. Rounds
alternate and take about the same time each; medians.
"""

from __future__ import annotations

import argparse
import gc
import json
from collections.abc import Callable, Mapping
from fractions import Fraction
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.first_answer import first_answer
from benchmarks.robots import CALLS, Robot, robots
from substructures.compile import Kernel, compile_program
from substructures.compile.engine import shared_runtime
from substructures.compile.target import host
from substructures.expr.bind import bind

Array = Any
#: seconds of a turn, at least
TURN = 5e-3
ONE = ("crba", "computeGeneralizedGravity")
ALL = (*ONE, "computeCoriolisMatrix")
METRIC_FORCES = ("metric", "forces")
EVERYTHING = (*METRIC_FORCES, "christoffel")


def alternating(works: Mapping[str, tuple[Callable[[], Any], int]], rounds: int) -> dict[str, list[float]]:
    """Seconds per state of every work (with its number of states) in every round.

    Every turn is repeated to take some milliseconds; the works alternate, so that drifts of the machine cancel.
    """
    times: dict[str, list[float]] = {name: [] for name in works}
    repeat = {}
    for name, (work, _) in works.items():
        work()
        start = perf_counter()
        work()
        repeat[name] = max(1, round(TURN / (perf_counter() - start)))
    gc.collect()
    for _ in range(rounds):
        for name, (work, count) in works.items():
            start = perf_counter()
            for _ in range(repeat[name]):
                work()
            times[name].append((perf_counter() - start) / repeat[name] / count)
    return times


def ratio(a: list[float], b: list[float]) -> float:
    """Median of the ratios of the rounds."""
    return median(x / y for x, y in zip(a, b, strict=True))


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
        start = perf_counter()
        compile_program(fresh, EVERYTHING)
        seconds.append(perf_counter() - start)
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


def threads(robot: Robot, figures: dict[str, float], rounds: int) -> None:
    """The same large batch with one thread and with two; with Gamma the memory is the limit rather than the cores."""
    for names, times_larger, figure in ((METRIC_FORCES, 64, "two_threads"), (EVERYTHING, 16, "two_threads_all")):
        kernel, count = robot.kernel(names), times_larger * len(robot.q)
        columns = [(robot.model.coordinates, np.tile(robot.q, (times_larger, 1)))]
        out = {n: np.zeros((count, *kernel.shape(n, packed=True))) for n in names}

        def work(n: int, kernel: Kernel = kernel, out: Any = out, columns: Any = columns) -> Callable[[], Any]:
            return lambda: kernel.evaluate_into(out, robot.numbers, columns=columns, packed=True, threads=n)

        times = alternating({"one": (work(1), count), "two": (work(2), count)}, rounds)
        figures[figure] = ratio(times["one"], times["two"])
        print(f"two threads: {figures[figure]:.2f} times one ({robot.name}, {count:,} states, {', '.join(names)})")


def parameters(robot: Robot, figures: dict[str, float], rounds: int) -> None:
    """Free parameters (one set, then a set for every state) beside numbers folded into the program."""
    exact = {n: Fraction(robot.numbers[n]) for n in robot.model.parameters}
    folded = compile_program(bind(robot.model.program, exact), EVERYTHING)
    kernel = robot.kernel(EVERYTHING)
    rest = {n: v for n, v in robot.numbers.items() if n not in exact}
    columns = [(robot.model.coordinates, robot.q)]
    out = {n: np.zeros((len(robot.q), *kernel.shape(n))) for n in kernel.names}
    swept = robot.numbers | {n: np.full(len(robot.q), robot.numbers[n]) for n in exact}
    given: dict[str, tuple[Kernel, dict[str, Any]]] = {
        "folded": (folded, rest),
        "free": (kernel, robot.numbers),
        "swept": (kernel, swept),
    }

    def work(k: Kernel, values: Mapping[str, Any]) -> tuple[Callable[[], None], int]:
        return lambda: k.evaluate_into(out, values, columns=columns, clean=True), len(robot.q)

    times = alternating({name: work(k, values) for name, (k, values) in given.items()}, rounds)
    figures["one_parameter_set"] = ratio(times["free"], times["folded"])
    figures["parameter_sweep"] = ratio(times["swept"], times["folded"])
    print(
        f"free parameters beside numbers folded in: {figures['one_parameter_set']:.2f} times the time for one set,"
        f" {figures['parameter_sweep']:.2f} for {len(exact)} parameters that differ in every state ({robot.name})"
    )


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
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer rounds")
    parser.add_argument("--json", type=Path, metavar="FILE")
    arguments = parser.parse_args()
    rounds = 7 if arguments.quick else 31
    figures: dict[str, float] = {}
    small, large = robots()
    start = perf_counter()
    shared_runtime(host().width)
    figures["compile_shared_s"] = perf_counter() - start
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
    parameters(small, figures, rounds)
    threads(small, figures, rounds)
    one_state(small, "6r", figures)
    one_state(large, "34", figures)
    first_answer(figures, rounds)
    if arguments.json:
        arguments.json.write_text(json.dumps({k: round(v, 6) for k, v in figures.items()}, indent=2) + "\n")


if __name__ == "__main__":
    main()
