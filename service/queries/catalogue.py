"""Versions of substructures: allocate, resolve, withdraw."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

from sqlalchemy import Connection, Row, and_, bindparam, func, insert, select, update

from service.content.integrity import missing
from service.database.tables import aliases, parts, substructures, tree_names, versions
from service.messages.references import Reference
from service.messages.refusals import NotDerived
from service.messages.viewer import PUBLIC, Viewer
from service.queries.common import now
from service.queries.owners import reference, seen_by, visible
from service.queries.seals import seal_of_part, seal_of_version
from service.queries.searching.terms import Term, exchange, stored_terms, terms_of

_NAMES = ("name", "version", "digest", "created", "withdrawn_at", "withdrawal_reason", "author")
_DETAILS = ("title", "description", "tags", "dof", "joints", "mass", "coordinates", "bodies", "ports", "parameters")
_REPORTS = ("operations", "certificate", "program", "software", "index_digest", "seal")
_OWNED = ("owner", "visibility")
COLUMNS = [
    *(versions.c[name] for name in _NAMES),
    *(parts.c[name] for name in _DETAILS + _REPORTS),
    *(substructures.c[name] for name in _OWNED),
    *(versions.c[name] for name in ("note", "origin")),
    reference(substructures, versions.c.derived_name, versions.c.derived_version),
    reference(substructures, versions.c.successor_name, versions.c.successor_version),
    reference(tree_names, versions.c.tree, versions.c.tree_revision),
]
STORED = versions.join(parts, parts.c.digest == versions.c.digest).join(
    substructures, substructures.c.name == versions.c.name
)
#: what searches read of the latest version of a name
_NARROW = (
    versions.c.digest,
    versions.c.created,
    *(parts.c[x] for x in ("dof", "joints", "mass", "searchable", "source")),
)
_VISIBLE, _IS_LATEST = visible(substructures), substructures.c.latest == versions.c.version


@dataclass(frozen=True, slots=True)
class Version:
    """A version with what depends on its content; JSON columns as stored text.

    ``derived_from``, ``successor``, ``tree``: references, None where there is none that the viewer sees;
    ``is_derived``: this server has derived all of it, with ``software``, and stored it as it is.
    """

    name: str
    version: int
    digest: str
    created: str
    withdrawn_at: str | None
    withdrawal_reason: str | None
    author: str
    title: str
    description: str
    tags: str
    dof: int
    joints: str
    mass: float | None
    coordinates: str
    bodies: str
    ports: str
    parameters: str
    operations: str
    certificate: str
    program: str
    software: str
    index_digest: str
    seal: str
    owner: str
    visibility: str
    note: str
    origin: str
    derived_from: str | None
    successor: str | None
    tree: str | None
    is_derived: bool = False

    @classmethod
    def of(cls, connection: Connection, row: Row[Any]) -> Self:
        """Out of a row of :data:`COLUMNS`."""
        values: list[Any] = [*row, row.seal == seal_of_part(connection, row._mapping)]
        return cls(*values)

    @property
    def is_public(self) -> bool:
        """Whether others see it."""
        return self.visibility == PUBLIC


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where a version comes from: ``origin``: what it came as; ``derived_from``: name and number of the version that it
    was made from; ``tree``: name and revision of the tree that was published as it.
    """

    note: str = ""
    origin: str = "definition"
    derived_from: tuple[str, int] | None = None
    tree: tuple[str, int] | None = None

    def values(self) -> dict[str, Any]:
        """Its columns."""
        told: dict[str, Any] = {"note": self.note, "origin": self.origin}
        for given, columns in ((self.derived_from, ("derived_name", "derived_version")), (self.tree, _TREE)):
            told |= dict(zip(columns, given or (None, None), strict=True))
        return told


_TREE = ("tree", "tree_revision")


def add_version(
    connection: Connection, name: str, digest: str, author: str, provenance: Provenance, wanted: int | None = None
) -> tuple[int, bool]:
    """The number of the version with this content, and whether it is new: the one that is ``wanted`` and free, or the
    next; the name is claimed, and so locked."""
    number = connection.execute(_OF_DIGEST, {"of_digest": digest}).scalar()
    if number is not None:
        return number, False
    number = wanted or connection.execute(_HIGHEST, {"of_name": name}).scalar_one() + 1
    row = {"name": name, "version": number, "digest": digest, "created": now(), "author": author}
    connection.execute(_NEW, row | provenance.values() | {"seal": seal_of_version(connection, row)})
    _set_latest(connection, name)
    return number, True


def digest_of_number(connection: Connection, name: str, number: int) -> str | None:
    """The content of a version, None where there is none."""
    found: str | None = connection.execute(_DIGEST, {"of_name": name, "of_version": number}).scalar()
    return found


def _set_latest(connection: Connection, name: str, is_anew: bool = False) -> None:
    """``is_anew``: whatever the name is found by until now."""
    before = connection.execute(_SHOWN, {"of_name": name}).scalar_one()
    latest = connection.execute(_OFFERED, {"of_name": name}).scalar()
    old, new = (
        connection.execute(_OF_LATEST, {"of_name": name, "of_version": each}).first() for each in (before, latest)
    )
    shown = (None,) * len(_NARROW) if new is None else new[: len(_NARROW)]
    values = {f"its_{column.name}": value for column, value in zip(_NARROW, shown, strict=True)}
    connection.execute(_NEW_LATEST, {"of_name": name, "its_latest": latest, **values})
    had, has = (set[Term]() if row is None else terms_of(name, *row[len(_NARROW) :]) for row in (old, new))
    exchange(connection, name, None if is_anew else had, has or set())


def name_of(connection: Connection, digest: str) -> str | None:
    """What a part is called; None of one that a tree brought along."""
    return connection.execute(_NAME_OF, {"of_digest": digest}).scalar()


def show_again(connection: Connection, digest: str) -> None:
    """Let searches find what is stored of a part, where it is the latest version of its name."""
    if (name := name_of(connection, digest)) is not None:
        _set_latest(connection, name, is_anew=True)


def wrong_latest(connection: Connection, digest: str) -> list[str]:
    """What searches read of a part, where it is the latest version of its name, and is not what is stored of it."""
    name = name_of(connection, digest)
    latest = None if name is None else connection.execute(_SHOWN, {"of_name": name}).scalar()
    row = connection.execute(_OF_LATEST, {"of_name": name, "of_version": latest}).first()
    if row is None or row.digest != digest:
        return []
    columns = [substructures.c[column.name] for column in _NARROW]
    shown = connection.execute(select(*columns).where(substructures.c.name == name)).one()
    wrong = [column.name for column, x, y in zip(_NARROW, shown, row, strict=False) if x != y]
    terms = terms_of(name or "", *row[len(_NARROW) :])
    return wrong if stored_terms(connection, name or "") == (terms or set()) else [*wrong, "words, tags and ports"]


def withdraw(
    connection: Connection, name: str, version: int, reason: str, successor: tuple[str, int] | None = None
) -> None:
    """Mark a version as withdrawn; the first mark stays. Until the end nobody else changes the name's versions."""
    connection.execute(_LOCKED, {"of_name": name})
    chosen = and_(versions.c.name == name, versions.c.version == version, versions.c.withdrawn_at.is_(None))
    instead = dict(zip(("successor_name", "successor_version"), successor or (None, None), strict=True))
    connection.execute(update(versions).where(chosen).values(withdrawn_at=now(), withdrawal_reason=reason, **instead))
    _set_latest(connection, name)


def offer(connection: Connection, name: str, version: int) -> None:
    """Take the mark of a version that is withdrawn away, as :func:`withdraw` sets it."""
    connection.execute(_LOCKED, {"of_name": name})
    marks = dict.fromkeys(("withdrawn_at", "withdrawal_reason", "successor_name", "successor_version"))
    chosen = and_(versions.c.name == name, versions.c.version == version)
    connection.execute(update(versions).where(chosen).values(**marks))
    _set_latest(connection, name)


def resolve(connection: Connection, viewer: Viewer, ref: Reference) -> Version | None:
    """The version that a reference means; None when the viewer sees none (or, for a bare name, all are withdrawn).

    Raises Refused (``missing-content``) for a version whose content is gone from the store, NotDerived for one that
    this server has not derived as it is.
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
        return None
    found = Version.of(connection, row)
    if not found.is_derived:
        raise NotDerived("part", found.digest)
    return found


def last(connection: Connection, viewer: Viewer, name: str) -> Version | None:
    """The version of a name with the highest number, withdrawn or not; None when the viewer sees none."""
    row = connection.execute(_LAST, {"name": name, **seen_by(viewer)}).first()
    return None if row is None else Version.of(connection, row)


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


def own_contents(connection: Connection, viewer: Viewer) -> dict[str, str]:
    """The digests of the latest versions that a viewer may change, with their names."""
    query = select(substructures.c.digest, substructures.c.name, substructures.c.latest)
    query = query.where(substructures.c.latest.is_not(None)).order_by(substructures.c.name)
    if not viewer.is_admin:
        query = query.where(substructures.c.owner == viewer.owner)
    return {digest: f"{name}@{number}" for digest, name, number in connection.execute(query)}


def all_versions(connection: Connection, viewer: Viewer) -> list[tuple[str, int]]:
    """Name and number of every version that a viewer sees and that is not withdrawn."""
    query = select(versions.c.name, versions.c.version).join(substructures, substructures.c.name == versions.c.name)
    query = query.where(versions.c.withdrawn_at.is_(None), _VISIBLE).order_by(versions.c.name, versions.c.version)
    return [(name, number) for name, number in connection.execute(query, seen_by(viewer))]


# Built once: to build a statement takes longer than to execute it.
_NAMED = select(*COLUMNS).select_from(STORED).where(versions.c.name == bindparam("name"), _VISIBLE)
_BY_DIGEST = _NAMED.where(versions.c.digest == bindparam("digest"))
_BY_NUMBER = _NAMED.where(versions.c.version == bindparam("number"))
_BY_ALIAS = _NAMED.join(
    aliases, and_(aliases.c.name == versions.c.name, aliases.c.version == versions.c.version)
).where(aliases.c.alias == bindparam("alias"))
_LATEST = _NAMED.where(_IS_LATEST)
_LAST = _NAMED.order_by(versions.c.version.desc()).limit(1)
_NEW = insert(versions)
_OF_DIGEST = select(versions.c.version).where(versions.c.digest == bindparam("of_digest"))
_NAME_OF = select(versions.c.name).where(versions.c.digest == bindparam("of_digest"))
_IS_OF_NAME = versions.c.name == bindparam("of_name")
_HIGHEST = select(func.coalesce(func.max(versions.c.version), 0)).where(_IS_OF_NAME)
_OFFERED = (  # from the highest number down: of 10,000 versions one row is read
    select(versions.c.version)
    .where(_IS_OF_NAME, versions.c.withdrawn_at.is_(None))
    .order_by(versions.c.version.desc())
    .limit(1)
)
_DIGEST = select(versions.c.digest).where(_IS_OF_NAME, versions.c.version == bindparam("of_version"))
_SHOWN = select(substructures.c.latest).where(substructures.c.name == bindparam("of_name"))
_LOCKED = _SHOWN.with_for_update()
_OF_LATEST = (
    select(*_NARROW, parts.c.title, parts.c.tags, parts.c.ports)
    .join(parts, parts.c.digest == versions.c.digest)
    .where(_IS_OF_NAME, versions.c.version == bindparam("of_version"))
)
_NEW_LATEST = (
    update(substructures)
    .where(substructures.c.name == bindparam("of_name"))
    .values({name: bindparam(f"its_{name}") for name in ("latest", *(column.name for column in _NARROW))})
)
