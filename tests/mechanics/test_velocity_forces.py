"""Velocity forces in the ways that there are, and how many operations they take."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_trees import Kind, Plain, model_of, random_definition, random_states
from serial_chains import IIWA, RX90, SIX, SIX14, revolute

from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.expr.graph import Expr, Graph
from substructures.expr.hoist import hoisted
from substructures.expr.program import program
from substructures.expr.replay import replay
from substructures.expr.tally import Tally
from substructures.quantities.formulas import derived
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.forces import velocity_forces

KINDS = [
    Kind(6, joints=("revolute", "prismatic"), depth=6),
    Kind(5, joints=("revolute", "prismatic", "universal", "fixed")),
    Kind(4, joints=("free", "revolute", "planar"), depth=10),
    Kind(5, chain=True, joints=("prismatic", "revolute"), depth=6),
]


WAYS = [velocity_forces.composite, velocity_forces.recursive, velocity_forces.multiplied]


def in_one_way(way: velocity_forces.Way, monkeypatch: pytest.MonkeyPatch) -> None:
    for each in WAYS:
        monkeypatch.setattr(velocity_forces, each.__name__, way)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_velocity_forces_are_products_with_christoffel_symbols(
    seed: int, way: velocity_forces.Way, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_one_way(way, monkeypatch)
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
    """As they are exported."""
    return hoisted(model.program.select(names)).count(per_state=True)["total"]


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


@pytest.mark.parametrize(
    ("name", "bias"),
    [("acrobot", 7), ("scara", 7), ("planar-3r", 23), ("spherical-wrist", 15), ("quadruped-leg", 79), ("ur5", 320)],
)
def test_few_christoffel_symbols_need_few_operations(name: str, bias: int) -> None:
    """By composites these are 10, 10, 39, 34, 124 and 336."""
    model = on_the_ground(Definition.read(catalogue.load(name)), [0, "-g", 0])
    assert per_state(model, "bias") <= bias


@pytest.mark.parametrize(
    ("name", "bias", "both"), [("humanoid-arm", 241, 432), ("humanoid-leg", 261, 512), ("humanoid-pelvis", 77, 132)]
)
def test_recursion_where_the_metric_has_no_composites_to_share(name: str, bias: int, both: int) -> None:
    """By composites 412, 435 and 95, with the metric 487, 569 and 139: more than inverse dynamics."""
    model = on_the_ground(Definition.read(catalogue.load(name)), [0, 0, "-g"])
    assert per_state(model, "bias") <= bias
    assert per_state(model, "metric", "bias") <= both
    assert per_state(model, "bias") <= per_state(model, "inverse_dynamics")


@pytest.mark.parametrize("name", ["puma560", "humanoid-leg", "quadruped-leg", "satellite", "trolley-crane"])
def test_no_way_needs_fewer_operations_with_the_metric(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    definition = Definition.read(catalogue.load(name))
    least = per_state(on_the_ground(definition, [0, 0, "-g"]), "metric", "nonlinear_effects")
    found = []
    for way in WAYS:
        with monkeypatch.context() as patch:
            in_one_way(way, patch)
            found.append(per_state(on_the_ground(definition, [0, 0, "-g"]), "metric", "nonlinear_effects"))
    assert least == min(found) < max(found)


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_a_tally_counts_what_a_program_has(seed: int) -> None:
    model = model_of(random_definition(np.random.default_rng(seed), KINDS[seed]))
    graph, names = Graph(), ("metric", "nonlinear_effects")
    symbols = {s.name: s for s in model.program.symbols}
    found = replay(model.program, graph, {}, names)
    tally = Tally(graph, symbols)
    for name in names:
        tally = tally.copy()
        tally.add(x for x in found[name].entries.values() if isinstance(x, Expr))
    assert tally.total == hoisted(program(graph, found, symbols)).count(per_state=True)["total"] > 0
