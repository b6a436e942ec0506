"""Motion of a tree with closures and prescribed coordinates, judged by its residuals and its energy balance."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from substructures.analysis.closed.constrained import SINGULAR, Constrained, Singular
from substructures.analysis.closed.doubt import energy_doubt
from substructures.analysis.closed.loops import least_multipliers, mobility
from substructures.analysis.closed.projection import Consistent, consistent_state
from substructures.analysis.closed.reductions import REDUCTIONS, Reduction
from substructures.analysis.closed.stepper import ClosedStepper
from substructures.analysis.motion.integration import IntegratedMotion, IntegratorSettings, integrate
from substructures.analysis.motion.judges import energy_balance
from substructures.analysis.motion.progress import ProgressReport, share_of
from substructures.analysis.motion.requests import ClosedRequest
from substructures.analysis.motion.steppers import scipy_stepper
from substructures.analysis.motion.trajectory import Check, Trajectory, crossings
from substructures.array import Array
from substructures.tree.model import Model

#: largest residuals of positions [m, 1] and velocities [per s] along a right motion
RESIDUAL = 1e-9
ADVICE = "look for very stiff springs, for masses or lengths near zero and for jumps in loads"


def simulate_closed(
    model: Model, request: Mapping[str, Any], progress: ProgressReport | None = None, folder: Path | None = None
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
    return _judged(s, asked, _moved(s, asked, x, place.rank, progress, folder), place.rank)


def _moved(
    s: Constrained, asked: ClosedRequest, x: Array, rank: int, progress: ProgressReport | None, folder: Path | None
) -> IntegratedMotion:
    reduction: Reduction = REDUCTIONS[asked.reduction](s, rank)
    inner = scipy_stepper(asked.method, asked.relative_tolerance, asked.absolute_tolerance, asked.max_step)

    def stepper(_f: object, t: float, y: Array, end: float) -> ClosedStepper:
        return ClosedStepper(reduction, inner, t, y, end)

    motion = integrate(
        reduction.rates,
        x,
        asked.span,
        asked.outputs(),
        IntegratorSettings(stepper, asked.max_steps, ADVICE),
        s.along.watches(lambda _, y: y[:-1], folder),
        s.along.breaks(asked.span),
        share_of(asked.span, progress),
        s.inputs.enter,
    )
    s.inputs.leave()
    return motion


def _judged(s: Constrained, asked: ClosedRequest, motion: IntegratedMotion, rank: int) -> Trajectory:
    """The motion with its series and checks."""
    t, x, results = motion.judged()
    judged = _along(_judged_quantities, s, t, x) | {"work": x[:, -1]}
    doubt = energy_doubt(s, rank, t, x[:, :-1], np.array(motion.step_t))
    balance = energy_balance(t, judged, s.conservative, asked.drift_limit, doubt)
    checks = (*_residual_checks(t, judged), balance)
    t, x = t[results], x[results]
    q, qd = np.split(x[:, :-1], 2, axis=1)
    series = _along(_forces, s, t, x) | {name: values[results] for name, values in judged.items()}
    series |= s.along.series_at(t, x[:, :-1])
    found = crossings(asked.events, motion.found, s.n)
    figures = {"evaluations": float(motion.evaluations)}
    return Trajectory(
        s.model.coordinates,
        t,
        q,
        qd,
        series,
        checks,
        motion.status,
        motion.message,
        motion.steps,
        found,
        figures,
    )


def _along(quantities: Callable[[Constrained], dict[str, Any]], s: Constrained, t: Array, x: Array) -> dict[str, Array]:
    """Quantities of a state at all states (q, q', work)."""
    rows = []
    for at, state in zip(t.tolist(), x, strict=True):
        s.move(at, *np.split(state[:-1], 2))
        rows.append(quantities(s))
    like = {name: np.shape(value) for name, value in quantities(s).items()}
    return {name: np.array([row[name] for row in rows]).reshape(len(rows), *shape) for name, shape in like.items()}


def _forces(s: Constrained) -> dict[str, Any]:
    """Accelerations and multipliers; not finite where they are not determined."""
    try:
        qdd, _ = s.accelerations(s.independent_rows())
        multipliers = least_multipliers(s, qdd)
    except Singular:
        qdd, multipliers = np.full(s.n, np.nan), np.full(len(s.labels), np.nan)
    return {"qdd": qdd, "multipliers": multipliers, "actuation": multipliers[s.closed :]}


def _judged_quantities(s: Constrained) -> dict[str, Any]:
    kinetic, potential = s.energies
    return {
        "kinetic_energy": kinetic,
        "potential_energy": potential,
        "position_residual": np.abs(s.phi).max(initial=0),
        "velocity_residual": np.abs(s.velocity_residual).max(initial=0),
    }


def _residual_checks(t: Array, columns: Mapping[str, Array]) -> Iterator[Check]:
    for name, reason, unit in (
        ("position", "the closures (and prescribed motions) are met", "m, 1"),
        ("velocity", "G q' + phi_t = 0", "m/s, 1/s"),
    ):
        residual = columns[f"{name}_residual"]
        yield Check.of((f"{name} residual", "zero", reason, unit), residual, t, 1.0, RESIDUAL)


def _nothing(model: Model, state: Consistent, t: float, message: str) -> Trajectory:
    """A motion that did not begin."""
    residuals = {"position_residual": state.residual, "velocity_residual": state.velocity_residual}
    series = {name: np.array([value]) for name, value in residuals.items()}
    return Trajectory(model.coordinates, np.array([t]), state.q[None], state.qd[None], series, (), "failed", message)
