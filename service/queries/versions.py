"""All versions of a part and all revisions of a tree, the newest first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, Select, func, select

from service.database.tables import parts, substructures, tree_names, trees, versions
from service.messages.viewer import Viewer
from service.queries.owners import reference, seen_by, visible


@dataclass(frozen=True, slots=True)
class VersionEntry:
    """A version in the list of its name; ``operations`` is JSON; ``before``: the version before, None of the first."""

    name: str
    version: int
    digest: str
    created: str
    author: str
    owner: str
    note: str
    origin: str
    derived_from: str | None
    tree: str | None
    dof: int
    operations: str
    withdrawn_at: str | None
    withdrawal_reason: str | None
    successor: str | None
    before: int | None


@dataclass(frozen=True, slots=True)
class RevisionEntry:
    """A revision in the list of its tree."""

    name: str
    revision: int
    digest: str
    created: str
    author: str
    owner: str
    note: str
    based_on: int | None
    dof: int


def page_versions(
    connection: Connection, viewer: Viewer, name: str, before: int | None, size: int
) -> list[VersionEntry]:
    """Up to ``size`` versions that a viewer sees, of lower numbers than ``before``."""
    query = _VERSIONS.where(versions.c.name == name)
    if before is not None:
        query = query.where(versions.c.version < before)
    rows = connection.execute(query.order_by(versions.c.version.desc()).limit(size), seen_by(viewer))
    return [VersionEntry(*row) for row in rows]


def page_revisions(
    connection: Connection, viewer: Viewer, name: str, before: int | None, size: int
) -> list[RevisionEntry]:
    """Up to ``size`` revisions that a viewer sees, of lower numbers than ``before``."""
    query = _REVISIONS.where(trees.c.name == name)
    if before is not None:
        query = query.where(trees.c.revision < before)
    rows = connection.execute(query.order_by(trees.c.revision.desc()).limit(size), seen_by(viewer))
    return [RevisionEntry(*row) for row in rows]


_EARLIER = versions.alias("earlier")
_VERSIONS: Select[Any] = (
    select(
        *(versions.c[name] for name in ("name", "version", "digest", "created", "author")),
        substructures.c.owner,
        *(versions.c[name] for name in ("note", "origin")),
        reference(substructures, versions.c.derived_name, versions.c.derived_version),
        reference(tree_names, versions.c.tree, versions.c.tree_revision),
        *(parts.c[name] for name in ("dof", "operations")),
        *(versions.c[name] for name in ("withdrawn_at", "withdrawal_reason")),
        reference(substructures, versions.c.successor_name, versions.c.successor_version),
        select(func.max(_EARLIER.c.version))
        .where(_EARLIER.c.name == versions.c.name, _EARLIER.c.version < versions.c.version)
        .correlate(versions)
        .scalar_subquery(),
    )
    .select_from(
        versions.join(parts, parts.c.digest == versions.c.digest).join(
            substructures, substructures.c.name == versions.c.name
        )
    )
    .where(visible(substructures))
)
_REVISIONS: Select[Any] = (
    select(
        *(trees.c[name] for name in ("name", "revision", "digest", "created", "author")),
        tree_names.c.owner,
        *(trees.c[name] for name in ("note", "based_on", "dof")),
    )
    .join(tree_names, tree_names.c.name == trees.c.name)
    .where(visible(tree_names))
)
