"""Values of the queue: attempts on items, items that are lost, and what became of items."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field


def attempt_id(job: str, position: int, number: int) -> str:
    """Names an attempt for all time."""
    return f"{job}.{position}.{number}"


def job_of(attempt: str) -> str:
    """The job of a named attempt."""
    return attempt.split(".")[0]


@dataclass(frozen=True, slots=True)
class Attempt:
    """A claimed item; ``item`` and ``blobs`` are JSON, ``number`` counts the attempts on it."""

    job: str
    position: int
    number: int
    kind: str
    key: str
    item: str
    blobs: str

    @property
    def id(self) -> str:
        """Names the attempt for all time."""
        return attempt_id(self.job, self.position, self.number)


@dataclass(frozen=True, slots=True)
class Lost:
    """A running item without anybody who computes it."""

    job: str
    position: int
    number: int
    deaths: tuple[str, ...]
    is_cancelling: bool

    @property
    def id(self) -> str:
        """The id of its latest attempt."""
        return attempt_id(self.job, self.position, self.number)


@dataclass(slots=True)
class Changes:
    """What became of items within a transaction: positions by new state, for every job."""

    by_job: dict[str, dict[str, list[int]]] = field(default_factory=dict)

    def add(self, job: str, state: str, positions: Iterable[int]) -> None:
        """Note that items of a job have a new state."""
        self.by_job.setdefault(job, {}).setdefault(state, []).extend(positions)

    def total(self) -> dict[str, int]:
        """How many items have come into every state."""
        totals: dict[str, int] = {}
        for states in self.by_job.values():
            for state, positions in states.items():
                totals[state] = totals.get(state, 0) + len(positions)
        return totals

    def finished(self) -> dict[str, tuple[int, int]]:
        """(done, failed) to be added to the counts of jobs."""
        sizes = {job: {state: len(p) for state, p in states.items()} for job, states in self.by_job.items()}
        return {
            job: (n.get("succeeded", 0) + n.get("failed", 0), n.get("failed", 0))
            for job, n in sizes.items()
            if "succeeded" in n or "failed" in n
        }
