"""Motion with velocity constraints (rolling, knife edges) in quasi-velocities, judged by energy and constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import scipy

from substructures.analysis.arguments import one_of
from substructures.analysis.equations.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.equations.velocity_constraints import Constraint
from substructures.analysis.motion.conditions import Conditions, read_conditions
from substructures.analysis.motion.corners import Laws, follow
from substructures.analysis.motion.integration import IntegratedMotion, IntegratorSettings, integrate
from substructures.analysis.motion.judges import energy_balance, spread, unbalanced
from substructures.analysis.motion.output_times import OutputTimes
from substructures.analysis.motion.problem import IntegratorChoice, MotionProblem, StateVector
from substructures.analysis.motion.progress import ProgressReport, share_of
from substructures.analysis.motion.second_run import accurate, at_end, second_run, state_groups
from substructures.analysis.motion.single_steps import steps_again
from substructures.analysis.motion.steppers import METHODS
from substructures.analysis.motion.trajectory import Crossing, Trajectory, crossings
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.analysis.motion.zeros import Watch
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.compile import compile_program
from substructures.errors import InvalidArgument, among
from substructures.expr.interpret import interpret, interpret_in_blocks
from substructures.quantities.limits import reached
from substructures.quantities.measured import numeric

FORMS = {"voronets": "bias", "boltzmann-hamel": "hamel_bias"}
NEEDS = ("metric", "forces", "potential_energy")
#: largest constrained velocity [m/s] and change of a gap [m] along a right motion
RESIDUAL = 1e-9
ADVICE = "the quasi-velocities may not describe the motion there (take others), or a body may lie flat"


@dataclass(frozen=True, kw_only=True)
class RollingProblem(MotionProblem):
    """A motion with ``constraints`` from ``start.q`` and quasi-velocities ``v`` (0 by default), or from velocities
    ``start.qd`` that meet them.

    ``velocities``, ``independent``: see :func:`quasi_velocity_equations`; ``form``: of the equations of motion.
    """

    constraints: Sequence[Constraint] = ()
    velocities: Mapping[str, str] | None = None
    independent: Sequence[str] | None = None
    v: StateVector | None = None
    form: Literal["voronets", "boltzmann-hamel"] = "voronets"

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of(self.integrator.method, "method", METHODS)
        one_of(self.form, "form", tuple(FORMS))


class _Rolling:
    """The right-hand side in compiled form. y = (q, v, work)."""

    def __init__(self, equations: QuasiVelocities, conditions: Conditions, form: str, folder: Path | None) -> None:
        model, self.conditions, self.form = equations.model, conditions, FORMS[form]
        self.equations, self.n, self.p = equations, model.dof, len(equations.velocities)
        self.columns = [*model.coordinates, *equations.velocities]
        self._t, self._y, self._x = np.zeros(1), np.zeros((1, self.n + self.p)), np.zeros((1, 2 * self.n))
        self.inputs = VaryingInputs(conditions, self._t, self._x, folder)
        wanted = ("metric", self.form, "forces", "lost_power")
        self._rates = np.zeros((1, self.n))
        self._out = {name: np.zeros((1, *equations.program.outputs[name].shape)) for name in wanted}
        values = self.conditions.values | {"t": self._t}
        columns = [(self.columns, self._y)]
        rates = compile_program(equations.program, ["rates"], folder)
        self._move = rates.bind({"rates": self._rates}, values, columns=columns)
        kernel = compile_program(equations.program, wanted, folder)
        source = equations.program.select(wanted)
        self._laws = Laws(source, kernel, self._out, values, [*columns, *self.inputs.columns])

    def corners(self, t: float, y: Array, folder: Path | None) -> list[Watch]:
        """Follow force laws on one side of their corners, from a start on; the corners are to be watched."""
        moving = ("t", *self.columns, *self.inputs.moving)
        return follow([*self.inputs.laws, self._laws], moving, self._fill, self.rates, (t, y), folder)

    def plain(self) -> None:
        """Force laws as they are."""
        for laws in (*self.inputs.laws, self._laws):
            laws.plain()

    def _fill(self, t: float, y: Array) -> None:
        self._x[0] = self.state(t, y)
        self.inputs.fill()

    def state(self, t: float, y: Array) -> Array:
        """(q, q') of y (a new array)."""
        self._t[0], self._y[0] = t, y[:-1]
        self._move()
        return np.concatenate((y[: self.n], self._rates[0]))

    def rates(self, t: float, y: Array) -> Array:
        """y'; not finite where the reduced metric is singular."""
        # g* v' = forces - bias, g* = T^T g T, q' = T v  (quasi_velocities)
        self._fill(t, y)
        self._laws.run()
        out, result = self._out, np.empty(len(y))
        force = out["forces"][0] - out[self.form][0]
        # LAPACK takes no matrix without rows: nothing is left free
        _, acceleration, info = scipy.linalg.lapack.dposv(out["metric"][0], force) if self.p else (None, force, 0)
        result[: self.n], result[-1] = self._rates[0], out["lost_power"][0]
        result[self.n : -1] = acceleration if not info else np.nan
        return result


def simulate_rolling(
    problem: RollingProblem, progress: ProgressReport | None = None, folder: Path | None = None
) -> Trajectory:
    """Integrate the equations of motion with velocity constraints.

    ``progress`` is told the finished share of the span and cancels by False. ``folder``: a cache of compiled kernels.
    Series: ``v`` (K, p), ``multipliers``, ``constraints`` (K, m; the latter B q'), ``gaps``, ``kinetic_energy``,
    ``potential_energy``, ``work`` [J], varying inputs, and those of the problem. Checks: B q' is zero, gaps are
    constant, and T + V - work is, but where springs depend on an input that varies. A span that cannot be finished is
    ``failed``. Raises InvalidInput (also for closures of the model that are not among the constraints; pointers start
    with names of arguments of ``simulate``), MissingValue and TooLarge.
    """
    model, start = problem.model, problem.span[0]
    conditions = read_conditions(model, problem.start, problem.span, NEEDS, problem.events, problem.series)
    place = dict(zip(model.coordinates, conditions.q.tolist(), strict=True))
    equations = quasi_velocity_equations(
        model, problem.constraints, velocities=problem.velocities, independent=problem.independent, near=place
    )
    rolling = _Rolling(equations, conditions, problem.form, folder)
    rolling.inputs.enter(*problem.span)
    y = np.concatenate((*_start(rolling, problem), (0.0,)))
    if not np.isfinite(rolling.rates(start, y)).all():
        advice = "the accelerations are not determined at the start: check masses, inertias and quasi-velocities"
        motion = IntegratedMotion([start], [y], [start], [y], status="failed", message=advice)
    else:
        motion = _moved(rolling, problem, y, progress, folder)
    found = _judged(rolling, problem, motion)
    more = _repeated if conditions.varied_potential() else _steps_again
    return replace(found, checks=(*found.checks, *more(rolling, problem, y, motion, progress)))


def _repeated(
    rolling: _Rolling, problem: RollingProblem, y: Array, first: IntegratedMotion, progress: ProgressReport | None
) -> tuple[Check, ...]:
    """Where an input that varies is part of the potential, no balance of energy judges: a second run does."""
    rolling.conditions = replace(rolling.conditions, events=())

    def again(span: tuple[float, float], times: Array, choice: IntegratorChoice) -> IntegratedMotion:
        """The same motion more carefully."""
        other = replace(problem, times=OutputTimes(span, times), integrator=choice, events=())
        return _moved(rolling, other, y, at_end(progress), None)

    groups = state_groups(rolling.n, rolling.p, "v")
    return accurate(second_run(first, problem.integrator, again), groups, problem.drift_limit)


def _steps_again(
    rolling: _Rolling, problem: RollingProblem, _: Array, first: IntegratedMotion, __: ProgressReport | None
) -> tuple[Check, ...]:
    """Some steps once more, where the balance of energy judges the whole."""
    rolling.conditions = replace(rolling.conditions, events=())

    def again(span: tuple[float, float], y: Array, choice: IntegratorChoice) -> IntegratedMotion:
        """From a state of the motion."""
        other = replace(problem, times=OutputTimes(span, [span[1]]), integrator=choice, events=())
        return _moved(rolling, other, y, None, None, turning=False)

    groups = state_groups(rolling.n, rolling.p, "v")
    return steps_again(first, problem.integrator, groups, problem.drift_limit, again)


def _moved(
    rolling: _Rolling,
    problem: RollingProblem,
    y: Array,
    progress: ProgressReport | None,
    folder: Path | None,
    turning: bool = True,
) -> IntegratedMotion:
    """The motion. ``turning``: it begins anew at corners of force laws."""
    integrator, conditions, span = problem.integrator, rolling.conditions, problem.span
    breaks = conditions.breaks(span)
    rolling.inputs.enter(span[0], [*breaks, span[1]][0])
    corners = rolling.corners(span[0], y, folder) if turning else []
    motion = integrate(
        rolling.rates,
        y,
        span,
        problem.times.grid(),
        IntegratorSettings(integrator.stepper(), integrator.max_steps, ADVICE),
        [*conditions.watches(rolling.state, folder), *corners],
        breaks,
        share_of(span, progress),
        rolling.inputs.enter,
    )
    rolling.plain()
    rolling.inputs.leave()
    return motion


def _start(rolling: _Rolling, problem: RollingProblem) -> tuple[Array, Array]:
    """q and v at the start."""
    model, names = rolling.equations.model, rolling.equations.velocities
    q, qd = rolling.conditions.q, rolling.conditions.qd
    if problem.v is not None and problem.start.qd is not None:
        raise InvalidArgument.at("/v", "two-velocities", "give either 'v' or 'qd'")
    place = rolling.conditions.values | dict(zip(model.coordinates, q, strict=True))
    T = interpret(rolling.equations.program, place, ["T"])["T"]
    if not np.isfinite(T).all():
        message = f"the velocities {', '.join(names)} do not describe the motion at this start; take others"
        raise InvalidArgument.at("/q", "singular-start", message)
    if problem.start.qd is None:
        return q, _by_name(problem.v, names)
    # q' = T v, in the sense of least squares, and exact for velocities that meet B q' = 0
    v = np.asarray(np.linalg.lstsq(T, qd)[0], dtype=np.float64)
    left = np.abs(T @ v - qd).max(initial=0)
    if left > 1e-9 * max(1.0, np.abs(qd).max(initial=0)):
        message = f"these velocities violate the constraints by {left:.3g}; give 'v' ({', '.join(names)}) instead"
        raise InvalidArgument.at("/qd", "violated", message)
    return q, v


def _by_name(given: Any, names: tuple[str, ...]) -> Array:
    if given is None:
        return np.zeros(len(names))
    if isinstance(given, Mapping):
        unknown = [name for name in given if name not in names]
        if unknown:
            message = f"unknown velocity '{str(unknown[0])[:80]}'{among(unknown[0], names)}"
            raise InvalidArgument.at("/v", "unknown-velocity", message)
        given = [given.get(name, 0) for name in names]
    v = numeric(given, "/v")
    if v.shape != (len(names),):
        message = f"shape {v.shape} found, ({len(names)},) expected: {', '.join(names)}"
        raise InvalidArgument.at("/v", "wrong-length", message)
    return v


def _judged(rolling: _Rolling, problem: RollingProblem, motion: IntegratedMotion) -> Trajectory:
    equations, conditions, n = rolling.equations, rolling.conditions, rolling.n
    t, y, results = motion.judged()
    slopes = np.array([rolling.rates(*pair) for pair in zip(t.tolist(), y, strict=True)])
    x = np.concatenate([y[:, :n], slopes[:, :n]], axis=1)
    values: dict[str, Any] = conditions.values | conditions.inputs_at(t, x) | {"t": t}
    values |= dict(zip(rolling.columns, y[:, :-1].T, strict=True))
    values |= {f"{name}'": slopes[:, n + i] for i, name in enumerate(equations.velocities)}
    names = ["constraints", "multipliers", "kinetic_energy", "potential_energy", *(["gaps"] if equations.gaps else [])]
    found = interpret_in_blocks(equations.program, values, names, len(t))
    series = {name: found[name] for name in names[1:]} | {"v": y[:, n:-1], "work": y[:, -1]}
    # B_ka q'^a
    series["constraints"] = np.einsum("kma,ka->km", found["constraints"], x[:, n:])
    checks = _checks(t, series, problem.drift_limit, conditions.varied_potential())
    span = reached(t, x[:, :n], x[:, n:])
    t, x = t[results], x[results]
    return Trajectory(
        equations.model.coordinates,
        t,
        x[:, :n],
        x[:, n:],
        {name: column[results] for name, column in series.items()} | conditions.series_at(t, x),
        checks,
        motion.status,
        motion.message,
        motion.steps,
        _events(rolling, problem, motion),
        {"evaluations": float(motion.evaluations)},
        motion.cancelled,
        span,
    )


def _events(rolling: _Rolling, problem: RollingProblem, motion: IntegratedMotion) -> tuple[Crossing, ...]:
    found = [(k, t, rolling.state(t, y)) for k, t, y in motion.found]
    return crossings(problem.events, found, rolling.n)


def _checks(t: Array, series: Mapping[str, Array], limit: float, varied: Sequence[str]) -> tuple[Check, ...]:
    slips = np.abs(series["constraints"]).max(axis=1, initial=0)
    checks = [
        unbalanced(varied) if varied else energy_balance(t, series, not series["work"].any(), limit),
        Check.of(("constraints", "zero", "B q' = 0", "m/s, 1/s"), slips, t, 1.0, RESIDUAL),
    ]
    if "gaps" in series:
        drift = spread(series["gaps"]).max(axis=1)
        reason = "integrals of constraints: rolling bodies keep their distance from the plane, loops stay closed"
        checks.append(Check.of(("gaps", "constant", reason, "m"), drift, t, 1.0, RESIDUAL))
    return tuple(checks)
