"""Versions of substructures: allocate, resolve, search, yank."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, Connection, Select, and_, bindparam, func, insert, or_, select, update

from service.database.tables import aliases, parts, substructures, tags, versions
from service.integrity import missing
from service.queries.common import now
from service.queries.owners import seen_by, visible
from service.references import Reference
from service.viewer import PUBLIC, Viewer

_NAMES = ("name", "version", "digest", "created", "yanked", "yank_reason", "author")
_DETAILS = ("title", "description", "tags", "dof", "joints", "coordinates", "bodies", "ports", "parameters")
_REPORTS = ("operations", "certificate", "program")
_OWNED = ("owner", "visibility")
_COLUMNS = [
    *(versions.c[name] for name in _NAMES),
    *(parts.c[name] for name in _DETAILS + _REPORTS),
    *(substructures.c[name] for name in _OWNED),
]
_STORED = versions.join(parts, parts.c.digest == versions.c.digest).join(
    substructures, substructures.c.name == versions.c.name
)
_VISIBLE, _IS_LATEST = visible(substructures), substructures.c.latest == versions.c.version
_SORTABLE: dict[str, ColumnElement[Any]] = {
    "name": versions.c.name,
    "dof": parts.c.dof,
    "created": versions.c.created,
}


@dataclass(frozen=True, slots=True)
class Version:
    """A version with what depends on its content; JSON columns as stored text."""

    name: str
    version: int
    digest: str
    created: str
    yanked: str | None
    yank_reason: str | None
    author: str
    title: str
    description: str
    tags: str
    dof: int
    joints: str
    coordinates: str
    bodies: str
    ports: str
    parameters: str
    operations: str
    certificate: str
    program: str
    owner: str
    visibility: str

    @property
    def is_public(self) -> bool:
        """Whether others see it."""
        return self.visibility == PUBLIC


@dataclass(frozen=True, slots=True)
class CatalogueSearch:
    """Which versions to list. All conditions must hold; ``sort`` is a name of ``SORTS``."""

    words: tuple[str, ...] = ()
    tags: tuple[str, ...] = ()
    dof_min: int | None = None
    dof_max: int | None = None
    joints: str | None = None
    owner: str | None = None
    sort: str = "name"


SORTS = tuple(sign + name for name in _SORTABLE for sign in ("", "-"))


def add_version(connection: Connection, name: str, digest: str, author: str) -> tuple[int, bool]:
    """The number of the version with this content, and whether it is new; the name is claimed, and so locked."""
    known = select(versions.c.version).where(versions.c.digest == digest)
    number = connection.execute(known).scalar()
    if number is not None:
        return number, False
    highest = select(func.coalesce(func.max(versions.c.version), 0)).where(versions.c.name == name)
    number = connection.execute(highest).scalar_one() + 1
    connection.execute(insert(versions).values(name=name, version=number, digest=digest, created=now(), author=author))
    _set_latest(connection, name)
    return number, True


def _set_latest(connection: Connection, name: str) -> None:
    highest = select(func.max(versions.c.version)).where(versions.c.name == name, versions.c.yanked.is_(None))
    connection.execute(
        update(substructures).where(substructures.c.name == name).values(latest=highest.scalar_subquery())
    )


def yank(connection: Connection, name: str, version: int, reason: str) -> None:
    """Mark a version as withdrawn; the first mark stays."""
    chosen = and_(versions.c.name == name, versions.c.version == version, versions.c.yanked.is_(None))
    connection.execute(update(versions).where(chosen).values(yanked=now(), yank_reason=reason))
    _set_latest(connection, name)


def resolve(connection: Connection, viewer: Viewer, ref: Reference) -> Version | None:
    """The version that a reference means; None when the viewer sees none (or, for a bare name, all are yanked).

    Raises Refused (``missing-content``) for a version whose content is gone from the store.
    """
    named = {"name": ref.name, **seen_by(viewer)}
    if ref.digest is not None:
        row = connection.execute(_BY_DIGEST, {**named, "digest": ref.digest}).first()
    elif ref.number is not None:
        row = connection.execute(_BY_NUMBER, {**named, "number": ref.number}).first()
    elif ref.alias is not None:
        row = connection.execute(_BY_ALIAS, {**named, "alias": ref.alias}).first()
    else:
        row = connection.execute(_LATEST, named).first()
    if row is None:
        _check_content(connection, viewer, ref)
    return None if row is None else Version(*row)


def _check_content(connection: Connection, viewer: Viewer, ref: Reference) -> None:
    """Raise Refused when what was looked for is a version without its content."""
    gone = select(versions.c.version, versions.c.digest).outerjoin(parts, parts.c.digest == versions.c.digest)
    gone = gone.join(substructures, substructures.c.name == versions.c.name)
    gone = gone.where(versions.c.name == ref.name, parts.c.digest.is_(None), _VISIBLE)
    if ref.number is not None:
        gone = gone.where(versions.c.version == ref.number)
    if ref.digest is not None:
        gone = gone.where(versions.c.digest == ref.digest)
    row = connection.execute(gone.order_by(versions.c.version.desc()).limit(1), seen_by(viewer)).first()
    if row is not None:
        raise missing(f"the definition of {ref.name}@{row.version}", row.digest)


def all_contents(connection: Connection) -> dict[str, str]:
    """The digests of all definitions with the names of their versions; without one if a tree brought it along."""
    query = select(versions.c.digest, versions.c.name, versions.c.version)
    ordered = connection.execute(query.order_by(versions.c.name, versions.c.version))
    named = {digest: f"{name}@{number}" for digest, name, number in ordered}
    others = connection.execute(select(parts.c.digest).order_by(parts.c.digest)).scalars()
    return named | {digest: "" for digest in others if digest not in named}


def all_versions(connection: Connection, viewer: Viewer) -> list[tuple[str, int]]:
    """Name and number of every version that a viewer sees and that is not withdrawn."""
    query = select(versions.c.name, versions.c.version).join(substructures, substructures.c.name == versions.c.name)
    query = query.where(versions.c.yanked.is_(None), _VISIBLE).order_by(versions.c.name, versions.c.version)
    return [(name, number) for name, number in connection.execute(query, seen_by(viewer))]


def page(
    connection: Connection, viewer: Viewer, search: CatalogueSearch, after: tuple[Any, ...] | None, size: int
) -> list[Version]:
    """Up to ``size`` latest versions that follow the position ``after`` (sort value, name) in the order of ``sort``."""
    column = _SORTABLE[search.sort.lstrip("-")]
    descending = search.sort.startswith("-")
    query = _matching(select(*_COLUMNS), search)
    if after is not None:
        value, name = after
        beyond = column < value if descending else column > value
        query = query.where(or_(beyond, and_(column == value, versions.c.name > name)))
    query = query.order_by(column.desc() if descending else column, versions.c.name).limit(size)
    return [Version(*row) for row in connection.execute(query, seen_by(viewer))]


def facets(connection: Connection, viewer: Viewer, search: CatalogueSearch) -> dict[str, dict[str, int]]:
    """How many of the versions found there are for every tag, joint sequence and number of degrees of freedom."""
    return {
        "tags": _counted(connection, viewer, _matching(select(tags.c.tag, func.count()), search, join_tags=True)),
        "joints": _counted(connection, viewer, _matching(select(parts.c.joints, func.count()), search)),
        "dof": _counted(connection, viewer, _matching(select(parts.c.dof, func.count()), search)),
    }


def _counted(connection: Connection, viewer: Viewer, query: Select[Any]) -> dict[str, int]:
    value = query.selected_columns[0]
    rows = connection.execute(query.group_by(value).order_by(value), seen_by(viewer))
    return {str(row[0]): row[1] for row in rows}


def _matching(query: Select[Any], search: CatalogueSearch, join_tags: bool = False) -> Select[Any]:
    query = query.select_from(_STORED.join(tags, tags.c.part == parts.c.digest) if join_tags else _STORED)
    query = query.where(_IS_LATEST, _VISIBLE)
    if search.owner is not None:
        query = query.where(substructures.c.owner == search.owner)
    for word in search.words:
        query = query.where(parts.c.searchable.contains(word.lower(), autoescape=True))
    for tag in search.tags:
        query = query.where(parts.c.digest.in_(select(tags.c.part).where(tags.c.tag == tag)))
    if search.dof_min is not None:
        query = query.where(parts.c.dof >= search.dof_min)
    if search.dof_max is not None:
        query = query.where(parts.c.dof <= search.dof_max)
    if search.joints is not None:
        query = query.where(parts.c.joints == search.joints)
    return query


# Built once: to build a statement takes longer than to execute it.
_NAMED = select(*_COLUMNS).select_from(_STORED).where(versions.c.name == bindparam("name"), _VISIBLE)
_BY_DIGEST = _NAMED.where(versions.c.digest == bindparam("digest"))
_BY_NUMBER = _NAMED.where(versions.c.version == bindparam("number"))
_BY_ALIAS = _NAMED.join(
    aliases, and_(aliases.c.name == versions.c.name, aliases.c.version == versions.c.version)
).where(aliases.c.alias == bindparam("alias"))
_LATEST = _NAMED.where(_IS_LATEST)
