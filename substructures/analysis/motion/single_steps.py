"""Single steps of an integration done again, more carefully: what first integrals cannot see.

A motion along which energy and momenta are constant may still be at the wrong place: on its way too early or too late,
or turned within what they leave open. So some of the accepted steps, and of the results between them, are integrated
once more from where they begin, each on its own: the difference at its end is the error of the step. Force laws are
taken as they are there, with their corners, so that a motion on the wrong side of one is seen.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.analysis.motion.integrators.compiled_steps import EXPLICIT, CompiledStepper
from substructures.analysis.motion.integrators.fixed_step import FixedStep
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import Function
from substructures.analysis.motion.integrators.steppers import Stepper
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.analysis.motion.second_run import LEAST, ROUNDING, TIGHTER
from substructures.analysis.verdict import About, Check
from substructures.array import Array

#: of steps, and of results, that are done again
STEPS, RESULTS = 12, 6
#: what is shorter than so many distances of its times from the next numbers is no step
SHORT = 100
#: so many steps at most for one of them
MOST = 10_000
#: a time and the state then
State = tuple[float, Array]
#: from where to where
Way = tuple[State, State]
#: begins anew from states: of spans (K, 2) and states (K, N) those at the ends (K, N); raises ArithmeticError that says
#: why it does not come there
From = Callable[[Array, Array], Array]
#: by name: columns of the states, unit, columns whose rounding is in them
Groups = Mapping[str, tuple[slice, str, slice]]


def steps_again(first: IntegratedMotion, groups: Groups, limit: float, again: From) -> tuple[Check, ...]:
    """One check; none of a motion that was not finished. ``again``: more carefully than the first time.

    The difference is relative to the largest number of its group of columns along the motion, and may reach ``limit``.
    """
    steps, more = ([], []) if first.status == "failed" or first.cancelled else _chosen(first)
    pairs = sorted([*steps, *more], key=lambda pair: pair[1][0])
    if not pairs:
        return ()
    spans = np.array([(start, end) for (start, _), (end, _) in pairs])
    try:
        two = again(spans, np.array([x for (_, x), _ in pairs]))
    except ArithmeticError as error:
        why = f"a step could not be done again: {error}"
        return (Check.left_out("steps", "accurate", why, needed=True),)
    one, times, along = np.array([x for _, (_, x) in pairs]), spans[:, 1], np.abs(np.array(first.step_x))
    errors = [_relative(one, two, along, group) for group in groups.values()]
    ways = f"{len(steps)} of the {first.steps:,} steps, and {len(pairs) - len(steps)} ways from one to a result"
    about: About = ("steps", "accurate", f"{ways}, done again in shorter ones, end where they ended", "1")
    return (Check.of(about, np.max(errors, axis=0), times, 1.0, limit),)


def _relative(one: Array, two: Array, along: Array, group: tuple[slice, str, slice]) -> Array:
    """The differences of a group (K,), beyond rounding, relative to its largest number ``along`` the motion."""
    columns, _, whole = group
    scale, noise = along[:, columns].max(initial=0), ROUNDING * along[:, whole].max(initial=0)
    error = np.abs(one[:, columns] - two[:, columns]).max(axis=1, initial=0)
    return np.asarray(np.where(error <= noise, 0.0, error / (scale or 1.0)))


def _chosen(first: IntegratedMotion) -> tuple[list[Way], list[Way]]:
    """Steps, and ways from a step to a result within the next one, evenly over the motion."""
    steps = list(zip(first.step_t, first.step_x, strict=True))
    results = list(zip(first.t, first.x, strict=True))
    found = [(steps[k], steps[k + 1]) for k in _spread(len(steps) - 1, STEPS)]
    more = []
    times = np.array(first.step_t)
    for k in _spread(len(results), RESULTS):
        before = int(np.searchsorted(times, results[k][0])) - 1
        if before >= 0:
            more.append((steps[before], results[k]))
    return [way for way in found if _has_length(way)], [way for way in more if _has_length(way)]


def _has_length(way: Way) -> bool:
    """Whether there is more than rounding between two times: events may happen where a result is wanted."""
    a, b = way[0][0], way[1][0]
    return b - a > SHORT * math.ulp(max(abs(a), abs(b)))


def _spread(count: int, most: int) -> list[int]:
    """Some of the numbers below ``count``, the first and the last among them."""
    if count <= most:
        return list(range(count))
    apart = (count - 1) / (most - 1)
    return [round(k * apart) for k in range(most)]


def careful(choice: Integrator, length: float | None = None) -> Integrator:
    """Other tolerances, by a method that begins at full order; for a way of this ``length`` at least two steps."""
    factor = TIGHTER if choice.relative_tolerance >= LEAST else 1 / TIGHTER
    like = {"BDF": "Radau", "LSODA": "Radau"}
    method = "DOP853" if isinstance(choice.method, FixedStep) else like.get(choice.method, choice.method)
    return replace(
        choice,
        method=method,
        relative_tolerance=factor * choice.relative_tolerance,
        absolute_tolerance=min(factor * choice.absolute_tolerance, 0.1),
        max_step=choice.max_step if length is None else length / 2,
        max_steps=MOST,
    )


def one_by_one(f: Function, stepper: Stepper, enter: Callable[[float, float], None]) -> From:
    """Of a function without events and breaks within steps; ``enter``: told the times between which it is called next.
    Machine code is made once for all.
    """
    solver: Any = None

    def again(span: tuple[float, float], x: Array) -> Array:
        """In at least two steps: the first is half the way."""
        nonlocal solver
        enter(*span)
        half = (span[1] - span[0]) / 2
        with np.errstate(all="ignore"):
            try:
                if hasattr(solver, "begin"):
                    solver.begin(span[0], x, span[1], half)
                else:
                    solver = stepper(f, span[0], x, span[1], first_step=half)
                for _ in range(MOST):
                    message = solver.step()
                    if solver.status != "running":
                        break
            except ValueError as error:  # of what is not finite
                raise ArithmeticError(str(error)) from error
        if solver.status != "finished" or not np.isfinite(solver.y).all():
            raise ArithmeticError(message or f"{MOST:,} steps do not reach its end, or it is not finite")
        return np.array(solver.y, dtype=np.float64)

    return each(again)


def at_once(f: RightHandSide, choice: Integrator) -> From:
    """The same, together where the function is machine code that is the same at all times; one by one where it is not,
    or where they do not all come to their ends.
    """
    stepper = choice.stepper()
    otherwise = one_by_one(f, stepper, f.enter)

    def every(spans: Array, states: Array) -> Array:
        """In at least two steps each: the first is half the way."""
        (a, b), half = spans.T, (spans[:, 1] - spans[:, 0]) / 2
        with np.errstate(all="ignore"):
            solver = stepper(f, a[0], states[0], b[0], first_step=half[0]) if np.isfinite(states).all() else None
            if isinstance(solver, CompiledStepper):
                ends, is_reached = solver.reach(np.stack([a, half, b], axis=1), states, MOST)
                if is_reached.all() and np.isfinite(ends).all():
                    return ends
        return otherwise(spans, states)

    return otherwise if f.has_breaks or choice.method not in EXPLICIT else every


def each(again: Callable[[tuple[float, float], Array], Array]) -> From:
    """One after the other: of a span and the state at its start the state at its end."""
    return lambda spans, states: np.array([again((a, b), x) for (a, b), x in zip(spans.tolist(), states, strict=True)])
