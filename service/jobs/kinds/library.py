"""What the kinds of jobs need to know of the store before an item is queued: references become digests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class StoredVersion:
    """A version of a substructure: its name, the digest of its definition, and that of its program.

    The blob of ``digest`` is the canonical definition (:meth:`substructures.part.definition.Definition.canonical`), the
    blob of ``program`` the canonical program, which ``software`` derived; ``not_judged``: outputs that its certificate
    could not decide.
    """

    name: str
    digest: str
    program: str
    software: str
    not_judged: tuple[str, ...] = ()


@dataclass(frozen=True)
class StoredTree:
    """A revision of a tree: name, digest, the digest of its program (a blob), ``spec`` and ``summary`` as JSON, its
    number, and the software that coupled it.
    """

    name: str
    digest: str
    program: str
    spec: str
    summary: str
    revision: int
    software: str


class Library(Protocol):
    """Read access to the store while a submission is being resolved; answers are expected to be cached."""

    def version(self, reference: str) -> StoredVersion | None:
        """The version that a reference means (``name``, ``name@3``, ``name@alias``, ``name@sha256:...``)."""

    def wrong_number(self, version: StoredVersion, /) -> str:
        """What is wrong with the number of a version, by its seal; empty where nothing is."""

    def tree(self, reference: str) -> StoredTree | None:
        """The revision of a tree that a reference means."""

    def absent(self, kind: str, reference: str) -> str:
        """Why a reference to a ``substructure``, ``tree`` or ``substructure or tree`` means nothing, and the remedy."""

    def catalogue(self) -> Sequence[str]:
        """References ``name@3`` to all versions that are not withdrawn."""

    def search(self, query: Mapping[str, Any]) -> Sequence[str]:
        """References ``name@3`` to the latest versions that a search finds: ``q``, ``tag``, ``dof``, ``joints``."""

    def trees(self) -> Sequence[str]:
        """References ``name@3`` to all revisions of trees."""

    def own(self, kind: str) -> Sequence[str]:
        """References to the latest versions (``substructure``) or revisions (``tree``) of what may be changed."""

    def may_change(self, kind: str, name: str) -> bool:
        """Whether a name belongs to whoever submits."""

    def recipe(self, digest: str) -> str | None:
        """Of a definition that is a published tree: what it was coupled of (:mod:`service.content.derivation`)."""

    def blob(self, digest: str) -> bytes | None:
        """The content of a definition or program."""

    def file(self, given: Mapping[str, Any]) -> Mapping[str, Any]:
        """The definition or tree in a robot file, ``{"file": text, "kind": ...}``. Raises InvalidDocument."""

    def sources(self) -> Sequence[str]:
        """Addresses of the instances that may be mirrored."""
