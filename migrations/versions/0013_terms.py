"""Tags, ports and the first letters of words of the latest versions as terms, in place of tables of all parts."""

from __future__ import annotations

import json
import re
from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"

AT_A_TIME = 500
WORD = re.compile(r"[^\W_]+")
LATEST = sa.text(
    """SELECT s.name, p.title, p.tags, p.ports FROM substructures s JOIN parts p ON p.digest = s.digest
       WHERE s.latest IS NOT NULL AND s.name > :last ORDER BY s.name LIMIT :size"""
)
NUMBERED = tuple(  # as SQLite's are, by a trigger
    statement.format(table=table, of=of)
    for table, of in (("substructures", "versions"), ("tree_names", "trees"))
    for statement in (
        "CREATE SEQUENCE {table}_numbers OWNED BY {table}.number",
        """UPDATE {table} SET number = place FROM
           (SELECT {table}.name AS named, row_number() OVER (ORDER BY min(of_it.created), {table}.name) AS place
            FROM {table} LEFT JOIN {of} of_it ON of_it.name = {table}.name GROUP BY {table}.name) AS placed
           WHERE named = {table}.name""",
        "SELECT setval('{table}_numbers', coalesce(max(number), 0) + 1, false) FROM {table}",
        "ALTER TABLE {table} ALTER COLUMN number SET DEFAULT nextval('{table}_numbers')",
    )
)
WORDED = (  # names as a column of their own
    "DROP TRIGGER substructures_numbered",
    "DROP TRIGGER substructures_worded",
    "DROP TABLE substructure_words",
    """CREATE VIRTUAL TABLE substructure_words USING
       fts5(name, searchable, source, content='substructures', content_rowid='number', tokenize='trigram')""",
    "INSERT INTO substructure_words (substructure_words) VALUES ('rebuild')",
    """CREATE TRIGGER substructures_numbered AFTER INSERT ON substructures BEGIN
         UPDATE substructures SET number = (SELECT coalesce(max(number), 0) + 1 FROM substructures)
         WHERE name = new.name;
         INSERT INTO substructure_words (rowid, name, searchable, source)
         SELECT number, name, searchable, source FROM substructures WHERE name = new.name;
       END""",
    """CREATE TRIGGER substructures_worded AFTER UPDATE OF searchable, source ON substructures BEGIN
         INSERT INTO substructure_words (substructure_words, rowid, name, searchable, source)
         VALUES ('delete', old.number, old.name, old.searchable, old.source);
         INSERT INTO substructure_words (rowid, name, searchable, source)
         VALUES (new.number, new.name, new.searchable, new.source);
       END""",
)


def upgrade() -> None:
    """Number the names, collect the terms, drop what they replace; index the words of names by themselves."""
    op.create_table(
        "search_terms",
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("term", sa.Text(), nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("kind", "term", "name", name=op.f("pk_search_terms")),
        sqlite_with_rowid=False,
    )
    connection = op.get_bind()
    for statement in NUMBERED if connection.dialect.name == "postgresql" else WORDED:
        op.execute(statement)
    terms, last = sa.table("search_terms", *map(sa.column, ("kind", "term", "name"))), ""
    while rows := connection.execute(LATEST, {"last": last, "size": AT_A_TIME}).all():
        last = rows[-1].name
        found = [{"kind": x, "term": y, "name": row.name} for row in rows for x, y in sorted(_terms(row))]
        if found:
            connection.execute(sa.insert(terms), found)
    for column in ("joints", "owner"):
        op.create_index(f"ix_substructures_{column}", "substructures", [column, "name"])
    op.drop_table("part_ports")
    op.drop_table("tags")


def _terms(row: Any) -> set[tuple[str, str]]:
    try:
        labels, ports = json.loads(row.tags), json.loads(row.ports)
    except ValueError:  # damaged; whoever reads it refuses it by name
        return set()
    words = WORD.findall(" ".join((row.name, row.title, *labels)).lower())
    starts = {start for word in words for start in (word[:1], word[:2]) if start.isascii()}
    return {(kind, each) for kind, some in (("tag", labels), ("port", ports), ("start", starts)) for each in some}
