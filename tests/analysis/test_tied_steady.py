"""Steady motions and equilibria of trees with velocity constraints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain
from rolling_bodies import FORWARD, FRONT, REAR, A, C, M, R, bicycle_part, disc_part, sleigh_part

from substructures import Model, equilibria, steady_motions
from substructures.errors import InvalidInput

FLOOR = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}
EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}


def tied(part: Plain, constraints: list[Plain], gravity: Any = (0, 0, -9.81)) -> Model:
    tree = {"gravity": list(gravity), "instances": [{"name": "s", "substructure": "p"}]}
    return tree_model({**tree, "velocity_constraints": constraints}, {"p": part})


def test_a_disc_rolls_on_a_circle() -> None:
    """Routh: A psi'^2 sin th cos th - (C + m r^2) (ph' + psi' cos th) psi' sin th = m g r cos th, whatever the rates
    (E. J. Routh, Advanced Rigid Dynamics, 1884, article 244), here for given ones with the tilt sought.
    """
    model = tied(disc_part(), [FLOOR])
    psi, ph = 1.1, -6.0
    found = steady_motions(model, rates={"s.psi": psi, "s.ph": ph}, starts=[0, 0, 0.5, 0, 1.4, 0], count=3)
    assert found.is_right
    assert found.moving == ("s.psi", "s.ph")
    motion = next(each for each in found.found if 0 < each.q[4] < np.pi)
    th = motion.q[4]
    np.testing.assert_allclose(motion.q[2], R * np.sin(th), atol=1e-12)
    np.testing.assert_allclose(motion.rates, [psi, ph], atol=1e-12)
    spin = ph + psi * np.cos(th)
    left = A * psi**2 * np.sin(th) * np.cos(th) - (C + M * R * R) * spin * psi * np.sin(th)
    assert left == pytest.approx(M * 9.81 * R * np.cos(th), abs=1e-9)
    assert abs(np.cos(th)) > 0.1
    assert motion.stability is not None


def test_a_disc_that_rolls_straight_is_stable_when_it_is_fast() -> None:
    """ph'^2 > m g r A / (C (C + m r^2)) (the same place), with the wheel upright."""
    model = tied(disc_part(), [FLOOR])
    limit = np.sqrt(M * 9.81 * R * A / (C * (C + M * R * R)))
    for share, verdict in ((0.9, "unstable"), (1.1, "undecided")):
        rates = {"s.psi": 0, "s.ph": share * limit}
        found = steady_motions(model, rates=rates, starts=[0, 0, 0.5, 0, 1.5, 0], count=0)
        motion = next(each for each in found.found if abs(each.q[4] - np.pi / 2) < 1e-9)
        assert motion.verdict in (verdict, "stable" if verdict != "unstable" else verdict)


def test_a_bicycle_stays_upright_at_speed() -> None:
    """The benchmark bicycle: unstable at 4 m/s, stable at 5 m/s (J. P. Meijaard et al., 2007: from 4.292 to 6.024)."""
    wheels = [("rear", "s.rear_axle", REAR), ("front", "s.front_axle", FRONT)]
    given = [{"name": name, "type": "rolling", "frame": frame, "radius": r} for name, frame, r in wheels]
    model = tied(bicycle_part(), given)
    for speed, verdict in ((4, "unstable"), (5, "stable")):
        rates, kind = {"s.rear": speed / REAR, "s.yaw": 0}, ["s.lean", "s.steer", "s.rear"]
        (motion,) = steady_motions(model, rates=rates, independent=kind, count=0).found
        np.testing.assert_allclose(motion.q[[4, 5, 7]], 0, atol=1e-12)
        assert motion.verdict == verdict
        assert motion.q[2] == pytest.approx(REAR)


def test_equilibria_of_a_pendulum_on_a_rolling_disc() -> None:
    """It hangs down or stands up wherever the disc is."""
    free = {"type": "planar", "coordinate": ["x", "z", "turn"], "placement": {"rpy": ["pi/2", 0, 0]}}
    hinge = {"type": "revolute", "coordinate": "q", "placement": {"position": [0, 0, 0]}}
    bodies: list[Plain] = [
        {"name": "disc", "parent": "base", "joint": free, "mass": 2, "inertia": {"xx": 0.125, "yy": 0.125, "zz": 0.25}},
        {
            "name": "rod",
            "parent": "disc",
            "joint": hinge,
            "mass": 1,
            "com": [0, -0.3, 0],
            "inertia": {"xx": 0.02, "zz": 0.02},
        },
    ]
    model = tied({"name": "p", "bodies": bodies}, [{**FLOOR, "radius": 0.5}])
    found = equilibria(model, starts=[[0, 0.5, 0, 0], [0, 0.5, 0, 3]])
    assert found.is_right
    assert "s.x" in found.held
    sums = sorted(round(float(np.cos(each.q[2] + each.q[3])), 9) for each in found.found)
    assert {*sums} == {-1.0, 1.0}
    assert all(each.q[1] == pytest.approx(0.5) for each in found.found)
    verdicts = {round(float(np.cos(each.q[2] + each.q[3]))): each.verdict for each in found.found}
    assert verdicts[-1] == "unstable"


def test_a_sleigh_glides_straight_on() -> None:
    """Stable with its mass centre ahead of the blade, as another speed or heading is another steady motion; with it
    behind unstable: w' = -m a u w / (I + m a^2) (S. A. Chaplygin, Mat. Sbornik 28, 1911).
    """
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    for a, verdict in ((0.25, "stable"), (-0.25, "unstable")):
        found = steady_motions(model, rates={"u": 2, "s.f": 0}, velocities=FORWARD, parameters={"s.a": a}, count=0)
        assert found.moving == ("s.f",)
        (motion,) = found.found
        assert motion.verdict == verdict


def test_what_means_nothing_says_so() -> None:
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    for given, pointer in (
        ({"momenta": {"s.f": 1}}, "/momenta"),
        ({"rates": {"s.f": 1}, "held": "rates"}, "/held"),
        ({"rates": {"s.f": 1}, "vary": "s.m"}, "/between"),
        ({"rates": {"s.f": 1}, "vary": "s.k", "between": (1, 2)}, "/vary"),
        ({"rates": {"s.f": 1}, "vary": "s.f", "between": (1, 1)}, "/between"),
        ({"rates": {"s.x": 1}, "velocities": FORWARD}, "/rates/s.x"),
        ({}, "/rates"),
    ):
        with pytest.raises(InvalidInput) as caught:
            steady_motions(model, **given)  # type: ignore[arg-type]
        assert caught.value.faults[0].pointer == pointer


@pytest.mark.parametrize("size", ["1", "1/10^12"])
def test_a_spring_beyond_half_a_turn_is_one_however_weak(size: str) -> None:
    """An arm on a sleigh with its rest at 5 rad; masses, inertias and springs of any size."""
    part = sleigh_part()
    joint = {"type": "revolute", "coordinate": "h", "stiffness": f"10*{size}", "rest": 5}
    arm = {"name": "arm", "parent": "b", "joint": joint, "mass": size, "inertia": {"xx": size, "zz": size}}
    numbers = part["parameters"] | {name: {"value": f"{x}*{size}"} for name, x in (("m", 2), ("I", 0.3))}
    document = part | {"bodies": [*part["bodies"], arm], "parameters": numbers}
    tree = {"gravity": [0, 0, 0], "velocity_constraints": [{"name": "blade", "type": "knife_edge", "frame": "s.b"}]}
    tree["instances"] = [{"name": "s", "substructure": "p"}]
    (found,) = equilibria(tree_model(tree, {"p": document}), starts=[[0, 0, 0, 4.5]], count=2).found
    np.testing.assert_allclose(found.q, [0, 0, 0, 5])
