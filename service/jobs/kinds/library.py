"""What a kind of job sees of the store while a submission is resolved, and how stored content is handed to workers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True, slots=True)
class PinnedTree:
    """A revision of a tree: ``reference`` is ``name@revision``, ``spec`` its document with references pinned."""

    reference: str
    digest: str
    spec: Mapping[str, Any]
    coordinates: tuple[str, ...]


class Library(Protocol):
    """The store, for reading. The digests that it gives name what workers are handed in ``Work.blobs``.

    ============================  ========================================================
    ``Work.blobs`` of a part      ``<digest>/definition``, ``<digest>/program``, ``<digest>/certificate``
    ``Work.blobs`` of a tree      ``<digest>/spec``, ``<digest>/program``, ``<digest>/summary``
    ============================  ========================================================

    All are JSON as stored; programs are in the stored format (``Part.load``, ``Model.load``).
    """

    def part(self, reference: str) -> str | None:
        """The digest of the definition that ``name``, ``name@3``, ``name@alias`` or ``name@sha256:...`` means."""

    def is_stored(self, digest: str) -> bool:
        """Whether there is a stored part with this definition."""

    def tree(self, reference: str) -> PinnedTree | None:
        """The revision of a tree that a reference means."""

    def catalogue(self) -> list[str]:
        """``name@sha256:...`` of every version that is not withdrawn."""
