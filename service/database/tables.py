"""Tables of the store (SQLAlchemy Core).

Parts and programs are content: immutable, named by their sha256, written at most once. Versions, tree revisions and
aliases are names that point to content. JSON and times are TEXT, because STRICT tables and exact decimals bear
neither SQLAlchemy's JSON nor its DATETIME type; times are UTC as ``2026-01-31T12:00:00.000000Z`` and sort as text.

::

    substructures --< versions >-- parts --- programs
        |  '--< aliases --< history   '--< part_uses >-- parts
        '--< search_terms
    tree_names --< trees --< tree_parts >-- parts
                     |'------------------ programs
                     '------------------- summary_forms
"""

from __future__ import annotations

from sqlalchemy import (
    BigInteger,
    Column,
    Float,
    ForeignKey,
    ForeignKeyConstraint,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    Table,
    Text,
    UniqueConstraint,
)

metadata = MetaData(
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s_%(referred_table_name)s",
        "pk": "pk_%(table_name)s",
    }
)


def _text(name: str, *arguments: ForeignKey, primary_key: bool = False, nullable: bool = False) -> Column[str]:
    return Column(name, Text, *arguments, primary_key=primary_key, nullable=nullable)


def _number(name: str, primary_key: bool = False, nullable: bool = False) -> Column[int]:
    return Column(name, Integer, primary_key=primary_key, autoincrement=False, nullable=nullable)


def _default(name: str, value: str) -> Column[str]:
    return Column(name, Text, nullable=False, server_default=value)


def _mass() -> Column[float]:
    return Column("mass", Float, nullable=True)


programs = Table(
    "programs",
    metadata,
    _text("digest", primary_key=True),
    Column("content", LargeBinary, nullable=False),  # canonical bytes, zlib-compressed
    _number("nodes"),
    _text("created"),
)

parts = Table(  # a derived definition: everything that depends on its content alone
    "parts",
    metadata,
    _text("digest", primary_key=True),
    _text("program", ForeignKey("programs.digest")),
    _text("definition"),
    _text("title"),
    _text("description"),
    _text("tags"),
    _text("searchable"),  # name, title, description and tags in lower case
    _default("source", ""),  # in lower case
    _number("dof"),
    _text("joints"),
    _mass(),  # of all bodies at the defaults of the parameters, kg; NULL where one has none
    _text("coordinates"),
    _text("bodies"),
    _text("ports"),
    _text("parameters"),
    _text("operations"),
    _text("certificate"),
    _text("created"),
    _default("software", ""),  # that derived it
    _default("seal", ""),  # of this server over all that follows from the definition
    _default("index_digest", ""),  # sha256 of the index
    _text("recipe", nullable=True),  # JSON: what a published tree was coupled of
    # the index of the formulas, JSON, of which the view ``formulas`` makes a row for each
    Column("outputs", Text, nullable=False, server_default="[]"),  # [quantity, output, shape of a formula, symmetry]
    Column(
        "formulas", Text, nullable=False, server_default="[]"
    ),  # [place in outputs, body, coordinate, entry, operations]
    Index(None, "software"),
)

search_terms = Table(  # of the latest version of every name, so that what has one of them is found at once
    "search_terms",
    metadata,
    _text("kind", primary_key=True),
    _text("term", primary_key=True),  # tag planar, port tip; start p and start pe of the word pendulum
    _text("name", primary_key=True),  # of substructures
    sqlite_with_rowid=False,
)

#: what a search reads of every name is in each of its indexes on SQLite, so that it reads nothing else
_READ = ("latest", "visibility", "owner", "dof", "joints", "mass", "number")

substructures = Table(  # one row a name; locked while a version number is allocated
    "substructures",
    metadata,
    _text("name", primary_key=True),
    _number("latest", nullable=True),  # highest version that is not withdrawn
    # of that version, so that searches read narrow rows
    _text("digest", nullable=True),
    _text("created", nullable=True),
    _number("dof", nullable=True),
    _text("joints", nullable=True),
    _mass(),
    _text("searchable", nullable=True),
    _text("source", nullable=True),
    _number("number", nullable=True),  # in the order of names that are equally relevant, and of SQLite's index of words
    _default("owner", "local"),
    _default("visibility", "public"),
    Index("ix_substructures_name", "name", *_READ, "digest"),
    Index("ix_substructures_dof", "dof", "name", *(each for each in _READ if each != "dof"), "digest"),
    Index("ix_substructures_created", "created", "name", *_READ, "digest"),
    Index("ix_substructures_joints", "joints", "name"),
    Index("ix_substructures_owner", "owner", "name"),
    Index("ix_substructures_number", "number", unique=True),
    Index("ix_substructures_digest", "digest"),
    Index("ix_substructures_seen", "visibility", "owner", "latest"),
)

versions = Table(
    "versions",
    metadata,
    _text("name", ForeignKey("substructures.name"), primary_key=True),
    _number("version", primary_key=True),
    _text("digest", ForeignKey("parts.digest")),
    _text("created"),
    _text("withdrawn_at", nullable=True),
    _text("withdrawal_reason", nullable=True),
    _default("author", ""),  # id of an API key
    _default("note", ""),  # of whoever submitted it
    _default("origin", ""),  # what it came as
    _text("derived_name", nullable=True),  # the version that it was made from
    _number("derived_version", nullable=True),
    _text("successor_name", nullable=True),  # what to take in place of a version that was withdrawn
    _number("successor_version", nullable=True),
    _text("tree", nullable=True),  # the revision of a tree that was published as this version
    _number("tree_revision", nullable=True),
    _default("seal", ""),  # of this server over name, number and digest
    UniqueConstraint("digest"),
    Index(None, "created"),
)

part_uses = Table(  # what a part that was published of a tree is built of
    "part_uses",
    metadata,
    _text("part", ForeignKey("parts.digest"), primary_key=True),
    _text("instance", primary_key=True),
    _text("used", ForeignKey("parts.digest")),
    Index(None, "used"),
)

aliases = Table(
    "aliases",
    metadata,
    _text("name", primary_key=True),
    _text("alias", primary_key=True),
    _number("version"),
    _number("revision"),
    _text("changed"),
    ForeignKeyConstraint(["name", "version"], ["versions.name", "versions.version"]),
)

alias_history = Table(
    "alias_history",
    metadata,
    _text("name", primary_key=True),
    _text("alias", primary_key=True),
    _number("revision", primary_key=True),
    _number("version"),
    _text("changed"),
    _text("principal"),
    ForeignKeyConstraint(["name", "alias"], ["aliases.name", "aliases.alias"]),
)

tree_names = Table(
    "tree_names",
    metadata,
    _text("name", primary_key=True),
    _number("latest"),
    # of that revision, so that searches read narrow rows
    _text("created", nullable=True),
    _number("dof", nullable=True),
    _text("joints", nullable=True),
    _mass(),
    _number("number", nullable=True),  # as those of parts
    _default("owner", "local"),
    _default("visibility", "public"),
    Index("ix_tree_names_name", "name", *_READ),
    Index("ix_tree_names_dof", "dof", "name", *(each for each in _READ if each != "dof")),
    Index("ix_tree_names_created", "created", "name", *_READ),
    Index("ix_tree_names_number", "number", unique=True),
)

summary_forms = Table(  # what summaries of trees of one shape have in common
    "summary_forms",
    metadata,
    _text("digest", primary_key=True),
    _text("content"),  # JSON with holes
)

trees = Table(
    "trees",
    metadata,
    _text("name", ForeignKey("tree_names.name"), primary_key=True),
    _number("revision", primary_key=True),
    _text("digest"),
    _text("spec"),  # references pinned to digests
    _text("program", ForeignKey("programs.digest")),
    _number("dof"),
    _text("summary_values"),  # of what Model.load needs beside the program, with gravity and instances as shown
    _text("summary_form", ForeignKey("summary_forms.digest"), nullable=True),  # NULL: the values are all of it
    _text("created"),
    _number("based_on", nullable=True),  # the revision that was changed
    Column("summary_digest", Text, nullable=False, server_default=""),  # sha256 of both together
    _default("author", ""),
    _default("note", ""),
    _default("joints", ""),
    _mass(),  # as of parts
    _default("software", ""),  # that coupled it
    _default("seal", ""),  # as of parts, with names and notes
    Index(None, "software"),
    Index(None, "digest"),
    Index(None, "created"),
)

renewals = Table(  # which software has derived all of the store anew
    "renewals",
    metadata,
    _text("software", primary_key=True),
    _text("seal"),
    _text("ended"),
)

folders = Table(  # that servers read parts from
    "folders",
    metadata,
    _text("path", primary_key=True),
    _text("state"),  # what was read, as it is told
)

tree_parts = Table(
    "tree_parts",
    metadata,
    _text("name", primary_key=True),
    _number("revision", primary_key=True),
    _text("instance", primary_key=True),
    _text("part", ForeignKey("parts.digest")),
    ForeignKeyConstraint(["name", "revision"], ["trees.name", "trees.revision"]),
    Index(None, "part"),
)

idempotency = Table(
    "idempotency",
    metadata,
    _text("principal", primary_key=True),
    _text("key", primary_key=True),
    _text("fingerprint"),  # sha256 of method, path, query, media types and body
    _text("owner"),  # the claim; whoever holds it may finish
    _text("created"),
    _number("status", nullable=True),  # NULL: in flight
    _text("headers", nullable=True),
    Column("size", BigInteger, nullable=False, server_default="0"),  # bytes of the body
    Column("body", LargeBinary, nullable=True),  # NULL with a status: recompute (requests that store nothing)
    _default("seal", ""),  # of this server over the request and its answer
    Index(None, "created"),
    Index(None, "principal", "size"),
)

api_keys = Table(
    "api_keys",
    metadata,
    _text("id", primary_key=True),
    _text("secret_hash"),
    _text("label"),
    _text("scopes"),
    _text("created"),
    _text("expires", nullable=True),
    _text("revoked", nullable=True),
    _default("owner", "local"),
)

sessions = Table(  # of pages, signed in to with a key
    "sessions",
    metadata,
    _text("id", primary_key=True),  # sha256 of the value of the cookie
    _text("key", ForeignKey("api_keys.id")),
    _text("created"),
    _text("expires"),
)

audit = Table(  # who did what; triggers keep its rows as they are
    "audit",
    metadata,
    Column("seq", Integer, primary_key=True),
    _text("time"),
    _text("key"),
    _text("owner"),
    _text("action"),
    _text("subject"),
    _text("detail"),
)
