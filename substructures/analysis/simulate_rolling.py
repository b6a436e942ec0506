"""Motion with velocity constraints (rolling, knife edges) in quasi-velocities, judged by energy and constraints."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.linalg import lapack

from substructures.analysis.closed_record import Status, energy_check
from substructures.analysis.closed_requests import RollingRequest
from substructures.analysis.constrained import Array
from substructures.analysis.given import parameter_values, read_inputs, read_state
from substructures.analysis.quasi_velocities import QuasiVelocities, velocity_equations
from substructures.analysis.trajectory import Check, Trajectory
from substructures.compile import compile_program
from substructures.errors import InvalidDocument
from substructures.expr.interpret import interpret
from substructures.model import Model
from substructures.states import numeric

FORMS = {"voronets": "bias", "boltzmann-hamel": "hamel_bias"}
#: told the share of the time span that is done; False cancels
Progress = Callable[[float], bool | None]
#: largest constrained velocity [m/s] and change of a gap [m] along a right motion
RESIDUAL = 1e-9


class _Rolling:
    """The right-hand side in compiled form. y = (q, v, work)."""

    def __init__(self, equations: QuasiVelocities, request: RollingRequest, folder: Path | None) -> None:
        model, self.form = equations.model, FORMS[request.form]
        self.equations, self.n, self.p = equations, model.dof, len(equations.velocities)
        self._inputs = read_inputs(model, request)
        found = parameter_values(model, request, ["metric", "forces", "potential_energy"])
        columns = [*model.coordinates, *equations.velocities, "t", *self._inputs.names]
        self.values = {name: x for name, x in found.items() if name not in columns}
        self._x = np.zeros((1, len(columns)))
        wanted = ("rates", "metric", self.form, "forces", "lost_power")
        self._out = {name: np.zeros((1, *equations.program.outputs[name].shape)) for name in wanted}
        kernel = compile_program(equations.program, wanted, folder)
        self._run = kernel.bind(self._out, self.values, columns=[(columns, self._x)])
        self.columns = columns

    def move(self, t: float, y: Array) -> Array:
        """Values of all columns at a state; the outputs are evaluated there."""
        x, k = self._x[0], self.n + self.p
        x[:k], x[k] = y[:k], t
        x[k + 1 :] = self._inputs.at(t)[:, 0]
        self._run()
        return x

    def rates(self, t: float, y: Array) -> Array:
        """y'; not finite where the reduced metric is singular."""
        self.move(t, y)
        out, result = self._out, np.empty(len(y))
        force = out["forces"][0] - out[self.form][0]
        _, acceleration, info = lapack.dposv(out["metric"][0], force)
        result[: self.n], result[-1] = out["rates"][0], out["lost_power"][0]
        result[self.n : -1] = acceleration if not info else np.nan
        return result


def simulate_rolling(
    model: Model, request: Mapping[str, Any], progress: Progress | None = None, folder: Path | None = None
) -> Trajectory:
    """Integrate the equations of motion with velocity constraints.

    ``request``: see RollingRequest. ``progress`` is told the finished share of the span and cancels by False.
    ``folder``: a cache of compiled kernels. Series: ``v`` (K, p),
    ``multipliers``, ``constraints`` (K, m; the latter B q'), ``gaps``, ``kinetic_energy``, ``potential_energy``,
    ``work``. Checks: B q' is zero, gaps and T + V - work are constant. A span that cannot be finished is ``failed``.
    Raises InvalidDocument, MissingValue and TooLarge.
    """
    asked = RollingRequest.read(request)
    start, _ = read_state(model, asked)
    place = dict(zip(model.coordinates, start.tolist(), strict=True))
    equations = velocity_equations(model, asked, place)
    rolling = _Rolling(equations, asked, folder)
    q, v = _start(rolling, asked)
    return _judged(rolling, *_integrate(rolling, asked, np.concatenate((q, v, (0.0,))), progress))


class _Reached:
    """States at the output times that were reached."""

    def __init__(self, times: Array) -> None:
        self.due = deque(times.tolist())
        self.t: list[float] = []
        self.y: list[Array] = []

    def until(self, t: float, state: Callable[[float], Array]) -> None:
        """Add the states of all output times up to t."""
        while self.due and self.due[0] <= t:
            self.t.append(self.due.popleft())
            self.y.append(state(self.t[-1]))

    def with_last(self, t: float, y: Array) -> tuple[Array, Array]:
        """Times and states, the last one that was reached included."""
        if not self.t or t > self.t[-1]:
            self.t.append(t)
            self.y.append(y)
        return np.array(self.t), np.array(self.y)


def _integrate(
    rolling: _Rolling, asked: RollingRequest, y: Array, progress: Progress | None
) -> tuple[Array, Array, tuple[Status, str, int]]:
    """Times, states; status, message and number of steps."""
    (t, last), reached, steps = asked.span, _Reached(asked.outputs()), 0
    reached.until(t, lambda _: y)
    if not np.isfinite(rolling.rates(t, y)).all():
        advice = "the accelerations are not determined at the start: check masses, inertias and quasi-velocities"
        return *reached.with_last(t, y), ("failed", advice, 0)
    solver = DOP853(rolling.rates, t, y, last, **asked.options())
    while solver.status == "running":
        t, y = solver.t, solver.y
        if steps >= asked.max_steps:
            message = f"t = {t:.9g} s after {steps:,} steps: raise 'max_steps', or shorten the time span"
            return *reached.with_last(t, y), ("failed", message, steps)
        complaint = solver.step()
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            advice = "the quasi-velocities may not describe the motion there (take others), or a body may lie flat"
            message = f"no step from t = {t:.9g} s on: {complaint or ''} {advice}"
            return *reached.with_last(t, y), ("failed", message, steps)
        steps += 1
        if reached.due and reached.due[0] <= solver.t:
            reached.until(solver.t, solver.dense_output())
        if progress is not None and progress(float((solver.t - asked.span[0]) / (last - asked.span[0]))) is False:
            message = f"cancelled at t = {solver.t:.9g} s"
            return *reached.with_last(solver.t, solver.y), ("stopped", message, steps)
    return np.array(reached.t), np.array(reached.y), ("finished", "", steps)


def _start(rolling: _Rolling, request: RollingRequest) -> tuple[Array, Array]:
    """q and v at the start."""
    model, names = rolling.equations.model, rolling.equations.velocities
    q, qd = read_state(model, request)
    if request.v is not None and request.qd is not None:
        raise InvalidDocument.at("/v", "two-velocities", "give either 'v' or 'qd'")
    place = rolling.values | dict(zip(model.coordinates, q, strict=True))
    T = interpret(rolling.equations.program, place, ["T"])["T"]
    if not np.isfinite(T).all():
        message = f"the velocities {', '.join(names)} do not describe the motion at this start; take others"
        raise InvalidDocument.at("/q", "singular-start", message)
    if request.qd is None:
        return q, _by_name(request.v, names)
    v = np.asarray(np.linalg.lstsq(T, qd)[0], dtype=np.float64)
    left = np.abs(T @ v - qd).max(initial=0)
    if left > 1e-9 * max(1.0, np.abs(qd).max(initial=0)):
        message = f"these velocities violate the constraints by {left:.3g}; give 'v' ({', '.join(names)}) instead"
        raise InvalidDocument.at("/qd", "violated", message)
    return q, v


def _by_name(given: Any, names: tuple[str, ...]) -> Array:
    if given is None:
        return np.zeros(len(names))
    if isinstance(given, Mapping):
        unknown = [name for name in given if name not in names]
        if unknown:
            message = f"unknown velocity '{str(unknown[0])[:80]}'; there are {', '.join(names)}"
            raise InvalidDocument.at("/v", "unknown-velocity", message)
        given = [given.get(name, 0) for name in names]
    v = numeric(given, "/v")
    if v.shape != (len(names),):
        message = f"shape {v.shape} found, ({len(names)},) expected: {', '.join(names)}"
        raise InvalidDocument.at("/v", "wrong-length", message)
    return v


def _judged(rolling: _Rolling, t: Array, states: Array, outcome: tuple[Status, str, int]) -> Trajectory:
    equations, n = rolling.equations, rolling.n
    columns = np.array([rolling.move(*pair).copy() for pair in zip(t, states, strict=True)])
    slopes = np.array([rolling.rates(*pair) for pair in zip(t, states, strict=True)])
    values: dict[str, Any] = rolling.values | dict(zip(rolling.columns, columns.T, strict=True))
    values |= {f"{name}'": slopes[:, n + i] for i, name in enumerate(equations.velocities)}
    names = ["rates", "constraints", "multipliers", "kinetic_energy", "potential_energy"]
    names += ["gaps"] if equations.gaps else []
    found = interpret(equations.program, values, names)
    qd = found["rates"]
    series = {name: found[name] for name in names[2:]} | {"v": states[:, n:-1], "work": states[:, -1]}
    series["constraints"] = np.einsum("kma,ka->km", found["constraints"], qd)
    checks = [energy_check(t, series, not series["work"].any()), _slip_check(t, series["constraints"])]
    if equations.gaps:
        checks.append(_gap_check(t, series["gaps"]))
    status, message, steps = outcome
    return Trajectory(equations.model.coordinates, t, states[:, :n], qd, series, tuple(checks), status, message, steps)


def _slip_check(t: Array, slips: Array) -> Check:
    size = np.abs(slips).max(axis=1, initial=0)
    bad = np.flatnonzero(~(size <= RESIDUAL))
    first = float(t[bad[0]]) if len(bad) else None
    return Check("constraints", "zero", "B q' = 0", "m/s, 1/s", float(size.max()), 1.0, RESIDUAL, first)


def _gap_check(t: Array, gaps: Array) -> Check:
    drift = np.abs(gaps - gaps[0]).max(axis=1)
    bad = np.flatnonzero(~(drift <= RESIDUAL))
    reason = "integrals of constraints: rolling bodies keep their distance from the plane, loops stay closed"
    first = float(t[bad[0]]) if len(bad) else None
    return Check("gaps", "constant", reason, "m", float(drift.max()), 1.0, RESIDUAL, first)
