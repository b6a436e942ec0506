"""Jobs: items, results, events, and which state may follow which."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"

CHANGES = {
    "job": {
        "queued": ("running", "succeeded", "cancelled"),
        "running": ("cancelling", "succeeded", "failed", "cancelled"),
        "cancelling": ("cancelled",),
    },
    "item": {
        "queued": ("running", "succeeded", "cancelled"),
        "running": ("queued", "succeeded", "failed", "cancelled"),
    },
}
TABLES = {"job": "jobs", "item": "job_items"}

SQLITE_GUARD = """
CREATE TRIGGER {table}_change BEFORE UPDATE OF state ON {table}
WHEN OLD.state <> NEW.state AND NOT EXISTS
  (SELECT 1 FROM state_changes WHERE entity = '{entity}' AND source = OLD.state AND target = NEW.state)
BEGIN SELECT RAISE(ABORT, 'impossible change of state: {entity}'); END
"""
SQLITE_BIRTH = """
CREATE TRIGGER {table}_birth BEFORE INSERT ON {table} WHEN NEW.state <> 'queued'
BEGIN SELECT RAISE(ABORT, 'impossible first state: {entity}'); END
"""
SQLITE_LOG = """
CREATE TRIGGER jobs_log_{event} AFTER {event} {of} ON jobs {when}
BEGIN
  INSERT INTO job_events (job, seq, time, type, data) VALUES (
    NEW.id, (SELECT coalesce(max(seq), 0) + 1 FROM job_events WHERE job = NEW.id),
    strftime('%Y-%m-%dT%H:%M:%f000Z', 'now'), 'state',
    json_object('state', NEW.state, 'was', {was}, 'done', NEW.done, 'failed', NEW.failed, 'total', NEW.total));
END
"""
POSTGRES = """
CREATE FUNCTION check_state_change() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF TG_OP = 'INSERT' THEN
    IF NEW.state <> 'queued' THEN RAISE EXCEPTION 'impossible first state: %', TG_ARGV[0]
      USING ERRCODE = 'check_violation'; END IF;
  ELSIF OLD.state <> NEW.state AND NOT EXISTS
    (SELECT 1 FROM state_changes WHERE entity = TG_ARGV[0] AND source = OLD.state AND target = NEW.state) THEN
    RAISE EXCEPTION 'impossible change of state: %', TG_ARGV[0] USING ERRCODE = 'check_violation';
  END IF;
  RETURN NEW;
END $$;
CREATE FUNCTION log_job_state() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE was text := NULL;
BEGIN
  IF TG_OP = 'UPDATE' THEN
    IF OLD.state = NEW.state THEN RETURN NULL; END IF;
    was := OLD.state;
  END IF;
  INSERT INTO job_events (job, seq, time, type, data) VALUES (
    NEW.id, (SELECT coalesce(max(seq), 0) + 1 FROM job_events WHERE job = NEW.id),
    to_char(clock_timestamp() AT TIME ZONE 'utc', 'YYYY-MM-DD"T"HH24:MI:SS.US"Z"'), 'state',
    json_build_object('state', NEW.state, 'was', was, 'done', NEW.done, 'failed', NEW.failed,
      'total', NEW.total)::text);
  RETURN NULL;
END $$;
CREATE TRIGGER jobs_change BEFORE INSERT OR UPDATE OF state ON jobs
  FOR EACH ROW EXECUTE FUNCTION check_state_change('job');
CREATE TRIGGER job_items_change BEFORE INSERT OR UPDATE OF state ON job_items
  FOR EACH ROW EXECUTE FUNCTION check_state_change('item');
CREATE TRIGGER jobs_log AFTER INSERT OR UPDATE OF state ON jobs FOR EACH ROW EXECUTE FUNCTION log_job_state();
"""


def upgrade() -> None:
    """Create the tables of the jobs and their triggers."""
    _create_jobs()
    _create_items()
    _create_results()
    changes = op.create_table(
        "state_changes",
        sa.Column("entity", sa.Text(), nullable=False),
        sa.Column("source", sa.Text(), nullable=False),
        sa.Column("target", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("entity", "source", "target", name=op.f("pk_state_changes")),
    )
    rows = [
        {"entity": entity, "source": source, "target": target}
        for entity, following in CHANGES.items()
        for source, states in following.items()
        for target in states
    ]
    op.bulk_insert(changes, rows)
    if op.get_bind().dialect.name == "sqlite":
        _guard_sqlite()
    else:
        op.execute(POSTGRES)


def _create_jobs() -> None:
    op.create_table(
        "jobs",
        sa.Column("id", sa.Text(), nullable=False),
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("principal", sa.Text(), nullable=False),
        sa.Column("state", sa.Text(), nullable=False),
        sa.Column("total", sa.Integer(), nullable=False),
        sa.Column("done", sa.Integer(), nullable=False),
        sa.Column("failed", sa.Integer(), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.Column("started", sa.Text(), nullable=True),
        sa.Column("finished", sa.Text(), nullable=True),
        sa.Column("error", sa.Text(), nullable=True),
        sa.CheckConstraint(
            "state IN ('queued', 'running', 'cancelling', 'succeeded', 'failed', 'cancelled')", name="ck_jobs_state"
        ),
        sa.CheckConstraint("failed <= done AND done <= total", name="ck_jobs_counts"),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_jobs")),
    )
    op.create_index(op.f("ix_jobs_state_id"), "jobs", ["state", "id"], unique=False)
    op.create_index(op.f("ix_jobs_finished"), "jobs", ["finished"], unique=False)
    op.create_table(
        "job_events",
        sa.Column("job", sa.Text(), nullable=False),
        sa.Column("seq", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("time", sa.Text(), nullable=False),
        sa.Column("type", sa.Text(), nullable=False),
        sa.Column("data", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["job"], ["jobs.id"], name=op.f("fk_job_events_job_jobs")),
        sa.PrimaryKeyConstraint("job", "seq", name=op.f("pk_job_events")),
    )


def _create_items() -> None:
    op.create_table(
        "job_items",
        sa.Column("job", sa.Text(), nullable=False),
        sa.Column("position", sa.Integer(), autoincrement=False, nullable=False),
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("item", sa.Text(), nullable=False),
        sa.Column("blobs", sa.Text(), nullable=False),
        sa.Column("state", sa.Text(), nullable=False),
        sa.Column("attempts", sa.Integer(), nullable=False),
        sa.Column("deaths", sa.Text(), nullable=False),
        sa.Column("fraction", sa.Float(), nullable=False),
        sa.Column("owner", sa.Text(), nullable=True),
        sa.Column("lease_until", sa.Text(), nullable=True),
        sa.Column("problem", sa.Text(), nullable=True),
        sa.Column("started", sa.Text(), nullable=True),
        sa.Column("finished", sa.Text(), nullable=True),
        sa.CheckConstraint(
            "state IN ('queued', 'running', 'succeeded', 'failed', 'cancelled')", name="ck_job_items_state"
        ),
        sa.CheckConstraint("(state = 'running') = (owner IS NOT NULL)", name="ck_job_items_owner"),
        sa.ForeignKeyConstraint(["job"], ["jobs.id"], name=op.f("fk_job_items_job_jobs")),
        sa.PrimaryKeyConstraint("job", "position", name=op.f("pk_job_items")),
    )
    op.create_index(op.f("ix_job_items_key"), "job_items", ["key"], unique=False)
    op.create_index(op.f("ix_job_items_job_finished"), "job_items", ["job", "finished"], unique=False)
    for name, columns, state in (
        ("ix_job_items_queued", ["job", "position"], "queued"),
        ("ix_job_items_running", ["job", "position"], "running"),
        ("uq_job_items_running", ["key"], "running"),
    ):
        where = sa.text(f"state = '{state}'")
        op.create_index(
            name, "job_items", columns, unique=name.startswith("uq"), sqlite_where=where, postgresql_where=where
        )


def _create_results() -> None:
    op.create_table(
        "results",
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("kind", sa.Text(), nullable=False),
        sa.Column("summary", sa.Text(), nullable=False),
        sa.Column("created", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("key", name=op.f("pk_results")),
    )
    op.create_table(
        "result_files",
        sa.Column("key", sa.Text(), nullable=False),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("size", sa.Integer(), nullable=False),
        sa.Column("content", sa.LargeBinary(), nullable=False),
        sa.ForeignKeyConstraint(["key"], ["results.key"], name=op.f("fk_result_files_key_results")),
        sa.PrimaryKeyConstraint("key", "name", name=op.f("pk_result_files")),
    )


def _guard_sqlite() -> None:
    for entity, table in TABLES.items():
        op.execute(SQLITE_GUARD.format(entity=entity, table=table))
        op.execute(SQLITE_BIRTH.format(entity=entity, table=table))
    op.execute(SQLITE_LOG.format(event="INSERT", of="", when="", was="NULL"))
    op.execute(SQLITE_LOG.format(event="UPDATE", of="OF state", when="WHEN OLD.state <> NEW.state", was="OLD.state"))
