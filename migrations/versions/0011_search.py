"""The latest version of every name in a narrow row, and its words by their trigrams, so that search is quick."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"

COLUMNS = {
    "digest": sa.Text,
    "created": sa.Text,
    "dof": sa.Integer,
    "joints": sa.Text,
    "searchable": sa.Text,
}
FILLED = """
UPDATE substructures SET (digest, created, dof, joints, searchable) = (
  SELECT p.digest, v.created, p.dof, p.joints, p.searchable
  FROM versions v JOIN parts p ON p.digest = v.digest
  WHERE v.name = substructures.name AND v.version = substructures.latest)
"""
# FTS5 knows rows by integers, which are not to change when the file is compacted
SQLITE = (
    "ALTER TABLE substructures ADD COLUMN number INTEGER",
    "UPDATE substructures SET number = rowid",
    "CREATE UNIQUE INDEX ix_substructures_number ON substructures (number)",
    """CREATE VIRTUAL TABLE substructure_words
       USING fts5(searchable, content='substructures', content_rowid='number', tokenize='trigram')""",
    "INSERT INTO substructure_words (substructure_words) VALUES ('rebuild')",
    """CREATE TRIGGER substructures_numbered AFTER INSERT ON substructures BEGIN
         UPDATE substructures SET number = (SELECT coalesce(max(number), 0) + 1 FROM substructures)
         WHERE name = new.name;
         INSERT INTO substructure_words (rowid, searchable)
         SELECT number, searchable FROM substructures WHERE name = new.name;
       END""",
    """CREATE TRIGGER substructures_worded AFTER UPDATE OF searchable ON substructures BEGIN
         INSERT INTO substructure_words (substructure_words, rowid, searchable)
         VALUES ('delete', old.number, old.searchable);
         INSERT INTO substructure_words (rowid, searchable) VALUES (new.number, new.searchable);
       END""",
)
POSTGRESQL = (
    "ALTER TABLE substructures ADD COLUMN number INTEGER",
    "CREATE UNIQUE INDEX ix_substructures_number ON substructures (number)",
    # trigrams come with PostgreSQL, but not every owner of a database may have them; without them search is slower
    """DO $$ BEGIN
         CREATE EXTENSION IF NOT EXISTS pg_trgm;
         CREATE INDEX substructure_words ON substructures USING gin (searchable gin_trgm_ops);
       EXCEPTION WHEN insufficient_privilege OR undefined_file OR feature_not_supported THEN
         RAISE NOTICE 'no pg_trgm: search reads every name';
       END $$""",
)


def upgrade() -> None:
    """Add the columns, fill them, and index them."""
    for name, kind in COLUMNS.items():
        op.add_column("substructures", sa.Column(name, kind(), nullable=True))
    op.execute(FILLED)
    for column in ("dof", "created"):
        op.create_index(op.f(f"ix_substructures_{column}"), "substructures", [column, "name"])
    op.create_index(op.f("ix_substructures_digest"), "substructures", ["digest"])
    op.create_index(op.f("ix_substructures_seen"), "substructures", ["visibility", "owner", "latest"])
    op.create_index(op.f("ix_tags_tag"), "tags", ["tag", "part"])
    for statement in SQLITE if op.get_bind().dialect.name == "sqlite" else POSTGRESQL:
        op.execute(statement)
