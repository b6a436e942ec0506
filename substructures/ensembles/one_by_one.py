"""Members with contacts or events, one after the other, each with the motion that it has alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.problems.contacts import contacts_of
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.kinds import TreeMotion
from substructures.analysis.motion.problems.output_times import OutputGrid, OutputTimes
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.simulation import simulate_tree
from substructures.analysis.motion.trajectory import Crossing, Trajectory
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.ensembles.columns import MotionColumns, statistics
from substructures.ensembles.members import Members, along
from substructures.ensembles.quantity_columns import row_of
from substructures.ensembles.result import TOLD, TOLD_EVENTS, Ensemble, Failure, Happened
from substructures.errors import InvalidArgument, InvalidInput
from substructures.quantities.quantity import TABLE
from substructures.quantities.sources import OF_MOTION
from substructures.tree.document import require_unignored

#: faults of a start that are those of one member: it fails, the others stay
OF_ONE = ("penetration",)
UNTIED = "contacts and events of ensembles are those of trees without closures and velocity constraints: leave them out"


@dataclass
class OneByOne:
    """Motions of ``members``, whose tree has no constraints, at the times ``grid``, with what they are worth.

    Raises InvalidArgument (``/events``, ``/contacts``, ``/columns/name/take``) for what is not followed here.
    """

    members: Members
    times: OutputTimes
    grid: Array
    integrator: Integrator
    columns: MotionColumns
    keeps: bool
    kind: TreeMotion
    events: Sequence[Event]
    failures: list[Failure] = field(default_factory=list)
    happened: list[dict[str, Any]] = field(default_factory=list)
    worst: dict[tuple[str, str], list[Any]] = field(default_factory=dict)
    most: float = 0.0
    failed: int = 0
    steps: int = 0
    evaluations: int = 0

    def __post_init__(self) -> None:
        self.kind = replace(self.kind, contacts=contacts_of(self.members.model, self.kind.contacts))
        if self.members.equations is not None:
            place = "/events" if self.events else "/contacts"
            raise InvalidArgument.at(place, "not-supported", UNTIED)
        for name in self.columns.integrals:
            message = "integrals are not computed with contacts or events: take the 'mean' at many times"
            raise InvalidArgument.at(f"/columns/{name}/take", "not-supported", message)
        if self.kind.contacts:
            require_unignored(self.members.model.ignored)
        for name, column in self.columns.columns.items():
            row = row_of(column.quantity or "")
            if self.kind.contacts and row is not None and TABLE[row].source in OF_MOTION:
                message = f"'{row}' is that of a tree without contacts: take an expression in the states"
                raise InvalidArgument.at(f"/columns/{name}/quantity", "not-supported", message)

    def run(self) -> Ensemble:
        """All members, or those up to where whoever watches the progress says that it is enough."""
        rows = list[dict[str, Any]]()
        for k in range(self.members.count):
            motion = self._moved(k)
            if motion is not None and motion.cancelled:
                break
            rows.append(self._noted(k, motion))
            if self._goes_on((k + 1) / self.members.count) is False:
                break
        return self._result(rows)

    def _moved(self, k: int) -> Trajectory | None:
        """The motion of a member; None where it cannot begin."""
        try:
            problem = TreeProblem(
                model=self.members.model,
                start=self.members.start_of(k),
                times=OutputTimes(self.times.span, OutputGrid(self.grid)),
                integrator=replace(self.integrator, progress=self._told(k)),
                events=self.events,
                kind=self.kind,
            )
            return simulate_tree(problem)
        except InvalidInput as error:
            if any(fault.code not in OF_ONE for fault in error.faults):
                raise
            self._fail(k, float(self.grid[0]), error.faults[0].message)
            return None

    def _told(self, k: int) -> ProgressReport:
        return lambda share: self._goes_on((k + share) / self.members.count)

    def _goes_on(self, share: float) -> bool | None:
        """Tell how much is done, which never falls, though steps reach beyond an impact; False is the end."""
        self.most = max(self.most, share)
        return None if self.integrator.progress is None else self.integrator.progress(self.most)

    def _fail(self, k: int, t: float, message: str) -> None:
        self.failed += 1
        if len(self.failures) < TOLD:
            self.failures.append(Failure(k, t, message))

    def _noted(self, k: int, motion: Trajectory | None) -> dict[str, Any]:
        """What a member is worth, by name."""
        names, n = self.columns.columns, len(self.members.model.positions)
        row: dict[str, Any] = {f"columns.{name}": np.nan for name in names} | {"violation": np.nan}
        row |= {"impacts": 0, "energy_change": 0.0, "ends": float(self.grid[0])}
        states = np.full((len(self.grid), n + self.members.model.dof), np.nan)
        if motion is not None:
            self.steps += motion.steps
            self.evaluations += int(motion.figures.get("evaluations", 0))
            row |= self._told_of(k, motion)
            at = np.searchsorted(motion.t, self.grid)
            there = np.append(motion.t, np.nan)[at] == self.grid
            states[there] = np.hstack([motion.q, motion.qd])[at[there]]
            if _is_whole(motion):
                row["violation"] = self._judged(motion)
                row |= {f"columns.{name}": x for name, x in self._columns(k, motion).items()}
            else:
                self._fail(k, row["ends"], motion.message)
        return row | ({"q": states[:, :n], "qd": states[:, n:]} if self.keeps else {})

    def _told_of(self, k: int, motion: Trajectory) -> dict[str, Any]:
        """Its impacts, resets and end; its events are noted."""
        acting = [event for event in motion.events if event.after is not None]
        left = max(0, TOLD_EVENTS - len(self.happened))
        self.happened += [_plain(k, event) for event in motion.events[:left]]
        return {
            "impacts": sum(event.kind == "impact" for event in acting),
            "energy_change": sum(event.energy_change for event in acting),
            "ends": float(motion.t[-1]) if len(motion.t) else float(self.grid[0]),
        }

    def _columns(self, k: int, motion: Trajectory) -> dict[str, float]:
        states = np.hstack([motion.q, motion.qd])[None]
        values, states = along(self.members, slice(k, k + 1), motion.t, states)
        second = None if "qdd" not in motion.series else lambda: motion.series["qdd"]
        found = self.columns.of(values, states, np.zeros((1, 0)), second)
        return {name: float(x[0]) for name, x in found.items()}

    def _judged(self, motion: Trajectory) -> float:
        """The largest violation in units of what is allowed, up to 1 where all is right."""
        shares = [self._share(check) for check in motion.checks if check.made]
        return np.nan if motion.is_right is None else max(shares)

    def _share(self, check: Check) -> float:
        allowed = check.limit * check.scale
        share = check.worst / allowed if allowed else float(check.worst > 0)
        # what rounding may add is allowed, too
        share = min(share, 1.0) if check.holds else max(share, float(np.nextafter(1, 2)))
        told = self.worst.setdefault((check.name, check.rule), [check.reason, check.unit, 0.0, 0.0, 0, check.limit])
        told[2], told[3] = max(told[2], check.worst), max(told[3], check.relative)
        told[4] += not check.holds
        return share

    def _result(self, rows: Sequence[dict[str, Any]]) -> Ensemble:
        whole = {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else ())}
        of_one = {name: whole.get(name, np.zeros(0)) for name in ("violation", "impacts", "energy_change", "ends")}
        columns = {name: whole.get(f"columns.{name}", np.zeros(0)) for name in self.columns.columns}
        names = ("reason", "unit", "worst", "relative", "violated", "limit")
        checks = ({"name": n, "rule": r, **dict(zip(names, x, strict=True))} for (n, r), x in self.worst.items())
        return Ensemble(
            self.members.model.coordinates,
            len(rows),
            self.grid,
            columns,
            {name: statistics(column) for name, column in columns.items()},
            of_one.pop("violation"),
            tuple(checks),
            tuple(self.failures),
            self.failed,
            self.steps,
            self.evaluations,
            whole.get("q"),
            whole.get("qd"),
            len(rows) < self.members.count,
            Happened(tuple(self.happened), **of_one),
            self.members.model.positions if self.members.model.balls else (),
        )


def _is_whole(motion: Trajectory) -> bool:
    """Whether it came to its end, or to an event that stops it: not where events accumulate (Zeno)."""
    last = motion.events[-1] if motion.events else None
    is_stopped = motion.status == "stopped" and last is not None and last.after is None
    return motion.status == "finished" or is_stopped


def _plain(k: int, event: Crossing) -> dict[str, Any]:
    change = {} if event.after is None else {"energy_change": event.energy_change}
    return {"member": k, "name": event.name, "t": event.t} | ({"kind": event.kind} if event.kind else {}) | change
