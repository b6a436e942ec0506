"""Motion of a tree with closures and prescribed coordinates, judged by its residuals and its energy balance."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from substructures.analysis.closed_stepper import ClosedStepper
from substructures.analysis.constrained import SINGULAR, Constrained, Singular
from substructures.analysis.integrate import Motion, Settings, integrate, scipy_stepper
from substructures.analysis.judges import energy_balance
from substructures.analysis.loops import least_multipliers, mobility
from substructures.analysis.progress import Report, share_of
from substructures.analysis.project import Consistent, consistent_state
from substructures.analysis.reductions import REDUCTIONS, Reduction
from substructures.analysis.requests import ClosedRequest
from substructures.analysis.trajectory import Check, Trajectory, crossings
from substructures.model import Model
from substructures.states import Array

#: largest residuals of positions [m, 1] and velocities [per s] along a right motion
RESIDUAL = 1e-9
ADVICE = "look for very stiff springs, for masses or lengths near zero and for jumps in loads"


def simulate_closed(
    model: Model, request: Mapping[str, Any], progress: Report | None = None, folder: Path | None = None
) -> Trajectory:
    """Integrate the equations of motion with closures from the closed state nearest to the given one.

    ``request``: see ClosedRequest. ``progress`` is told the finished share of the span and cancels by False.
    ``folder``: a cache of compiled kernels.

    The series of the result: ``qdd`` (K, n), ``multipliers`` (K, m; of least norm), ``kinetic_energy``,
    ``potential_energy``, ``work`` (K,), ``position_residual``, ``velocity_residual`` (K,), ``actuation`` (K, p; forces
    of the prescribed coordinates), varying inputs, and what the request asks for. Checks: both residuals are zero, and
    T + V - work is constant; work is that of forces without potential and of prescribed coordinates. Loops that cannot
    be closed, a singular position at the start or on the way and a span that cannot be finished are ``failed``, with
    advice and the motion up to there. Raises InvalidDocument and MissingValue.
    """
    asked = ClosedRequest.read(request)
    s, start = Constrained(model, asked, folder), asked.span[0]
    s.inputs.enter(*asked.span)
    state = consistent_state(s, start, s.along.q, s.along.qd, asked.fixed)
    place = mobility(s, start, state.q)
    message = state.message or (f"the start is singular: {SINGULAR}" if place.singular else "")
    if message:
        return _nothing(model, state, start, message)
    s.move(start, state.q, state.qd)
    x = np.concatenate((state.q, state.qd, (0.0,)))
    return _judged(s, asked, _moved(s, asked, x, place.rank, progress, folder))


def _moved(
    s: Constrained, asked: ClosedRequest, x: Array, rank: int, progress: Report | None, folder: Path | None
) -> Motion:
    reduction: Reduction = REDUCTIONS[asked.reduction](s, rank)
    inner = scipy_stepper(asked.method, asked.relative_tolerance, asked.absolute_tolerance, asked.max_step)

    def stepper(_f: object, t: float, y: Array, end: float) -> ClosedStepper:
        return ClosedStepper(reduction, inner, t, y, end)

    motion = integrate(
        reduction.rates,
        x,
        asked.span,
        asked.outputs(),
        Settings(stepper, asked.max_steps, ADVICE),
        s.along.watches(lambda _, y: y[:-1], folder),
        s.along.breaks(asked.span),
        share_of(asked.span, progress),
        s.inputs.enter,
    )
    s.inputs.leave()
    return motion


def _judged(s: Constrained, asked: ClosedRequest, motion: Motion) -> Trajectory:
    """The motion with its series and checks."""
    t, x = np.array(motion.t), np.array(motion.x)
    q, qd = np.split(x[:, :-1], 2, axis=1)
    rows = [_quantities(s, at, *pair) for at, *pair in zip(motion.t, q, qd, strict=True)]
    series = {name: np.array([row[name] for row in rows]) for name in rows[0]} | {"work": x[:, -1]}
    checks = [*_residual_checks(s, motion), energy_balance(t, series, s.conservative, asked.drift_limit)]
    series |= s.along.series_at(t, x[:, :-1])
    found = crossings(asked.events, motion.found, s.n)
    figures = {"evaluations": float(motion.evaluations)}
    return Trajectory(
        s.model.coordinates,
        t,
        q,
        qd,
        series,
        tuple(checks),
        motion.status,
        motion.message,
        motion.steps,
        found,
        figures,
    )


def _quantities(s: Constrained, t: float, q: Array, qd: Array) -> dict[str, Any]:
    """Series at a state; accelerations and multipliers are not finite where they are not determined."""
    s.move(t, q, qd)
    try:
        qdd, _ = s.accelerations(s.independent_rows())
        multipliers = least_multipliers(s, qdd)
    except Singular:
        qdd, multipliers = np.full(s.n, np.nan), np.full(len(s.labels), np.nan)
    kinetic, potential = s.energies
    position, velocity = _residuals(s)
    return {
        "qdd": qdd,
        "multipliers": multipliers,
        "kinetic_energy": kinetic,
        "potential_energy": potential,
        "actuation": multipliers[s.closed :],
        "position_residual": position,
        "velocity_residual": velocity,
    }


def _residuals(s: Constrained) -> tuple[float, float]:
    return float(np.abs(s.phi).max(initial=0)), float(np.abs(s.velocity_residual).max(initial=0))


def _residual_checks(s: Constrained, motion: Motion) -> list[Check]:
    """Of all accepted steps that were kept."""
    found = []
    for t, x in zip(motion.step_t, motion.step_x, strict=True):
        s.move(t, *np.split(x[:-1], 2))
        found.append(_residuals(s))
    sizes, times = np.array(found), np.array(motion.step_t)
    reason = "the closures (and prescribed motions) are met"
    return [
        Check.of(("position residual", "zero", reason, "m, 1"), sizes[:, 0], times, 1.0, RESIDUAL),
        Check.of(("velocity residual", "zero", "G q' + phi_t = 0", "m/s, 1/s"), sizes[:, 1], times, 1.0, RESIDUAL),
    ]


def _nothing(model: Model, state: Consistent, t: float, message: str) -> Trajectory:
    """A motion that did not begin."""
    residuals = {"position_residual": state.residual, "velocity_residual": state.velocity_residual}
    series = {name: np.array([value]) for name, value in residuals.items()}
    return Trajectory(model.coordinates, np.array([t]), state.q[None], state.qd[None], series, (), "failed", message)
