"""Motion of a tree with closures and prescribed coordinates, judged by its residuals and its energy balance."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from substructures.analysis.arguments import one_of
from substructures.analysis.closed.constrained import SINGULAR, Constrained, Singular, require_fixed
from substructures.analysis.closed.dry_friction import ClosedDryMotion
from substructures.analysis.closed.dry_state import DryConstrained
from substructures.analysis.closed.energy_uncertainty import energy_uncertainty
from substructures.analysis.closed.loops import least_multipliers, mobility
from substructures.analysis.closed.projection import Consistent, consistent_state
from substructures.analysis.closed.reductions import REDUCTIONS, Reduction
from substructures.analysis.closed.stepper import ClosedStepper
from substructures.analysis.motion.friction.dry_friction import friction_laws
from substructures.analysis.motion.friction.dry_run import DryRun, integrate_dry, sticking
from substructures.analysis.motion.integrators.compiled_steps import EXPLICIT
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import STIFF, IntegratorSettings, integrate
from substructures.analysis.motion.integrators.progress import ProgressReport, share_of
from substructures.analysis.motion.integrators.steppers import Stepper
from substructures.analysis.motion.judges.states import energy_balance, unbalanced
from substructures.analysis.motion.problems.kinds import ClosedMotion
from substructures.analysis.motion.problems.problem import Integrator, MotionProblem
from substructures.analysis.motion.second_judges import computed_again
from substructures.analysis.motion.second_run import state_groups
from substructures.analysis.motion.single_steps import careful, one_by_one
from substructures.analysis.motion.trajectory import Crossing, Trajectory, crossings, in_order
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.quantities.numbers.limits import reached
from substructures.tree.model import Model

#: largest residuals of positions and velocities [per s] along a right motion, over the width of their rows
RESIDUAL = 1e-9
#: of the event where the closures lose rank
LOST_RANK = "lost-rank"
#: explicit ones, and implicit ones for stiff motions, that go on from the closures after every step
METHODS = (*EXPLICIT, "Radau", "BDF")
#: steps from which on it is looked whether friction makes a motion stiff, and near rest: in velocities v_0 of its law
MANY, NEAR_REST = 1000, 3
ADVICE = f"{STIFF}, or look for masses or lengths near zero and for jumps in loads"


@dataclass(frozen=True, kw_only=True)
class ClosedProblem(MotionProblem):
    """A motion with closures from the closed state nearest to the start."""

    kind: ClosedMotion = field(default_factory=ClosedMotion)

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of(self.integrator.method, "method", METHODS)


def simulate_closed(problem: ClosedProblem) -> Trajectory:
    """Integrate the equations of motion with closures from the closed state nearest to the given one.

    The series of the result: ``qdd`` (K, n), ``multipliers`` (K, m; of least norm), ``kinetic_energy``,
    ``potential_energy``, ``work`` (K,), ``position_residual``, ``velocity_residual`` (K,), ``actuation`` (K, p; forces
    of the prescribed coordinates), varying inputs, and those of the problem, with exact friction ``friction`` (K, n),
    where forces are not unique those whose largest share of F_s is least. Checks: both residuals are zero, beside
    how far the closures are open in other positions, and T + V - work is constant, or, where an input that varies is
    part of V, a second run finds the same; work is that of forces without potential, of springs that change with time,
    and of prescribed coordinates. Loops that cannot be closed, a singular position at the start or on the way and a
    span that cannot be finished are ``failed``, with advice and the motion up to there; where the closures lose rank on
    the way ``events`` has ``lost-rank``. Raises InvalidInput (pointers start with names of arguments of ``simulate``)
    and MissingValue.
    """
    progress, folder = problem.integrator.progress, problem.integrator.folder
    require_fixed(problem.model, problem.kind.fixed)
    s, start = _constrained(problem, folder), problem.span[0]
    s.inputs.enter(*problem.span)
    state = consistent_state(s, start, s.conditions.q, s.conditions.qd, problem.kind.fixed)
    place = mobility(s, start, state.q)
    message = state.message or (f"the start is singular: {SINGULAR}" if place.singular else "")
    if message:
        return _nothing(problem.model, state, start, message)
    s.move(start, state.q, state.qd)
    # x = (q, q', W), W the work of forces without potential and of prescribed coordinates
    x = np.concatenate((state.q, state.qd, (0.0,)))
    motion = _moved(s, problem, x, place.rank, progress, folder)
    found = _judged(s, problem, motion, place.rank)
    found = replace(found, message=". ".join(filter(None, (found.message, _stiff(s, problem, motion)))))
    return replace(found, checks=(*found.checks, *_again(s, problem, motion, place.rank)))


def _again(s: Constrained, problem: ClosedProblem, motion: IntegratedMotion, rank: int) -> tuple[Check, ...]:
    """What is found when the motion, or steps of it, are computed once more."""
    s.conditions = replace(s.conditions, events=())

    def move(other: ClosedProblem, y: Array, told: ProgressReport | None, turning: bool) -> IntegratedMotion:
        """The motion once more."""
        return _moved(s, other, y, rank, told, None, turning)

    is_whole, alone = bool(s.conditions.varied_potential()), None
    if not (is_whole or isinstance(s, DryConstrained)):
        s.move(motion.step_t[0], *_state(s, motion.step_x[0]))
        reduction = REDUCTIONS[problem.kind.reduction](s, rank)
        alone = one_by_one(reduction, _landing(reduction, careful(problem.integrator)), s.inputs.enter)
    again = computed_again(problem, motion, state_groups(s.n, s.n), move, is_whole=is_whole, alone=alone)
    s.inputs.leave()
    return again


def _state(s: Constrained, x: Array) -> tuple[Array, Array]:
    """q, q' of (q, q', work)."""
    return x[: s.n], x[s.n : 2 * s.n]


def _stiff(s: Constrained, problem: ClosedProblem, motion: IntegratedMotion) -> str:
    """What is said of many steps near rest, where the smooth law of friction is steep."""
    explicit = problem.integrator.method in EXPLICIT and not isinstance(s, DryConstrained)
    if not explicit or motion.steps < MANY or "friction" not in s.model.program.outputs:
        return ""
    laws = friction_laws(s.model, s.conditions.values)
    rates = np.abs(np.array(motion.step_x)[:, s.n + laws.places])
    slow = (rates < NEAR_REST * laws.velocity).mean(axis=0) > 0.5
    if not slow.any():
        return ""
    names = ", ".join(f"'{s.model.coordinates[a]}'" for a in laws.places[slow])
    return (
        f"{motion.steps:,} steps were taken, most of them while {names} nearly stood still, where the smooth law of "
        "friction is stiff: the method 'Radau' and 'friction': 'exact' need no such steps"
    )


def _constrained(problem: ClosedProblem, folder: Path | None) -> Constrained:
    notes: dict[str, Any] = {"events": problem.events, "series": problem.series}
    kind = DryConstrained if problem.kind.friction == "exact" else Constrained
    return kind(problem.model, problem.start, problem.span, problem.kind.prescribed, **notes, folder=folder)


def _moved(
    s: Constrained,
    problem: ClosedProblem,
    x: Array,
    rank: int,
    progress: ProgressReport | None,
    folder: Path | None,
    turning: bool = True,
) -> IntegratedMotion:
    """The motion. ``turning``: it begins anew at corners of force laws."""
    reduction: Reduction = REDUCTIONS[problem.kind.reduction](s, rank)
    span, breaks = problem.span, s.conditions.breaks(problem.span)
    s.inputs.enter(span[0], [*breaks, span[1]][0])
    settings = IntegratorSettings(_landing(reduction, problem.integrator), problem.integrator.max_steps, ADVICE)
    watches, told = s.conditions.watches(lambda _, y: y[:-1], folder), share_of(span, progress)
    given = x, span, problem.times.grid(), settings
    motion: IntegratedMotion
    if isinstance(s, DryConstrained):
        motion = integrate_dry(ClosedDryMotion(s, reduction), *given, watches, breaks, told, DryRun())
    else:
        watches = [*watches, *(s.corners(span[0], x, folder) if turning else [])]
        motion = integrate(reduction.rates, *given, watches, breaks, told, s.inputs.enter)
        s.plain()
    s.inputs.leave()
    return motion


def _landing(reduction: Reduction, integrator: Integrator) -> Stepper:
    """Steps that land on the closures."""
    inner = integrator.stepper()

    def stepper(_f: object, t: float, y: Array, end: float, first_step: float | None = None) -> ClosedStepper:
        """From y at t on."""
        return ClosedStepper(reduction, inner, t, y, end, first_step)

    return stepper


def _judged(s: Constrained, problem: ClosedProblem, motion: IntegratedMotion, rank: int) -> Trajectory:
    """The motion with its series and checks."""
    t, x, results = motion.judged()
    judged = _at_states(_judged_quantities, s, t, x) | {"work": x[:, -1]}
    residuals, effort = list(_residual_checks(t, judged, s.width)), judged.pop("effort")
    names = s.conditions.varied_potential()
    if names:
        balance = unbalanced(names)
    else:
        doubt = energy_uncertainty(s, rank, t, x[:, :-1], np.array(motion.step_t))
        balance = energy_balance(t, judged | {"effort": effort}, s.conservative, problem.drift_limit, doubt)
    forces: Callable[[Constrained], dict[str, Any]] = _forces
    checks: tuple[Check, ...] = (*residuals, balance)
    told = list[Crossing]()
    if isinstance(s, DryConstrained) and isinstance(motion, DryRun):
        dry = ClosedDryMotion(s)
        judged["friction"], forces = dry.friction(motion, t, x), partial(_dry_forces, dry, motion)
        checks = (*checks, sticking(dry, motion, t, judged["friction"], problem.drift_limit))
        told = motion.told(s.model.coordinates, dry.laws, slice(s.n, 2 * s.n))
    span = reached(t, *np.split(x[:, :-1], 2, axis=1))
    t, x = t[results], x[results]
    q, qd = np.split(x[:, :-1], 2, axis=1)
    series = _at_states(forces, s, t, x) | {name: values[results] for name, values in judged.items()}
    series |= s.conditions.series_at(t, x[:, :-1])
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
        in_order(crossings(problem.events, motion.found, slice(s.n, 2 * s.n)), told, _lost(motion, t, q, qd)),
        {"evaluations": float(motion.evaluations)},
        motion.cancelled,
        span,
    )


def _lost(motion: IntegratedMotion, t: Array, q: Array, qd: Array) -> list[Crossing]:
    """The last state, where the motion ended because the closures lose rank there."""
    is_lost = motion.status == "failed" and SINGULAR in motion.message
    return [Crossing(LOST_RANK, float(t[-1]), q[-1], qd[-1], kind=LOST_RANK)] if is_lost else []


def _at_states(
    quantities: Callable[[Constrained], dict[str, Any]], s: Constrained, t: Array, x: Array
) -> dict[str, Array]:
    """Quantities of a state at all states (q, q', work)."""
    rows = []
    for at, state in zip(t.tolist(), x, strict=True):
        s.move(at, *_state(s, state))
        rows.append(quantities(s))
    like = {name: np.shape(value) for name, value in quantities(s).items()}
    return {name: np.array([row[name] for row in rows]).reshape(len(rows), *shape) for name, shape in like.items()}


def _dry_forces(dry: ClosedDryMotion, run: DryRun, s: Constrained) -> dict[str, Any]:
    """As _forces, with the joints that slip and stick then."""
    qdd, _, _ = dry.moved(s.t, np.concatenate((s.q, s.qd)), run.at(s.t))
    known = np.isfinite(qdd).all()
    multipliers = least_multipliers(s, qdd) if known else np.full(len(s.labels), np.nan)
    return {"qdd": qdd, "multipliers": multipliers, "actuation": multipliers[s.closed :]}


def _forces(s: Constrained) -> dict[str, Any]:
    """Accelerations and multipliers; not finite where they are not determined."""
    try:
        # g q'' = f + G^T lambda, G q'' = -c; with all rows, the lambda of least norm
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
        "position_residual": s.phi.copy(),
        "velocity_residual": s.velocity_residual,
        "effort": s.effort,
    }


def _residual_checks(t: Array, judged: dict[str, Array], width: Array) -> Iterator[Check]:
    """Of the residuals of all rows (K, m), in whose place the largest of each state are put."""
    about = ("position residual", "the closures (and prescribed motions) are met", "1")
    rate = ("velocity residual", "G q' + phi_t = 0", "1/s")
    # max_k |phi_k| / width_k, max_k |(G q' + phi_t)_k| / width_k
    for series, (name, reason, unit) in {"position_residual": about, "velocity_residual": rate}.items():
        rows = np.abs(judged[series])
        judged[series] = rows.max(axis=1, initial=0)
        yield Check.of((name, "zero", reason, unit), (rows / width).max(axis=1, initial=0), t, 1.0, RESIDUAL)


def _nothing(model: Model, state: Consistent, t: float, message: str) -> Trajectory:
    """A motion that did not begin."""
    residuals = {"position_residual": state.residual, "velocity_residual": state.velocity_residual}
    series = {name: np.array([value]) for name, value in residuals.items()}
    return Trajectory(model.coordinates, np.array([t]), state.q[None], state.qd[None], series, (), "failed", message)
