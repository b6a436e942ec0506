"""All versions of a part and all revisions of a tree, the newest first; seals of the numbers of versions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, Select, bindparam, func, select, update

from service.database.tables import parts, substructures, tree_names, trees, versions
from service.messages.viewer import Viewer
from service.queries.owners import reference, seen_by, visible
from service.queries.seals import VERSION, seal_of_version


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


def wrong_number(connection: Connection, digest: str, is_sealed: bool) -> str:
    """What is wrong with the name and number of a content by the seal that they have to have, empty where nothing is or
    it has none; ``is_sealed``: one without a seal is wrong, too.
    """
    row = connection.execute(_NUMBERS.where(versions.c.digest == digest)).mappings().first()
    if row is None or row["seal"] == seal_of_version(connection, row) or not (row["seal"] or is_sealed):
        return ""
    name, found = row["name"], f"{row['name']}@{row['version']}"
    others = connection.execute(_NUMBERS.where(versions.c.name == name)).mappings().all()
    seals = {x["seal"] for x in others}
    was = [x["version"] for x in others if seal_of_version(connection, {**x, "digest": digest}) in seals]
    told = f"it was {name}@{was[0]}, and is {found} now" if was else f"its number {found} does not have its seal"
    return f"{told}: contents of versions were exchanged in the store; restore a backup"


def seal_numbers(connection: Connection) -> int:
    """Seal names and numbers of all contents as they are: of how many that was to be done."""
    rows = connection.execute(_NUMBERS).mappings().all()
    right = [{"of_name": x["name"], "of_version": x["version"], "its": seal_of_version(connection, x)} for x in rows]
    wrong = [new for new, row in zip(right, rows, strict=True) if new["its"] != row["seal"]]
    if wrong:
        connection.execute(_SEAL, wrong)
    return len(wrong)


_NUMBERS = select(*(versions.c[name] for name in (*VERSION, "seal")))
_SEAL = (
    update(versions)
    .where(versions.c.name == bindparam("of_name"), versions.c.version == bindparam("of_version"))
    .values(seal=bindparam("its"))
)
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
