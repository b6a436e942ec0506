"""Motions of trees of one shape: numbers that are put in are values of the kernel of the shape."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from catalogue_entries import shipped_part

from substructures import Model, couple, simulate
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.motion.judges.integrals import integrals_along
from substructures.analysis.motion.right_hand_side import RightHandSide


def _model(mass: str, place: str, pull: str, arm: str = "scara") -> Model:
    """An arm with a pendulum as its hand."""
    parts = {"arm": shipped_part(arm), "hand": shipped_part("simple-pendulum")}
    hand: dict[str, Any] = {"name": "hand", "substructure": "x", "at": f"arm.{parts['arm'].ports[0]}"}
    hand |= {"parameters": {"m": mass}, "placement": {"position": [place, 0, "1/5"]}}
    tree = {"name": "t", "gravity": [0, 0, pull], "instances": [{"name": "arm", "substructure": "x"}, hand]}
    return couple(tree, parts)


def test_trees_of_one_shape_move_by_one_kernel() -> None:
    first, second = (_model(*given) for given in (("0.7", "0.31", "-1.62"), ("0.9", "0.23", "-3.71")))
    assert first.program.digest != second.program.digest
    values = {name: float(given["value"]) for name, given in first.parameters.items()}
    one, other = (RightHandSide(each, values, each.input_names) for each in (first, second))
    assert one.kernel is other.kernel
    x = 0.1 * np.arange(one.size)
    assert np.abs(one(0.0, x) - other(0.0, x)).max() > 1e-3
    assert first.of_shape.program.digest == second.of_shape.program.digest


def test_a_motion_by_the_shape_is_the_motion_with_the_numbers_in_the_formulas() -> None:
    model = _model("0.7", "0.31", "-1.62")
    alone = replace(model, unbound=None)
    assert alone.of_shape is alone
    q = 0.3 + 0.1 * np.arange(model.dof)
    found, expected = (simulate(each, q, (0, 1)) for each in (model, alone))
    assert np.abs(found.q - expected.q).max() < 1e-7
    assert [(each.name, each.rule, each.holds) for each in found.checks] == [
        (each.name, each.rule, each.holds) for each in expected.checks
    ]
    assert found.is_right


def test_integrals_by_the_shape_are_those_of_the_tree() -> None:
    model = _model("0.7", "0.31", "-1.62")
    found, expected = integrals_along(model, [], []), first_integrals(model, [], [])
    assert [each.name for each in found.integrals] == [each.name for each in expected.integrals]
    assert {s.name for s in found.program.symbols} == {s.name for s in expected.program.symbols}


def test_a_motion_leaves_the_numbers_out_of_the_formulas() -> None:
    # which no search for further integrals takes
    model = _model("0.7", "0.31", "-1.62", "ur5")
    assert simulate(model, 0.3 + 0.1 * np.arange(model.dof), (0, 1)).is_right
    assert "program" not in vars(model)
    assert len(model.program)
    assert model.of_shape.numbers
    other = replace(model, program=model.of_shape.program)
    assert other.of_shape is other
