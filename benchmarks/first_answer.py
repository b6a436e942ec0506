"""The first numbers of a tree that was just put together, by each of the three ways, and which one is chosen.

python -m benchmarks.first_answer [--json FILE]

Metric and forces from the tree document on, with warm parts (their kernels are compiled): *parts* couples numbers and
compiles nothing; *interpreter* couples formulas first; *kernel* couples formulas and compiles them. In brackets the
same for a tree whose formulas are there, as in the service. One thread.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median
from time import perf_counter
from typing import Any

import numpy as np

from benchmarks.derive import humanoid
from benchmarks.report import keep, options
from service.store.kernels import Way, quickest
from substructures import Definition, Model, Part, TreeSpec, catalogue, couple, derive
from substructures.compile import Kernel, compile_program
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.part_kernels import CompiledParts

NAMES = ("forces", "metric")
STATES = (1, 16, 256, 4096, 65536)
#: a measurement is repeated for about this long, at most REPEAT times
SECONDS, REPEAT = 0.3, 15


@dataclass(frozen=True)
class Case:
    """A tree with its parts and default values."""

    key: str
    title: str
    spec: TreeSpec
    parts: Mapping[str, Part]

    def values(self, coordinates: tuple[str, ...], states: int) -> dict[str, Any]:
        """Random states at rest; one state as floats."""
        rng, values = np.random.default_rng(0), {}
        for name, part in self.parts.items():
            values |= {f"{name}.{p}": default_number(d["value"]) for p, d in part.parameters.items()}
        for name, parameter in self.spec.parameters.items():
            values[name] = default_number(parameter.value)
        for c in coordinates:
            values |= {c: rng.uniform(-1, 1, states) if states > 1 else 0.3, f"{c}'": 0.0}
        return values


def cases() -> tuple[Case, Case]:
    """A Puma 560 mounted on a UR5, 6 + 6 dof, and the humanoid, 34 dof from 7 parts."""
    parts = {name: derive(Definition.read(catalogue.load(part))) for name, part in (("a", "ur5"), ("b", "puma560"))}
    instances = [
        {"name": "a", "substructure": "ur5"},
        {"name": "b", "substructure": "puma560", "at": "a.flange", "placement": {"position": [0, 0, "0.1"]}},
    ]
    two = TreeSpec.read({"name": "t", "gravity": [0, 0, "-9.81"], "instances": instances})
    spec, library = humanoid()
    seven = {i.name: derive(library[str(i.substructure)]) for i in spec.instances}
    return Case("6_6", "6 + 6 dof", two, parts), Case("34", "34 dof from 7 parts", spec, seven)


def seconds(work: Callable[[], Any]) -> float:
    """Median wall time."""
    times: list[float] = []
    while not times or (sum(times) < SECONDS and len(times) < REPEAT):
        start = perf_counter()
        work()
        times.append(perf_counter() - start)
    return median(times)


def first_answer(figures: dict[str, float], rounds: int) -> None:
    """The table of both cases; ``rounds`` of the first figure."""
    for case in cases():
        engine = CompiledParts()
        for part in case.parts.values():
            engine.warm(part)
        document = case.spec.model_dump(by_alias=True, exclude_defaults=True)
        tree = NumericTree(case.spec, case.parts, engine)
        one, times = case.values(tree.coordinates, 1), []
        for _ in range(rounds):
            start = perf_counter()
            NumericTree(TreeSpec.read(document), case.parts, engine).evaluate(one, NAMES)
            times.append(perf_counter() - start)
        figures[f"first_answer_{case.key}_ms"] = median(times) * 1e3
        print(f"first numbers of a new tree, {case.title}: {median(times) * 1e3:.1f} ms from its document on")
        crossover(case, tree, figures)


def crossover(case: Case, tree: NumericTree, figures: dict[str, float]) -> None:
    """The three ways for more and more states."""
    model = couple(case.spec, case.parts)
    assembling = seconds(lambda: NumericTree(case.spec, case.parts, tree.engine))
    coupling = seconds(lambda: couple(case.spec, case.parts))
    compiling = seconds(lambda: compile_program(_fresh(model), NAMES))
    kernel = compile_program(model.program, NAMES)
    print(f"{case.title}: formulas coupled and verified in {coupling * 1e3:.0f} ms, compiled in", end=" ")
    print(f"{compiling * 1e3:.0f} ms; milliseconds:")
    print(f"{'states':>8} {'parts':>21} {'interpreter':>21} {'kernel':>21}  chosen")
    losses = []
    for states in STATES:
        values = case.values(tree.coordinates, states)
        run = running(tree, model, kernel, values, states)
        run[Way.KERNEL] += compiling
        total = {way: x + (assembling if way is Way.PARTS else coupling) for way, x in run.items()}
        chosen = quickest(states, coupled=False, warm=True), quickest(states, coupled=True, warm=True)
        losses += [total[chosen[0]] / min(total.values()), run[chosen[1]] / min(run.values())]
        cells = " ".join(f"{total[way] * 1e3:>10.1f} ({run[way] * 1e3:>8.1f})" for way in Way)
        print(f"{states:>8} {cells}  {chosen[0]} ({chosen[1]})")
        figures |= {f"crossover_{case.key}_{way}_{states}_ms": x * 1e3 for way, x in total.items()}
    pace = figures[f"crossover_{case.key}_parts_4096_ms"] / 4096e3
    figures |= {
        f"crossover_{case.key}_states": (coupling + compiling) / pace,
        f"crossover_{case.key}_loss": max(losses),
    }
    print(f"compiling pays off from {(coupling + compiling) / pace:,.0f} states on; the way chosen takes", end=" ")
    print(f"{max(losses):.1f} times as long as the best one, at worst")


def running(tree: NumericTree, model: Model, kernel: Kernel, values: dict[str, Any], states: int) -> dict[Way, float]:
    """Seconds of the three ways when everything is prepared."""
    known = values | {s.name: 0.0 for s in model.program.symbols if s.name not in values}
    return {
        Way.PARTS: seconds(lambda: tree.evaluate(values, NAMES)),
        Way.INTERPRETER: seconds(lambda: interpret_in_blocks(model.program, known, NAMES, states)),
        Way.KERNEL: seconds(lambda: kernel.evaluate(known)),
    }


def _fresh(model: Model) -> Any:
    """The program without what it remembers."""
    return type(model.program).from_bytes(model.program.to_bytes())


def main() -> None:
    """Print the tables; with --json FILE write the figures."""
    arguments = options(__doc__).parse_args()
    figures: dict[str, float] = {}
    first_answer(figures, 15)
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
