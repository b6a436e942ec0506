"""Simulation of a tree without closures, judged by all its first integrals, and by the norms of its quaternions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

from substructures.analysis.equations.formulas import require_tree
from substructures.analysis.motion.conditions import DYNAMICS, Conditions, read_conditions
from substructures.analysis.motion.contacts.contact_run import ContactRun, again, integrate_contacts, with_contacts
from substructures.analysis.motion.contacts.deciding import DecidedContacts
from substructures.analysis.motion.friction.dry_friction import DryMotion, friction_laws
from substructures.analysis.motion.friction.dry_run import DryRun, integrate_dry, with_friction
from substructures.analysis.motion.friction.loaded_friction import LoadedRightHandSide, with_loads
from substructures.analysis.motion.integrators.fixed_step import march, require_no_stops, semi_implicit_euler
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.integrators.progress import ProgressReport, share_of
from substructures.analysis.motion.judges.balls import (
    energies,
    kept_lengths,
    reached_in_rates,
    told_with_lengths,
    with_lengths,
)
from substructures.analysis.motion.judges.integrals import AlongMotion, integrals_along, judge
from substructures.analysis.motion.judges.states import MotionStates, unbalanced
from substructures.analysis.motion.problems.problem import MotionProblem
from substructures.analysis.motion.resets import Accelerations, Resets, acting, simulate_with_resets
from substructures.analysis.motion.right_hand_side import RightHandSide, is_definite
from substructures.analysis.motion.second_judges import computed_again
from substructures.analysis.motion.second_run import state_groups
from substructures.analysis.motion.single_steps import at_once, careful
from substructures.analysis.motion.trajectory import Crossing, Trajectory, crossings, in_order
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.errors import InvalidInput
from substructures.expr.interpret import interpret_in_blocks
from substructures.mechanics.accelerations import definite_solve
from substructures.quantities.numbers.conditioning import LEAST, MOST, OVERFLOW, RANGE, is_usable

SINGULAR = (
    "the metric is singular or not positive definite at the start: a massless body, or a joint at a singular angle "
    "(spherical and free joints: pitch = +-pi/2); change masses, inertias or the start"
)


def simulate_tree(problem: TreeProblem) -> Trajectory:
    """The motion of a tree from a start over a span of time, with the drift of all its first integrals.

    ``series`` of the result, (K,) each: ``energy`` [J], momenta and other first integrals, ``power``
    [W], ``work`` [J], varying inputs under their names, and those of the problem; of k contacts ``gaps`` (K, k) [m] and
    ``contact_forces`` (K, k, 3) [N]; with ball joints ``kinetic_energy``, ``potential_energy`` [J]. What goes wrong on
    the way is a trajectory with status ``failed``, advice, and the motion up to there.
    Raises InvalidInput (``has-closures``; pointers start with names of arguments of ``simulate``)
    and MissingValue.
    """
    conditions = tree_conditions(problem)
    if problem.integrator.fixed_step is not None:
        require_no_stops(problem.events)
    if acting(problem.events):
        resets = Resets(problem, conditions, partial(_accelerations, conditions, problem))
        return simulate_with_resets(problem, resets, lambda p: _simulate(p, tree_conditions(p)))
    return _simulate(problem, conditions)


def _simulate(problem: TreeProblem, conditions: Conditions) -> Trajectory:
    """Without events that act."""
    progress, folder = problem.integrator.progress, problem.integrator.folder
    try:
        f = _right_hand_side(conditions, problem)
    except InvalidInput as error:
        if any(fault.code == "singular-metric" for fault in error.faults):
            return _failed(conditions, problem, str(error))
        raise
    # x = (q, q', W), W only where there is any power
    x = np.concatenate([conditions.start, np.zeros(f.size - len(conditions.start))])
    message = _unfit(conditions, problem, f, x)
    if message:
        return _failed(conditions, problem, message)
    motion, figures = _moved(conditions, problem, f, x, progress, folder)
    found = _judged(conditions, problem, f, motion, figures)
    is_whole = not any(check.name.startswith("energy") for check in found.checks)
    instead = [unbalanced(conditions.in_potential(list(problem.start.inputs)))] if is_whole else []
    quiet = replace(conditions, events=())

    def move(other: TreeProblem, y: Array, told: ProgressReport | None, turning: bool) -> IntegratedMotion:
        """The motion once more."""
        return _moved(quiet, other, f, y, told, None, turning)[0]

    # where every state says all of what comes after it
    is_plain = not isinstance(f, DecidedContacts) and problem.kind.friction != "exact"
    alone = at_once(f, careful(problem.integrator)) if is_plain else None
    again = computed_again(problem, motion, state_groups(f.m, f.n), move, is_whole=is_whole, alone=alone)
    f.leave()
    return replace(found, checks=(*found.checks, *instead, *again))


def _right_hand_side(conditions: Conditions, problem: TreeProblem) -> RightHandSide:
    """x' = f(t, x), with friction by the load of joints where that is asked for."""
    given, folder = (problem.model, conditions.values, conditions.zero, conditions), problem.integrator.folder
    if problem.kind.contacts:
        found = DecidedContacts(*given, problem.kind.contacts, folder)
        found.require_above(problem.span[0], conditions.start)
        return found
    if problem.kind.friction == "loaded" and problem.kind.bearings is not None:
        return LoadedRightHandSide(*given, problem.kind.bearings, folder)
    return RightHandSide(*given, folder)


def _accelerations(conditions: Conditions, problem: TreeProblem) -> Accelerations:
    """The function (t, x) -> q'', with what sticks at rest."""
    f = _right_hand_side(conditions, problem)
    return _dry(conditions, f).settled if problem.kind.friction == "exact" else lambda t, x: f.evaluate(t, x)[0]


def _unfit(conditions: Conditions, problem: TreeProblem, f: RightHandSide, x: Array) -> str:
    """Why there are no accelerations at the start that formulas of them can be trusted with."""
    try:
        acceleration, pivots, _ = f.evaluate(problem.span[0], x)
    except ArithmeticError as error:
        return f"at the start {error}"
    if not (is_definite(pivots) and (pivots >= LEAST).all() and (pivots <= MOST).all()):
        states = _states(conditions, f, np.array([problem.span[0]]), x[None])
        model = problem.model
        metric = interpret_in_blocks(model.program, states.symbols(model), ["metric"], 1)["metric"]
        if not np.isfinite(metric).all():
            return f"{OVERFLOW.format('metric')} (at the start)"
        diagonal = np.einsum("nkk->nk", metric)
        if (diagonal > 0).all() and not ((diagonal >= LEAST) & (diagonal <= MOST)).all():
            return f"at the start {RANGE}"
        # the pivots as parts of the diagonal, whatever the units of the coordinates
        if not is_usable(definite_solve(metric, np.zeros(diagonal.shape))[1]).all():
            return SINGULAR
    if not np.isfinite(acceleration).all():
        return "a force is not finite at the start: look at springs of length 0 and roots or divisions in loads"
    return ""


def tree_conditions(problem: MotionProblem) -> Conditions:
    """Check a problem against its model, which has no closures. Raises InvalidInput and MissingValue."""
    require_tree(problem.model, "TreeMotion")
    return read_conditions(problem.model, problem.start, problem.span, DYNAMICS, problem.events, problem.series)


def _moved(
    conditions: Conditions,
    problem: TreeProblem,
    f: RightHandSide,
    x: Array,
    progress: ProgressReport | None,
    folder: Path | None,
    turning: bool = True,
) -> tuple[IntegratedMotion, dict[str, float]]:
    """The motion and its figures. ``turning``: it begins anew at corners of force laws."""
    begin = perf_counter()
    span, most, outputs = problem.span, problem.integrator.max_steps, problem.times.grid()
    told = share_of(span, progress)
    figures: dict[str, float] = {}
    if problem.integrator.fixed_step is not None:
        euler = semi_implicit_euler(f.n, f.m, f.moved)
        motion, pace = march(f, euler, x, span, outputs, problem.integrator.fixed_step, most, told)
        figures |= pace.figures
    else:
        settings = IntegratorSettings(problem.integrator.stepper(), most)
        watches = conditions.watches(lambda _, y: y[: f.rates.stop], folder)
        breaks = conditions.breaks(span)
        if problem.kind.friction == "exact":
            motion = integrate_dry(_dry(conditions, f), x, span, outputs, settings, watches, breaks, told, DryRun())
        elif isinstance(f, DecidedContacts) and turning:
            motion = integrate_contacts(f, x, span, outputs, settings, watches, breaks, told)
        elif isinstance(f, DecidedContacts):
            motion = again(f, x, span, outputs, settings)
        else:
            if turning:
                watches = [*watches, *f.corners(span[0], x, folder)]
            motion = integrate(f, x, span, outputs, settings, watches, breaks, told, f.enter)
            f.plain()
        f.leave()
    return motion, figures | {"evaluations": motion.evaluations, "seconds": perf_counter() - begin}


def _failed(conditions: Conditions, problem: MotionProblem, message: str) -> Trajectory:
    """Only the start."""
    t, q, qd = np.array([problem.span[0]]), conditions.q[None], conditions.qd[None]
    model = problem.model
    positions = model.positions if model.balls else ()
    return Trajectory(model.coordinates, t, q, qd, status="failed", message=message, positions=positions)


def _judged(
    conditions: Conditions,
    problem: MotionProblem,
    f: RightHandSide,
    motion: IntegratedMotion,
    figures: Mapping[str, float],
) -> Trajectory:
    model = problem.model
    # inputs that are 0 all the time leave more constant
    forces = [name for name in problem.start.inputs if name not in conditions.zero]
    forces += [f"tau.{name}" for name in f.pushed]
    integrals = integrals_along(model, forces, conditions.zero & set(model.parameters))
    t, x, results = motion.judged()
    # H = T + V with H' = Q_a q'^a + V', momenta p_c = g_cb q'^b, ... at all steps, results and events
    states = _states(conditions, f, t, x)
    along = AlongMotion.of(model, integrals, states)
    series = along.series
    more = _of_kind(series, conditions, f, motion, states, x, problem.drift_limit)
    checks = [*judge(along, problem.drift_limit), *kept_lengths(model, t, x, problem.drift_limit)]
    if states.work is not None and f.has_power and "energy" in series:
        series["work"] = states.work
    series |= energies(along.sizes, states.qd) if model.balls else {}
    span = reached_in_rates(model, t, x)
    t, x = t[results], x[results, : f.rates.stop]
    return Trajectory(
        model.coordinates,
        t,
        with_lengths(model, x[:, : f.m]),
        x[:, f.m :],
        {name: values[results] for name, values in series.items()} | conditions.series_at(t, x),
        (*checks, *more),
        motion.status,
        motion.message,
        motion.steps,
        _told(conditions, problem, f, motion),
        figures,
        motion.cancelled,
        span,
        positions=model.positions if model.balls else (),
    )


def _of_kind(
    series: dict[str, Array],
    conditions: Conditions,
    f: RightHandSide,
    motion: IntegratedMotion,
    states: MotionStates,
    x: Array,
    limit: float,
) -> tuple[Check, ...]:
    """What contacts, dry friction and the load of joints add: checks, and series at all states."""
    more: tuple[Check, ...] = ()
    if isinstance(motion, ContactRun) and isinstance(f, DecidedContacts):
        more = with_contacts(f, motion, states.t, x, series)
    elif isinstance(motion, DryRun):
        more = (with_friction(series, _dry(conditions, f), motion, states.t, x, limit),)
    if isinstance(f, LoadedRightHandSide):
        more = (with_loads(series, f, states, x, limit),)
    return more


def _told(
    conditions: Conditions, problem: MotionProblem, f: RightHandSide, motion: IntegratedMotion
) -> tuple[Crossing, ...]:
    """Events, what contacts did, and joints with exact friction."""
    model, found = conditions.model, list[Crossing]()
    if isinstance(f, DecidedContacts):
        found = f.told
    elif isinstance(motion, DryRun):
        found = motion.told(model.coordinates, _dry(conditions, f).laws, f.rates)
    told = in_order(crossings(problem.events, motion.found, f.rates), found)
    return tuple(told_with_lengths(model, event) for event in told)


def _states(conditions: Conditions, f: RightHandSide, t: Array, x: Array) -> MotionStates:
    """States x (K, m + n), or longer by their work, at times t (K,), with the values of all symbols."""
    values: dict[str, float | Array] = {**conditions.values, **conditions.inputs_at(t, x[:, : f.rates.stop])}
    work = x[:, -1] if f.has_power else np.zeros(len(t))
    return MotionStates(t, x[:, : f.m], x[:, f.rates], values, work)


def _dry(conditions: Conditions, f: RightHandSide) -> DryMotion:
    """The same equations with joints that stick."""
    return DryMotion(f, conditions, friction_laws(conditions.model, conditions.values))
