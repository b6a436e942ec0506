"""Names, keys and jobs have owners, pages have sessions, and what is done is noted."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"

SQLITE_GUARD = """
CREATE TRIGGER audit_{event} BEFORE {event} ON audit
BEGIN SELECT RAISE(ABORT, 'the audit is append-only'); END
"""
POSTGRES_GUARD = """
CREATE FUNCTION keep_audit() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN RAISE EXCEPTION 'the audit is append-only' USING ERRCODE = 'check_violation'; END $$;
CREATE TRIGGER audit_kept BEFORE UPDATE OR DELETE OR TRUNCATE ON audit
  FOR EACH STATEMENT EXECUTE FUNCTION keep_audit();
"""


def upgrade() -> None:
    """Everything there is belongs to ``local``; a job of before to the key that submitted it, as it was."""
    for table in ("substructures", "tree_names"):
        op.add_column(table, sa.Column("owner", sa.Text(), nullable=False, server_default="local"))
        op.add_column(table, sa.Column("visibility", sa.Text(), nullable=False, server_default="public"))
    for table in ("versions", "trees"):
        op.add_column(table, sa.Column("author", sa.Text(), nullable=False, server_default=""))
    for table in ("api_keys", "jobs"):
        op.add_column(table, sa.Column("owner", sa.Text(), nullable=False, server_default="local"))
    op.execute("UPDATE jobs SET owner = principal")
    _create_audit()
    op.create_table(
        "sessions",
        sa.Column("id", sa.Text(), nullable=False),
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.Column("expires", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["key"], ["api_keys.id"], name=op.f("fk_sessions_key_api_keys")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_sessions")),
    )


def _create_audit() -> None:
    op.create_table(
        "audit",
        sa.Column("seq", sa.Integer(), nullable=False),
        sa.Column("time", sa.Text(), nullable=False),
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("owner", sa.Text(), nullable=False),
        sa.Column("action", sa.Text(), nullable=False),
        sa.Column("subject", sa.Text(), nullable=False),
        sa.Column("detail", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("seq", name=op.f("pk_audit")),
    )
    if op.get_bind().dialect.name == "sqlite":
        for event in ("UPDATE", "DELETE"):
            op.execute(SQLITE_GUARD.format(event=event))
    else:
        op.execute(POSTGRES_GUARD)
