"""What seals are over: see :mod:`service.database.seals`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sqlalchemy import Connection, RowMapping

from service.database.seals import seal

#: what follows from the definition of a part and is served; the program is in it by its digest, as are the formulas
PART = (
    *("digest", "program", "software", "title", "description", "tags", "dof", "joints", "mass", "coordinates"),
    *("bodies", "ports", "parameters", "operations", "certificate", "index_digest"),
)
#: what is served of a revision, but for documents that are in it by their digests
TREE = (
    *("name", "revision", "digest", "program", "software", "dof", "joints", "mass", "summary_digest"),
    *("created", "based_on", "author", "note"),
)
#: which content a number of a name is
VERSION = ("name", "version", "digest")
#: the key says of which kind, software and item; the summary is in it by its digest, as are the files
RESULT = ("key", "kind", "is_good", "digest")
#: which request, and what was answered, but for the body
ANSWER = ("principal", "key", "fingerprint", "status", "headers")


def seal_of_part(connection: Connection, row: Mapping[str, Any] | RowMapping) -> str:
    """The seal that a row of a part with these values has to have."""
    return seal(connection, ["part", *(row[name] for name in PART)])


def seal_of_tree(connection: Connection, row: Mapping[str, Any] | RowMapping) -> str:
    """The seal that a row of a revision with these values has to have."""
    return seal(connection, ["tree", *(row[name] for name in TREE)])


def seal_of_version(connection: Connection, row: Mapping[str, Any] | RowMapping) -> str:
    """The seal that a row of a version with these values has to have."""
    return seal(connection, ["version", *(row[name] for name in VERSION)])


def seal_of_result(connection: Connection, row: Mapping[str, Any] | RowMapping, files: Mapping[str, str]) -> str:
    """The seal that a row of a result with these values has to have; ``files``: digests by name."""
    return seal(connection, ["result", *(row[name] for name in RESULT), sorted(files.items())])


def seal_of_answer(connection: Connection, row: Mapping[str, Any] | RowMapping, digest: str) -> str:
    """The seal that a row of an answer with these values has to have; ``digest``: of its body."""
    return seal(connection, ["answer", *(row[name] for name in ANSWER), digest])
