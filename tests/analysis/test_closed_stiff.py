"""Implicit methods on closures: few steps where a motion is stiff, and the same motion as explicit methods find."""

from __future__ import annotations

import numpy as np
import pytest
from closed_trees import at, held_bar, slider_crank
from random_trees import Plain
from simulated import simulated

from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.closed.reductions import Projected
from substructures.analysis.closed.stepper import ClosedStepper
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.problems.start import Start

from .closed_motions import METHODS

IMPLICIT = ["Radau", "BDF"]


@pytest.mark.parametrize("reduction", METHODS)
@pytest.mark.parametrize("method", IMPLICIT)
def test_smooth_friction_near_rest_takes_few_evaluations(method: str, reduction: str) -> None:
    """1 N m against 5 N m: the crank creeps by v_0 atanh(1/5), which takes RK45 193,010 evaluations."""
    request: Plain = {"inputs": {"tau.f.q1": 1}, "count": 2, "method": method, "reduction": reduction}
    motion = simulated(held_bar(), [0.5, 0.09, 1.2], (0, 0.3), **request)
    assert (motion.status, motion.is_right, motion.message) == ("finished", True, "")
    assert motion.figures["evaluations"] < {"Radau": 2500, "BDF": 700}[method]
    assert motion.series["position_residual"].max() < 1e-14
    np.testing.assert_allclose(motion.qd[-1, 0], 0.001 * np.arctanh(0.2), rtol=1e-4)


@pytest.mark.parametrize("reduction", METHODS)
@pytest.mark.parametrize("method", IMPLICIT)
def test_a_crank_that_turns_round(method: str, reduction: str) -> None:
    """With another choice of independent coordinates on the way, and events located."""
    model = slider_crank()
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=40), "fixed": ["x.crank"]}
    request |= {"span": (0, 0.1), "inputs": {"tau.x.crank": "2*sin(20*t)"}, "count": 2, "reduction": reduction}
    implicit, explicit = (simulated(model, **request, method=m) for m in (method, "DOP853"))
    assert implicit.is_right, implicit.checks
    assert explicit.q[-1, 0] > 4
    np.testing.assert_allclose(implicit.q, explicit.q, atol=1e-8)
    np.testing.assert_allclose(implicit.qd, explicit.qd, atol=1e-8 * np.abs(explicit.qd).max())


@pytest.mark.parametrize("method", ["DOP853", *IMPLICIT])
def test_steps_go_on_from_the_closures(method: str) -> None:
    """What a step is beside the closures before it lands is its own error, and not the sum of those before it."""
    model, integrator = slider_crank(), Integrator(method, 1e-5, 1e-7)
    given = Start(at(model, crank=0.3, piston=0.17), at(model, crank=40))
    s = Constrained(model, given, (0, 1))
    closed = consistent_state(s, 0.0, s.conditions.q, s.conditions.qd, ["x.crank"])
    s.move(0.0, closed.q, closed.qd)
    stepper = ClosedStepper(Projected(s, s.rank()), integrator.stepper(), 0.0, np.r_[closed.q, closed.qd, 0], 1.0)
    beside = []
    while stepper.status == "running":
        assert stepper.step() is None
        s.move(stepper.t, *np.split(stepper.inner.y[:-1], 2))
        beside.append(s.opening)
    first, last = np.array_split(beside, 2)
    assert first.max() > 1e-9
    assert last.max() < 2 * first.max()
