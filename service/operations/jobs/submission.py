"""What is submitted: items that are resolved, and those that are left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from service.queries.jobs.jobs import NewItem
from substructures.errors import Fault


@dataclass(frozen=True, slots=True)
class Skipped:
    """An item that cannot be computed and is left out: its number among those given, and why."""

    item: int
    faults: Sequence[Fault]


@dataclass(frozen=True, slots=True)
class JobSubmission:
    """A job ready to be queued."""

    kind: str
    items: Sequence[NewItem]
    uploads: Sequence[str] = ()  # digests of the states that the items refer to
    shared: bool = False  # whether every key may see it
    skipped: Sequence[Skipped] = ()
    label: str = ""
    retry_of: str | None = None
