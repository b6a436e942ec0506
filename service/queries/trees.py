"""Revisions of trees: allocate, resolve, list."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from sqlalchemy import Connection, Select, and_, bindparam, insert, select, update

from service.database.tables import tree_names, tree_parts, trees
from service.integrity import checked
from service.queries.common import insert_missing
from service.references import Reference


@dataclass(frozen=True, slots=True)
class Tree:
    """A revision of a tree; ``spec`` (references pinned) and ``summary`` are JSON."""

    name: str
    revision: int
    digest: str
    spec: str
    program: str
    dof: int
    summary: str
    created: str
    based_on: int | None
    summary_digest: str


def lock_name(connection: Connection, name: str) -> int:
    """The latest revision number of a name, 0 when there is none; locks it until the transaction ends."""
    insert_missing(connection, tree_names, [{"name": name, "latest": 0}])
    return connection.execute(_LOCKED, {"name": name}).scalar_one()


def add_revision(connection: Connection, tree: Tree, parts: Mapping[str, str]) -> None:
    """Store a new latest revision and which part every instance is; the name is locked."""
    connection.execute(_NEW, asdict(tree))
    connection.execute(_NEW_LATEST, {"of_name": tree.name, "number": tree.revision})
    key = {"name": tree.name, "revision": tree.revision}
    values = [{**key, "instance": instance, "part": digest} for instance, digest in parts.items()]
    if values:
        connection.execute(_NEW_PART, values)


def resolve(connection: Connection, ref: Reference) -> Tree | None:
    """The revision that a reference means, the latest for a bare name. Raises Refused (``damaged-content``)."""
    if ref.digest is not None:
        row = connection.execute(_BY_DIGEST, {"name": ref.name, "digest": ref.digest}).first()
    elif ref.number is not None:
        row = connection.execute(_BY_NUMBER, {"name": ref.name, "number": ref.number}).first()
    elif ref.alias is not None:
        return None
    else:
        row = connection.execute(_LATEST, {"name": ref.name}).first()
    if row is None:
        return None
    tree = Tree(*row)
    checked(f"the document of tree {tree.name}@{tree.revision}", tree.digest, tree.spec.encode())
    checked(f"the summary of tree {tree.name}@{tree.revision}", tree.summary_digest, tree.summary.encode())
    return tree


def all_revisions(connection: Connection) -> list[tuple[str, int]]:
    """Name and number of every revision."""
    query = select(trees.c.name, trees.c.revision).order_by(trees.c.name, trees.c.revision)
    return [(name, number) for name, number in connection.execute(query)]


def get_damaged(connection: Connection, name: str, revision: int) -> Tree | None:
    """A revision as it is stored, whatever its digests say."""
    row = connection.execute(_BY_NUMBER, {"name": name, "number": revision}).first()
    return None if row is None else Tree(*row)


def replace_model(connection: Connection, tree: Tree) -> None:
    """Put a tree that was coupled anew in the place of what is stored of the revision; its document stays."""
    chosen = (trees.c.name == tree.name) & (trees.c.revision == tree.revision)
    names = ("program", "dof", "summary", "summary_digest")
    values = {name: getattr(tree, name) for name in names}
    connection.execute(update(trees).where(chosen).values(**values))


def page(connection: Connection, after: str | None, size: int) -> list[Tree]:
    """Up to ``size`` latest revisions whose names follow ``after``."""
    query = _all().join(tree_names, _is_latest())
    if after is not None:
        query = query.where(trees.c.name > after)
    return [Tree(*row) for row in connection.execute(query.order_by(trees.c.name).limit(size))]


def _all() -> Select[Any]:
    return select(*(trees.c[name] for name in Tree.__slots__))


def _is_latest() -> Any:
    return and_(tree_names.c.name == trees.c.name, tree_names.c.latest == trees.c.revision)


# Built once: to build a statement takes longer than to execute it.
_NAMED = _all().where(trees.c.name == bindparam("name"))
_BY_DIGEST = _NAMED.where(trees.c.digest == bindparam("digest")).order_by(trees.c.revision).limit(1)
_BY_NUMBER = _NAMED.where(trees.c.revision == bindparam("number"))
_LATEST = _NAMED.join(tree_names, _is_latest())
_LOCKED = select(tree_names.c.latest).where(tree_names.c.name == bindparam("name")).with_for_update()
_NEW, _NEW_PART = insert(trees), insert(tree_parts)
_NEW_LATEST = update(tree_names).where(tree_names.c.name == bindparam("of_name")).values(latest=bindparam("number"))
