"""What is submitted: items that are resolved, and those that are left out."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

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


def key_of(kind: str, item: Mapping[str, Any], content: bytes, software: str) -> str:
    """The key of an item, whose JSON the ``content`` is, that ``software`` computes."""
    family = "analyse" if "analysis" in item else kind  # items of simulate and optimise say what they are
    return "sha256:" + hashlib.sha256(f"{family}\n{software}\n".encode() + content).hexdigest()
