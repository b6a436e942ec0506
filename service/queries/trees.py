"""Revisions of trees: allocate, resolve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, Self

from sqlalchemy import Connection, Row, Select, bindparam, delete, func, insert, select, update

from service.content.derivation import software
from service.content.integrity import checked
from service.content.tree_summaries import summary_text
from service.database.tables import parts, summary_forms, tree_names, tree_parts, trees
from service.messages.references import Reference
from service.messages.refusals import NotDerived
from service.messages.viewer import ANYBODY, PUBLIC, Viewer
from service.queries.common import insert_missing
from service.queries.owners import seen_by, visible
from service.queries.seals import TREE, seal_of_tree


@dataclass(frozen=True, slots=True)
class Tree:
    """A revision of a tree; ``spec`` (references pinned) and ``summary`` are JSON, that stored as values and ``form``.
    ``is_derived``: this server has coupled it, with ``software``, and stored it as it is.
    """

    name: str
    revision: int
    digest: str
    spec: str
    program: str
    dof: int
    created: str
    based_on: int | None
    summary_values: str
    summary_form: str | None
    form: str | None
    summary_digest: str
    author: str
    owner: str
    visibility: str
    note: str = ""
    joints: str = ""
    mass: float | None = None
    software: str = ""
    seal: str = ""
    is_derived: bool = True

    @classmethod
    def of(cls, connection: Connection, row: Row[Any]) -> Self:
        """Out of a row of all columns."""
        values: list[Any] = [*row, row.seal == seal_of_tree(connection, row._mapping)]
        return cls(*values)

    @property
    def summary(self) -> str:
        """What Model.load needs beside the program, with gravity and instances as shown."""
        return summary_text(self.summary_values, self.form, self.spec)

    @property
    def is_public(self) -> bool:
        """Whether others see it."""
        return self.visibility == PUBLIC


def latest_revision(connection: Connection, name: str) -> int:
    """The latest revision number of a name that is claimed, 0 when there is none."""
    return connection.execute(_LATEST_NUMBER, {"name": name}).scalar_one()


def digest_of(connection: Connection, name: str, revision: int) -> str | None:
    """The digest of the document of a revision; None of one that was removed."""
    return connection.execute(_DIGEST, {"name": name, "number": revision}).scalar()


def add_revision(connection: Connection, tree: Tree, parts: Mapping[str, str]) -> None:
    """Store a new latest revision, coupled here, and which part every instance is; the name is locked."""
    _put_form(connection, tree)
    row = {name: value for name, value in asdict(tree).items() if name in _COLUMNS}
    connection.execute(_NEW, _sealed(connection, row))
    shown = {f"its_{name}": getattr(tree, name) for name in _NARROW}
    connection.execute(_NEW_LATEST, {"of_name": tree.name, "its_latest": tree.revision, **shown})
    _put_parts(connection, tree.name, tree.revision, parts)


def _put_form(connection: Connection, tree: Tree, replace: bool = False) -> None:
    if tree.form:
        insert_missing(connection, summary_forms, [{"digest": tree.summary_form, "content": tree.form}])
        if replace:  # what is there may be damaged
            connection.execute(_FORM_AGAIN, {"of_digest": tree.summary_form, "its_content": tree.form})


def _put_parts(connection: Connection, name: str, revision: int, parts: Mapping[str, str]) -> None:
    key = {"name": name, "revision": revision}
    values = [{**key, "instance": instance, "part": digest} for instance, digest in parts.items()]
    if values:
        connection.execute(_NEW_PART, values)


def resolve(connection: Connection, viewer: Viewer, ref: Reference) -> Tree | None:
    """The revision that a reference means, the latest for a bare name; None when the viewer sees none.

    Raises Refused (``damaged-content``), NotDerived for one that this server has not coupled as it is.
    """
    named = {"name": ref.name, **seen_by(viewer)}
    if ref.digest is not None:
        row = connection.execute(_BY_DIGEST, {**named, "digest": ref.digest}).first()
    elif ref.number is not None:
        row = connection.execute(_BY_NUMBER, {**named, "number": ref.number}).first()
    elif ref.alias is not None:
        return None
    else:
        row = connection.execute(_LATEST, named).first()
    if row is None:
        return None
    tree = Tree.of(connection, row)
    checked(f"the document of tree {tree.name}@{tree.revision}", tree.digest, tree.spec.encode())
    checked(f"the summary of tree {tree.name}@{tree.revision}", tree.summary_digest, tree.summary.encode())
    if not tree.is_derived:
        raise NotDerived("tree", f"{tree.name}@{tree.revision}")
    return tree


def _sealed(connection: Connection, row: Mapping[str, Any]) -> dict[str, Any]:
    """The row of a revision under the seal of this server."""
    mass = row["mass"]
    found = {**row, "mass": None if mass is None else float(mass), "software": row["software"] or software()}
    return {**found, "seal": seal_of_tree(connection, found)}


def remove(connection: Connection, name: str) -> None:
    """Remove all revisions; the name stays its owner's, and later ones count on, so that no number is two trees."""
    for table in (tree_parts, trees):
        connection.execute(delete(table).where(table.c.name == name))
    gone = dict.fromkeys(("created", "dof", "joints", "mass"))
    connection.execute(update(tree_names).where(tree_names.c.name == name).values(**gone))


def all_revisions(connection: Connection, viewer: Viewer) -> list[tuple[str, int]]:
    """Name and number of every revision that a viewer sees."""
    query = select(trees.c.name, trees.c.revision).join(tree_names, tree_names.c.name == trees.c.name)
    query = query.where(_VISIBLE).order_by(trees.c.name, trees.c.revision)
    return [(name, number) for name, number in connection.execute(query, seen_by(viewer))]


def own_revisions(connection: Connection, viewer: Viewer, every: bool = False) -> list[tuple[str, int]]:
    """Name and number of the latest revision of every tree that a viewer may change; ``every``: of all revisions."""
    query = select(trees.c.name, trees.c.revision).join(tree_names, tree_names.c.name == trees.c.name)
    query = query if every else query.where(_IS_LATEST)
    if not viewer.is_admin:
        query = query.where(tree_names.c.owner == viewer.owner)
    ordered = query.order_by(trees.c.name, trees.c.revision)
    return [(name, number) for name, number in connection.execute(ordered)]


def part_programs(connection: Connection, name: str, revision: int) -> tuple[str, ...]:
    """The digests of the programs of the parts of a revision, in the order of the instances' names."""
    query = select(parts.c.program).join(tree_parts, tree_parts.c.part == parts.c.digest)
    query = query.where(tree_parts.c.name == name, tree_parts.c.revision == revision)
    return tuple(connection.execute(query.order_by(tree_parts.c.instance)).scalars())


def with_program(connection: Connection, name: str, digest: str, program: str) -> list[Tree]:
    """The revisions of a tree with this document whose formulas are this program."""
    query = _all().where(trees.c.name == name, trees.c.digest == digest, trees.c.program == program)
    return [Tree.of(connection, row) for row in connection.execute(query.order_by(trees.c.revision))]


def get_damaged(connection: Connection, name: str, revision: int) -> Tree | None:
    """A revision as it is stored, whatever its digests say."""
    named = {"name": name, "number": revision, **seen_by(ANYBODY)}
    row = connection.execute(_BY_NUMBER, named).first()
    return None if row is None else Tree.of(connection, row)


def replace_model(connection: Connection, tree: Tree, made_by: str = "") -> None:
    """Put a tree that was coupled anew in the place of what is stored of the revision; its document stays.

    ``made_by``: the software that did, if not that of this process.
    """
    chosen = (trees.c.name == tree.name) & (trees.c.revision == tree.revision)
    summary = "summary_values", "summary_form", "summary_digest"
    names = ("program", "dof", "joints", "mass", *summary, "software", "seal")
    _put_form(connection, tree, replace=True)
    row = _sealed(connection, {**asdict(tree), "software": made_by})
    connection.execute(update(trees).where(chosen).values({name: row[name] for name in names}))
    shown = {name: getattr(tree, name) for name in _NARROW}
    is_latest = (tree_names.c.name == tree.name) & (tree_names.c.latest == tree.revision)
    connection.execute(update(tree_names).where(is_latest).values(**shown))


def part_digests(connection: Connection, name: str, revision: int) -> dict[str, str]:
    """Which part every instance of a revision is found by."""
    query = select(tree_parts.c.instance, tree_parts.c.part)
    rows = connection.execute(query.where(tree_parts.c.name == name, tree_parts.c.revision == revision))
    return {row.instance: row.part for row in rows}


def put_parts(connection: Connection, name: str, revision: int, parts: Mapping[str, str]) -> None:
    """Write which part every instance of a revision is, over what is there."""
    chosen = (tree_parts.c.name == name) & (tree_parts.c.revision == revision)
    connection.execute(delete(tree_parts).where(chosen))
    _put_parts(connection, name, revision, parts)


def wrong_latest(connection: Connection, tree: Tree) -> list[str]:
    """What searches read of a tree, where this is its latest revision, and is not what is stored of it."""
    columns = [tree_names.c[name] for name in _NARROW]
    chosen = (tree_names.c.name == tree.name) & (tree_names.c.latest == tree.revision)
    row = connection.execute(select(*columns).where(chosen)).first()
    return [] if row is None else [name for name, x in zip(_NARROW, row, strict=True) if x != getattr(tree, name)]


def stale_revisions(connection: Connection) -> list[tuple[str, int]]:
    """Name and number of all revisions that other software has coupled, or that are not as this server stored them."""
    columns = [trees.c[name] for name in TREE]
    rows = connection.execute(select(*columns, trees.c.seal).order_by(trees.c.name, trees.c.revision)).mappings()
    ours = software()
    return [
        (row["name"], row["revision"])
        for row in rows
        if row["software"] != ours or row["seal"] != seal_of_tree(connection, row)
    ]


def count_revisions(connection: Connection) -> tuple[int, int]:
    """How many revisions there are that this software has coupled, and how many in all."""
    count = select(func.count()).select_from(trees)
    done = connection.execute(count.where(trees.c.software == software())).scalar_one()
    return done, connection.execute(count).scalar_one()


def _all() -> Select[Any]:
    columns: list[Any] = [
        summary_forms.c.content if name == "form" else (tree_names if name in _OWNED else trees).c[name]
        for name in Tree.__slots__
        if name not in _MADE
    ]
    found = select(*columns).join_from(trees, tree_names, tree_names.c.name == trees.c.name)
    return found.join(summary_forms, summary_forms.c.digest == trees.c.summary_form, isouter=True)


_OWNED, _MADE = ("owner", "visibility"), ("is_derived",)
_COLUMNS = frozenset(trees.columns.keys())
_VISIBLE, _IS_LATEST = visible(tree_names), tree_names.c.latest == trees.c.revision

# Built once: to build a statement takes longer than to execute it.
_NAMED = _all().where(trees.c.name == bindparam("name"), _VISIBLE)
_BY_DIGEST = _NAMED.where(trees.c.digest == bindparam("digest")).order_by(trees.c.revision).limit(1)
_BY_NUMBER = _NAMED.where(trees.c.revision == bindparam("number"))
_LATEST = _NAMED.where(_IS_LATEST)
#: of all names
LATEST = _all().where(_IS_LATEST, _VISIBLE)
_LATEST_NUMBER = select(tree_names.c.latest).where(tree_names.c.name == bindparam("name"))
_DIGEST = select(trees.c.digest).where(trees.c.name == bindparam("name"), trees.c.revision == bindparam("number"))
_NEW, _NEW_PART = insert(trees), insert(tree_parts)
_FORM_AGAIN = (
    update(summary_forms)
    .where(summary_forms.c.digest == bindparam("of_digest"))
    .values(content=bindparam("its_content"))
)
_NARROW = ("created", "dof", "joints", "mass")  # what searches read of the latest revision
_NEW_LATEST = (
    update(tree_names)
    .where(tree_names.c.name == bindparam("of_name"))
    .values({name: bindparam(f"its_{name}") for name in ("latest", *_NARROW)})
)
