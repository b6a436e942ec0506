"""Families of orbits by arclength on closures, with velocity constraints and with ball joints: those without."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis.test_orbit_families import D, F

from substructures import Model, couple, derive
from substructures.analysis.orbits.orbit import Family
from substructures.analysis.orbits.periodic import Shooting, periodic_orbits

from .orbit_trees import slider, tree_of

Plain = dict[str, Any]
RANGE: Plain = {"vary": "p.w", "between": (1.6, 1.1), "steps": 4}


def duffing(*masses: float) -> Plain:
    """x'' + d x' + x + x^3 = F cos(w t), of carts beside each other that hold each other."""
    parameters = {"d": {"value": str(D), "unit": "N s/m"}, "w": {"value": "0.5", "unit": "rad/s"}}
    names, laws = "xz", [{"damping": "d"}, {}]
    bodies = [
        {**slider(name, "base", [1, 0, 0], **law), "mass": mass}
        for name, law, mass in zip(names, laws, masses, strict=False)
    ]
    loads = [
        {"type": "potential", "potential": "x^2/2 + x^4/4"},
        {"type": "joint", "coordinate": "x", "force": f"{F}*cos(w*t)"},
    ]
    ports = [{"name": f"top_{body['name'][-1]}", "body": body["name"]} for body in bodies]
    return {"name": "carts", "parameters": parameters, "bodies": bodies, "loads": loads, "ports": ports}


def carts(**tied: Any) -> Model:
    part = derive(duffing(0.4, 0.6))
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "p", "substructure": "carts"}], **tied}
    return couple(tree, {"p": part})


@pytest.fixture(scope="module")
def alone() -> Family:
    return periodic_orbits(tree_of(duffing(1.0)), [-0.1], Shooting("2*pi/p.w"), **RANGE)


def same_folds(found: Family, expected: Family) -> None:
    assert (found.message, found.is_right) == ("", True)
    assert [one.kind for one in found.bifurcations] == [one.kind for one in expected.bifurcations] != []
    values = [[one.at.value for one in family.bifurcations] for family in (found, expected)]
    np.testing.assert_allclose(*values, rtol=1e-6)


def test_two_carts_that_a_weld_holds(alone: Family) -> None:
    """On a closure, in the coordinate that it leaves."""
    weld = {"name": "weld", "type": "weld", "from": "p.top_x", "to": "p.top_z"}
    found = periodic_orbits(carts(closures=[weld]), [-0.1, -0.1], Shooting("2*pi/p.w"), **RANGE)
    same_folds(found, alone)
    for orbit in found.found:
        assert orbit.q[0] == pytest.approx(orbit.q[1], abs=1e-9)
        assert len(orbit.multipliers) == 2


def test_two_carts_that_a_belt_drives() -> None:
    """By a velocity constraint: where the second one is does not matter, and is held."""
    belt = {"name": "belt", "type": "linear", "expression": "p.x' - p.z'"}
    shooting, given = Shooting("2*pi/p.w", hold=("p.z",)), {**RANGE, "between": (1.6, 1.5), "steps": 2}
    found = periodic_orbits(carts(velocity_constraints=[belt]), [-0.1, 0.1], shooting, **given)
    assert (found.message, found.is_right) == ("", True)
    values = [float(orbit.value or 0) for orbit in found.found]
    assert values[-1] == pytest.approx(1.5, rel=1e-9)
    alone = periodic_orbits(tree_of(duffing(1.0)), [-0.1], Shooting("2*pi/p.w"), vary="p.w", values=values)
    for orbit, other in zip(found.found, alone.found, strict=True):
        np.testing.assert_allclose(orbit.q, [other.q[0], 0.1], atol=1e-8)
        # of the place that is held one more, which is 1
        expected = np.sort_complex([1, *other.multipliers])
        np.testing.assert_allclose(np.sort_complex(orbit.multipliers), expected, atol=1e-6)


def pendulum(joint: Plain) -> Model:
    inertia = {"xx": "0.02", "yy": "0.02", "zz": "0.01"}
    body = {"name": "b", "parent": "base", "mass": 1, "com": [0, 0, "-l"], "inertia": inertia}
    parameters = {"l": {"value": 1, "unit": "m"}, "d": {"value": "0.3"}}
    return tree_of({"name": "swing", "parameters": parameters, "bodies": [{**body, "joint": joint}]})


def test_a_ball_joint_swings_as_a_hinge() -> None:
    """Driven in a plane, over its length: the orbits of the hinge, whose multipliers are among those of the ball.
    Turned about the vertical each orbit is another one, which a number of the quaternion that is held keeps away.
    """
    given: Plain = {"vary": "p.l", "between": (0.5, 0.8), "steps": 2}
    period, torque = 2 * np.pi / 2.9, "0.9*cos(2.9*t)"
    place: Plain = {"axis": [0, 1, 0], "placement": {"position": [0, 0, 0]}}
    ball, start = pendulum({"type": "ball", "damping": "d"}), [float(np.cos(0.05)), 0.0, float(np.sin(0.05)), 0.0]
    shooting = Shooting(period, hold=("p.q_b_z",))
    found = periodic_orbits(ball, start, shooting, inputs={"tau.p.w_b_y": torque}, **given)
    assert (found.message, found.is_right) == ("", True)
    assert (found.found[0].value, found.found[-1].value) == (0.5, pytest.approx(0.8, rel=1e-9))
    values = [float(orbit.value or 0) for orbit in found.found]
    hinge = pendulum({"type": "revolute", "coordinate": "a", "damping": "d", **place})
    plane = periodic_orbits(hinge, [0.1], Shooting(period), inputs={"tau.p.a": torque}, vary="p.l", values=values)
    for orbit, other in zip(found.found, plane.found, strict=True):
        assert np.linalg.norm(orbit.q) == pytest.approx(1, abs=1e-9)
        assert 2 * np.arctan2(orbit.q[2], orbit.q[0]) == pytest.approx(other.q[0], abs=1e-7)
        assert len(orbit.multipliers) == 6
        for multiplier in other.multipliers:
            assert np.abs(orbit.multipliers - multiplier).min() < 1e-6
