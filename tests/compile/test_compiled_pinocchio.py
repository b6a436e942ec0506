"""Kernels of random trees and of the whole catalogue beside Pinocchio."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import CHAINS
from independent import by_coordinate, value, values
from machine_code import NEEDS_MACHINE_CODE
from random_trees import GRAVITY, Kind, model_of, random_definition
from related import joints_of, reduction

from substructures import catalogue
from substructures.compile import compile_program
from substructures.quantities.numbers.defaults import default_number
from substructures.tree.model import Model

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional

pytestmark = NEEDS_MACHINE_CODE

Plain = dict[str, Any]


def compare(model: Model, definition: Plain, numbers: dict[str, float], count: int, gravity: Any) -> float:
    """Largest relative deviation of metric, gravity forces and Coriolis matrix; the definition holds numbers only."""
    if not model.dof:
        return 0.0
    q, qd = np.random.default_rng(count).uniform(-3, 3, (2, count, model.dof))
    kernel = compile_program(model.program, ["metric", "gravity", "christoffel"])
    found = kernel.evaluate(numbers, columns=[(model.coordinates, q)])
    assert all(np.isfinite(found[name]).all() for name in ("metric", "gravity", "christoffel"))
    engine, names = engine_of(definition, gravity), list(joints_of(definition))
    order = engine.order(names)
    N, q0 = reduction(definition, names, [c.removeprefix("x.") for c in model.coordinates])
    place = np.argsort(order)
    joints, rates = (q @ N.T + q0)[:, place], (qd @ N.T)[:, place]
    data, rotors = engine.model.createData(), np.diag(by_coordinate(definition, "armature", names))
    metric, coriolis = np.empty((2, count, len(names), len(names)))
    forces = np.empty((count, len(names)))
    for i in range(count):
        metric[i] = pin.crba(engine.model, data, joints[i])
        coriolis[i] = pin.computeCoriolisMatrix(engine.model, data, joints[i], rates[i])
        forces[i] = -pin.computeGeneralizedGravity(engine.model, data, joints[i])
    upper = np.triu(metric)
    metric = (upper + np.triu(upper, 1).swapaxes(1, 2))[:, order][:, :, order] + rotors
    pairs = (
        (found["metric"], N.T @ metric @ N),
        (found["gravity"], forces[:, order] @ N),
        (np.einsum("iabc,ic->iab", found["christoffel"], qd), N.T @ coriolis[:, order][:, :, order] @ N),
    )
    return max(worst(*pair) for pair in pairs)


def worst(found: Any, expected: Any) -> float:
    """The largest deviation in a state, relative to its largest number there."""
    states = found.reshape(len(found), -1), expected.reshape(len(found), -1)
    return float((np.abs(states[0] - states[1]).max(axis=1) / np.abs(states[1]).max(axis=1).clip(min=1e-2)).max())


def random_tree(seed: int, count: int) -> float:
    rng = np.random.default_rng(seed)
    definition = random_definition(
        rng, Kind(int(rng.integers(2, 7)), bool(rng.integers(2)), loads=0, springs=0, depth=8)
    )
    model = model_of(definition)
    rest = {s.name: 0.0 for s in model.program.symbols} | {n: p["value"] for n, p in model.parameters.items()}
    return compare(model, definition, {n: float(v) for n, v in rest.items()}, count, GRAVITY)


def numeric(definition: Plain, names: dict[str, float]) -> Plain:
    """The definition with numbers for its parameters, as far as the engine reads it."""

    def numbers(given: Any) -> Any:
        if isinstance(given, dict):
            return {k: v if k in ("type", "about", "coordinate", "of") else numbers(v) for k, v in given.items()}
        return values(given, names).tolist() if isinstance(given, list) else value(given, names)

    bodies = [{k: v if k in ("name", "parent") else numbers(v) for k, v in b.items()} for b in definition["bodies"]]
    for body in bodies:
        if "placement" in body["joint"]:
            body["joint"]["placement"] = {"position": [0.0] * 3, "rpy": [0.0] * 3} | body["joint"]["placement"]
    return {"bodies": bodies, "relations": [numbers(each) for each in definition.get("relations", [])]}


def entry(name: str, count: int, tree: Any, states: Any) -> float:
    """An entry of the catalogue by itself."""
    model = tree(("x", name, "world"))
    given = {n: v if np.ndim(v) == 0 else 0.0 for n, v in states(model, 1).items()}
    document = catalogue.load(name)
    # some drop out of the formulas
    known = {n: default_number(p.get("value", 1)) for n, p in document.get("parameters", {}).items()}
    plain = numeric(document, known | {n.removeprefix("x."): v for n, v in given.items()})
    return compare(model, plain, given, count, [0, 0, -9.81])


def test_random_trees() -> None:
    assert max(random_tree(seed, 20) for seed in range(8)) < 1e-10


@pytest.mark.parametrize("name", ["puma560", "kuka-iiwa-14", "excavator-arm", "quadruped-leg", "ball-pendulum"])
def test_entries(name: str, tree: Any, states: Any) -> None:
    assert entry(name, 20, tree, states) < 1e-10


@pytest.mark.deep
@pytest.mark.parametrize("block", range(10))
def test_many_random_trees(block: int) -> None:
    assert max(random_tree(seed, 1000) for seed in range(100 + 10 * block, 110 + 10 * block)) < 1e-10


@pytest.mark.deep
@pytest.mark.parametrize("name", CHAINS)
def test_many_states_of_the_catalogue(name: str, tree: Any, states: Any) -> None:
    """Over all entries 10^5 states and more."""
    assert entry(name, -(-100_000 // len(CHAINS)), tree, states) < 1e-10
