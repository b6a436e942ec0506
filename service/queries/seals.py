"""What the seals of parts and of revisions of trees are over: see :mod:`service.database.seals`."""

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


def seal_of_part(connection: Connection, row: Mapping[str, Any] | RowMapping) -> str:
    """The seal that a row of a part with these values has to have."""
    return seal(connection, ["part", *(row[name] for name in PART)])


def seal_of_tree(connection: Connection, row: Mapping[str, Any] | RowMapping) -> str:
    """The seal that a row of a revision with these values has to have."""
    return seal(connection, ["tree", *(row[name] for name in TREE)])
