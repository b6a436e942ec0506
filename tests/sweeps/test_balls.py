"""Sweeps of trees with ball and floating joints: rows are what their trees are; other columns refuse them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import couple, simulate
from substructures.errors import InvalidInput
from substructures.sweeps.block import disagreement
from tests.sweeps.in_process import Sweep

TURN = np.array([0.5, -0.1, 0.7, 0.2])
STATE = {
    "q": [0.1, 0.2, 0.3, *(TURN / np.linalg.norm(TURN)), 1, 2, 3, 4],
    "qd": [0.1, -0.2, 0.3, 0.5, 0.4, -0.3, 100, 90, -80, 70],
    "qdd": [0, 0, 1, 0, 0, 1, 0, 0, 0, 2],
}
SATELLITE: dict[str, Any] = {
    "template": {
        "name": "satellite",
        "gravity": [0, 0, "-1.6"],
        "instances": [
            {"name": "bus", "substructure": "satellite-wheels"},
            {"name": "load", "substructure": "camera", "at": "bus.payload", "placement": {"position": [0, 0, 0.4]}},
        ],
    },
    "choices": {"load": ["camera", {"substructure": "flange-tool", "placement": {"rpy": [0.3, 0, 0]}}]},
    "samples": {"method": "grid", "of": {"bus.Ixx": {"values": [4, 5, 6]}, "bus.mw": {"values": [1, 2]}}},
    "columns": {
        "mass": "mass",
        "dof": "dof",
        "whole": {"quantity": "metric", "of": ["bus.vx", "bus.vx"]},
        "torque": {"quantity": "inverse_dynamics", "of": "bus.wz", "over": STATE},
        "bias": {"quantity": "bias", "over": STATE, "take": "largest_absolute"},
        "turn": {"quantity": "forward_dynamics", "of": "bus.wx", "over": {"q": STATE["q"], "qd": STATE["qd"]}},
        "specific": "torque/mass",
    },
}


def test_rows_are_what_their_trees_are() -> None:
    sweep = Sweep(SATELLITE)
    found = sweep.rows()
    assert (sweep.refusals.by_code, len(found.rows)) == ({}, 12)
    for k in (0, 5, 7, 11):
        slow, condition = sweep.slow(k)
        assert not disagreement({name: float(found.columns[name][k]) for name in slow}, slow, condition)
    # without a state nothing is turned, and the mass is on the diagonal
    np.testing.assert_allclose(found.columns["whole"], found.columns["mass"], rtol=1e-14)
    # masses of wheels, which lie in the origin, do not turn it
    assert len({float(x) for x in found.columns["torque"]}) == 6


AT = {"at": {"q": STATE["q"]}}


def test_motions_are_those_of_one_tree() -> None:
    """The rate of the hub, which wheels at full speed turn, after a second."""
    motion = {"analysis": "simulation", "at": {"q": STATE["q"], "qd": STATE["qd"]}, "span": [0, 1], "take": "end"}
    sweep = Sweep(SATELLITE, columns={"rate": {**motion, "expression": "bus.wx'"}}, choices={})
    found = sweep.rows()
    assert len(found.rows) == 6
    for row in (0, 5):
        parts = {name: shipped_part(entry) for name, entry in (("bus", "satellite-wheels"), ("load", "camera"))}
        run = simulate(couple(sweep.plan.tree(row), parts), STATE["q"], (0, 1), qd=STATE["qd"])
        assert run.is_right
        assert found.columns["rate"][row] == pytest.approx(run.qd[-1, 3], rel=1e-6)


@pytest.mark.parametrize(
    ("column", "code"),
    [
        ({"analysis": "reach", "of": "load.lens", "about": "bus.hub"}, "has-balls"),
        ({"analysis": "linearisation", **AT, "take": "lowest_frequency"}, "has-balls"),
        ({"quantity": "bias", "over": {"q": [0] * 11}, "take": "largest"}, "not-a-unit-quaternion"),
    ],
)
def test_other_columns_say_what_is_the_matter(column: Any, code: str) -> None:
    sweep = Sweep(SATELLITE, columns={"x": column}, choices={})
    try:
        sweep.rows()
    except InvalidInput as error:
        found = {fault.code for fault in error.faults}
    else:
        found = {*sweep.refusals.by_code}
    assert found == {code}
