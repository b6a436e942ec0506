"""Names and their owners: of parts and of trees."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

from sqlalchemy import (
    Boolean,
    ColumnElement,
    Connection,
    FromClause,
    Table,
    Text,
    bindparam,
    case,
    cast,
    or_,
    select,
    update,
)

from service.database.tables import substructures, tree_names, tree_parts, versions
from service.messages.viewer import PUBLIC, Viewer
from service.queries.common import insert_missing

AT_A_TIME = 500
CANDIDATES = 1000
Kind = Literal["substructure", "tree"]
_TABLES: dict[Kind, Table] = {"substructure": substructures, "tree": tree_names}
_FIRST: dict[Kind, dict[str, Any]] = {"substructure": {"latest": None}, "tree": {"latest": 0}}


@dataclass(frozen=True, slots=True)
class Ownership:
    """Whose a name is, and whether others see it."""

    owner: str
    visibility: str


def visible(table: FromClause) -> ColumnElement[bool]:
    """The condition that a name is there for a viewer; its values are those of :func:`seen_by`."""
    return or_(table.c.visibility == PUBLIC, table.c.owner == bindparam("viewer"), bindparam("sees_all", type_=Boolean))


def seen_by(viewer: Viewer) -> dict[str, Any]:
    """The values of :func:`visible`."""
    return {"viewer": viewer.owner, "sees_all": viewer.is_admin}


def reference(table: Table, name: ColumnElement[str], number: ColumnElement[int]) -> ColumnElement[str | None]:
    """``name@3`` out of two columns; NULL where the name is none that the viewer of :func:`seen_by` sees."""
    named = table.alias()
    is_seen = select(named.c.name).where(named.c.name == name, visible(named)).exists()
    return case((is_seen, name + "@" + cast(number, Text)))


def ownership(connection: Connection, kind: Kind, name: str) -> Ownership | None:
    """Whose a name is; None for one that is free."""
    row = connection.execute(_OF[kind], {"name": name}).first()
    return None if row is None else Ownership(*row)


def ownerships(connection: Connection, kind: Kind, names: Iterable[str]) -> dict[str, Ownership]:
    """Whose names are, of those that are taken."""
    table, wanted = _TABLES[kind], list(set(names))
    query = select(table.c.name, table.c.owner, table.c.visibility)
    found: dict[str, Ownership] = {}
    for start in range(0, len(wanted), AT_A_TIME):
        rows = connection.execute(query.where(table.c.name.in_(wanted[start : start + AT_A_TIME])))
        found |= {name: Ownership(owner, visibility) for name, owner, visibility in rows}
    return found


def names_like(connection: Connection, viewer: Viewer, kind: Kind, name: str) -> list[str]:
    """Names that a viewer sees and that begin like one that is not there, or, of few, all."""
    table = _TABLES[kind]
    query = select(table.c.name).where(visible(table)).order_by(table.c.name).limit(CANDIDATES)
    query = query.where(table.c.dof.is_not(None)) if kind == "tree" else query  # not of removed ones
    begins = table.c.name.startswith(name[:1].strip("\0").lower(), autoescape=True)
    found = list(connection.execute(query.where(begins), seen_by(viewer)).scalars())
    return found or list(connection.execute(query, seen_by(viewer)).scalars())


def claim(connection: Connection, kind: Kind, name: str, wanted: Ownership) -> Ownership:
    """Whose a name is, that of ``wanted`` if it was free; locks it until the transaction ends."""
    row = {"name": name, "owner": wanted.owner, "visibility": wanted.visibility, **_FIRST[kind]}
    if insert_missing(connection, _TABLES[kind], [row]):
        return wanted
    return Ownership(*connection.execute(_LOCKED[kind], {"name": name}).one())


def change(connection: Connection, kind: Kind, name: str, wanted: Ownership) -> None:
    """Give a name another owner or visibility."""
    table = _TABLES[kind]
    values = {"owner": wanted.owner, "visibility": wanted.visibility}
    connection.execute(update(table).where(table.c.name == name).values(**values))


# Built once: to build a statement takes longer than to execute it.
_OF = {
    kind: select(table.c.owner, table.c.visibility).where(table.c.name == bindparam("name"))
    for kind, table in _TABLES.items()
}
_LOCKED = {kind: query.with_for_update() for kind, query in _OF.items()}


def private_parts(connection: Connection, digests: Iterable[str]) -> dict[str, tuple[str, str]]:
    """Name and owner of those of the parts that are private, by digest."""
    wanted = list(set(digests))
    found: dict[str, tuple[str, str]] = {}
    for start in range(0, len(wanted), AT_A_TIME):
        rows = connection.execute(_PRIVATE, {"digests": wanted[start : start + AT_A_TIME]})
        found |= {digest: (name, owner) for digest, name, owner in rows}
    return found


def private_parts_of_tree(connection: Connection, name: str) -> dict[str, tuple[str, str]]:
    """Name and owner of the private parts in any revision of a tree, by digest."""
    used = select(tree_parts.c.part).where(tree_parts.c.name == name).distinct()
    return private_parts(connection, connection.execute(used).scalars())


def is_version(connection: Connection, name: str, digest: str) -> bool:
    """Whether a name has a version with this content."""
    query = select(versions.c.version).where(versions.c.name == name, versions.c.digest == digest)
    return connection.execute(query).first() is not None


_PRIVATE = (
    select(versions.c.digest, versions.c.name, substructures.c.owner)
    .join(substructures, substructures.c.name == versions.c.name)
    .where(versions.c.digest.in_(bindparam("digests", expanding=True)), substructures.c.visibility != PUBLIC)
)
