"""What parts are used for: trees that have them as instances, parts that such trees became, parts made from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from sqlalchemy import BindParameter, ColumnElement, Connection, Select, bindparam, select, tuple_

from service.database.tables import part_uses, parts, substructures, tree_names, tree_parts, versions
from service.messages.viewer import Viewer
from service.queries.owners import private_parts, reference, seen_by, visible

#: how something uses a part, in the order of pages
KINDS = ("derived", "part", "tree")
#: kind, name, number
Position = tuple[str, str, int]


@dataclass(frozen=True, slots=True)
class Use:
    """``kind``: ``derived``: a version that was made from the part; ``part``: one that is a published tree with it;
    ``tree``: a revision of a tree. ``instances``: by name the version that they are.
    """

    kind: str
    name: str
    number: int
    instances: Mapping[str, int]


@dataclass(frozen=True, slots=True)
class Withdrawn:
    """An instance of a tree whose part is withdrawn; ``cell.arm``: one of the published tree that ``cell`` is."""

    instance: str
    name: str
    version: int
    reason: str
    successor: str | None


def put(connection: Connection, part: str, uses: Mapping[str, str]) -> None:
    """Note the digests of the parts that a new part is built of, by instance; those that are stored."""
    if not uses:
        return
    known = connection.execute(select(parts.c.digest).where(parts.c.digest.in_(list(uses.values())))).scalars()
    stored = set(known)
    rows = [{"part": part, "instance": name, "used": digest} for name, digest in uses.items() if digest in stored]
    if rows:
        connection.execute(part_uses.insert(), rows)


def page(
    connection: Connection, viewer: Viewer, name: str, version: int | None, after: Position | None, size: int
) -> list[Use]:
    """Up to ``size`` uses that a viewer sees, of one version or of all, which follow the position ``after``."""
    found: list[Use] = []
    for kind in KINDS:
        if (after is None or kind >= after[0]) and len(found) < size:
            start = after[1:] if after is not None and kind == after[0] else None
            found += _of_kind(connection, viewer, kind, (name, version), start, size - len(found))
    return found


def _of_kind(
    connection: Connection,
    viewer: Viewer,
    kind: str,
    part: tuple[str, int | None],
    after: tuple[str, int] | None,
    size: int,
) -> list[Use]:
    name, number, instance, used, query = _rows(kind, part[1] is not None)
    given = {"part": part[0], "version": part[1], "size": size, **seen_by(viewer)}
    places = _places(kind, part[1] is not None)
    if after is not None:
        places = places.where(tuple_(name, number) > tuple_(*after))
    keys: list[tuple[str, int]] = [(row[0], row[1]) for row in connection.execute(places, given)]
    instances: dict[Any, dict[str, int]] = {key: {} for key in keys}
    if instance is not None and keys:
        chosen = query.where(tuple_(name, number).in_(keys)).order_by(instance)
        for *key, label, version in connection.execute(chosen.with_only_columns(name, number, instance, used), given):
            instances[tuple(key)][label] = version
    return [Use(kind, *key, instances[key]) for key in keys]


@cache
def _places(kind: str, of_version: bool) -> Select[Any]:
    """Names and numbers of what uses ``part``, perhaps only its ``version``; ``size`` at most."""
    name, number, _, _, query = _rows(kind, of_version)
    return query.with_only_columns(name, number).distinct().order_by(name, number).limit(bindparam("size"))


@cache
def _rows(kind: str, of_version: bool) -> tuple[Any, Any, Any, Any, Select[Any]]:
    """Columns of name, number, instance and version of the part, and the rows that they are of."""
    part: BindParameter[str] = bindparam("part")
    version: BindParameter[int] = bindparam("version")
    if kind == "tree":
        joined = tree_parts.join(versions, versions.c.digest == tree_parts.c.part)
        joined = joined.join(tree_names, tree_names.c.name == tree_parts.c.name)
        query = select(tree_parts.c.name).select_from(joined).where(visible(tree_names), versions.c.name == part)
        query = query.where(versions.c.version == version) if of_version else query
        return tree_parts.c.name, tree_parts.c.revision, tree_parts.c.instance, versions.c.version, query
    whole = versions.alias()
    seen = whole.join(substructures, substructures.c.name == whole.c.name)
    if kind == "derived":
        query = select(whole.c.name).select_from(seen).where(visible(substructures), whole.c.derived_name == part)
        query = query.where(whole.c.derived_version == version) if of_version else query
        return whole.c.name, whole.c.version, None, None, query
    joined = seen.join(part_uses, part_uses.c.part == whole.c.digest)
    joined = joined.join(versions, versions.c.digest == part_uses.c.used)
    query = select(whole.c.name).select_from(joined).where(visible(substructures), versions.c.name == part)
    query = query.where(versions.c.version == version) if of_version else query
    return whole.c.name, whole.c.version, part_uses.c.instance, versions.c.version, query


def private_parts_of(connection: Connection, name: str) -> dict[str, tuple[str, str]]:
    """Name and owner of the private parts that versions of a name are built of, by digest."""
    used = select(part_uses.c.used).join(versions, versions.c.digest == part_uses.c.part)
    return private_parts(connection, connection.execute(used.where(versions.c.name == name).distinct()).scalars())


def withdrawn(connection: Connection, viewer: Viewer, tree: str, revision: int) -> Sequence[Withdrawn]:
    """The instances of a revision of a tree whose parts are withdrawn, as far as the viewer sees these."""
    return _withdrawn(connection, viewer, _OF_TREE, {"tree": tree, "revision": revision})


def withdrawn_in_part(connection: Connection, viewer: Viewer, digest: str) -> Sequence[Withdrawn]:
    """The same of a part that is a published tree."""
    return _withdrawn(connection, viewer, _OF_PART, {"digest": digest})


def _withdrawn(
    connection: Connection, viewer: Viewer, query: Select[Any], given: Mapping[str, Any]
) -> Sequence[Withdrawn]:
    rows = connection.execute(query, {**given, **seen_by(viewer)})
    return [
        Withdrawn(instance, name, version, reason or "", instead) for instance, name, version, reason, instead in rows
    ]


def _withdrawn_rows(instance: ColumnElement[str], used: ColumnElement[str], chosen: ColumnElement[bool]) -> Select[Any]:
    """Of the parts that are used, and of those that these are built of, as far as it goes: ``arm.wrist``."""
    direct = select(instance.label("instance"), used.label("part")).where(chosen).cte("used", recursive=True)
    deeper = select(direct.c.instance + "." + part_uses.c.instance, part_uses.c.used)
    all_used = direct.union(deeper.join(direct, direct.c.part == part_uses.c.part))
    successor = reference(substructures, versions.c.successor_name, versions.c.successor_version)
    columns = (all_used.c.instance, versions.c.name, versions.c.version, versions.c.withdrawal_reason, successor)
    joined = all_used.join(versions, versions.c.digest == all_used.c.part)
    joined = joined.join(substructures, substructures.c.name == versions.c.name)
    query: Select[Any] = select(*columns).select_from(joined).where(versions.c.withdrawn_at.is_not(None))
    return query.where(visible(substructures)).order_by(all_used.c.instance)


_OF_TREE = _withdrawn_rows(
    tree_parts.c.instance,
    tree_parts.c.part,
    (tree_parts.c.name == bindparam("tree")) & (tree_parts.c.revision == bindparam("revision")),
)
_OF_PART = _withdrawn_rows(part_uses.c.instance, part_uses.c.used, part_uses.c.part == bindparam("digest"))
