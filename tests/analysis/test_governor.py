"""A flyball governor with rods against its equations in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from closed_trees import at, governor, governor_accelerations, lift

from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import Outputs, simulate

from .closed_motions import right


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
    motion = simulate(model, start, (0, 0.5), qd=at(model, turn=steady), outputs=Outputs(count=3))
    right(motion)
    np.testing.assert_allclose(motion.q[-1][1:], start[1:], atol=1e-9)
    motion = simulate(model, start, (0, 1.5), qd=at(model, turn=1.2 * steady), outputs=Outputs(count=51))
    right(motion)
    arms = motion.q[:, model.coordinates.index("x.right")]
    momentum = (0.011 + 2 * (0.03 + 0.3 * np.sin(arms)) ** 2) * motion.qd[:, 0]
    assert np.ptp(arms) > 0.05
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-9)
