"""The store as the kinds of jobs see it while a submission is resolved."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

from service.database.connections import Connection
from service.jobs.kinds.library import StoredTree, StoredVersion
from service.queries import catalogue, content, trees
from service.references import parse_reference


class StoreLibrary:
    """Reads in one transaction, so that all items of a submission see the same state; answers are remembered."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self.version = lru_cache(maxsize=None)(self._version)
        self.tree = lru_cache(maxsize=1000)(self._tree)

    def _version(self, reference: str) -> StoredVersion | None:
        ref = parse_reference(reference)
        found = None if ref is None else catalogue.resolve(self._connection, ref)
        return None if found is None else StoredVersion(found.name, found.digest, found.program)

    def _tree(self, reference: str) -> StoredTree | None:
        ref = parse_reference(reference)
        found = None if ref is None else trees.resolve(self._connection, ref)
        return None if found is None else StoredTree(found.name, found.digest, found.program, found.spec, found.summary)

    def catalogue(self) -> Sequence[str]:
        """References ``name@3`` to all versions that are not withdrawn."""
        return [f"{name}@{number}" for name, number in catalogue.all_versions(self._connection)]

    def trees(self) -> Sequence[str]:
        """References ``name@3`` to all revisions of trees."""
        return [f"{name}@{number}" for name, number in trees.all_revisions(self._connection)]

    def blob(self, digest: str) -> bytes | None:
        """The content of a definition or program."""
        return content.get_blob(self._connection, digest)
