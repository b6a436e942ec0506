"""Motion with velocity constraints (rolling, knife edges) in quasi-velocities, judged by energy and constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.arguments import one_of
from substructures.analysis.equations.kernels import evaluated
from substructures.analysis.equations.nonholonomic.positions import start_velocities
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.corners import has_corners
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.integrators.progress import ProgressReport, share_of
from substructures.analysis.motion.integrators.steppers import METHODS
from substructures.analysis.motion.judges.states import energy_balance, spread, unbalanced
from substructures.analysis.motion.problems.kinds import ConstrainedMotion
from substructures.analysis.motion.problems.problem import MotionProblem
from substructures.analysis.motion.reduced_motion import ReducedMotion
from substructures.analysis.motion.second_judges import computed_again
from substructures.analysis.motion.second_run import state_groups
from substructures.analysis.motion.trajectory import Trajectory, crossings
from substructures.analysis.motion.velocity_choices import VelocityChoices
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.numbers.limits import reached

NEEDS = ("metric", "forces", "potential_energy")
#: largest constrained velocity [m/s] and change of a gap [m] along a right motion
RESIDUAL = 1e-9
#: quasi-velocities describe a motion badly where velocities are so many times larger beside them than elsewhere
FAR = 30
ADVICE = "the quasi-velocities may not describe the motion there (take others), or a body may lie flat"


@dataclass(frozen=True, kw_only=True)
class RollingProblem(MotionProblem):
    """A motion with constraints from ``start.q`` and quasi-velocities, or velocities ``start.qd`` that meet them."""

    kind: ConstrainedMotion

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of(self.integrator.method, "method", METHODS)


def simulate_rolling(problem: RollingProblem) -> Trajectory:
    """Integrate the equations of motion with velocity constraints.

    Series: ``v`` (K, p), ``multipliers``, ``constraints`` (K, m; the latter B q' + b), ``gaps``, ``kinetic_energy``,
    ``potential_energy``, ``work`` [J], varying inputs, and those of the problem. Checks: B q' + b is zero, gaps are
    constant, and T + V - work is, but where springs depend on an input that varies. A span that cannot be finished is
    ``failed``. Raises InvalidInput (also for closures of the model that are not among the constraints; pointers start
    with names of arguments of ``simulate``), MissingValue and TooLarge.
    """
    model, start, kind = problem.model, problem.span[0], problem.kind
    progress, folder = problem.integrator.progress, problem.integrator.folder
    conditions = read_conditions(model, problem.start, problem.span, NEEDS, problem.events, problem.series)
    place = dict(zip(model.coordinates, conditions.q.tolist(), strict=True)) | {"t": start}
    equations = quasi_velocity_equations(
        model, kind.constraints, velocities=kind.velocities, independent=kind.independent, near=place
    )
    rolling = ReducedMotion(equations, conditions, problem.kind.form, folder)
    rolling.inputs.enter(*problem.span)
    choices = _choices(rolling, problem, folder)
    y = np.concatenate((conditions.q, _start(rolling, problem), (0.0,)))
    x = choices.begun(start, y)
    if not np.isfinite(rolling.rates(start, y)).all():
        advice = "the accelerations are not determined at the start: check masses, inertias and quasi-velocities"
        motion = IntegratedMotion([start], [x], [start], [x], status="failed", message=advice)
    else:
        motion = _moved(choices, problem, x, progress, folder)
    found = _judged(choices, problem, motion)
    is_whole = bool(conditions.varied_potential())
    choices.first.conditions = replace(choices.first.conditions, events=())

    def move(other: RollingProblem, y: Array, told: ProgressReport | None, turning: bool) -> IntegratedMotion:
        """The motion once more."""
        return _moved(choices, other, y, told, None, turning)

    groups = state_groups(rolling.n, choices.rates, "v" if choices.make is None else "qd")
    again = computed_again(problem, motion, groups, move, is_whole=is_whole)
    return replace(found, checks=(*found.checks, *again))


def _choices(rolling: ReducedMotion, problem: RollingProblem, folder: Path | None) -> VelocityChoices:
    """Velocities that the program chose are changed on the way, but where a corner of a force law is followed."""
    equations, conditions = rolling.equations, rolling.conditions
    given = problem.kind.velocities is not None or problem.kind.independent is not None
    cornered = has_corners(equations.program) or has_corners(conditions.expressions)
    if given or cornered or equations.determinant is None:
        return VelocityChoices(rolling, None)

    def make(chosen: Sequence[str]) -> ReducedMotion:
        """The motion in the velocities of these coordinates."""
        other = quasi_velocity_equations(problem.model, problem.kind.constraints, independent=chosen)
        return ReducedMotion(other, conditions, problem.kind.form, folder)

    return VelocityChoices(rolling, make)


def _moved(
    choices: VelocityChoices,
    problem: RollingProblem,
    x: Array,
    progress: ProgressReport | None,
    folder: Path | None,
    turning: bool = True,
) -> IntegratedMotion:
    """The motion. ``turning``: it begins anew at corners of force laws."""
    rolling, integrator, span = choices.first, problem.integrator, problem.span
    conditions = rolling.conditions
    breaks = conditions.breaks(span)
    choices.enter(span[0], [*breaks, span[1]][0])
    corners = rolling.corners(span[0], x, folder) if turning and choices.make is None else []
    motion = integrate(
        rolling,
        x,
        span,
        problem.times.grid(),
        IntegratorSettings(choices.stepper(integrator.stepper()), integrator.max_steps, ADVICE),
        [*conditions.watches(choices.state, folder), *corners],
        breaks,
        share_of(span, progress),
        choices.enter,
    )
    rolling.plain()
    choices.leave()
    return motion


def _start(rolling: ReducedMotion, problem: RollingProblem) -> Array:
    """v at the start."""
    conditions, equations = rolling.conditions, rolling.equations
    place = conditions.values | dict(zip(equations.model.coordinates, conditions.q, strict=True))
    qd = None if problem.start.qd is None else conditions.qd
    return start_velocities(equations, place | {"t": problem.span[0]}, qd, problem.kind.v)


def _judged(choices: VelocityChoices, problem: RollingProblem, motion: IntegratedMotion) -> Trajectory:
    equations, conditions, n = choices.first.equations, choices.first.conditions, choices.first.n
    t, states, results = motion.judged()
    x, columns = np.zeros((len(t), 2 * n)), dict[str, Array]()
    for rolling, places, y in choices.pieces(t, states):
        x[places], found = _series(rolling, t[places], y)
        for name, values in found.items():
            columns.setdefault(name, np.zeros((len(t), *values.shape[1:])))[places] = values
    # B_ka q'^a + b_k
    slips = np.einsum("kma,ka->km", columns.pop("constraints"), x[:, n:]) + columns.pop("given", 0)
    v = states[:, n:-1] if choices.make is None else x[:, n + _places(equations)]
    series = columns | {"v": v, "work": states[:, -1], "constraints": slips}
    checks = _checks(t, series, problem.drift_limit, conditions.varied_potential())
    span, message = reached(t, x[:, :n], x[:, n:]), _message(choices, motion, t, x[:, :n])
    t, x = t[results], x[results]
    return Trajectory(
        equations.model.coordinates,
        t,
        x[:, :n],
        x[:, n:],
        {name: column[results] for name, column in series.items()} | conditions.series_at(t, x),
        checks,
        motion.status,
        message,
        motion.steps,
        crossings(problem.events, [(k, t, choices.state(t, x)) for k, t, x in motion.found], slice(n, 2 * n)),
        {"evaluations": float(motion.evaluations)},
        motion.cancelled,
        span,
    )


def _series(rolling: ReducedMotion, t: Array, y: Array) -> tuple[Array, dict[str, Array]]:
    """(q, q') (K, 2 n), and outputs of the equations by name, at states y (K, N)."""
    equations, conditions, n = rolling.equations, rolling.conditions, rolling.n
    slopes = np.array([rolling.rates(*pair) for pair in zip(t.tolist(), y, strict=True)])
    x = np.concatenate([y[:, :n], slopes[:, :n]], axis=1)
    values: dict[str, Any] = conditions.values | conditions.inputs_at(t, x) | {"t": t}
    values |= dict(zip(rolling.columns, y[:, :-1].T, strict=True))
    values |= {f"{name}'": slopes[:, n + i] for i, name in enumerate(equations.velocities)}
    more = [name for name in ("gaps", "given") if name in equations.program.outputs]
    names = ["constraints", "multipliers", "kinetic_energy", "potential_energy", *more]
    return x, evaluated(equations.program, values, names, len(t))


def _places(equations: QuasiVelocities) -> NDArray[np.int64]:
    """Of the coordinates whose velocities they are."""
    rates = [f"{name}'" for name in equations.model.coordinates]
    return np.array([rates.index(name) for name in equations.velocities], dtype=np.int64)


def _message(choices: VelocityChoices, motion: IntegratedMotion, t: Array, q: Array) -> str:
    """That of the motion; or that velocities that were kept do not describe it somewhere on the way."""
    equations = choices.first.equations
    if motion.message or choices.make is not None or equations.determinant is None or not len(q):
        return motion.message
    values = choices.first.conditions.values | dict(zip(equations.model.coordinates, q.T, strict=True)) | {"t": t}
    size = np.abs(interpret_in_blocks(equations.program, values, ["T"], len(q))["T"]).max(axis=(1, 2), initial=0)
    if not size.max() > FAR * size.min():
        return ""
    names = ", ".join(equations.velocities)
    return (
        f"the velocities {names} describe the motion badly where {equations.singular} is near zero, as it is on this "
        "way: take others ('velocities', or another choice of 'independent')"
    )


def _checks(t: Array, series: Mapping[str, Array], limit: float, varied: Sequence[str]) -> tuple[Check, ...]:
    slips = np.abs(series["constraints"]).max(axis=1, initial=0)
    checks = [
        unbalanced(varied) if varied else energy_balance(t, series, not series["work"].any(), limit),
        Check.of(("constraints", "zero", "B q' + b = 0", "m/s, 1/s"), slips, t, 1.0, RESIDUAL),
    ]
    if "gaps" in series:
        drift = spread(series["gaps"].T).max(axis=0)
        reason = "integrals of constraints: rolling bodies keep their distance from the plane, loops stay closed"
        checks.append(Check.of(("gaps", "constant", reason, "m"), drift, t, 1.0, RESIDUAL))
    return tuple(checks)
