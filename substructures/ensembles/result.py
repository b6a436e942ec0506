"""What became of an ensemble: columns, statistics, verdicts, and what contacts and events of its members did."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array

#: failures, and events, that are told one by one
TOLD, TOLD_EVENTS = 100, 10_000


@dataclass(frozen=True)
class Failure:
    """A member that has no motion up to the end: its number, when it ended [s], and why."""

    member: int
    t: float
    message: str


@dataclass(frozen=True)
class Happened:
    """What contacts and events did. ``events``: the first 10,000 of all members with ``member``, ``name``, ``t`` [s],
    ``kind`` and ``energy_change`` [J]; of each member (M,) how many ``impacts``, by how much these and resets have
    changed its energy, ``energy_change`` [J], and when it ``ends`` [s], by an event that stops it or at the end.
    """

    events: tuple[Mapping[str, Any], ...]
    impacts: Array
    energy_change: Array
    ends: Array


@dataclass(frozen=True)
class Ensemble:
    """``count`` = M motions at the times ``t`` (K,).

    ``columns`` (M,) by name, not a number for members that failed, and their ``statistics``. ``violation`` (M,): the
    largest of all conditions in units of what is allowed, so that a motion is right up to 1; not a number where it
    failed or nothing could be checked. ``checks``: of each condition the largest violation relative to its scale, and
    how many members violate it. ``q``, ``qd`` (M, K, n) [rad, m; per s] where they are asked for, not a number after
    the end of a member; ``positions``: the columns of ``q``, where they are not the coordinates. ``steps``: of all.
    ``happened``: where members have contacts or events, each is a motion of its own, as by ``simulate``.
    """

    coordinates: tuple[str, ...]
    count: int
    t: Array
    columns: Mapping[str, Array]
    statistics: Mapping[str, Mapping[str, Any]]
    violation: Array
    checks: tuple[Mapping[str, Any], ...]
    failures: tuple[Failure, ...]
    failed: int
    steps: int
    evaluations: int
    q: Array | None = None
    qd: Array | None = None
    cancelled: bool = False
    happened: Happened | None = None
    positions: tuple[str, ...] = ()

    def __repr__(self) -> str:
        names = ", ".join(self.columns) or "none"
        right = int((self.violation <= 1).sum())
        return f"Ensemble of {self.count}: {right} right, {self.failed} failed; columns: {names}"

    @property
    def is_right(self) -> bool | None:
        """True when all members are right, False when any violates a necessary condition, None otherwise."""
        if (self.violation > 1).any():
            return False
        return True if (self.violation <= 1).all() and self.count and not self.cancelled else None

    def summary(self) -> dict[str, Any]:
        """As plain data and arrays."""
        states = {} if self.q is None else {"q": self.q, "qd": self.qd}
        return {
            "coordinates": list(self.coordinates),
            **({"positions": list(self.positions)} if self.positions else {}),
            "count": self.count,
            "t": self.t,
            "is_right": self.is_right,
            "right": int((self.violation <= 1).sum()),
            "wrong": np.flatnonzero(self.violation > 1)[:TOLD],
            "failed": self.failed,
            "failures": [vars(each) for each in self.failures],
            "checks": [dict(each) for each in self.checks],
            "columns": dict(self.columns),
            "statistics": dict(self.statistics),
            "violation": self.violation,
            "steps": self.steps,
            "evaluations": self.evaluations,
            "cancelled": self.cancelled,
            "one_by_one": self.happened is not None,
            **({} if self.happened is None else vars(self.happened)),
            **states,
        }
