"""The store as the kinds of jobs see it while a submission is resolved."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from importlib import import_module
from typing import Any

from service.content.cache import Cache
from service.database.connections import Connection
from service.jobs.kinds.decoded import marks_of
from service.jobs.kinds.kind import ENTRY
from service.jobs.kinds.library import StoredTree, StoredVersion
from service.messages.references import parse_reference
from service.messages.refusals import Refused
from service.messages.viewer import OPEN, PUBLIC, Viewer
from service.operations.owners import EITHER, absent_either, absent_part, absent_tree, may_have, private_parts
from service.operations.sharing.provenance import derived_from
from service.queries import catalogue, content, renewals, trees, versions
from service.queries.catalogue import Version
from service.queries.owners import Kind, Ownership, ownership, ownerships
from service.queries.owners import private_parts as hidden_parts
from service.queries.searching import part_search
from service.queries.searching.part_search import CatalogueSearch
from service.queries.searching.words import words_of
from service.queries.trees import Tree
from service.schemas.entries import PartEntry
from service.schemas.jobs import ItemDocument
from service.sources import read_source
from substructures.errors import InvalidDocument

PAGE = 200  # parts that are searched at a time

Reader = Callable[[Mapping[str, Any]], Mapping[str, Any]]


def _read_here(given: Mapping[str, Any]) -> Mapping[str, Any]:
    found: Mapping[str, Any] = import_module("substructures.interchange.importing").document_of(given)
    return found


class StoreLibrary:
    """Reads in one transaction, so that all items of a submission see the same state; answers are remembered."""

    def __init__(
        self,
        connection: Connection,
        viewer: Viewer,
        sources: Sequence[str] = (),
        file: Reader = _read_here,
        blobs: Cache[bytes] | None = None,
    ) -> None:
        """``sources``: settings of the instances that may be mirrored; ``file`` reads a robot file; ``blobs``: kept by
        their digests. ``private``: names of what was found and is not for all.
        """
        self._connection, self._viewer = connection, viewer
        self._sources, self.file, self._blobs = sources, file, blobs
        self.private: set[str] = set()
        self._whose: dict[str, dict[str, Ownership | None]] = {}
        self.version = lru_cache(maxsize=None)(self._version)
        self.tree = lru_cache(maxsize=1000)(self._tree)
        self._hidden = lru_cache(maxsize=1000)(lambda digests: hidden_parts(connection, digests))

    def _version(self, reference: str) -> StoredVersion | None:
        ref = parse_reference(reference)
        found = None if ref is None else catalogue.resolve(self._connection, self._viewer, ref)
        self._note(found)
        if found is None:
            return None
        marks = marks_of(found.certificate)
        return StoredVersion(found.name, found.digest, found.program, found.software, marks)

    def wrong_number(self, version: StoredVersion) -> str:
        """What is wrong with the number of a version, by its seal."""
        return versions.wrong_number(self._connection, version.digest, renewals.is_ours(self._connection))

    def _tree(self, reference: str) -> StoredTree | None:
        ref = parse_reference(reference)
        found = None if ref is None else trees.resolve(self._connection, self._viewer, ref)
        self._note(found)
        names = StoredTree.__dataclass_fields__
        return None if found is None else StoredTree(**{name: getattr(found, name) for name in names})

    def _note(self, found: Version | Tree | None) -> None:
        if found is not None and not found.is_public:
            self.private.add(found.name)

    def absent(self, kind: str, reference: str) -> str:
        """Why a reference means nothing, and what may help."""
        absent = {"tree": absent_tree, EITHER: absent_either}.get(kind, absent_part)
        return absent(self._connection, self._viewer, reference)

    def catalogue(self) -> Sequence[str]:
        """References ``name@3`` to all versions that are not withdrawn."""
        return [f"{name}@{number}" for name, number in catalogue.all_versions(self._connection, self._viewer)]

    def search(self, query: Mapping[str, Any]) -> Sequence[str]:
        """References to the latest versions that a search finds, by name."""
        narrow: dict[str, Any] = {"tags": (query["tag"],)} if "tag" in query else {}
        if "dof" in query:
            narrow |= {"dof_min": query["dof"], "dof_max": query["dof"]}
        if "joints" in query:
            narrow["joints"] = query["joints"]
        wanted = CatalogueSearch(words_of(query.get("q", "")), **narrow)
        found: list[str] = []
        after = None
        while page := part_search.page(self._connection, self._viewer, wanted, after, PAGE):
            found += [f"{version.name}@{version.version}" for version, _ in page]
            after = page[-1][1]
        return found

    def trees(self) -> Sequence[str]:
        """References ``name@3`` to all revisions of trees."""
        return [f"{name}@{number}" for name, number in trees.all_revisions(self._connection, self._viewer)]

    def own(self, kind: str) -> Sequence[str]:
        """References to the latest versions or revisions of what may be changed."""
        if kind == "tree":
            found = trees.own_revisions(self._connection, self._viewer)
            return [f"{name}@{number}" for name, number in found]
        return list(catalogue.own_contents(self._connection, self._viewer).values())

    def may_change(self, kind: str, name: str) -> bool:
        """Whether a name belongs to whoever submits."""
        found = ownership(self._connection, "tree" if kind == "tree" else "substructure", name)
        return found is not None and self._viewer.may_change(found.owner)

    def foresee(self, kind: str, items: Sequence[Mapping[str, Any]]) -> None:
        """Look up at once whose the names are that :meth:`owned` is going to be asked about."""
        named, _ = _names(kind)
        names = [item[named].get("name") for item in items if isinstance(item.get(named), Mapping)]
        texts = {name for name in names if isinstance(name, str)}
        self._whose[kind] = {**dict.fromkeys(texts), **ownerships(self._connection, _names(kind)[1], texts)}

    def owned(self, kind: str, item: ItemDocument) -> ItemDocument:
        """The members of an item of kind ``assemble`` or ``derive`` that say for whom it stores what; equal items of
        others are others. Raises InvalidDocument for a name or a part that may not be used.
        """
        if kind == "upgrade":
            return {}
        member, named = _names(kind)
        entry, what = PartEntry(**item.get(ENTRY, {})), item[member]
        name = what["name"]
        known = self._whose.get(kind, {})
        try:
            found = known[name] if name in known else ownership(self._connection, named, name)
            whose = may_have(self._viewer, named, name, found, entry)
            derived_from(self._connection, self._viewer, entry)
        except Refused as error:
            raise InvalidDocument.at("/name", error.code, error.detail) from None
        if whose.visibility != PUBLIC:
            self.private.add(what["name"])
        instances = what.get("instances", ()) if kind == "assemble" else ()
        digests = {each["name"]: each.get("substructure", "").partition("@")[2] for each in instances}
        hidden = self._hidden(frozenset(digests.values())) if instances else {}
        faults = list(private_parts(whose, instances, digests, hidden))
        if faults:
            raise InvalidDocument(faults)
        return {} if self._viewer.owner == OPEN else {"owner": self._viewer.owner}

    def recipe(self, digest: str) -> str | None:
        """What a published tree was coupled of."""
        return content.get_recipe(self._connection, digest)

    def blob(self, digest: str) -> bytes | None:
        """The content of a definition or program."""
        found = None if self._blobs is None else self._blobs.get(digest)
        if found is None:
            found = content.get_blob(self._connection, digest)
            if found is not None and self._blobs is not None:
                self._blobs.put(digest, found)
        return found

    def sources(self) -> Sequence[str]:
        """Addresses of the instances that may be mirrored, without keys."""
        return [read_source(text).address for text in self._sources]


def _names(kind: str) -> tuple[str, Kind]:
    """The member of an item that has the name of what it stores, and of what this is a name."""
    return ("definition", "substructure") if kind == "derive" else ("tree", "tree")
