"""Batches for two threads, with parameters that vary, with one position, and larger than the memory."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from multiprocessing import get_context
from multiprocessing.connection import Connection
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.robots import EVERYTHING, METRIC_FORCES, Robot
from benchmarks.timing import alternating, ratio
from substructures.compile import Kernel, compile_program
from substructures.expr.bind import bind


def threads(robot: Robot, figures: dict[str, float], rounds: int) -> None:
    """The same large batch with one thread and with two, and in halves by two processes, which share nothing: what the
    machine gives just now.
    """
    for names, times_larger, figure in ((METRIC_FORCES, 64, "two_threads"), (EVERYTHING, 16, "two_threads_all")):
        kernel, count = robot.kernel(names), times_larger * len(robot.q)
        q = np.tile(robot.q, (times_larger, 1))
        out = {n: np.zeros((count, *kernel.shape(n, packed=True))) for n in names}

        def work(n: int, size: int, kernel: Kernel = kernel, out: Any = out, q: Any = q) -> Callable[[], Any]:
            some = {name: array[:size] for name, array in out.items()}
            columns = [(robot.model.coordinates, q[:size])]
            return lambda: kernel.evaluate_into(some, robot.numbers, columns=columns, packed=True, threads=n)

        with in_processes([work(1, count // 2)] * 2) as halves:
            works = {"one": (work(1, count), count), "two": (work(2, count), count), "halves": (halves, count)}
            times = alternating(works, rounds, perf_counter)
        figures[figure] = ratio(times["one"], times["two"])
        figures[f"{figure}_machine"] = ratio(times["one"], times["halves"])
        print(
            f"two threads: {figures[figure]:.2f} times one ({robot.name}, {count:,} states, {', '.join(names)});"
            f" two processes with half of the states each: {figures[f'{figure}_machine']:.2f}"
        )


@contextmanager
def in_processes(works: Sequence[Callable[[], Any]]) -> Iterator[Callable[[], None]]:
    """A call that does each work once in a process of its own, with memory of its own, all at a time."""

    def serve(end: Connection, work: Callable[[], Any]) -> None:
        while end.recv():
            work()
            end.send(True)

    context, ends = get_context("fork"), list[Connection]()
    for work in works:
        end, other = context.Pipe()
        context.Process(target=serve, args=(other, work), daemon=True).start()
        ends.append(end)

    def once() -> None:
        for end in ends:
            end.send(True)
        for end in ends:
            end.recv()

    try:
        yield once
    finally:
        for end in ends:
            end.send(False)


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
