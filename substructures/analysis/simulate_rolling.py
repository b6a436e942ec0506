"""Motion with velocity constraints (rolling, knife edges) in quasi-velocities, judged by energy and constraints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.linalg import lapack

from substructures.analysis.closed_record import Status, energy_check
from substructures.analysis.constrained import Array, given_inputs, read_state
from substructures.analysis.loops import check_fields
from substructures.analysis.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.signals import Signals
from substructures.analysis.span import Progress, Span, read_span
from substructures.analysis.trajectory import Check, Trajectory
from substructures.compile import compile_program
from substructures.errors import InvalidDocument
from substructures.expr.interpret import interpret
from substructures.model import Model
from substructures.states import States, numeric, symbol_values

DOCUMENT = ("constraints", "velocities", "independent")
FIELDS = {
    *DOCUMENT,
    *("q", "qd", "v", "parameters", "inputs", "start", "end", "times", "outputs", "rtol", "atol", "max_step"),
    *("max_steps", "form"),
}
FORMS = {"voronets": "bias", "boltzmann-hamel": "hamel_bias"}
#: largest constrained velocity [m/s] and change of a gap [m] along a right motion
RESIDUAL = 1e-9


class _Rolling:
    """The right-hand side in compiled form. y = (q, v, work)."""

    def __init__(self, equations: QuasiVelocities, request: Mapping[str, Any], folder: Path | None) -> None:
        model, self.form = equations.model, _form(request)
        self.equations, self.n, self.p = equations, model.dof, len(equations.velocities)
        names, given, pointers = given_inputs(model, request)
        self._inputs = Signals(given, pointers, smooth=False)
        nothing = States(np.zeros((1, self.n)), np.zeros((1, self.n)), None, True)
        plain = {"parameters": request.get("parameters")}
        found = symbol_values(model, plain, nothing, ["metric", "forces", "potential_energy"])
        columns = [*model.coordinates, *equations.velocities, "t", *names]
        self.values = {k: float(np.reshape(v, -1)[0]) for k, v in found.items() if k not in columns}
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

    ``request``: ``constraints``, ``velocities`` or ``independent`` (see VelocityConstraints); ``q`` (n,) or by name,
    and ``v`` (p,) or by name, or ``qd`` that meets the constraints; ``form``: ``voronets`` (default) or
    ``boltzmann-hamel``; ``parameters``, ``inputs``, ``start``, ``end``, ``times``, ``outputs``, ``rtol``, ``atol``,
    ``max_step``, ``max_steps`` as for closed loops; ``folder``: a cache of compiled kernels. Series: ``v`` (K, p),
    ``multipliers``, ``constraints`` (K, m; the latter B q'), ``gaps``, ``kinetic_energy``, ``potential_energy``,
    ``work``. Checks: B q' is zero, gaps and T + V - work are constant. A span that cannot be finished is ``failed``.
    Raises InvalidDocument, MissingValue and TooLarge.
    """
    check_fields(request, FIELDS)
    span = read_span(request)
    document = {k: request[k] for k in DOCUMENT if request.get(k) is not None}
    place = dict(zip(model.coordinates, map(float, read_state(model, request)[0]), strict=True))
    equations = quasi_velocity_equations(model, document, place)
    rolling = _Rolling(equations, request, folder)
    q, v = _start(rolling, request)
    states, status, message, steps = _integrate(rolling, span, np.concatenate((q, v, (0.0,))), progress)
    return _judged(rolling, span.times[: len(states)], states, (status, message, steps))


def _integrate(rolling: _Rolling, span: Span, y: Array, progress: Progress | None) -> tuple[Array, Status, str, int]:
    first, last = span.times[[0, -1]]
    if not np.isfinite(rolling.rates(first, y)).all():
        advice = "the accelerations are not determined at the start: check masses, inertias and quasi-velocities"
        return y[None], "failed", advice, 0
    solver = DOP853(rolling.rates, first, y, last, rtol=span.rtol, atol=span.atol, max_step=span.max_step)
    states, steps = [y], 0
    while solver.status == "running":
        if steps >= span.max_steps:
            return np.array(states), "failed", f"t = {solver.t:.9g} s after {steps:,} steps: raise 'max_steps'", steps
        complaint = solver.step()
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            advice = "the quasi-velocities may not describe the motion there (take others), or a body may lie flat"
            return (
                np.array(states),
                "failed",
                f"no step from t = {solver.t:.9g} s on: {complaint or ''} {advice}",
                steps,
            )
        steps += 1
        if len(states) < len(span.times) and solver.t >= span.times[len(states)]:
            dense: Callable[[float], Array] = solver.dense_output()
            due = span.times[len(states) : np.searchsorted(span.times, solver.t, side="right")]
            states += [dense(t) for t in due]
        if progress is not None and not progress(float((solver.t - first) / (last - first))):
            return np.array(states), "stopped", f"cancelled at t = {solver.t:.9g} s", steps
    return np.array(states), "finished", "", steps


def _start(rolling: _Rolling, request: Mapping[str, Any]) -> tuple[Array, Array]:
    """q and v at the start."""
    model, names = rolling.equations.model, rolling.equations.velocities
    q, qd = read_state(model, request)
    if request.get("v") is not None and request.get("qd") is not None:
        raise InvalidDocument.at("/v", "two-velocities", "give either 'v' or 'qd'")
    place = rolling.values | dict(zip(model.coordinates, q, strict=True))
    T = interpret(rolling.equations.program, place, ["T"])["T"]
    if not np.isfinite(T).all():
        message = f"the velocities {', '.join(names)} do not describe the motion at this start; take others"
        raise InvalidDocument.at("/q", "singular-start", message)
    if request.get("qd") is None:
        return q, _by_name(request.get("v"), names)
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


def _form(request: Mapping[str, Any]) -> str:
    form = request.get("form", "voronets")
    if not isinstance(form, str) or form not in FORMS:
        raise InvalidDocument.at("/form", "unknown-form", f"unknown form; there are {', '.join(FORMS)}")
    return FORMS[form]


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
