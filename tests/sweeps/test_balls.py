"""Sweeps of trees with ball and floating joints: rows are what their trees are, and closed forms of their analyses."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import TreeSpec, couple, derive, simulate
from substructures.errors import InvalidInput
from substructures.quantities.sources import Sources, of_parts
from substructures.sweeps.block import disagreement
from substructures.sweeps.optimum import optimal_parameters
from tests.sweeps.in_process import Sweep
from tests.sweeps.test_optimum import aim

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


def rod(name: str, parent: str, joint: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": name,
        "parent": parent,
        "joint": joint,
        "mass": "m",
        "com": [0, 0, "-l"],
        "inertia": {"xx": "0.3", "yy": "0.2", "zz": "0.1"},
    }


def rods(*joints: dict[str, Any], port: str = "0.2") -> dict[str, Any]:
    """One below the other, of length 2 l, the tip beside the last one."""
    below = {"placement": {"position": [0, 0, "-2*l"]}}
    bodies = [rod(f"b{k}", f"b{k - 1}" if k else "base", {**(below if k else {}), **x}) for k, x in enumerate(joints)]
    return {
        "name": "rods",
        "parameters": {"m": {"value": 1.5, "unit": "kg"}, "l": {"value": 0.5, "unit": "m"}},
        "bodies": bodies,
        "ports": [{"name": "tip", "body": f"b{len(joints) - 1}", "position": [port, 0, "-2*l"]}],
    }


def swept_by(part: dict[str, Any], columns: dict[str, Any]) -> Sweep:
    template = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "a", "substructure": "rods"}]}
    samples = {"method": "grid", "of": {"a.l": {"values": [0.4, 0.5]}, "a.m": {"values": [1, 2]}}}
    return Sweep({"template": template, "columns": columns, "samples": samples}, {"rods": part})


def swept(part: dict[str, Any], columns: dict[str, Any]) -> dict[str, Any]:
    sweep = swept_by(part, columns)
    found = dict(sweep.rows().columns)
    assert not sweep.refusals.by_code
    for row in (0, 3):
        slow, _ = sweep.slow(row)
        assert {name: pytest.approx(float(found[name][row]), rel=1e-6, abs=1e-9) for name in slow} == slow
    return found


def test_equilibria_are_found_from_any_attitude() -> None:
    """A pendulum on a ball joint, pulled aside by a torque about x, rests where m g l sin(angle) = torque; its turning
    about the vertical is free.
    """
    at = {"q": [np.cos(0.3), np.sin(0.3), 0, 0], "inputs": {"tau.a.w_b0_x": 1.5}}
    still = {"q": [1, 0, 0, 0]}
    found = swept(
        rods({"type": "ball"}),
        {
            "w": {"analysis": "equilibrium", "at": at, "of": "a.q_b0_w"},
            "x": {"analysis": "equilibrium", "at": at, "of": "a.q_b0_x"},
            "fast": {"analysis": "linearisation", "at": still, "take": "highest_frequency"},
            "same": {"analysis": "linearisation", "at": {"q": TURN / np.linalg.norm(TURN)}, "settle": True,
                     "take": "highest_frequency"},
            "slow": {"analysis": "linearisation", "at": still, "take": "lowest_frequency"},
        },
    )  # fmt: skip
    m, length = found["a.m"], found["a.l"]
    np.testing.assert_allclose(2 * np.arctan2(found["x"], found["w"]), np.arcsin(1.5 / (m * 9.81 * length)), rtol=1e-9)
    np.testing.assert_allclose(found["fast"], np.sqrt(m * 9.81 * length / (0.2 + m * length**2)), rtol=1e-9)
    np.testing.assert_allclose(found["same"], found["fast"], rtol=1e-6)
    np.testing.assert_allclose(found["slow"], 0, atol=1e-6)


def test_the_best_length_of_a_pendulum() -> None:
    """w^2 = m g l/(J + m l^2) is largest where m l^2 = J."""
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "a", "substructure": "rods"}]}
    parts = {"a": derive(rods({"type": "ball"}))}
    sources = Sources(couple(tree, parts), of_parts=of_parts(TreeSpec.read(tree), parts))
    at = {"q": [1, 0, 0, 0], "inputs": {}}
    columns = {"w": {"analysis": "linearisation", "at": at, "take": "highest_frequency"}}
    found = optimal_parameters(sources, aim("-w", {"a.l": (0.1, 1)}, columns, starts=2))
    assert found.is_right
    assert found.parameters["a.l"] == pytest.approx(np.sqrt(0.2 / 1.5), rel=1e-4)


def test_reach_is_over_all_attitudes() -> None:
    """Two rods on balls reach as far as they are long; behind an elbow of 0.5 rad at least by the law of cosines; and
    a body that slides anywhere has no reach.
    """
    reach = {"r": {"analysis": "reach", "of": "a.tip"}}
    ball, elbow = {"type": "ball"}, {"type": "revolute", "coordinate": "e", "limits": [0.5, 2], "axis": [1, 0, 0]}
    found = swept(rods(ball, ball), reach)
    np.testing.assert_allclose(found["r"], 2 * found["a.l"] + np.hypot(0.2, 2 * found["a.l"]), rtol=1e-9)
    found = swept(rods({"type": "prismatic", "coordinate": "s", "limits": [-1, 0]}, ball, elbow, port="0"), reach)
    arm = 2 * found["a.l"]
    np.testing.assert_allclose(found["r"], arm + 1 + arm * np.sqrt(2 + 2 * np.cos(0.5)), rtol=1e-9)
    anywhere = swept_by(rods({"type": "floating"}, ball), reach)
    anywhere.rows()
    assert {*anywhere.refusals.by_code} == {"no-limits"}
    about = swept(rods({"type": "floating"}, ball), {"r": {"analysis": "reach", "of": "a.tip", "about": "a.b0"}})
    np.testing.assert_allclose(about["r"], 2 * about["a.l"] + np.hypot(0.2, 2 * about["a.l"]), rtol=1e-9)


@pytest.mark.parametrize(
    ("column", "code"),
    [
        ({"analysis": "equilibrium", **AT, "of": "bus.wx"}, "unknown-coordinate"),
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
