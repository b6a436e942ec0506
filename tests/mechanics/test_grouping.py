"""Base parameters as a change of binding: the same functions with fewer operations, and all moved masses in place."""

from __future__ import annotations

import json

import numpy as np
import pytest
from random_cuts import all_cuts, cut_tree
from random_trees import Kind, Plain, random_definition, random_states, with_parameters
from serial_chains import IIWA, RX90, SIX, SIX14, revolute

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree import couple as coupling

KINDS = [
    Kind(6, joints=("revolute", "prismatic"), depth=6),
    Kind(5, joints=("revolute", "prismatic", "universal", "fixed")),
    Kind(4, chain=True, joints=("prismatic", "revolute", "planar"), depth=10),
    Kind(4, chain=True, joints=("universal", "cylindrical", "revolute"), depth=8),
]
QUANTITIES = ["metric", "christoffel", "bias", "forces", "gravity", "inverse_dynamics", "potential_energy"]


def coupled(tree: Plain, group: bool) -> Model:
    spec = TreeSpec.read(tree)
    parts = {
        i.name: derive(Definition.read(json.loads(i.definition.canonical()))) for i in spec.instances if i.definition
    }
    return couple(spec, parts, group=group)


@pytest.mark.parametrize("seed", range(len(KINDS)))
def test_grouped_trees_are_the_same_functions(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """In pieces, with numbers (grouped by themselves) and with parameters; the certificate sees the rest."""
    rng = np.random.default_rng(seed + 10)
    definition = random_definition(rng, KINDS[seed])
    definition = with_parameters(rng, definition, 0.5 if seed % 2 else 0)
    cuts = list(all_cuts(definition))
    tree = cut_tree(rng, definition, cuts[len(cuts) // 2])
    grouped = coupled(tree, True)
    monkeypatch.setattr(coupling, "numbers_and", lambda _: lambda _: False)
    plain = coupled(tree, False)
    assert grouped.program.digest != plain.program.digest
    states = random_states(rng, 3, plain.dof)
    inputs = {s.name: [0.3] * 3 for s in plain.program.symbols if s.kind == "input"}
    found, expected = (evaluate(m, QUANTITIES, inputs=inputs, t=0.3, **states) for m in (grouped, plain))
    for name in QUANTITIES:
        size = max(1.0, float(np.abs(expected[name]).max(initial=0)))
        assert np.abs(found[name] - expected[name]).max(initial=0) < 1e-10 * size, name


def on_the_ground(definition: Definition, group: bool, values: Plain | None = None) -> Model:
    tree: Plain = {"name": "t", "gravity": [0, 0, "-g"], "parameters": {"g": {}}}
    tree["instances"] = [{"name": "x", "substructure": definition.name, "at": "world", "parameters": values or {}}]
    return couple(TreeSpec.read(tree), {"x": derive(definition)}, group=group)


@pytest.mark.parametrize(
    ("rows", "both", "inverse"),
    [(RX90, 464, 450), (IIWA, 897, 532), (SIX14, 1167, 645), (SIX, 1453, 731)],
    ids=["rx90", "iiwa", "6r with 14 parameters", "6r"],
)
def test_operations_per_state(rows: list[Plain], both: int, inverse: int) -> None:
    """Without base parameters 475 and 538, 910 and 636, 1195 and 745, 1484 and 831."""
    program = on_the_ground(revolute(rows), True).program
    assert program.count(["metric", "christoffel"], per_state=True)["total"] <= both
    assert program.count(["inverse_dynamics"], per_state=True)["total"] <= inverse


def test_numbers_are_grouped_by_themselves(monkeypatch: pytest.MonkeyPatch) -> None:
    definition = revolute(RX90)
    values = {name: str(k % 7 + 1) for k, name in enumerate(definition.parameters)}
    grouped = on_the_ground(definition, False, values)
    monkeypatch.setattr(coupling, "numbers_and", lambda _: lambda _: False)
    plain = on_the_ground(definition, False, values)
    assert grouped.operations["inverse_dynamics"] < 0.95 * plain.operations["inverse_dynamics"]
    assert grouped.operations["metric"] <= plain.operations["metric"]
