"""What computes items: an engine starts them, reports about them, and can stop them at any moment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol


@dataclass(frozen=True)
class Budget:
    """What one item may use."""

    cpu_seconds: float
    memory_bytes: int


@dataclass(frozen=True)
class Work:
    """One item, complete in itself: whoever computes it needs neither the database nor any other item.

    ``id`` names the attempt. ``item``: plain JSON with references pinned to digests. ``blobs``: the contents that the
    item refers to, by digest.
    """

    id: str
    kind: str
    item: Mapping[str, Any]
    blobs: Mapping[str, bytes]
    budget: Budget


@dataclass(frozen=True)
class Outcome:
    """What came of an item that was computed: a summary and files, or the problem document of its own failure; with
    both the item has failed, and what there is of its result is kept beside the problem.
    """

    summary: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, bytes] = field(default_factory=dict)
    problem: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class AttemptReport:
    """News of one attempt: ``fraction`` done while it runs; at its end an outcome, or what was seen of its death.

    ``cpu_seconds``: what it took, where that is known.
    """

    id: str
    fraction: float = 0.0
    outcome: Outcome | None = None
    death: str = ""
    cpu_seconds: float = 0.0

    @property
    def is_final(self) -> bool:
        """Whether the attempt has ended."""
        return self.outcome is not None or bool(self.death)


class Engine(Protocol):
    """Computes works in processes of their own. Not for several threads at a time."""

    @property
    def free(self) -> int:
        """Works that can be started now."""

    def start(self, work: Work) -> None:
        """Start to compute; reports follow."""

    def stop(self, attempt: str) -> None:
        """Kill what computes the attempt; no report follows. Nothing happens when there is none."""

    def reports(self, seconds: float) -> list[AttemptReport]:
        """News, waiting at most so long for the first."""

    def close(self) -> None:
        """Stop all, and leave no process behind."""
