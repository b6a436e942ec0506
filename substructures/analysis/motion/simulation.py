"""Simulation of a tree without closures, judged by all its first integrals."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.formulas import require_tree
from substructures.analysis.motion.fixed_step import march
from substructures.analysis.motion.inputs import Along, read_along
from substructures.analysis.motion.integration import IntegratedMotion, IntegratorSettings, integrate
from substructures.analysis.motion.judges import MotionStates, integral_series, judge
from substructures.analysis.motion.progress import ProgressReport, share_of
from substructures.analysis.motion.requests import TAYLOR, SimulationRequest
from substructures.analysis.motion.right_hand_side import RightHandSide, is_definite
from substructures.analysis.motion.steppers import Stepper, scipy_stepper
from substructures.analysis.motion.taylor import require_taylor, taylor_stepper
from substructures.analysis.motion.trajectory import Trajectory, crossings
from substructures.array import Array
from substructures.errors import InvalidDocument, InvalidInput
from substructures.tree.model import Model

DYNAMICS = ("metric", "bias", "forces", "potential_energy")
SINGULAR = (
    "the metric is singular or not positive definite at the start: a massless body, or a joint at a singular angle "
    "(spherical and free joints: pitch = +-pi/2); change masses, inertias or the start"
)


def simulate_tree(
    model: Model, request: Mapping[str, Any], progress: ProgressReport | None = None, folder: Path | None = None
) -> Trajectory:
    """The motion of a tree from a start over a span of time, with the drift of all its first integrals.

    ``request``: see SimulationRequest; ``q`` and ``qd`` as in ``evaluate``, for one state. ``progress`` is told the
    finished share of the span and stops the integration by False. ``folder``: where compiled kernels are kept.
    ``series`` of the result: ``energy``, momenta and other first integrals, ``power``, ``work``, varying inputs under
    their names, and what the request asks for. What goes wrong on the way is a trajectory with status ``failed``,
    advice, and the motion up to there. Raises InvalidDocument (pointers into the request; ``has-closures``) and
    MissingValue.
    """
    asked = SimulationRequest.read(request)
    along = read_tree(model, asked)
    try:
        f = RightHandSide(model, along.values, along.zero, along, folder)
    except InvalidInput as error:
        if any(fault.code == "singular-metric" for fault in error.faults):
            return _failed(along, asked, str(error))
        raise
    x = np.concatenate([along.start, np.zeros(f.size - 2 * f.n)])
    acceleration, pivots, _ = f.evaluate(asked.span[0], x)
    if not is_definite(pivots):
        return _failed(along, asked, SINGULAR)
    if not np.isfinite(acceleration).all():
        message = "a force is not finite at the start: look at springs of length 0 and roots or divisions in loads"
        return _failed(along, asked, message)
    return _judged(along, asked, f, *_moved(along, asked, f, x, progress, folder))


def read_tree(model: Model, request: SimulationRequest) -> Along:
    """Check a request against a model. Raises InvalidDocument and MissingValue."""
    require_tree(model)
    along = read_along(model, request, request.span, DYNAMICS)
    if request.method == TAYLOR and request.fixed_step is None:
        require_taylor(list(along.curves), request.max_step)
    if request.fixed_step is not None and request.events:
        message = "steps of a fixed size do not stop for events: leave 'events' or 'fixed_step' out"
        raise InvalidDocument.at("/events", "not-supported", message)
    return along


def _moved(
    along: Along,
    request: SimulationRequest,
    f: RightHandSide,
    x: Array,
    progress: ProgressReport | None,
    folder: Path | None,
) -> tuple[IntegratedMotion, dict[str, float]]:
    begin = perf_counter()
    told = share_of(request.span, progress)
    figures: dict[str, float] = {}
    outputs = request.outputs()
    if request.fixed_step is not None:
        motion, pace = march(f, f.n, x, request.span, outputs, request.fixed_step, request.max_steps, told)
        figures |= {"real_time_factor": pace.factor, "longest_step": pace.longest}
    else:
        settings = IntegratorSettings(_stepper(along, request, f), request.max_steps)
        watches = along.watches(lambda _, y: y[: 2 * f.n], folder)
        breaks = along.breaks(request.span)
        motion = integrate(f, x, request.span, outputs, settings, watches, breaks, told, f.enter)
        f.leave()
    return motion, figures | {"evaluations": motion.evaluations, "seconds": perf_counter() - begin}


def _stepper(along: Along, request: SimulationRequest, f: RightHandSide) -> Stepper:
    if request.method == TAYLOR:
        return taylor_stepper(along, request.relative_tolerance, f.has_power)
    return scipy_stepper(request.method, request.relative_tolerance, request.absolute_tolerance, request.max_step)


def _judged(
    along: Along, request: SimulationRequest, f: RightHandSide, motion: IntegratedMotion, figures: Mapping[str, float]
) -> Trajectory:
    model = along.model
    given = [n for n in request.inputs if n not in along.zero]
    integrals = first_integrals(model, given, along.zero & set(model.parameters))
    t, x, results = motion.judged()
    states = _states(along, f, t, x)
    series = integral_series(model, integrals, states)
    checks = judge(model, integrals, states, series, request.drift_limit)
    if f.has_power and "energy" in series:
        series["work"] = states.work
    x = x[results, : 2 * f.n]
    t = t[results]
    return Trajectory(
        model.coordinates,
        t,
        x[:, : f.n],
        x[:, f.n :],
        {name: values[results] for name, values in series.items()} | along.series_at(t, x),
        checks,
        motion.status,
        motion.message,
        motion.steps,
        crossings(request.events, motion.found, model.dof),
        figures,
    )


def _states(along: Along, f: RightHandSide, t: Array, x: Array) -> MotionStates:
    n = f.n
    values: dict[str, float | Array] = {**along.values, **along.inputs_at(t, x[:, : 2 * n])}
    work = x[:, 2 * n] if f.has_power else np.zeros(len(t))
    return MotionStates(t, x[:, :n], x[:, n : 2 * n], values, work)


def _failed(along: Along, request: SimulationRequest, message: str) -> Trajectory:
    """Only the start."""
    n = along.model.dof
    q, qd = along.start[None, :n], along.start[None, n:]
    return Trajectory(along.model.coordinates, np.array([request.span[0]]), q, qd, status="failed", message=message)
