"""Coupled = in one piece, for every possible cut; orders of coupling; parts that change nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import deep
from random_cuts import all_cuts, coupled, cut_tree
from random_trees import (
    Kind,
    Plain,
    coordinates_of,
    model_of,
    random_definition,
    random_states,
    vector,
    with_parameters,
)

from substructures import Model
from substructures.quantities.numbers.evaluation import evaluate

TOLERANCE = 1e-10
QUANTITIES = ["metric", "christoffel", "gravity", "forces", "potential_energy", "kinematics", "momentum"]
INPUTS = {"u1": 0.7, "u2": -0.4}

#: six chains and six trees
MECHANISMS = [
    Kind(6, chain=True, joints=("revolute",), depth=6),
    Kind(5, chain=True, joints=("revolute", "prismatic"), depth=6),
    Kind(5, chain=True, joints=("revolute", "prismatic", "fixed")),
    Kind(4, chain=True, depth=8),
    Kind(4, chain=True, joints=("universal", "cylindrical", "revolute"), depth=8),
    Kind(5, chain=True, springs=3, joints=("revolute", "prismatic")),
    Kind(6, joints=("revolute",), depth=6),
    Kind(6, joints=("revolute", "prismatic", "fixed")),
    Kind(5),
    Kind(5, depth=10, loads=6),
    Kind(4, joints=("free", "revolute", "planar"), depth=10),
    Kind(6, joints=("fixed", "revolute"), springs=2),
]


def mechanism(number: int) -> tuple[Plain, list[tuple[str, ...]]]:
    """A mechanism (every other one with parameters) and all its cuts."""
    rng = np.random.default_rng(9000 + number)
    definition = random_definition(rng, MECHANISMS[number])
    while sum(len(coordinates_of(body)) for body in definition["bodies"]) < 3:
        definition = random_definition(rng, MECHANISMS[number])
    definition = with_parameters(rng, definition, 0.5 if number % 2 else 0)
    return definition, list(all_cuts(definition))


def answers(model: Model, q: dict[str, Any], qd: dict[str, Any]) -> dict[str, Any]:
    """Evaluated at states by coordinate name (without the instance), quantities in the order of sorted names."""
    names = [c.split(".")[1] for c in model.coordinates]
    order = np.argsort(names)
    inputs = {s.name: [INPUTS.get(s.name.split(".")[-1], 0.3)] for s in model.program.symbols if s.kind == "input"}
    inputs = {name: value * 2 for name, value in inputs.items()}
    request = {"quantities": QUANTITIES, "inputs": inputs, "t": 0.3}
    states = {k: np.stack([x[c] for c in names], axis=1) for k, x in (("q", q), ("qd", qd))} if names else {}
    answer = evaluate(model, **(request | states))
    result = {name: answer[name] for name in ("potential_energy",)}
    result |= {f"momentum {k}": x for k, x in answer["momentum"].items()}
    for name, axes in (("metric", 2), ("christoffel", 3), ("gravity", 1), ("forces", 1)):
        x = answer[name]
        for axis in range(1, axes + 1):
            x = np.take(x, order, axis=axis)
        result[name] = x
    for f, frame in enumerate(answer.frames or ()):
        short = frame.split(".")[1]
        if short != "base" and not short.startswith("seat"):
            k = answer["kinematics"]
            result |= {f"{name} {short}": k[name][:, f] for name in ("position", "rotation")}
            result |= {f"{name} {short}": k[name][:, f][:, order] for name in ("U", "Omega")}
    return result


def states_of(model: Model, seed: int = 0) -> tuple[dict[str, Any], dict[str, Any]]:
    states = random_states(np.random.default_rng(seed), 2, model.dof)
    names = [c.split(".")[1] for c in model.coordinates]
    return tuple({c: states[k][:, i] for i, c in enumerate(names)} for k in ("q", "qd"))


def assert_same(found: dict[str, Any], expected: dict[str, Any], some: bool = False) -> float:
    """Relative to the largest entry of every quantity."""
    assert some or found.keys() == expected.keys()
    worst = 0.0
    for name, x in expected.items():
        scale = max(float(np.abs(x).max(initial=0)), 1.0)
        error = float(np.abs(found[name] - x).max(initial=0)) / scale
        assert error < TOLERANCE, (name, error)
        worst = max(worst, error)
    return worst


def check(number: int, chosen: list[int]) -> float:
    definition, cuts = mechanism(number)
    whole = model_of(definition)
    q, qd = states_of(whole)
    expected = answers(whole, q, qd)
    worst = 0.0
    for i in chosen:
        tree = cut_tree(np.random.default_rng(100 * number + i), definition, cuts[i])
        worst = max(worst, assert_same(answers(coupled(tree), q, qd), expected))
    return worst


@pytest.mark.parametrize("number", [1, 3, 5, 7, 9, 10, *deep(0, 2, 4, 6, 8, 11)])
def test_some_cuts(number: int) -> None:
    """Each joint alone is not enough: two drawn, and the one into single bodies."""
    size = 2 ** MECHANISMS[number].bodies
    check(number, [*np.random.default_rng(number).integers(1, size - 1, 2), size - 1])


@pytest.mark.deep
@pytest.mark.parametrize("number", range(len(MECHANISMS)))
def test_every_cut(number: int) -> None:
    size = 2 ** MECHANISMS[number].bodies
    print(f"mechanism {number}, {size} cuts: largest relative deviation {check(number, list(range(size))):.2g}")


@pytest.mark.parametrize("number", [3, 7, 9])
def test_two_orders_of_coupling_agree(number: int) -> None:
    """Instances in another order: the same coordinates and numbers, permuted."""
    definition, cuts = mechanism(number)
    tree = cut_tree(np.random.default_rng(1), definition, cuts[-1])
    other = tree | {"instances": tree["instances"][::-1]}
    one, two = coupled(tree), coupled(other)
    assert set(one.coordinates) == set(two.coordinates)
    q, qd = states_of(one)
    assert_same(answers(two, q, qd), answers(one, q, qd))


def hosted(seed: int, guest: Plain, share: float = 0.5) -> tuple[Model, Model, Plain]:
    """A random host alone, and with the guest on one of its bodies."""
    rng = np.random.default_rng(seed)
    definition = with_parameters(rng, random_definition(rng, Kind(4, depth=7)), share)
    tree = cut_tree(rng, definition, ())
    body = definition["bodies"][-1]["name"]
    mount = {"at": f"rest.{body}", "placement": {"position": vector(rng), "rpy": vector(rng, 3)}}
    more = {"name": "guest", "definition": guest} | mount
    return coupled(tree), coupled(tree | {"instances": [*tree["instances"], more]}), mount


MASSLESS: Plain = {
    "name": "massless",
    "bodies": [
        {"name": "m1", "parent": "base", "joint": {"type": "revolute", "coordinate": "z1", "theta": 0.4, "d": 0.3}},
        {"name": "m2", "parent": "m1", "joint": {"type": "prismatic", "coordinate": "z2", "theta": 1.1}},
        {"name": "m3", "parent": "base", "joint": {"type": "fixed", "d": 0.2}},
    ],
}


@pytest.mark.parametrize("seed", range(3))
def test_a_massless_substructure_changes_nothing(seed: int) -> None:
    alone, together, _ = hosted(seed, MASSLESS)
    q, qd = states_of(alone)
    extra = {"z1": np.array([0.4, -1.0]), "z2": np.array([1.3, 0.2])}
    found, expected = answers(together, q | extra, qd | extra), answers(alone, q, qd)
    n = alone.dof
    # sorted by name, z1 and z2 come last
    for name in ("metric", "christoffel", "gravity"):
        rest = found[name].copy()
        rest[(slice(None), *(slice(0, n),) * (rest.ndim - 1))] = 0
        assert not rest.any()
    cut = {
        k: x[(slice(None), *(slice(0, n),) * (x.ndim - 1))] for k, x in found.items() if k in ("metric", "christoffel")
    }
    cut |= {k: found[k][:, :n] for k in ("gravity", "forces")}
    cut |= {k: found[k][:, :n] for k in expected if k.startswith(("U ", "Omega "))}
    assert_same(found | cut, expected, some=True)
    assert together.operations["metric"] == alone.operations["metric"]
    assert together.operations["christoffel"] == alone.operations["christoffel"]


@pytest.mark.parametrize("seed", range(3))
def test_a_tool_without_joints_equals_a_fixed_body(seed: int) -> None:
    tool = {"mass": 0.7, "com": [0.1, -0.2, 0.3], "inertia": {"xx": 0.03, "yy": 0.04, "zz": 0.05, "xy": 0.004}}
    guest = {"name": "tool", "bodies": [{"name": "tool", "parent": "base", "joint": {"type": "fixed"}, **tool}]}
    _, together, mount = hosted(seed, guest)
    rng = np.random.default_rng(seed)
    definition = with_parameters(rng, random_definition(rng, Kind(4, depth=7)), 0.5)
    parent = definition["bodies"][-1]["name"]
    joint = {"type": "fixed", "placement": mount["placement"]}
    definition["bodies"].append({"name": "tool", "parent": parent, "joint": joint, **tool})
    whole = model_of(definition)
    q, qd = states_of(whole)
    assert_same(answers(together, q, qd), answers(whole, q, qd))
