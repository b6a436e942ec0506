"""The first numbers of a tree that was just put together: straight from stored parts, nothing compiled."""

from __future__ import annotations

from statistics import median
from time import perf_counter

from substructures import Definition, TreeSpec, catalogue, derive
from substructures.numeric import NumericTree
from substructures.states import default_number


def first_answer(figures: dict[str, float], rounds: int) -> None:
    """A Puma 560 mounted on a UR5, 6 + 6 dof: metric and forces for one state, from the tree document on."""
    parts = {name: derive(Definition.read(catalogue.load(part))) for name, part in (("a", "ur5"), ("b", "puma560"))}
    instances = [
        {"name": "a", "substructure": "ur5"},
        {"name": "b", "substructure": "puma560", "at": "a.flange", "placement": {"position": [0, 0, "0.1"]}},
    ]
    document = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": instances}
    values = dict.fromkeys((f"{name}.{c}" for name, part in parts.items() for c in part.coordinates), 0.3)
    for name, part in parts.items():
        values |= {f"{name}.{p}": default_number(d["value"]) for p, d in part.parameters.items()}
    times = []
    for _ in range(rounds):
        start = perf_counter()
        NumericTree(TreeSpec.read(document), parts).evaluate(values, ("metric", "forces"))
        times.append(perf_counter() - start)
    figures["first_answer_6_6_ms"] = median(times) * 1e3
    print(f"first numbers of a new 6 + 6 dof tree, from its document on: {figures['first_answer_6_6_ms']:.1f} ms")
