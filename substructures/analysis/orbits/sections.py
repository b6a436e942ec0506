"""Poincare sections: the states in which a motion crosses a surface of the state space in one direction.

H. Poincare, Les methodes nouvelles de la mecanique celeste III, 1899, chapter 27; M. Henon and C. Heiles, The
applicability of the third integral of motion, Astron. J. 69, 1964.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Literal

import numpy as np

from substructures.analysis.arguments import NumberOrExpression, positive, whole
from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.output_times import OutputGrid, OutputTimes
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import Start, StateVector
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.orbits.flow import moved, require_steady_ties
from substructures.errors import InvalidInput
from substructures.tree.model import Model

MOST = 1_000_000
#: of the only event
PLACE = "/events/0"


@dataclass(frozen=True, repr=False)
class PoincareSection(Trajectory):
    """The states in which a motion crosses a surface, as a trajectory of these alone, with the checks of the motion."""


def poincare_section(
    model: Model,
    q: StateVector | None,
    quantity: NumberOrExpression,
    duration: float,
    *,
    level: float = 0.0,
    direction: Literal["rising", "falling", "both"] = "rising",
    count: int = 1000,
    qd: StateVector | None = None,
    inputs: Mapping[str, Signal] | None = None,
    parameters: Mapping[str, float] | None = None,
    integrator: Integrator | None = None,
) -> PoincareSection:
    """The states ``q``, ``qd`` (K, n) at the times ``t`` (K,) [s] in which a motion of a tree crosses the surface
    ``quantity`` = ``level``, the first ``count`` in up to a ``duration`` [s].

    ``quantity``: an expression in coordinates, velocities, parameters and t (of a forced motion ``sin(w*t)`` is met
    once a period), its unit; ``direction``: which crossings count. The checks are those of the whole motion: its first
    integrals, its balance of energy, some steps again. Raises InvalidInput (pointers start with names of arguments)
    and MissingValue.
    """
    whole(count, "count", 1, MOST)
    span = (0.0, positive(duration, "duration"))
    event = Event("section", quantity, level, direction, count=count)
    start = Start(q, qd, parameters or {}, inputs or {})
    # nothing but the crossings is wanted
    times, choice = OutputTimes(span, OutputGrid(count=2)), integrator or Integrator()
    problem = TreeProblem(model=model, start=start, times=times, integrator=choice, events=(event,))
    try:
        require_moving(model, "poincare-sections")
        require_steady_ties(model, "poincare-sections")
        motion = moved(problem)
    except InvalidInput as error:
        raise error.moved(lambda place: place.removeprefix(PLACE)) from None
    return _met(motion, count, span[1])


def _met(motion: Trajectory, count: int, duration: float) -> PoincareSection:
    """The states of its events, as they were looked for."""
    met, n, m = motion.events, len(motion.coordinates), motion.q.shape[1]
    found = {field.name: getattr(motion, field.name) for field in fields(motion)}
    if motion.status != "failed" and not motion.cancelled:
        message = "" if len(met) == count else f"the section is met {len(met)} times in {duration:g} s"
        found |= {"status": "finished", "message": message}
    found["t"] = np.array([one.t for one in met], dtype=np.float64)
    found["q"] = np.array([one.q for one in met], dtype=np.float64).reshape(-1, m)
    found["qd"] = np.array([one.qd for one in met], dtype=np.float64).reshape(-1, n)
    return PoincareSection(**found | {"series": {}, "events": ()})
