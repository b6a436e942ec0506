"""Motion of a tree with closures and prescribed coordinates, judged by its residuals and its energy balance."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import DOP853

from substructures.analysis.closed_record import Record, Status, judged
from substructures.analysis.closed_requests import ClosedRequest
from substructures.analysis.constrained import SINGULAR, Array, Constrained, Singular
from substructures.analysis.events import Events, Occurrence, first_stop
from substructures.analysis.given import check_fixed, read_state
from substructures.analysis.loops import mobility
from substructures.analysis.project import Consistent, consistent_state
from substructures.analysis.reductions import METHODS, Reduction
from substructures.analysis.trajectory import Trajectory
from substructures.errors import InvalidDocument
from substructures.model import Model

#: told the share of the time span that is done; False cancels
Progress = Callable[[float], bool | None]
#: how often a step that ran into a singular position is begun again, each time a quarter as long
RETRIES = 10


def simulate_closed(
    model: Model, request: Mapping[str, Any], progress: Progress | None = None, folder: Path | None = None
) -> Trajectory:
    """Integrate the equations of motion with closures from the closed state nearest to the given one.

    ``request``: see ClosedRequest. ``progress`` is told the finished share of the span and cancels by False.
    ``folder``: a cache of compiled kernels.

    The series of the result: ``qdd`` (K, n), ``multipliers`` (K, m; of least norm), ``kinetic_energy``,
    ``potential_energy``, ``work`` (K,), ``position_residual``, ``velocity_residual`` (K,), ``actuation`` (K, p; forces
    of the prescribed coordinates), ``event_times``. Checks: both residuals are zero, and T + V - work is constant; work
    is that of forces without potential and of prescribed coordinates. Loops that cannot be closed, a singular
    position and a span that cannot be finished are ``failed``, with advice and the motion up to there. Raises
    InvalidDocument and MissingValue.
    """
    asked = ClosedRequest.read(request)
    check_fixed(model, asked.fixed)
    s, (q, qd), start = Constrained(model, asked, folder), read_state(model, asked), asked.span[0]
    _check_tables(s, asked.span)
    events = Events(model, asked.events, s.values)
    state = consistent_state(s, start, q, qd, asked.fixed)
    place = mobility(s, start, state.q)
    message = state.message or (f"the start is singular: {SINGULAR}" if place.singular else "")
    if message:
        return _nothing(model, state, start, message)
    s.move(start, state.q, state.qd)
    run = _Run(METHODS[asked.method](s, place.rank), asked, events, progress)
    status, message = run.go(state.q, state.qd)
    return judged(s, run.record, status, message) if run.record.rows else _nothing(model, state, start, message)


class _Run:
    """One integration."""

    def __init__(self, reduction: Reduction, asked: ClosedRequest, events: Events, progress: Progress | None) -> None:
        self.reduction, self.asked, self.events, self.progress = reduction, asked, events, progress
        self.s, self.record = reduction.s, Record()
        self.pending: Iterator[float] = iter(asked.outputs().tolist())
        self.next = next(self.pending, np.inf)

    def go(self, q: Array, qd: Array) -> tuple[Status, str]:
        """Status and message at the end; the states are in the record, the last one that was reached included."""
        start = self.asked.span[0]
        try:
            self.landed = start, q, qd, 0.0
            y = self.reduction.pack(q, qd, 0.0)
            self._output(start, lambda _: y)
            status, message = self._steps(self._solver(start, y, None))
        except Singular as error:
            status, message = "failed", f"stopped at t = {self.s.t:.9g} s: {error}"
        if status == "failed":
            self._keep_last()
        return status, message

    def _keep_last(self) -> None:
        t, q, qd, work = self.landed
        if self.record.rows and t > self.record.rows[-1]["t"]:
            self.s.move(t, q, qd)
            with suppress(Singular):
                self.record.keep(self.s, self.reduction.rows, work)

    def _solver(self, t: float, y: Array, first: float | None) -> DOP853:
        last = self.asked.span[1]
        options: dict[str, Any] = self.asked.options()
        if first is not None:
            options["first_step"] = min(first, last - t)
        return DOP853(self.reduction.rates, t, y, last, **options)

    def _steps(self, solver: DOP853) -> tuple[Status, str]:
        before = solver.t, self.events.at(solver.t, self.s.q, self.s.qd)
        while solver.status == "running":
            solver, advice = self._advance(solver)
            if advice:
                return "failed", advice
            stop = None
            if solver.t >= self.next or self.events.events:
                dense = solver.dense_output()
                after = solver.t, self._events(solver.t, dense)
                stop = self._watch(before, after, dense)
                self._output(solver.t if stop is None else stop.time, dense)
                before = after
                if stop is not None:
                    return self._stopped(stop, dense)
            solver = self._landed(solver)
            if self.progress is not None and self.progress(self._share(solver.t)) is False:
                return "stopped", f"cancelled at t = {solver.t:.9g} s"
        return "finished", ""

    def _events(self, t: float, dense: Callable[[float], Array]) -> Array:
        """Values of the event expressions at a time within the last step."""
        return self.events.at(t, *self.reduction.land(t, dense(t))) if self.events.events else np.zeros(0)

    def _watch(
        self, before: tuple[float, Array], after: tuple[float, Array], dense: Callable[[float], Array]
    ) -> Occurrence | None:
        """Record the events of the last step, up to the one that stops the motion."""
        found = self.events.between(before, after, lambda t: self._events(t, dense))
        stop = first_stop(found)
        self.record.occurrences += [one for one in found if stop is None or one.time <= stop.time]
        return stop

    def _advance(self, solver: DOP853) -> tuple[DOP853, str]:
        """The solver after one step; what to change when there is none."""
        if self.record.steps >= self.asked.max_steps:
            many = f"t = {solver.t:.9g} s after {self.record.steps:,} steps"
            return solver, f"{many}: raise 'max_steps', or shorten the time span"
        for _ in range(RETRIES):
            try:
                complaint = solver.step()
                break
            except Singular:
                solver = self._again(solver)
        else:
            complaint = solver.step()
        if solver.status == "failed":
            return solver, (
                f"no step from t = {solver.t:.9g} s on: {complaint} Look for very stiff springs, for masses or lengths "
                "near zero and for jumps in loads; else loosen 'relative_tolerance', or end before"
            )
        self.record.steps += 1
        return solver, ""

    def _again(self, solver: DOP853) -> DOP853:
        """From the last state with another choice of independent rows and coordinates and a shorter step."""
        t, q, qd, work = self.landed
        self.s.move(t, q, qd)
        self.reduction.choose(anew=True)
        return self._solver(t, self.reduction.pack(q, qd, work), solver.h_abs / 4)

    def _landed(self, solver: DOP853) -> DOP853:
        """The solver with its state moved onto the closures; a new one when the state has got another meaning."""
        t, work = solver.t, float(solver.y[-1])
        q, qd = self.reduction.land(t, solver.y)
        self.record.residuals(self.s)
        self.landed = t, q, qd, work
        changed = self.reduction.choose()
        y = self.reduction.pack(q, qd, work)
        if changed and solver.status == "running":
            return self._solver(t, y, solver.h_abs)
        if solver.status == "running":
            solver.y, solver.f = y, self.reduction.rates(t, y)
        return solver

    def _output(self, until: float, dense: Callable[[float], Array]) -> None:
        """Record all output times up to this one."""
        while self.next <= until:
            self._keep(self.next, dense(self.next))
            self.next = next(self.pending, np.inf)

    def _keep(self, t: float, y: Array) -> None:
        self.reduction.land(t, y)
        self.record.keep(self.s, self.reduction.rows, float(y[-1]))

    def _stopped(self, stop: Occurrence, dense: Callable[[float], Array]) -> tuple[Status, str]:
        if not self.record.rows or self.record.rows[-1]["t"] < stop.time:
            self._keep(stop.time, dense(stop.time))
        return "stopped", f"event '{stop.event.name}' at t = {stop.time:.12g} s"

    def _share(self, t: float) -> float:
        first, last = self.asked.span
        return float((t - first) / (last - first))


def _check_tables(s: Constrained, span: tuple[float, float]) -> None:
    """Tables of prescribed motions hold within their times only."""
    if s.prescribed.motions is None:
        return
    first, last = s.prescribed.motions.span
    if span[0] < first or span[1] > last:
        message = f"the tables hold from {first:.9g} s to {last:.9g} s only; end within, or continue them"
        raise InvalidDocument.at("/prescribed", "outside-table", message)


def _nothing(model: Model, state: Consistent, t: float, message: str) -> Trajectory:
    """A motion that did not begin."""
    residuals = {"position_residual": state.residual, "velocity_residual": state.velocity_residual}
    series = {name: np.array([value]) for name, value in residuals.items()}
    return Trajectory(model.coordinates, np.array([t]), state.q[None], state.qd[None], series, (), "failed", message)
