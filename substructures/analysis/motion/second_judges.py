"""What judges a motion beside its first integrals: it, or parts of it, are computed once more, more carefully."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.problems.output_times import OutputGrid, OutputTimes
from substructures.analysis.motion.problems.problem import Integrator, MotionProblem
from substructures.analysis.motion.second_run import accurate, at_end, second_run
from substructures.analysis.motion.single_steps import From, Groups, careful, each, steps_again
from substructures.analysis.verdict import Check
from substructures.array import Array

Problem = TypeVar("Problem", bound=MotionProblem)
#: integrates a problem without events from a state; the last argument: it begins anew at corners of force laws
Move = Callable[[Problem, Array, ProgressReport | None, bool], IntegratedMotion]


def computed_again(
    problem: Problem,
    first: IntegratedMotion,
    groups: Groups,
    move: Move[Problem],
    *,
    is_whole: bool,
    alone: From | None = None,
) -> tuple[Check, ...]:
    """``is_whole``: a second run, where an input that varies is part of the potential and no balance of energy judges;
    else some steps, where a balance of energy or first integrals judge the whole, by ``alone`` where there is such.
    """
    told = at_end(problem.integrator.progress)

    def run(span: tuple[float, float], times: Array, choice: Integrator) -> IntegratedMotion:
        """The same motion more carefully."""
        wanted = OutputTimes(span, OutputGrid(times))
        return move(replace(problem, times=wanted, integrator=choice, events=()), first.step_x[0], told, True)

    def step(span: tuple[float, float], x: Array) -> Array:
        """From a state of the motion."""
        wanted, choice = OutputTimes(span, OutputGrid([span[1]])), careful(problem.integrator, span[1] - span[0])
        second = move(replace(problem, times=wanted, integrator=choice, events=()), x, None, False)
        if second.status != "finished":
            raise ArithmeticError(second.message)
        return second.x[-1]

    if is_whole:
        return accurate(second_run(first, problem.integrator, run), groups, problem.drift_limit)
    return steps_again(first, groups, problem.drift_limit, alone or each(step))
