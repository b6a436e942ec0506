"""Returns of a motion to a section, a surface of the state space: where an orbit of unknown period begins.

H. Poincare, Les methodes nouvelles de la mecanique celeste III, 1899, chapter 27.
"""

from __future__ import annotations

import numpy as np

from substructures.analysis.arguments import exact, require_read
from substructures.analysis.equations.expressions import names, vector
from substructures.analysis.motion.conditions import state_names
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.output_times import OutputGrid, OutputTimes
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.orbits.flow import EndsEarlyError, Flow
from substructures.analysis.orbits.orbit import Section
from substructures.analysis.verdict import About, Check
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Program, program
from substructures.loads.scope import Scope

#: of the event that stands for the section
NAME = "(section)"
#: relative, of the time of return and the level
RETURN = 1e-7
#: relative, of times of crossings at which an event acts
SAME = 1e-12
PLACE = "/section/quantity"


class Returns:
    """Of the motions of a problem without inputs that depend on the time. Raises InvalidInput, MissingValue."""

    def __init__(self, flow: Flow, problem: TreeProblem, section: Section) -> None:
        self.flow, self.problem, self.section = flow, problem, section
        self._program = _slopes(problem, section)

    def first(self, x: Array) -> tuple[Array, float]:
        """The state in which the motion from x (size,) first crosses the section, behind an event that acts there,
        and the time [s] until it has come back. Raises EndsEarlyError.
        """
        section = self.section
        # before the others: where one of them acts at the same time, it is met, too
        event = Event(NAME, section.quantity, section.level, section.direction, count=section.count + 1)
        times = OutputTimes((0.0, (section.count + 1) * section.duration), OutputGrid(count=2))
        motion = self.flow.run(x, times, (event, *self.problem.events))
        met = [crossing for crossing in motion.events if crossing.name == NAME]
        if len(met) <= section.count:
            why = motion.message or f"choose another start, or a longer duration than {section.duration:g} s"
            raise EndsEarlyError(f"it meets the section {len(met)} times where {section.count + 1} are needed: {why}")
        begun = met[0]
        acts = [each.after for each in motion.events if each.after and abs(each.t - begun.t) <= SAME * begun.t]
        q, qd = acts[-1] if acts else (begun.q, begun.qd)
        return self.flow.states(q[None], qd[None])[0], met[-1].t - begun.t

    def row(self, x: Array, values: dict[str, float]) -> tuple[Array, float]:
        """The derivatives (size,) of the quantity by the state x (size,), and what it is short of its level."""
        full = np.concatenate(self.flow.split(x))
        given = values | dict(zip(state_names(self.problem.model), full.tolist(), strict=True))
        found = interpret(self._program, given, ["slopes", "gap"])
        return self.flow.by_state(x, found["slopes"]), -float(found["gap"][0])

    def checks(self, x: Array, period: float, values: dict[str, float] | None) -> list[Check]:
        """The time of return, and with the ``values`` of parameters whether the orbit begins on the section."""
        last, again = np.array([period]), self.first(x)[1]
        reason = "the period is the time in which the motion comes back to the section"
        about: About = ("section", "accurate", reason, "1")
        found = [Check.of(about, np.array([again / period - 1]), last, 1.0, RETURN)]
        if values is not None:
            slopes, short = self.row(x, values)
            scale = float(np.abs(slopes) @ (1 + np.abs(x)))
            about = ("start", "zero", "the orbit begins on the section", "")
            found.append(Check.of(about, np.array([short]), last, scale, RETURN))
        return found


def _slopes(problem: TreeProblem, section: Section) -> Program:
    """Outputs ``slopes`` (2n,), ``gap`` (1,)."""
    scope = Scope(Graph())
    quantity = scope.read(exact(section.quantity, PLACE), PLACE, names(problem.model, scope, False))
    slopes = gradient([quantity], list(state_names(problem.model)))[0]
    require_read(scope)
    level = scope.graph.lift(exact(section.level, "/section/level"))
    found = program(scope.graph, {"slopes": vector(slopes), "gap": vector([quantity - level])}, scope.symbols)
    if any(symbol.kind == "time" for symbol in found.symbols):
        message = "a section whose time of return is unknown does not depend on t: give 'period' in its place"
        raise InvalidArgument.at(PLACE, "not-supported", message)
    return found
