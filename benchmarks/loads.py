"""Coupling 6 + 6 dof with ten loads of a tree beside coupling without: process time, in turns, medians and operations.

Run ``python -m benchmarks.loads``. The loads are one or two of every type, between frames of both arms and the world.
"""

from __future__ import annotations

from statistics import median
from time import process_time
from typing import Any

from substructures import Definition, TreeSpec, catalogue, couple, derive

Plain = dict[str, Any]
ROUNDS = 15


def ten_loads() -> list[Plain]:
    ends = {"from": "a.flange", "to": "b.flange"}
    return [
        {"name": "l0", "type": "spring", **ends, "stiffness": 100, "damping": 1, "length": 0.1},
        {"name": "l1", "type": "spring", "from": "a.link3", "to": "b.link2", "stiffness": 50},
        {"name": "l2", "type": "spring", "to": "b.link3", "to_at": [0.1, 0, 0], "stiffness": 50, "length": 0.2},
        {"name": "l3", "type": "bushing", "from": "a.link2", "to": "b.link1", "stiffness": [1, 2, 3]},
        {"name": "l4", "type": "force", **ends, "at": [0, 0, 0.1], "vector": ["u", 0, 0]},
        {"name": "l5", "type": "force", "to": "a.flange", "vector": [0, "u", 0], "axes": "world"},
        {"name": "l6", "type": "torque", **ends, "vector": [0, 0, "u"]},
        {"name": "l7", "type": "joint", "coordinate": "a.q3", "force": "-2*a.q3'^3"},
        {"name": "l8", "type": "potential", "potential": "3*(a.q1 - b.q1)^2"},
        {"name": "l9", "type": "potential", "potential": "20*(distance(a.link4, b.link4) - 1)^2"},
    ]


def tree(loads: list[Plain]) -> TreeSpec:
    instances = [
        {"name": "a", "substructure": "puma560"},
        {"name": "b", "substructure": "puma560", "at": "a.flange", "placement": {"position": [0, 0, 0.2]}},
    ]
    given = {"name": "pair", "gravity": [0, 0, "-9.81"], "instances": instances, "inputs": {"u": {}}, "loads": loads}
    return TreeSpec.read(given)


def main() -> None:
    part = derive(Definition.read(catalogue.load("puma560")))
    trees = {"without": tree([]), "with ten": tree(ten_loads())}
    times: dict[str, list[float]] = {name: [] for name in trees}
    for _ in range(ROUNDS):
        for name, spec in trees.items():
            start = process_time()
            model = couple(spec, {"a": part, "b": part})
            times[name].append(process_time() - start)
    ratio = median(y / x for x, y in zip(*times.values(), strict=True))
    for name, spec in trees.items():
        model = couple(spec, {"a": part, "b": part})
        verify, formulas = model.certificate["seconds"]["verify"], model.certificate["seconds"]["couple"]
        print(
            f"{name:10} {1e3 * median(times[name]):7.1f} ms CPU ({formulas:.3f} s coupled, {verify:.3f} s verified), "
            f"{model.operations['forces']} operations of Q, {model.operations['total']} of M, Gamma, Q"
        )
    print(f"with ten loads / without: {ratio:.2f} (median of {ROUNDS} pairs)")


if __name__ == "__main__":
    main()
