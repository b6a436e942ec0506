"""Compiled kernels beside Pinocchio, called state by state from Python for the same robot in the same run.

python -m benchmarks.evaluate [--quick] [--json FILE]

Ours, one thread, Python part of the call included, in three forms: *blocks* (`Kernel.blocks`: independent entries, vectors
of states), *rows* (`evaluate_into`: M and Q as dense arrays of every state, Gamma as its independent entries), *dense* (Gamma
as well: of 34^3 = 39,304 numbers 1,953 are independent). Pinocchio: crba, computeGeneralizedGravity, computeCoriolisMatrix
for one state after the other. What a call from Python costs is measured with an empty model and given beside ("calls");
"net" leaves it out. The ratios are those of blocks. Rounds alternate and take about the same time each; medians.
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import argparse
import gc
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.chains import chain, general_rows, row_of
from benchmarks.derive import humanoid
from benchmarks.peers import Peer
from substructures import Definition, TreeSpec, couple, derive
from substructures.compile import Kernel, compile_program
from substructures.compile.engine import shared_runtime
from substructures.compile.target import host
from substructures.expr.bind import bind
from substructures.model import Model
from substructures.states import default_number

Array = Any
#: states of a batch; the results of a batch should stay in the third-level cache
BATCHES = {"6r": 4096, "34": 1024}
#: states that Pinocchio is called for in a round
CALLS = 1024
#: seconds of a turn, at least
TURN = 5e-3
ONE = ("crba", "computeGeneralizedGravity")
ALL = (*ONE, "computeCoriolisMatrix")
METRIC_FORCES = ("metric", "forces")
EVERYTHING = (*METRIC_FORCES, "christoffel")


@dataclass
class Robot:
    """A model with numbers for its parameters, random states, and the same robot in Pinocchio."""

    name: str
    model: Model
    peer: Peer
    numbers: dict[str, float]
    q: Array
    qd: Array

    @classmethod
    def of(
        cls, name: str, spec: TreeSpec, library: Mapping[str, Definition], values: dict[str, float], batch: int
    ) -> Robot:
        """Couples the tree; parameters without a value have their defaults."""
        model = couple(spec, {i.name: derive(library[str(i.substructure)]) for i in spec.instances})
        numbers = {
            n: default_number(p["value"]) for n, p in model.parameters.items() if p["value"] is not None
        } | values
        # actuators rest; velocities and times that no force depends on do not matter
        numbers |= {s.name: 0.0 for s in model.program.symbols if s.kind not in ("parameter", "inertia", "coordinate")}
        q, qd = np.random.default_rng(0).uniform(-3, 3, (2, batch, model.dof))
        return cls(name, model, Peer.of(spec, library, numbers), numbers, q, qd)

    def kernel(self, names: tuple[str, ...]) -> Kernel:
        """Compiled anew."""
        return compile_program(self.model.program, names)

    def ours(self, kernel: Kernel, packed: tuple[str, ...] = ("christoffel",)) -> Callable[[], Any]:
        """One batch into arrays that are used again."""
        columns = [(self.model.coordinates, self.q)]
        out = {n: np.zeros((len(self.q), *kernel.shape(n, n in packed))) for n in kernel.names}
        return lambda: kernel.evaluate_into(out, self.numbers, columns=columns, packed=packed, clean=True)

    def in_blocks(self, kernel: Kernel) -> Callable[[], Any]:
        """One batch in the form that the vector unit gives."""
        columns = [(self.model.coordinates, self.q)]
        out = kernel.blocks(self.numbers, columns=columns).array
        return lambda: kernel.blocks(self.numbers, columns=columns, out=out)

    def theirs(self, functions: tuple[str, ...]) -> Callable[[], None]:
        """The same states one by one, each function in a loop of its own."""
        order = np.argsort(self.peer.order)
        q, qd = list(self.q[:CALLS, order]), list(self.qd[:CALLS, order])
        model, data = self.peer.model, self.peer.model.createData()

        def work() -> None:
            for name in functions:
                function = getattr(pin, name)
                if name == "computeCoriolisMatrix":
                    for x, v in zip(q, qd, strict=True):
                        function(model, data, x, v)
                else:
                    for x in q:
                        function(model, data, x)

        return work

    def check(self) -> float:
        """Largest relative deviation of metric, gravity and Coriolis matrix from Pinocchio's."""
        names = ("metric", "gravity", "christoffel")
        found = self.kernel(names).evaluate(self.numbers, columns=[(self.model.coordinates, self.q[:20])])
        order, worst = self.peer.order, 0.0
        place, data = np.argsort(order), self.peer.model.createData()
        for i in range(20):
            x, v = self.q[i][place], self.qd[i][place]
            M = np.triu(pin.crba(self.peer.model, data, x))
            M = (M + np.triu(M, 1).T)[np.ix_(order, order)]
            forces = -pin.computeGeneralizedGravity(self.peer.model, data, x)[order]
            C = pin.computeCoriolisMatrix(self.peer.model, data, x, v)[np.ix_(order, order)]
            pairs = ((found["metric"][i], M), (found["gravity"][i], forces), (found["christoffel"][i] @ self.qd[i], C))
            worst = max(worst, *(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs))
        return worst


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
    """The same large batch with one thread and with two."""
    kernel, count = robot.kernel(EVERYTHING), 8 * len(robot.q)
    columns = [(robot.model.coordinates, np.tile(robot.q, (8, 1)))]
    out = {n: np.zeros((count, *kernel.shape(n, packed=True))) for n in kernel.names}

    def work(n: int) -> tuple[Callable[[], None], int]:
        return lambda: kernel.evaluate_into(out, robot.numbers, columns=columns, packed=True, threads=n), count

    times = alternating({"one": work(1), "two": work(2)}, rounds)
    figures["two_threads"] = ratio(times["one"], times["two"])
    print(f"two threads: {figures['two_threads']:.2f} times one ({robot.name}, {count:,} states)")


def parameters(robot: Robot, figures: dict[str, float], rounds: int) -> None:
    """Free parameters (one set, then a set for every state) beside numbers folded into the program."""
    exact = {n: Fraction(robot.numbers[n]) for n in robot.model.parameters}
    folded = compile_program(bind(robot.model.program, exact), EVERYTHING)
    kernel = robot.kernel(EVERYTHING)
    rest = {n: v for n, v in robot.numbers.items() if n not in exact}
    columns = [(robot.model.coordinates, robot.q)]
    out = {n: np.zeros((len(robot.q), *kernel.shape(n))) for n in kernel.names}
    swept = robot.numbers | {n: np.full(len(robot.q), robot.numbers[n]) for n in exact}
    given = {"folded": (folded, rest), "free": (kernel, robot.numbers), "swept": (kernel, swept)}

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
    evaluate = lambda: kernel.evaluate(robot.numbers, columns=columns, packed=True)  # noqa: E731
    times = alternating({"bound": (prepared, 1), "evaluate": (evaluate, 1)}, 15)
    for name, some in times.items():
        figures[f"one_state_{key}_{name}_us"] = median(some) * 1e6
    print(f"one state, {robot.name}: prepared call {median(times['bound']) * 1e6:.1f} us, ", end="")
    print(f"evaluate {median(times['evaluate']) * 1e6:.1f} us")


def robots() -> tuple[Robot, Robot]:
    """The general 6R chain with random constants, and the humanoid of the catalogue."""
    definition = chain("general-6r", general_rows(6))
    rng = np.random.default_rng(7)
    values = {f"p0.{p}": float(rng.uniform(0.1, 1)) for p in definition.parameters}
    values |= {n: 1 + v for n, v in values.items() if n.startswith(("p0.Ixx", "p0.Iyy", "p0.Izz"))}
    small = Robot.of(
        "general 6R", row_of([definition]), {definition.name: definition}, values | {"g": 9.81}, BATCHES["6r"]
    )
    spec, library = humanoid()
    return small, Robot.of("humanoid, 34 dof", spec, library, {}, BATCHES["34"])


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
    if arguments.json:
        arguments.json.write_text(json.dumps({k: round(v, 6) for k, v in figures.items()}, indent=2) + "\n")


if __name__ == "__main__":
    main()
