"""Loads of trees and of parts of every type against an independent engine, with the forces put in by hand."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from in_depth import seeds

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from random_trees import Plain, random_states  # noqa: E402 -- the engine is optional

from substructures import Definition, TreeSpec, couple, derive  # noqa: E402
from substructures.quantities.from_parts import NumericTree  # noqa: E402
from substructures.quantities.numbers.evaluation import evaluate  # noqa: E402

from .tree_loads import ByHand, one_definition, random_tree, two_definitions  # noqa: E402

TOLERANCE = 1e-10
QUANTITIES = ["forces", "inverse_dynamics", "potential_energy"]


def compare_tree(seed: int) -> float:
    """The largest relative deviation of forces and inverse dynamics of one random tree at two random states."""
    rng = np.random.default_rng(seed)
    definitions = two_definitions(rng)
    tree = random_tree(rng, definitions)
    spec, parts = TreeSpec.read(tree), {name: derive(Definition.read(x)) for name, x in definitions.items()}
    model = couple(spec, parts)
    names = {"k": 1.7, "u": 0.6, "t": 0.8}
    states = random_states(rng, 2, model.dof)
    answer = evaluate(model, QUANTITIES, **states, inputs={"u": 0.6}, t=0.8)
    values = {"u": 0.6, "t": 0.8}
    for mark, field in (("", "q"), ("'", "qd"), ("''", "qdd")):
        values |= {f"{c}{mark}": states[field][:, i] for i, c in enumerate(model.coordinates)}
    # one after the other: each asks for what it needs
    numbers = {x: NumericTree(spec, parts).evaluate(values, [x])[x] for x in QUANTITIES}
    worst = max(float(np.abs(numbers[x] - answer[x]).max()) for x in QUANTITIES)
    assert worst < 1e-11 * max(float(np.abs(answer[x]).max()) for x in QUANTITIES)
    for i in range(2):
        hand = ByHand(tree, list(model.coordinates), states["q"][i], states["qd"][i], names)
        Q = np.sum([hand.force(load) for load in tree["loads"]], axis=0)
        a = np.zeros(model.dof)
        a[hand.order] = states["qdd"][i]
        weight = -pin.computeGeneralizedGravity(hand.engine.model, hand.data, hand.q)[hand.order]
        tau = pin.rnea(hand.engine.model, hand.data, hand.q, hand.v, a)[hand.order] - Q
        for found, expected in ((answer["forces"][i], weight + Q), (answer["inverse_dynamics"][i], tau)):
            scale = max(float(np.abs(expected).max()), 1e-2)
            worst = max(worst, float(np.abs(found - expected).max()) / scale)
    return worst


@pytest.mark.parametrize("block", seeds(1, 10))
def test_hundred_random_trees(block: int) -> None:
    for seed in range(10 * block, 10 * block + 10):
        assert compare_tree(seed) < TOLERANCE, f"seed {seed}"


def own_definition(tree: Plain) -> Plain:
    """The tree as one definition with its loads between its own frames: names a_b1, a_q1, ..."""

    def named(value: Any) -> Any:
        if isinstance(value, list):
            return [named(x) for x in value]
        if isinstance(value, dict):
            return {key: named(x) for key, x in value.items()}
        return re.sub(r"\b([ab])\.(\w+)", r"\1_\2", value) if isinstance(value, str) else value

    loads = [{key: named(value) for key, value in load.items() if key != "name"} for load in tree["loads"]]
    symbols = {"parameters": tree["parameters"], "inputs": tree["inputs"]}
    return {**one_definition(tree), **symbols, "loads": loads}


@pytest.mark.parametrize("seed", seeds(8, 30))
def test_loads_within_a_part(seed: int) -> None:
    """The same loads between bodies of one definition; a spring there has no ports."""
    rng = np.random.default_rng(seed)
    definitions = two_definitions(rng)
    tree = random_tree(rng, definitions)
    own = [load for load in tree["loads"] if "world" not in (load.get("from"), *load.get("along", ()))]
    inner = [load for load in own if load["type"] != "spring"]
    some = tree["loads"] = [load for load in inner if not re.search(r"\(world", str(load))]
    part = derive(Definition.read(own_definition(tree)))
    spec = TreeSpec.read(
        {"name": "t", "gravity": tree["gravity"], "instances": [{"name": "x", "substructure": "whole"}]}
    )
    model = couple(spec, {"x": part})
    names, states = {"k": 1.7, "u": 0.6, "t": 0.8}, random_states(rng, 2, model.dof)
    answer = evaluate(model, QUANTITIES, **states, inputs={"x.u": 0.6}, t=0.8)
    coordinates = [c.removeprefix("x.").replace("_", ".", 1) for c in model.coordinates]
    for i in range(2):
        hand = ByHand(tree, coordinates, states["q"][i], states["qd"][i], names)
        Q = np.sum([hand.force(load) for load in some], axis=0)
        weight = -pin.computeGeneralizedGravity(hand.engine.model, hand.data, hand.q)[hand.order]
        scale = max(float(np.abs(weight + Q).max()), 1e-2)
        assert np.abs(answer["forces"][i] - weight - Q).max() < TOLERANCE * scale
