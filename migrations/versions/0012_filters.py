"""Ports, masses and sources of parts, and the latest revision of every tree in a narrow row, so that both are found."""

from __future__ import annotations

import ast
import json
import math
from collections.abc import Callable, Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from functools import lru_cache
from typing import Any

import flint
import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"

AT_A_TIME = 500
READ = ("latest", "visibility", "owner", "dof", "joints", "mass", "number")
SHELVES = {"substructures": ("digest",), "tree_names": ()}
OPERATIONS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: lambda x, y: x + y,
    ast.Sub: lambda x, y: x - y,
    ast.Mult: lambda x, y: x * y,
    ast.Div: lambda x, y: x / y,
    ast.Pow: lambda x, y: x**y,
}
FUNCTIONS = ("sin", "cos", "tan", "sqrt", "exp", "log", "asin", "acos", "atan")
SOURCES = "UPDATE substructures SET source = (SELECT source FROM parts p WHERE p.digest = substructures.digest)"
MASSES = "UPDATE substructures SET mass = (SELECT mass FROM parts p WHERE p.digest = substructures.digest)"
LATEST = """
UPDATE tree_names SET (created, dof, joints, mass) = (
  SELECT t.created, t.dof, t.joints, t.mass FROM trees t
  WHERE t.name = tree_names.name AND t.revision = tree_names.latest)
"""
SQLITE = (
    "DROP TRIGGER substructures_numbered",
    "DROP TRIGGER substructures_worded",
    "DROP TABLE substructure_words",
    """CREATE VIRTUAL TABLE substructure_words USING
       fts5(searchable, source, content='substructures', content_rowid='number', tokenize='trigram')""",
    "INSERT INTO substructure_words (substructure_words) VALUES ('rebuild')",
    """CREATE TRIGGER substructures_numbered AFTER INSERT ON substructures BEGIN
         UPDATE substructures SET number = (SELECT coalesce(max(number), 0) + 1 FROM substructures)
         WHERE name = new.name;
         INSERT INTO substructure_words (rowid, searchable, source)
         SELECT number, searchable, source FROM substructures WHERE name = new.name;
       END""",
    """CREATE TRIGGER substructures_worded AFTER UPDATE OF searchable, source ON substructures BEGIN
         INSERT INTO substructure_words (substructure_words, rowid, searchable, source)
         VALUES ('delete', old.number, old.searchable, old.source);
         INSERT INTO substructure_words (rowid, searchable, source) VALUES (new.number, new.searchable, new.source);
       END""",
    "UPDATE tree_names SET number = rowid",
    """CREATE VIRTUAL TABLE tree_words USING
       fts5(name, content='tree_names', content_rowid='number', tokenize='trigram')""",
    "INSERT INTO tree_words (tree_words) VALUES ('rebuild')",
    """CREATE TRIGGER tree_names_numbered AFTER INSERT ON tree_names BEGIN
         UPDATE tree_names SET number = (SELECT coalesce(max(number), 0) + 1 FROM tree_names) WHERE name = new.name;
         INSERT INTO tree_words (rowid, name) SELECT number, name FROM tree_names WHERE name = new.name;
       END""",
)
POSTGRESQL = (
    """DO $$ BEGIN
         CREATE EXTENSION IF NOT EXISTS pg_trgm;
         CREATE INDEX substructure_sources ON substructures USING gin (source gin_trgm_ops);
         CREATE INDEX tree_words ON tree_names USING gin (name gin_trgm_ops);
       EXCEPTION WHEN insufficient_privilege OR undefined_file OR feature_not_supported THEN
         RAISE NOTICE 'no pg_trgm: search reads every name';
       END $$""",
)


def upgrade() -> None:
    """Add the columns, fill them, and index them."""
    _create()
    connection = op.get_bind()
    _fill_parts(connection)
    _fill_trees(connection)
    for statement in (SOURCES, MASSES, LATEST):
        op.execute(statement)
    is_sqlite = connection.dialect.name == "sqlite"
    _index(is_sqlite)
    for statement in SQLITE if is_sqlite else POSTGRESQL:
        op.execute(statement)


def _create() -> None:
    op.add_column("parts", sa.Column("source", sa.Text(), nullable=False, server_default=""))
    op.add_column("trees", sa.Column("joints", sa.Text(), nullable=False, server_default=""))
    op.add_column("substructures", sa.Column("source", sa.Text(), nullable=True))
    for table in ("parts", "trees", *SHELVES):
        op.add_column(table, sa.Column("mass", sa.Float(), nullable=True))
    for name, kind in {"created": sa.Text, "dof": sa.Integer, "joints": sa.Text, "number": sa.Integer}.items():
        op.add_column("tree_names", sa.Column(name, kind(), nullable=True))
    op.create_table(
        "part_ports",
        sa.Column("port", sa.Text(), nullable=False),
        sa.Column("part", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["part"], ["parts.digest"], name=op.f("fk_part_ports_part_parts")),
        sa.PrimaryKeyConstraint("port", "part", name=op.f("pk_part_ports")),
    )


def _index(is_sqlite: bool) -> None:
    """On SQLite a search reads nothing but an index, which would be too wide for PostgreSQL."""
    for table, more in SHELVES.items():
        for sort in ("name", "dof", "created") if is_sqlite else ():
            if table == "substructures" and sort != "name":
                op.drop_index(op.f(f"ix_{table}_{sort}"), table)
            op.create_index(op.f(f"ix_{table}_{sort}"), table, list(dict.fromkeys((sort, "name", *READ, *more))))
    for sort in () if is_sqlite else ("dof", "created"):
        op.create_index(op.f(f"ix_tree_names_{sort}"), "tree_names", [sort, "name"])
    op.create_index(op.f("ix_tree_names_number"), "tree_names", ["number"], unique=True)


def _fill_parts(connection: sa.Connection) -> None:
    names = ("digest", "definition", "parameters", "ports", "certificate")
    parts = sa.table("parts", *map(sa.column, (*names, "source", "mass")))
    told: dict[str, Any] = {"source": sa.bindparam("its_source"), "mass": sa.bindparam("its_mass")}
    filled = sa.update(parts).where(parts.c.digest == sa.bindparam("its_digest")).values(told)
    ports = sa.insert(sa.table("part_ports", sa.column("port"), sa.column("part")))
    for rows in _batches(connection, [parts.c[name] for name in names], parts.c.digest):
        found = [_part(row) for row in rows]
        connection.execute(filled, [values for values, _ in found])
        named = [{"port": port, "part": values["its_digest"]} for values, some in found for port in some]
        if named:
            connection.execute(ports, named)


def _batches(connection: sa.Connection, columns: list[Any], key: Any) -> Iterator[list[Any]]:
    query, last = sa.select(*columns).order_by(key).limit(AT_A_TIME), ""
    while rows := list(connection.execute(query.where(key > last)).all()):
        yield rows
        last = rows[-1][0]


def _part(row: Any) -> tuple[dict[str, Any], list[str]]:
    """Source, mass and ports of a part; nothing of one that is damaged."""
    digest, definition, parameters, ports, certificate = row
    told: dict[str, Any] = {"its_digest": digest, "its_source": "", "its_mass": None}
    try:
        document = _read(definition)
        told["its_source"] = str(document.get("source", "")).lower().replace("\0", "")
        names = _Values({name: each["value"] for name, each in _read(parameters).items()})
        told["its_mass"] = _total((text, names) for text in _masses(document, certificate))
        return told, list(dict.fromkeys(map(str, _read(ports))))
    except Exception:  # whoever reads it refuses it by name
        return told, []


def _masses(document: Mapping[str, Any], certificate: str) -> list[Any]:
    """The masses of bodies, numbers or expressions in SI."""
    given = [body.get("mass", 0) for body in document.get("bodies", ())]
    return [x if not isinstance(x, dict) else _si(certificate)[f"/bodies/{k}/mass"] for k, x in enumerate(given)]


def _si(certificate: str) -> dict[str, Any]:
    """What was converted to SI, by its place."""
    return {each["pointer"]: each["si"] for each in _read(certificate).get("converted", ())}


def _fill_trees(connection: sa.Connection) -> None:
    names = ("name", "revision", "spec", "summary")
    trees = sa.table("trees", *map(sa.column, (*names, "joints", "mass")))
    keys = connection.execute(sa.select(trees.c.name, trees.c.revision)).all()
    for name, number in keys:
        chosen = (trees.c.name == name) & (trees.c.revision == number)
        spec, summary = connection.execute(sa.select(trees.c.spec, trees.c.summary).where(chosen)).one()
        told = _tree(connection, name, number, spec, summary)
        connection.execute(sa.update(trees).where(chosen).values(told))


def _tree(connection: sa.Connection, name: str, number: int, spec: str, summary: str) -> dict[str, Any]:
    """Joints and mass of a revision; nothing of one that is damaged."""
    try:
        document, told = _read(spec), _read(summary)
        converted = {each["pointer"]: each["si"] for each in told["certificate"].get("converted", ())}
        texts: dict[str, Any] = {}
        for each, parameter in document.get("parameters", {}).items():
            texts[each] = _in_si(parameter.get("value"), converted, f"/parameters/{each}/value")
        masses: list[tuple[Any, str]] = []
        parts: dict[str, str] = dict(map(tuple, connection.execute(PARTS, {"name": name, "revision": number})))
        for k, instance in enumerate(document.get("instances", ())):
            own = instance["name"]
            definition, parameters, certificate = connection.execute(PART, {"digest": parts[own]}).one()
            texts |= {f"{own}.{each}": shown["value"] for each, shown in _read(parameters).items()}
            for each, given in instance.get("parameters", {}).items():
                texts[f"{own}.{each}"] = _in_si(given, converted, f"/instances/{k}/parameters/{each}")
            masses += [(text, f"{own}.") for text in _masses(_read(definition), certificate)]
        names = _Values(texts)
        return {"joints": str(told["joints"]), "mass": _total((text, names.of(own)) for text, own in masses)}
    except Exception:
        return {"joints": "", "mass": None}


PARTS = sa.text("SELECT instance, part FROM tree_parts WHERE name = :name AND revision = :revision")
PART = sa.text("SELECT definition, parameters, certificate FROM parts WHERE digest = :digest")


def _in_si(given: Any, converted: Mapping[str, Any], pointer: str) -> Any:
    return converted.get(pointer, given["value"]) if isinstance(given, dict) else given


def _read(text: str) -> Any:
    return json.loads(text, parse_float=Decimal)


class _Values:
    """Values of parameters by name, computed when asked for."""

    def __init__(self, texts: Mapping[str, Any], prefix: str = "", found: dict[str, Any] | None = None) -> None:
        self._texts, self._prefix, self._found = texts, prefix, {} if found is None else found

    def of(self, prefix: str) -> _Values:
        """Those of an instance by their own names."""
        return _Values(self._texts, prefix, self._found)

    def get(self, name: str) -> Any:
        """The value. Raises KeyError, or what evaluating raises."""
        name = self._prefix + name
        if name not in self._found:
            self._found[name] = _value(self._texts[name], _Values(self._texts, "", self._found))
        return self._found[name]


def _total(masses: Iterator[tuple[Any, _Values]]) -> float | None:
    """The sum; None where a parameter has no value, or an expression is none that is read here."""
    try:
        with flint.ctx.workprec(128):
            total = float(sum((_value(text, names) for text, names in masses), flint.arb(0)))
    except Exception:
        return None
    return total if math.isfinite(total) else None


def _value(given: Any, names: _Values) -> Any:
    if not isinstance(given, str):
        return _number(Fraction(given))
    return _node(_tree_of(given), names)


@lru_cache(maxsize=10_000)
def _tree_of(text: str) -> Any:
    """The syntax of an expression, which is that of Python but for the sign of powers. Nothing is executed."""
    return ast.parse(text.strip().replace("^", "**"), mode="eval").body


def _node(node: Any, names: _Values) -> Any:
    match node:
        case ast.Constant(value=int() | float()):
            return _number(Fraction(repr(node.value)))
        case ast.Name(id="pi"):
            return flint.arb.pi()
        case ast.Name(id=name):
            return names.get(name)
        case ast.Attribute(value=ast.Name(id=instance), attr=name):
            return names.get(f"{instance}.{name}")
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_node(operand, names)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _node(operand, names)
        case ast.BinOp(left=left, op=sign, right=right):
            return OPERATIONS[type(sign)](_node(left, names), _node(right, names))
        case ast.Call(func=ast.Name(id=name), args=[argument], keywords=[]) if name in FUNCTIONS:
            return getattr(_node(argument, names), name)()
    raise ValueError("not known here")


def _number(x: Fraction) -> Any:
    return flint.arb(flint.fmpq(x.numerator, x.denominator))
