"""A flyball governor with rods against its equations in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from closed_motions import right
from closed_trees import at, governor

from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import simulate


def lift(angle: float) -> tuple[float, float, float]:
    """Lift of the sleeve over the angle of the arms, and two derivatives: rods of length 0.25 at 0.15 m on the arms."""
    a, length, h = 0.15, 0.25, 0.4
    s = np.sqrt(length**2 - (a * np.sin(angle)) ** 2)
    ds = -(a**2) * np.sin(angle) * np.cos(angle) / s
    dds = -(a**2) * np.cos(2 * angle) / s - ds**2 / s
    return h - a * np.cos(angle) - s, a * np.sin(angle) - ds, a * np.cos(angle) - dds


def governor_accelerations(angle: float, rate: float, spin: float) -> tuple[float, float]:
    """Of the arms and of the spindle, from T = (I(a) W^2 + M(a) a'^2) / 2 and V(a)."""
    r, length, ball, sleeve, k, g = 0.03, 0.3, 1.0, 0.8, 500.0, 9.81
    z, dz, ddz = lift(angle)
    reach, dreach = r + length * np.sin(angle), length * np.cos(angle)
    inertia, dinertia = 0.011 + 2 * ball * reach**2, 4 * ball * reach * dreach
    mass, half = 2 * ball * length**2 + sleeve * dz**2, sleeve * dz * ddz
    slope = 2 * ball * g * length * np.sin(angle) + (sleeve * g + k * z) * dz
    return (0.5 * dinertia * spin**2 - half * rate**2 - slope) / mass, -dinertia * rate * spin / inertia


@pytest.mark.parametrize(("angle", "rate", "spin"), [(0.6, 0, 7.0), (0.4, 1.5, 9.0), (0.9, -2.0, 3.0)])
def test_governor_accelerations(angle: float, rate: float, spin: float) -> None:
    model = governor()
    start = at(model, right=angle, left=angle, lift=lift(angle)[0])
    speeds = at(model, right=rate, left=rate, lift=lift(angle)[1] * rate, turn=spin)
    found = loop_state(model, start, qd=speeds)
    assert (found.mobility.degrees_of_freedom, found.mobility.redundant) == (2, False)
    np.testing.assert_allclose(found.consistent.q, start, atol=1e-12)
    arms, spindle = governor_accelerations(angle, rate, spin)
    np.testing.assert_allclose(found.qdd[[1, 2, 0]], [arms, arms, spindle], rtol=1e-10, atol=1e-10)


def test_governor_keeps_its_speed_and_its_angular_momentum() -> None:
    """At the speed of steady motion nothing moves; disturbed, energy and angular momentum about the spindle stay."""
    model, angle = governor(), 0.6
    low, high = governor_accelerations(angle, 0, 0)[0], governor_accelerations(angle, 0, 1)[0]
    steady = np.sqrt(-low / (high - low))
    start = at(model, right=angle, left=angle, lift=lift(angle)[0])
    motion = simulate(model, start, (0, 0.5), qd=at(model, turn=steady), count=3)
    right(motion)
    np.testing.assert_allclose(motion.q[-1][1:], start[1:], atol=1e-9)
    motion = simulate(model, start, (0, 1.5), qd=at(model, turn=1.2 * steady), count=51)
    right(motion)
    arms = motion.q[:, model.coordinates.index("x.right")]
    momentum = (0.011 + 2 * (0.03 + 0.3 * np.sin(arms)) ** 2) * motion.qd[:, 0]
    assert np.ptp(arms) > 0.05
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-9)
