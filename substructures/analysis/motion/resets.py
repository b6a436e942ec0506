"""Motions whose events act: where a quantity crosses its level the state becomes another one, and the motion goes on.

Between two such events it is a motion like any other, and judged as one: first integrals are constant there, whatever
the event did to them. What it did to the energy is told with it. Events that follow each other ever more quickly (Zeno:
a ball that comes to rest) end the motion where they accumulate, at once where a ball does not bounce at all.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, TypeVar

import numpy as np

from substructures.analysis.equations.expressions import Given, read_expressions
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.problems.event_gaps import GAPS, gap_rates
from substructures.analysis.motion.problems.events import DIRECTIONS, Event
from substructures.analysis.motion.problems.output_times import OutputGrid, OutputTimes
from substructures.analysis.motion.problems.problem import MotionProblem
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.trajectory import Crossing, Trajectory
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import InvalidArgument, among
from substructures.expr.interpret import interpret, interpret_in_blocks
from substructures.expr.program import Program
from substructures.quantities.numbers.quaternions import quaternions_in

#: so many events one after the other, each within this share of the span from the one before: they accumulate
MANY, SOON = 10, 1e-6
#: most events that act in a motion
MOST = 10_000
#: part of a rate before an event that is none after it
NONE = 1e-6
Status = Literal["finished", "stopped", "failed"]
Problem = TypeVar("Problem", bound=MotionProblem)
#: the accelerations (n,) at a time and a state
Accelerations = Callable[[float, Array], Array]
ENERGY = ("metric", "potential_energy")


def acting(events: Sequence[Event]) -> bool:
    """Whether one of them changes the state."""
    return any(event.reset for event in events)


@dataclass(frozen=True)
class Rest:
    """What rests at the level of an event: it is carried ``across``, or held there by what has a limit (friction), so
    that the event is to act again where it goes this ``depth`` beyond.
    """

    depth: float
    across: bool


NOT_AT_REST = Rest(0.0, across=False)


class Resets:
    """What events make of states; ``dynamics``: makes the function (t, x) -> accelerations (n,), by which it is looked
    whether they bring something to rest; None where nobody asks.

    Raises InvalidArgument for names that are no coordinates or velocities, and for events without a direction, which
    would happen again where they have happened."""

    def __init__(
        self, problem: MotionProblem, conditions: Conditions, dynamics: Callable[[], Accelerations] | None = None
    ) -> None:
        self.conditions, self.events = conditions, problem.events
        self._dynamics = dynamics
        known = state_names(problem.model)
        self._places: dict[int, list[int]] = {}
        given: list[Given] = []
        for i, event in enumerate(problem.events):
            if event.reset and event.direction == "both":
                message = "an event that acts needs its direction, rising or falling: else it happens where it left off"
                raise InvalidArgument.at(f"/events/{i}/direction", "direction-needed", message)
            for name in event.reset:
                if name not in known:
                    message = f"'{name[:80]}' is no coordinate or velocity{among(name, known)}"
                    raise InvalidArgument.at(f"/events/{i}/reset/{escape(name)}", "unknown-coordinate", message)
            if any(other.name == event.name for other in problem.events[:i]):
                raise InvalidArgument.at(f"/events/{i}/name", "duplicate-name", f"a second event '{event.name}'")
            self._places[i] = [known.index(name) for name in event.reset]
            pointers = (f"/events/{i}/reset/{escape(name)}" for name in event.reset)
            given.append(list(zip(event.reset.values(), pointers, strict=True)))
        groups = {str(i): group for i, group in enumerate(given) if group}
        self._program = read_expressions(problem.model, groups)

    def which(self, motion: Trajectory) -> int | None:
        """The event that acts where a motion was stopped, None where none does."""
        if motion.status != "stopped" or motion.cancelled or not motion.events:
            return None
        name = motion.events[-1].name
        return next((i for i, event in enumerate(self.events) if event.reset and event.name == name), None)

    def after(self, event: int, t: float, x: Array) -> Array:
        """The state (2n,) after an event at a state; quaternions have the length 1."""
        found = x.copy()
        values = {**self._values(t, x), "t": t}
        found[self._places[event]] = interpret(self._program, values, [str(event)])[str(event)]
        model = self.conditions.model
        for some in quaternions_in(model.positions, model.balls):
            found[some] /= np.linalg.norm(found[some])
        return found

    def _values(self, t: float, x: Array) -> dict[str, Any]:
        inputs = {name: float(u[0]) for name, u in self.conditions.inputs_at(np.array([t]), x[None]).items()}
        return {**self.conditions.values, **inputs, **dict(zip(state_names(self.conditions.model), x, strict=True))}

    def at_rest(self, event: int, t: float, x: Array, y: Array, span: float) -> Rest:
        """Whether the state y that an event makes of x stays at its level, g' = 0 beside that at x, and whether g''
        carries it across once more: a ball that does not bounce. ``span``: of the motion [s].
        """
        if self._dynamics is None:
            return NOT_AT_REST
        (here, before, _), (there, after, bend) = self._gap(event, t, x), self._gap(event, t, y)
        depth, carried = NONE**2 * abs(before) * span, DIRECTIONS[self.events[event].direction] * bend * span
        if abs(there) > abs(here) + depth or abs(after) > NONE * abs(before):
            return NOT_AT_REST
        is_held = abs(carried) <= NONE * abs(before)
        return Rest(depth if is_held else 0.0, not is_held and carried > 0)

    def _gap(self, event: int, t: float, x: Array) -> tuple[float, float, float]:
        """What the quantity of an event is from its level at a state, and the first two derivatives by the time."""
        model, (second, rates) = self.conditions.model, self._gaps
        accelerations = {f"{q}''": a for q, a in zip(model.coordinates, second(t, x).tolist(), strict=True)}
        found = interpret(rates, self._values(t, x) | {"t": t} | accelerations)
        g, by_t, by_tt = (float(found[name][event]) for name in GAPS)
        return g, by_t, by_tt

    @cached_property
    def _gaps(self) -> tuple[Accelerations, Program]:
        assert self._dynamics is not None  # noqa: S101 -- asked before
        return self._dynamics(), gap_rates(self.conditions.model, self.events)

    def energy(self, t: float, x: Array) -> float:
        """H = 1/2 g_ab q'^a q'^b + V [J]."""
        n, model = len(self.conditions.model.positions), self.conditions.model
        needed = [*ENERGY, "T_0"] if model.given else list(ENERGY)
        found = interpret_in_blocks(model.program, {**self._values(t, x), "t": t}, needed, 1)
        metric, potential, *drives = (found[name][0] for name in needed)
        return float(0.5 * x[n:] @ metric @ x[n:] + potential - sum(drives))


def simulate_with_resets(problem: Problem, resets: Resets, move: Callable[[Problem], Trajectory]) -> Trajectory:
    """The motion piece by piece; ``move``: computes one, up to the first event that acts."""
    span, wanted = problem.span, problem.times.grid()
    stopping = [replace(event, action="stop") if event.reset else event for event in problem.events]
    choice = replace(problem.integrator, progress=_forwards(problem.integrator.progress))
    whole, pieces = replace(problem, events=stopping, integrator=choice), list[Trajectory]()
    start, t, soon, work = problem.start, span[0], 0, 0.0
    why: tuple[Status, str] | None
    while True:
        due = wanted[wanted > t] if pieces else wanted
        piece = move(_from(whole, start, t, due, sum(each.steps for each in pieces)))
        if "work" in piece.series:
            piece = replace(piece, series={**piece.series, "work": piece.series["work"] + work})
            work = float(piece.series["work"][-1]) if len(piece.t) else work
        k = resets.which(piece)
        if k is None:
            return _joined([*pieces, piece])
        last = piece.events[-1]
        x = np.concatenate([last.q, last.qd])
        y = resets.after(k, last.t, x)
        change, n = resets.energy(last.t, y) - resets.energy(last.t, x), len(last.q)
        told = replace(last, after=(y[:n], y[n:]), energy_change=change)
        piece = replace(piece, events=(*piece.events[:-1], told))
        soon = soon + 1 if last.t - t <= SOON * (span[1] - span[0]) else 0
        rest = resets.at_rest(k, last.t, x, y, span[1] - span[0]) if np.isfinite(y).all() else NOT_AT_REST
        soon = MANY if rest.across else soon
        why = ("finished", "") if last.t >= span[1] else _why_not(last, y, soon, len(pieces) + 1)
        if why is not None:  # the state before the event is the last result
            return replace(_joined([*pieces, piece]), status=why[0], message=why[1])
        pieces.append(_without_its_end(piece, due))
        whole = replace(whole, events=_to_come(problem.events, whole.events, piece, rest.depth))
        start, t = replace(start, q=y[:n].tolist(), qd=y[n:].tolist()), last.t


def _from(whole: Problem, start: Start, t: float, due: Array, steps: int) -> Problem:
    """What is left of a problem at a time."""
    (begin, end), choice = whole.span, whole.integrator
    told: ProgressReport | None = None
    if choice.progress is not None:
        report = choice.progress

        def told(share: float) -> bool | None:
            """Of the whole span."""
            return report((t - begin + share * (end - t)) / (end - begin))

    left = replace(choice, progress=told, max_steps=max(1, choice.max_steps - steps))
    times = OutputTimes((t, end), OutputGrid(tuple(due.tolist())))
    return replace(whole, start=start, times=times, integrator=left)


def _to_come(given: Sequence[Event], events: Sequence[Event], piece: Trajectory, depth: float) -> list[Event]:
    """What is left of the counts of events that do not act; the one that acted last has its level so much deeper."""
    met, acted = Counter(event.name for event in piece.events), piece.events[-1].name
    return [
        replace(event, level=first.level + (DIRECTIONS[event.direction] * depth if event.name == acted else 0.0))
        if event.reset
        else replace(event, count=max(1, event.count - met[event.name]))
        for first, event in zip(given, events, strict=True)
    ]


def _forwards(report: ProgressReport | None) -> ProgressReport | None:
    """A progress that never falls: steps reach beyond an event at which the motion turns back."""
    most = 0.0

    def told(share: float) -> bool | None:
        """The largest share until now is told."""
        nonlocal most
        most = max(most, share)
        return None if report is None else report(most)

    return None if report is None else told


def _without_its_end(piece: Trajectory, due: Array) -> Trajectory:
    """The state where it was stopped is a result only where one was wanted."""
    kept = np.isin(piece.t, due)
    series = {name: values[kept] for name, values in piece.series.items()}
    return replace(piece, t=piece.t[kept], q=piece.q[kept], qd=piece.qd[kept], series=series)


def _why_not(last: Crossing, y: Array, soon: int, count: int) -> tuple[Status, str] | None:
    """Status and message where the motion does not go on."""
    if not np.isfinite(y).all():
        return "failed", f"the event '{last.name}' at t = {last.t:.9g} s leads to no finite state"
    if soon >= MANY:
        message = f"events follow each other without end at t = {last.t:.9g} s (Zeno), the last one is '{last.name}'"
        return "stopped", f"{message}: what goes on there is another motion, of a body at rest"
    if count >= MOST:
        return "failed", f"{MOST:,} events act up to t = {last.t:.9g} s: end the span before it"
    return None


def _joined(pieces: Sequence[Trajectory]) -> Trajectory:
    """One motion, which ended as its last piece did; of each check the worst."""
    last = pieces[-1]
    names = [name for name in last.series if all(name in piece.series for piece in pieces)]
    series = {name: np.concatenate([piece.series[name] for piece in pieces]) for name in names}
    lows, highs = ([piece.reached[k] for piece in pieces if piece.reached is not None] for k in (0, 1))
    return replace(
        last,
        t=np.concatenate([piece.t for piece in pieces]),
        q=np.concatenate([piece.q for piece in pieces]),
        qd=np.concatenate([piece.qd for piece in pieces]),
        series=series,
        checks=_worst([check for piece in pieces for check in piece.checks]),
        steps=sum(piece.steps for piece in pieces),
        events=tuple(event for piece in pieces for event in piece.events),
        figures={name: sum(piece.figures.get(name, 0.0) for piece in pieces) for name in last.figures},
        reached=(np.min(lows, axis=0), np.max(highs, axis=0)) if lows else None,
    )


def _worst(checks: Sequence[Check]) -> tuple[Check, ...]:
    """Of all that have one name and rule the one that is violated, was not made though needed, or is the largest."""
    found: dict[tuple[str, str], Check] = {}
    for check in checks:
        known = found.get((check.name, check.rule))
        if known is None or _badness(check) > _badness(known):
            found[check.name, check.rule] = check
    return tuple(found.values())


def _badness(check: Check) -> tuple[bool, bool, float]:
    return check.holds is False, not check.made and check.needed, check.relative if check.made else -1.0
