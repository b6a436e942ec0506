"""States within a step are as accurate as those at its ends, for all kinds of motion."""

from __future__ import annotations

import numpy as np
import pytest
from analysis_models import catalogue_model
from closed_trees import at, closed_entry, four_bar
from random_trees import Plain
from rolling_bodies import FLOOR, R, disc
from simulated import simulated

from substructures import Model
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import FixedStep

from .closed_motions import METHODS

ACROBOT: Plain = {"q": [1.2, 0.4], "span": [0, 1]}


def assert_same_drift(model: Model, request: Plain, count: int) -> tuple[Trajectory, Trajectory]:
    """With many results, and with those at the ends of the span only; the energy drifts about as far."""
    many, few = (simulated(model, **request, count=k) for k in (count, 2))
    assert many.steps == few.steps
    one, two = (next(c for c in motion.checks if c.name == "energy") for motion in (many, few))
    assert one.worst <= 1.3 * two.worst + 2e-13 * one.scale
    return many, few


@pytest.mark.parametrize("count", [51, 1201])
@pytest.mark.parametrize("method", ["DOP853", "RK45", "RK23", "Radau", "LSODA"])
def test_trees(method: str, count: int) -> None:
    coarse = {"relative_tolerance": 1e-7, "absolute_tolerance": 1e-9} if method == "RK23" else {}
    assert_same_drift(catalogue_model("acrobot"), ACROBOT | {"method": method} | coarse, count)


@pytest.mark.parametrize("method", ["rk4", "semi-implicit-euler"])
def test_fixed_steps(method: str) -> None:
    assert_same_drift(catalogue_model("acrobot"), ACROBOT | {"fixed_step": FixedStep(0.01, method)}, 1234)


@pytest.mark.parametrize("reduction", METHODS)
def test_closed_motions(reduction: str) -> None:
    model = four_bar((0, -9.81, 0))
    request: Plain = {"q": at(model, crank=0.7, coupler=0.2, rocker=1.2), "qd": at(model, crank=9)}
    assert_same_drift(model, request | {"fixed": ["x.crank"], "span": [0, 0.5], "reduction": reduction}, 601)


def test_rolling_motions() -> None:
    start = [0, 0, R * np.sin(1.2), 0.2, 1.2, 0]
    request: Plain = {"constraints": [FLOOR], "q": start, "v": [1.0, 0.5, 6.0], "span": [0, 3]}
    assert_same_drift(disc(), request, 2001)


@pytest.mark.parametrize("method", ["DOP853", "RK45", "Radau"])
def test_many_states_of_a_step_are_those_of_few(method: str) -> None:
    """A polynomial through shorter steps against these steps themselves."""
    model = catalogue_model("acrobot")
    many, few = (simulated(model, **ACROBOT, count=count, method=method) for count in (2401, 13))
    np.testing.assert_allclose(many.q[::200], few.q, atol=1e-11)
    np.testing.assert_allclose(many.qd[::200], few.qd, atol=1e-10)


@pytest.mark.parametrize("reduction", METHODS)
def test_many_states_before_a_singular_position(reduction: str) -> None:
    """The last step is cut short there; results go on up to its end, without a gap."""
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    flat = closed_entry("four-bar", [pin], l0=0.3, l1=0.2, l2=0.3, l3=0.2)
    request: Plain = {"q": at(flat, crank=0.5, coupler=-0.5, rocker=0.5), "qd": at(flat, crank=-2.0)}
    request |= {"fixed": ["x.crank"], "reduction": reduction, "span": [0, 1]}
    motion = simulated(flat, **request, count=5001)
    assert motion.status == "failed"
    assert motion.checks
    assert all(check.holds for check in motion.checks), motion.checks
    assert len(motion.t) > 700
    assert np.diff(motion.t).max() < 2.001e-4
