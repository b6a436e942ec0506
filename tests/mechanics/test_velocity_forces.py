"""Velocity forces from composites and from few Christoffel symbols, and how many operations they take."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_trees import Kind, Plain, model_of, random_definition, random_states
from serial_chains import IIWA, RX90, SIX, SIX14, revolute

from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.quantities.evaluation import evaluate
from substructures.quantities.formulas import derived
from substructures.tree import velocity_forces

KINDS = [
    Kind(6, joints=("revolute", "prismatic"), depth=6),
    Kind(5, joints=("revolute", "prismatic", "universal", "fixed")),
    Kind(4, joints=("free", "revolute", "planar"), depth=10),
    Kind(5, chain=True, joints=("prismatic", "revolute"), depth=6),
]


@pytest.mark.parametrize("few", [0, 10**6], ids=["by composites", "from Christoffel symbols"])
@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_velocity_forces_are_products_with_christoffel_symbols(
    seed: int, few: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(velocity_forces, "FEW", few)
    rng = np.random.default_rng(seed)
    model = model_of(random_definition(rng, KINDS[seed]))
    states = random_states(rng, 3, model.dof)
    found = evaluate(model, ["christoffel", "bias", "gravity"], **{k: states[k] for k in ("q", "qd")})
    expected = np.einsum("nabc,nb,nc->na", found["christoffel"], states["qd"], states["qd"])
    size = max(1.0, float(np.abs(expected).max(initial=0)))
    assert np.abs(found["bias"] - expected).max(initial=0) < 1e-11 * size
    assert "nonlinear_effects" in model.program.outputs  # compared with both of them by the certificate


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_accelerations_are_those_of_a_model_without_nonlinear_effects(seed: int) -> None:
    """As models are that older versions stored."""
    rng = np.random.default_rng(seed)
    model = model_of(random_definition(rng, KINDS[seed]))
    outputs = {name: x for name, x in model.program.outputs.items() if name != "nonlinear_effects"}
    old = replace(model, program=replace(model.program, outputs=outputs))
    states = random_states(rng, 3, model.dof)
    new, before = (
        evaluate(each, ["forward_dynamics"], q=states["q"], qd=states["qd"])["forward_dynamics"]
        for each in (model, old)
    )
    assert np.abs(new - before).max(initial=0) < 1e-9 * max(1.0, float(np.abs(new).max(initial=0)))


def on_the_ground(definition: Definition, gravity: list[object]) -> Model:
    tree: Plain = {"name": "t", "gravity": gravity, "parameters": {"g": {}}}
    tree["instances"] = [{"name": "x", "substructure": definition.name, "at": "world"}]
    return couple(TreeSpec.read(tree), {"x": derive(definition)})


def per_state(model: Model, *names: str) -> int:
    return model.program.count(names, per_state=True)["total"]


@pytest.mark.parametrize(
    ("rows", "bias", "both", "forward"),
    [(RX90, 478, 569, 741), (IIWA, 574, 700, 957), (SIX14, 763, 1072, 1239), (SIX, 875, 1252, 1439)],
    ids=["rx90", "iiwa", "6r with 14 parameters", "6r"],
)
def test_operations_per_state(rows: list[Plain], bias: int, both: int, forward: int) -> None:
    model = on_the_ground(revolute(rows), [0, 0, "-g"])
    assert per_state(model, "bias") <= bias
    assert per_state(model, "metric", "bias") <= both
    program = derived(model, "forward_dynamics")
    assert program.count(["forward_dynamics"], per_state=True)["total"] <= forward


@pytest.mark.parametrize(("name", "bias"), [("acrobot", 8), ("scara", 8), ("planar-3r", 32), ("spherical-wrist", 15)])
def test_few_christoffel_symbols_need_few_operations(name: str, bias: int) -> None:
    """By composites these are 10, 10, 40 and 34."""
    model = on_the_ground(Definition.read(catalogue.load(name)), [0, "-g", 0])
    assert per_state(model, "bias") <= bias
