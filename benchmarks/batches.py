"""Batches for two threads, with parameters that vary, with one position, and larger than the memory."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from fractions import Fraction
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.robots import EVERYTHING, METRIC_FORCES, Robot
from benchmarks.timing import alternating, ratio
from substructures.compile import Kernel, compile_program
from substructures.compile.engine import workers
from substructures.expr.bind import bind


def threads(robot: Robot, figures: dict[str, float], rounds: int) -> None:
    """The same large batch with one thread and with two; with Gamma the memory is the limit rather than the cores."""
    for names, times_larger, figure in ((METRIC_FORCES, 64, "two_threads"), (EVERYTHING, 16, "two_threads_all")):
        kernel, count = robot.kernel(names), times_larger * len(robot.q)
        columns = [(robot.model.coordinates, np.tile(robot.q, (times_larger, 1)))]
        out = {n: np.zeros((count, *kernel.shape(n, packed=True))) for n in names}

        def work(n: int, kernel: Kernel = kernel, out: Any = out, columns: Any = columns) -> Callable[[], Any]:
            return lambda: kernel.evaluate_into(out, robot.numbers, columns=columns, packed=True, threads=n)

        times = alternating({"one": (work(1), count), "two": (work(2), count)}, rounds, perf_counter)
        figures[figure] = ratio(times["one"], times["two"])
        figures["two_threads_machine"] = free_threads(rounds)
        print(
            f"two threads: {figures[figure]:.2f} times one ({robot.name}, {count:,} states, {', '.join(names)});"
            f" threads that share nothing: {figures['two_threads_machine']:.2f}"
        )


def free_threads(rounds: int) -> float:
    """What the machine gives two threads just now: hashing, in the first-level cache and without the interpreter."""
    data = bytes(2**14)

    def one() -> None:
        for _ in range(200):
            hashlib.sha256(data)

    def two() -> None:
        other = workers().submit(one)
        one()
        other.result()

    times = alternating({"one": (one, 1), "two": (two, 2)}, rounds, perf_counter)
    return ratio(times["one"], times["two"])


def parameters(robot: Robot, figures: dict[str, float], rounds: int) -> None:
    """Free parameters (one set, then a set for every state) beside numbers folded into the program."""
    program = robot.model.program
    exact = {s.name: Fraction(robot.numbers[s.name]) for s in program.symbols if s.name in robot.model.parameters}
    folded = compile_program(bind(program, exact), EVERYTHING)
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


def one_position(robot: Robot, key: str, figures: dict[str, float], rounds: int) -> None:
    """Many velocities at one position beside a position for every state: metric, forces and bias."""
    names = ("metric", "forces", "bias")
    kernel, count = robot.kernel(names), len(robot.q)
    velocities = ([f"{c}'" for c in robot.model.coordinates], robot.qd)
    out = {n: np.zeros((count, *kernel.shape(n))) for n in names}

    def work(q: Any) -> tuple[Callable[[], None], int]:
        columns = [(robot.model.coordinates, q), velocities]
        return lambda: kernel.evaluate_into(out, robot.numbers, columns=columns, clean=True), count

    times = alternating({"one": work(robot.q[:1]), "all": work(robot.q)}, rounds)
    figures[key] = ratio(times["one"], times["all"])
    print(
        f"M, Q and bias for many velocities at one position: {figures[key]:.2f} times the time for as many positions"
        f" ({robot.name})"
    )


def ten_million(figures: dict[str, float]) -> None:
    """10^7 states through one kernel in a process of its own: rate, and peak of memory."""
    command = [sys.executable, "-m", "benchmarks.stream"]
    found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    figures |= {"stream_1e7_mib": found["mib"], "stream_1e7_states_per_s": found["states_per_s"]}
    print(
        f"10^7 states of the UR5, M and Q, as a stream: {found['states_per_s'] / 1e6:.1f} million states a second with"
        f" one thread, peak of the whole process {found['mib']:.0f} MiB"
    )
