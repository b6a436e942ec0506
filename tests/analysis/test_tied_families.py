"""Families of steady motions with velocity constraints, and where they gain or lose their stability."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain
from rolling_bodies import FORWARD, FRONT, REAR, A, C, M, R, bicycle_part, disc_part, sleigh_part

from substructures import Model, steady_motions
from substructures.analysis.stability.constrained_search import ConstrainedSearch

FLOOR = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}
EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}


def tied(part: Plain, constraints: list[Plain], gravity: Any = (0, 0, -9.81)) -> Model:
    tree = {"gravity": list(gravity), "instances": [{"name": "s", "substructure": "p"}]}
    return tree_model({**tree, "velocity_constraints": constraints}, {"p": part})


def test_the_critical_speed_of_a_rolling_disc() -> None:
    """ph'^2 = m g r A / (C (C + m r^2)) (E. J. Routh, Advanced Rigid Dynamics, 1884, article 244)."""
    model = tied(disc_part(), [FLOOR])
    found = steady_motions(
        model, rates={"s.psi": 0}, vary="s.ph", between=(2, 4), steps=8, starts=[0, 0, 0.5, 0, 1.5, 0], count=0
    )
    assert found.is_right
    critical = np.sqrt(M * 9.81 * R * A / (C * (C + M * R * R)))
    (one,) = found.bifurcations
    assert one.kind == "zero-eigenvalue"
    assert one.at.value == pytest.approx(critical, rel=1e-6)
    values = np.array([motion.value for motion in found.found])
    assert (values.min(), values.max()) == (2, 4)
    assert {each.verdict for each in found.found if float(each.value or 0) < critical} == {"unstable"}
    assert "unstable" not in {each.verdict for each in found.found if float(each.value or 0) > critical}


def test_circles_of_a_disc_are_a_family() -> None:
    """Each meets Routh's equation (the same article), over a rate and over the radius."""
    model = tied(disc_part(), [FLOOR])
    for vary, between in (("s.ph", (-7, -5)), ("s.r", (0.4, 0.6))):
        rates = {"s.psi": 1.1, "s.ph": -6}
        found = steady_motions(
            model, rates=rates, vary=vary, between=between, steps=6, starts=[0, 0, 0.5, 0, 1.4, 0], count=0
        )
        assert found.is_right
        assert len(found.found) > 6
        tilts = []
        for motion in found.found:
            r = motion.value if vary == "s.r" else R
            assert r is not None
            th, (psi, ph) = motion.q[4], motion.rates
            transverse, axial = M * r * r / 4, M * r * r / 2
            left = transverse * psi**2 * np.sin(th) * np.cos(th)
            left -= (axial + M * r * r) * (ph + psi * np.cos(th)) * psi * np.sin(th)
            assert left == pytest.approx(M * 9.81 * r * np.cos(th), abs=1e-8)
            assert motion.q[2] == pytest.approx(r * np.sin(th), abs=1e-10)
            tilts.append(th)
        assert np.ptp(tilts) > 0.01


def test_the_weave_and_the_capsize_speed_of_a_bicycle() -> None:
    """Of the benchmark: 4.29238253634111 and 6.02426201538837 m/s (J. P. Meijaard et al., 2007, section 6)."""
    wheels = [("rear", "s.rear_axle", REAR), ("front", "s.front_axle", FRONT)]
    given = [{"name": name, "type": "rolling", "frame": frame, "radius": r} for name, frame, r in wheels]
    model = tied(bicycle_part(), given)
    found = steady_motions(
        model,
        rates={"s.yaw": 0},
        vary="s.rear",
        between=(4 / REAR, 6.5 / REAR),
        steps=3,
        independent=["s.lean", "s.steer", "s.rear"],
        count=0,
    )
    assert found.is_right
    weave, capsize = found.bifurcations
    assert (weave.kind, capsize.kind) == ("hopf", "zero-eigenvalue")
    # up to what counts as a real part that is 0
    assert weave.at.value == pytest.approx(4.29238253634111 / REAR, rel=1e-5)
    assert capsize.at.value == pytest.approx(6.02426201538837 / REAR, rel=1e-5)
    assert "3.43503" in weave.reason


def test_a_pendulum_on_a_geared_table_leaves_the_vertical() -> None:
    """cos th = g / (l w^2) from w^2 = g / l on; the table turns twice for a turn of the wheel that it is geared to."""
    bodies: list[Plain] = [
        turning("wheel", "base", "w", [0, 0, 1], {"inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}}),
        turning("table", "base", "f", [0, 0, 1], {"inertia": {"xx": 0.2, "yy": 0.2, "zz": 0.2}}),
        turning("rod", "table", "th", [0, 1, 0], {"mass": 1, "com": [0, 0, "-l"]}),
    ]
    part: Plain = {"name": "p", "bodies": bodies, "parameters": {"l": {"value": 0.5, "unit": "m"}}}
    model = tied(part, [{"name": "gear", "type": "linear", "expression": "s.f' - 2*s.w'"}])
    found = steady_motions(model, rates={}, vary="s.f", between=(3, 7), steps=20, count=4)
    assert found.is_right, found.message
    forks = [one for one in found.bifurcations if one.kind == "pitchfork" and abs(one.at.q[2]) < 1]
    (fork,) = forks
    assert fork.at.value == pytest.approx(np.sqrt(9.81 / 0.5), rel=1e-7)
    aside = [motion for motion in found.found if 0.1 < abs(motion.q[2]) < 3]
    assert {np.sign(motion.q[2]) for motion in aside} == {-1, 1}
    for motion in aside:
        assert np.cos(motion.q[2]) == pytest.approx(9.81 / (0.5 * float(motion.value or 0) ** 2), abs=1e-8)


def turning(name: str, parent: str, coordinate: str, axis: list[int], mass: Plain) -> Plain:
    joint = {"type": "revolute", "coordinate": coordinate, "axis": axis, "placement": {"position": [0, 0, 0]}}
    return {"name": name, "parent": parent, "joint": joint, **mass}


def test_a_sleigh_turns_round_where_its_mass_is_behind_the_blade() -> None:
    """w' = -m a u w / (I + m a^2) changes its sign with a (S. A. Chaplygin, Mat. Sbornik 28, 1911); at any speed u."""
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    asked: Plain = {"velocities": FORWARD, "count": 0, "steps": 6}
    found = steady_motions(model, rates={"u": 2, "s.f": 0}, vary="s.a", between=(-0.25, 0.2), **asked)
    (one,) = found.bifurcations
    assert one.kind == "zero-eigenvalue"
    assert one.at.value == pytest.approx(0, abs=1e-6)
    by_speed = steady_motions(model, rates={"s.f": 0}, vary="u", between=(1, 2), **asked)
    assert by_speed.is_right
    assert {motion.verdict for motion in by_speed.found} == {"stable"}
    # where ways are left free there is no one family
    free = steady_motions(model, rates={}, vary="s.f", between=(0, 1), **asked)
    assert not free.found
    assert "name rates of more coordinates" in free.message


def test_a_wrong_derivative_by_the_rate_ends_the_family(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tangent and Newton's steps need it."""
    by_rate = ConstrainedSearch.by_rate
    monkeypatch.setattr(ConstrainedSearch, "by_rate", lambda search, name: -by_rate(search, name))
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    motions = steady_motions(model, rates={"s.f": 0}, vary="u", between=(1, 2), velocities=FORWARD, count=0, steps=6)
    assert "ends at" in motions.message
