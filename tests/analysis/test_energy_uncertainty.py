"""Judgements beside singular positions: rounding is no fault there, and a wrong stepper is still found out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import at, closed_entry
from in_depth import deep
from simulated import simulated

from substructures import Model
from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.reductions import Reduction
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.verdict import Check

from .closed_motions import METHODS

PIN = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
#: the crank [rad] of the parallelogram below goes from 0.5 to the singular position at 0
PLACES = {"far": (0.2, 0.4), "near": (0.0, 0.01)}


def parallelogram() -> Model:
    """All its links come in line where the crank is at 0."""
    return closed_entry("four-bar", [PIN], (0, -9.81, 0), l0=0.3, l1=0.2, l2=0.3, l3=0.2)


def moved(reduction: str, speed: float = -3.0, **more: Any) -> tuple[Trajectory, Check]:
    """Towards the singular position, and the verdict on its energy."""
    model = parallelogram()
    start = at(model, crank=0.5, coupler=-0.5, rocker=0.5)
    motion = simulated(model, start, (0, 1), qd=at(model, crank=speed), fixed=["x.crank"], reduction=reduction, **more)
    return motion, next(check for check in motion.checks if check.name == "energy")


@pytest.mark.parametrize("reduction", METHODS)
@pytest.mark.parametrize("method", ["DOP853", "RK45"])
@pytest.mark.parametrize("speed", [-2.0, -3.0, -8.0])
def test_a_right_motion_is_right_up_to_a_singular_position(reduction: str, method: str, speed: float) -> None:
    """And ends at the same place whatever the steps: where states are no longer determined well enough."""
    motion, energy = moved(reduction, speed, method=method, count=201)
    # it did not come to its end, and what there is of it obeys all conditions
    assert (motion.status, motion.is_right) == ("failed", None)
    assert motion.checks
    assert all(check.holds for check in motion.checks), motion.checks
    assert energy.relative < 0.5 * energy.limit
    model = parallelogram()
    share = 1e-4 if reduction == "projection" else 1e-3
    assert motion.q[-1] == pytest.approx(at(model, crank=1, coupler=-1, rocker=1) * motion.q[-1, 0], abs=1e-9)
    assert 0.4 * share < motion.q[-1, 0] < 2 * share


@pytest.mark.parametrize(
    ("reduction", "place"),
    [("projection", "far"), ("projection", "near"), ("partitioning", "near"), *deep(("partitioning", "far"))],
)
def test_a_force_with_a_wrong_sign_is_found_out(reduction: str, place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    low, high = PLACES[place]
    solved = Constrained.solved

    def planted(s: Constrained, chosen: Any) -> Any:
        if low < s.q[0] < high:
            s.f *= -1
        return solved(s, chosen)

    monkeypatch.setattr(Constrained, "solved", planted)
    # steps in machine code do not ask it
    monkeypatch.setattr(Constrained, "compiled", lambda *_: None)
    motion, energy = moved(reduction, count=2001)
    assert not energy.holds
    assert energy.relative > 100 * energy.limit
    assert motion.q[np.searchsorted(motion.t, energy.time), 0] < high + 0.2


@pytest.mark.parametrize("reduction", METHODS)
@pytest.mark.parametrize(("place", "error"), [("far", 1e-7), ("near", 1e-5)])
def test_velocities_that_are_a_little_off_are_found_out(
    reduction: str, place: str, error: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Twice the error of a velocity is in the energy: near the singular position a hundred limits show."""
    low, high = PLACES[place]
    land = Reduction.land

    def planted(self: Reduction, t: float, y: Any) -> Any:
        q, qd = land(self, t, y)
        return q, qd * (1 + error) if low < q[0] < high else qd

    monkeypatch.setattr(Reduction, "land", planted)
    _, energy = moved(reduction, max_step=0.01)
    assert not energy.holds
