"""Where controlled motions start, and on closures where they may end: states that are closed, demands that are not told
twice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import SINGULAR, Constrained
from substructures.analysis.closed.loops import mobility
from substructures.analysis.closed.pivoting import pivoted
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.control.holding import HOLDING, ties_of
from substructures.analysis.control.problem import ControlProblem
from substructures.analysis.motion.problems.start import Start
from substructures.array import Array
from substructures.errors import InvalidArgument, listed
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Graph
from substructures.expr.replay import replay
from substructures.mechanics.closure_rows import RANK
from substructures.quantities.numbers.states import States, known_values, read_states
from substructures.tree.model import Model

#: demands on coordinates that others decide may differ from these by so much, beside the largest or 1
SAME = 1e-6
#: index in (q, q'), and value
Demand = tuple[int, float]


@dataclass(frozen=True)
class StartState:
    """(q, q') ``x`` (2 n,), on the closures where there are any; their independent ``rows`` (r,); ``closed``: the
    closures in numbers; ``held``: B (K, k, n) of velocity constraints at positions (K, n).
    """

    x: Array
    rows: NDArray[np.int64]
    closed: Constrained | None = None
    held: Callable[[Array], Array] | None = None


def start_state(model: Model, problem: ControlProblem, varied: Mapping[str, str] | None = None) -> StartState:
    """The start of a problem, with closures the closed state nearest to the given one; ``varied``: parameters by where
    they are named.

    Raises InvalidInput (``/q``: ``open-closure``, ``singular-start``; ``/qd``: ``violated``; where ``varied`` is named:
    ``opens-closure``).
    """
    states = read_states(model, {"q": problem.q, "qd": problem.qd}, 1)
    x = np.concatenate([states.q[0], states.qd[0]])
    if model.velocity_constraints:
        return _held(model, problem, states, x, varied or {})
    if not model.closures:
        return StartState(x, np.zeros(0, dtype=np.int64))
    _require_kept(model, varied or {})
    begin = Start(x[: model.dof], x[model.dof :], problem.parameters or {}, problem.inputs or {})
    s = Constrained(model, begin, (problem.t, problem.t))
    found = consistent_state(s, problem.t, s.conditions.q, s.conditions.qd)
    if found.message:
        raise InvalidArgument.at("/q", "open-closure", found.message)
    if mobility(s, problem.t, found.q).singular:
        raise InvalidArgument.at("/q", "singular-start", f"the position is singular: {SINGULAR}")
    s.move(problem.t, found.q, found.qd)
    return StartState(np.concatenate([found.q, found.qd]), s.independent_rows(), s)


def _held(model: Model, problem: ControlProblem, states: States, x: Array, varied: Mapping[str, str]) -> StartState:
    """With velocity constraints, which the start has to meet."""
    n, ties, given = model.dof, ties_of(model), {"parameters": problem.parameters, "inputs": problem.inputs}
    values = known_values(model, {**given, "t": problem.t}, states, model.parameters)

    def rows(q: Array) -> Array:
        """B at positions."""
        return ties.rows(values, model.coordinates, q)

    B = rows(x[None, :n])[0]
    if np.linalg.matrix_rank(B, RANK) < len(B):
        names = listed(ties.labels)
        raise InvalidArgument.at("/q", "singular-start", f"the constraints {names} depend on each other at the start")
    left = float(np.abs(B @ x[n:]).max(initial=0))
    if left > SAME * max(1.0, float((np.abs(B) @ np.abs(x[n:])).max(initial=0))):
        raise InvalidArgument.at("/qd", "violated", f"these velocities violate the constraints by {left:.3g}")
    needed = ties.program.needs([HOLDING[0]])
    for pointer, name in varied.items():
        if name in needed:
            message = f"the velocity constraints depend on '{name}': the start would not meet them; compare two runs"
            raise InvalidArgument.at(pointer, "opens-closure", message)
    # q' on them
    x = np.concatenate([x[:n], x[n:] - np.linalg.pinv(B) @ (B @ x[n:])])
    return StartState(x, np.arange(len(B)), held=rows)


def _require_kept(model: Model, varied: Mapping[str, str]) -> None:
    """Raises InvalidArgument for parameters with which the start would not stay closed."""
    graph = Graph()
    rows = replay(model.program, graph, {}, ["closure.residual"])["closure.residual"].entries.values()
    for slopes in gradient([graph.lift(x) for x in rows], list(varied.values())):
        for (pointer, name), slope in zip(varied.items(), slopes, strict=True):
            if not slope.is_zero:
                message = f"the closures depend on '{name}': the start would not stay closed; compare two runs"
                raise InvalidArgument.at(pointer, "opens-closure", message)


def independent_demands(start: StartState, demands: Sequence[Demand]) -> list[Demand]:
    """Demands on the end that do not follow from each other on the closures, near the closed state that meets them.

    Raises InvalidArgument (``/end/q``, ``/end/qd``: ``open-closure``) where they contradict each other.
    """
    s = start.closed
    if start.held is not None:
        return _moving(start, start.held, demands)
    if s is None:
        return list(demands)
    n, names = s.n, s.model.coordinates
    at, speeds = ([d for d in demands if (d[0] >= n) == moving] for moving in (False, True))
    q = start.x[:n].copy()
    q[[a for a, _ in at]] = [value for _, value in at]
    free = _free(s, start, q)
    kept = _independent(free, [a for a, _ in at])
    found = consistent_state(s, s.t, q, np.zeros(n), [names[a] for a in kept])
    if found.message:
        raise InvalidArgument.at("/end/q", "open-closure", found.message)
    _require_same("/end/q", names, [(a, x, found.q[a]) for a, x in at])
    free = _free(s, start, found.q)
    moved = _independent(free, [i - n for i, _ in speeds])
    values = {i - n: value for i, value in speeds}
    # q' = N z with what is demanded of the coordinates that are kept
    rates = free @ np.linalg.lstsq(free[moved], np.array([values[a] for a in moved]), rcond=None)[0]
    _require_same("/end/qd", names, [(a, x, rates[a]) for a, x in values.items()])
    return [d for d in at if d[0] in kept] + [d for d in speeds if d[0] - n in moved]


def _moving(start: StartState, held: Callable[[Array], Array], demands: Sequence[Demand]) -> list[Demand]:
    """Demands without those on velocities that follow from others by velocity constraints, where the end is known."""
    n = len(start.x) // 2
    q, speeds = start.x[:n].copy(), [d for d in demands if d[0] >= n]
    for a, value in (d for d in demands if d[0] < n):
        q[a] = value
    B = held(q[None])[0]
    free = np.linalg.svd(B)[2][len(B) :].T
    moved = _independent(np.asarray(free, dtype=np.float64), [i - n for i, _ in speeds])
    return [d for d in demands if d[0] < n or d[0] - n in moved]


def _free(s: Constrained, start: StartState, q: Array) -> Array:
    """An orthonormal basis N (n, n - r) of the velocities that the closures leave free."""
    s.move(s.t, q, np.zeros(s.n))
    _, _, right = np.linalg.svd(s.balanced[start.rows])
    return np.asarray(right[len(start.rows) :].T, dtype=np.float64)


def _independent(free: Array, places: list[int]) -> list[int]:
    """As many of the coordinates as move independently of each other."""
    rank = int(np.linalg.matrix_rank(free[places], RANK)) if places else 0
    return sorted(places[k] for k in pivoted(free[places].T, rank)[:rank]) if rank else []


def _require_same(pointer: str, names: Sequence[str], triples: Sequence[tuple[int, float, float]]) -> None:
    size = max([1.0, *(abs(x) for _, x, _ in triples)])
    for a, wanted, found in triples:
        if abs(wanted - found) > SAME * size:
            message = (
                f"'{names[a]}' is to be {wanted:g}, which the closures and the other demands make {found:g}: leave it"
            )
            raise InvalidArgument.at(pointer, "open-closure", f"{message} out")
