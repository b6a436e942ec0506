"""The flow of a tree whose events act, and of its linear neighbourhood: where the state x jumps to R(t, x) at the zero
of e(t, x), neighbouring motions jump a little earlier or later, by the saltation matrix

    S = R_x + (f+ - R_x f- - R_t) e_x / (e_x f- + e_t)

with the rates f-, f+ before and after (R. I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical
Systems, 2004, chapter 7).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from substructures.analysis.arguments import exact, require_read
from substructures.analysis.equations.expressions import names, vector
from substructures.analysis.motion.conditions import state_names
from substructures.analysis.motion.problems.event_gaps import read_gaps
from substructures.analysis.motion.problems.output_times import OutputGrid, OutputTimes
from substructures.analysis.motion.resets import Resets
from substructures.analysis.motion.trajectory import Crossing, Trajectory
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.orbits.flow import EndsEarlyError, Flow
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Program, program
from substructures.loads.scope import Scope

#: an event whose quantity moves so slowly, relative to what its slopes and rates are, is grazed
GRAZED = 1e-9
#: points of Gauss and Legendre in a piece between two events
POINTS = 24
#: a start whose event is so near its level is moved along the motion by this part of the period
NEAR, AHEAD = 1e-6, 0.31


class HybridFlow(Flow):
    """``problem``: with events that act. Raises InvalidInput, MissingValue as sensitivities and simulations."""

    def __init__(self, problem: TreeProblem) -> None:
        for i, event in enumerate(problem.events):
            if not event.reset:
                message = f"the event '{event.name}' does nothing: give its 'reset', or leave it out"
                raise InvalidArgument.at(f"/events/{i}/reset", "missing", message)
        super().__init__(replace(problem, events=()))
        if self.equations is not None:
            message = "events act on trees without closures and velocity constraints: leave 'reset' out"
            raise InvalidArgument.at("/events/0/reset", "not-supported", message)
        self.tree, self.resets = problem, Resets(problem, self.conditions)
        self._slopes = _slopes(problem)
        self.is_forced = self.is_forced or any(symbol.kind == "time" for symbol in self._slopes.symbols)

    def begun(self, x: Array, period: float) -> Array:
        """A start on the same motion at which no event is about to happen."""
        if self.is_forced or all(abs(self._gap(i, x)) > NEAR for i in range(len(self.tree.events))):
            return x
        states, _ = self.move(x, np.eye(self.chart.width), (0.0, AHEAD * period), np.array([AHEAD * period]))
        found: Array = states[-1]
        return found

    def _gap(self, event: int, x: Array) -> float:
        return float(interpret(self._slopes, self._at(0.0, x), [f"gap.{event}"])[f"gap.{event}"][0])

    def _at(self, t: float, x: Array) -> dict[str, float]:
        return {**self.conditions.values, **dict(zip(state_names(self.model), x.tolist(), strict=True)), "t": t}

    def motion(self, x: Array, period: float, count: int) -> tuple[Trajectory, Array]:
        """The motion over a period at so many times, with its checks, and the monodromy matrix (width, width)."""
        run = self._run(x, (0.0, period), OutputGrid(count=count))
        slopes = self.move(x, np.eye(self.chart.width), (0.0, period), np.array([0.0, period]))[1]
        return run, slopes[-1]

    def _run(self, x: Array, span: tuple[float, float], grid: OutputGrid) -> Trajectory:
        run = self.run(x, OutputTimes(span, grid), self.tree.events)
        if run.status != "finished":
            raise EndsEarlyError(run.message or "an event stops it")
        return run

    def _pieces(self, x: Array, span: tuple[float, float]) -> Iterator[tuple[float, float, Array, Crossing | None]]:
        """Begin, end, first state of each piece between events, and the event that ends it."""
        a, at = span[0], x
        for event in self._run(x, span, OutputGrid(times=(span[1],))).events:
            if event.after is not None:
                yield a, event.t, at, event
                a, at = event.t, np.concatenate(event.after)
        if a < span[1]:
            yield a, span[1], at, None

    def move(self, x: Array, directions: Array, span: tuple[float, float], times: Array) -> tuple[Array, Array]:
        """As of a flow without events; at the time of an event the state behind it."""
        states, slopes = [], []
        S: Array = directions
        for a, b, at, event in self._pieces(x, span):
            here = times[(times >= a) & ((times < b) | ((event is None) & (times <= b)))]
            found = super().move(at, S, (a, b), np.append(here, b))
            states += list(found[0][:-1])
            slopes += list(found[1][:-1])
            S = found[1][-1]
            if event is not None:
                S = self.saltation(event) @ S
                if b >= span[1]:
                    states.append(np.concatenate(event.after or ()))
                    slopes.append(S)
        return np.array(states), np.array(slopes)

    def saltation(self, event: Crossing) -> Array:
        """S (width, width) of an event that has happened. Raises EndsEarlyError where it is only grazed."""
        i = next(k for k, each in enumerate(self.tree.events) if each.name == event.name)
        x, y = np.concatenate([event.q, event.qd]), np.concatenate(event.after or ())
        found = interpret(self._slopes, self._at(event.t, x), [f"event.{i}", f"reset.{i}"])
        e, rows = found[f"event.{i}"], found[f"reset.{i}"].reshape(-1, self.chart.size + 1)
        before, after = self.full_rate(event.t, x), self.full_rate(event.t, y)
        R = np.eye(self.chart.size, self.chart.size + 1)
        R[[state_names(self.model).index(name) for name in self.tree.events[i].reset]] = rows
        speed = float(e[:-1] @ before + e[-1])
        if abs(speed) <= GRAZED * (1 + float(np.abs(e[:-1]) @ np.abs(before))):
            raise EndsEarlyError(f"the event '{event.name}' is only grazed at t = {event.t:.9g} s")
        jump = after - R[:, :-1] @ before - R[:, -1]
        found_S = R[:, :-1] + np.outer(jump, e[:-1]) / speed
        return np.asarray(self.chart.along(y) @ found_S @ self.chart.ways(x).T)

    def volume(self, motion: Trajectory) -> float:
        """det M = product of exp of the integrals of the divergence, and of det S: by Gauss's rule in each piece."""
        nodes, weights = np.polynomial.legendre.leggauss(POINTS)
        x, result = np.concatenate([motion.q[0], motion.qd[0]]), 1.0
        for a, b, at, event in self._pieces(x, (float(motion.t[0]), float(motion.t[-1]))):
            t = (a + b) / 2 + (b - a) / 2 * nodes
            states, _ = super().move(at, np.eye(self.chart.width), (a, b), t)
            result *= float(np.exp((b - a) / 2 * weights @ self.divergence(t, states)))
            result *= 1.0 if event is None else float(np.linalg.det(self.saltation(event)))
        return result


def _slopes(problem: TreeProblem) -> Program:
    """Outputs ``event.k`` (2n + 1,), the derivatives of its quantity by the state and t, ``reset.k`` (m (2n + 1),)
    those of what it makes of m components of the state, row by row, ``gap.k`` (1,), what it is from its level."""
    scope = Scope(Graph())
    lookup, outputs, by = names(problem.model, scope, False), {}, [*state_names(problem.model), "t"]
    gaps = read_gaps(scope, lookup, problem.events)
    for i, (event, gap) in enumerate(zip(problem.events, gaps, strict=True)):
        pointer = f"/events/{i}/quantity"
        resets = [scope.read(exact(x, pointer), pointer, lookup) for x in event.reset.values()]
        outputs[f"event.{i}"] = vector(gradient([gap], by)[0])
        outputs[f"reset.{i}"] = vector([x for row in gradient(resets, by) for x in row])
        outputs[f"gap.{i}"] = vector([gap])
    require_read(scope)
    return program(scope.graph, outputs, scope.symbols)
