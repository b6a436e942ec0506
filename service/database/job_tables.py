"""Tables of the jobs. Which state may follow which is a table too; triggers refuse anything else and log every change.

::

    job    queued -> running -> succeeded | failed          item   queued -> running -> succeeded | failed
              |         '-> cancelling -> cancelled                  |  ^-- lost --'---> cancelled
              '-> succeeded (all known) | cancelled                  '-> succeeded (known) | cancelled

    jobs --< job_items ... results --< result_files         (an item finds its result by its key)
      |---< job_events
      '---< job_uploads >--- uploads                       (chunks of states that items refer to, by digest)

The key of an item is the sha256 of its kind, of the software and of what is to be computed, with all references
pinned: equal items have equal results, whoever asks, where the result has the seal of this server.
"""

from __future__ import annotations

from sqlalchemy import (
    BigInteger,
    Boolean,
    CheckConstraint,
    Column,
    Float,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    Table,
    Text,
    false,
    text,
    true,
)

from service.database.tables import metadata

JOB_STATES = ("queued", "running", "cancelling", "succeeded", "failed", "cancelled")
ITEM_STATES = ("queued", "running", "succeeded", "failed", "cancelled")


def _known(name: str, states: tuple[str, ...]) -> CheckConstraint:
    return CheckConstraint(f"state IN ({', '.join(map(repr, states))})", name=name)


def _index_of(state: str, name: str, *columns: str, unique: bool = False) -> Index:
    """Of items in this state; in PostgreSQL, too, as migrations make it: a word of it here would import its dialect."""
    return Index(name, *columns, unique=unique, sqlite_where=text(f"state = '{state}'"))


jobs = Table(
    "jobs",
    metadata,
    Column("id", Text, primary_key=True),  # sorts by time
    Column("kind", Text, nullable=False),
    Column("principal", Text, nullable=False),
    Column("state", Text, nullable=False),
    Column("total", Integer, nullable=False),
    Column("done", Integer, nullable=False),  # succeeded or failed
    Column("failed", Integer, nullable=False),
    Column("attempts", Integer, nullable=False),  # of all items
    Column("created", Text, nullable=False),
    Column("started", Text, nullable=True),
    Column("finished", Text, nullable=True),
    Column("error", Text, nullable=True),  # problem document
    Column("shared", Boolean, nullable=False, server_default=false()),  # whether every key may see it
    Column("owner", Text, nullable=False, server_default="local"),
    Column("label", Text, nullable=False, server_default=""),  # what it is for, in words
    Column("retry_of", Text, nullable=True),  # the job whose items are tried again
    Column("skipped", Integer, nullable=False, server_default="0"),  # items of the submission that were left out
    _known("ck_jobs_state", JOB_STATES),
    CheckConstraint("failed <= done AND done <= total", name="ck_jobs_counts"),
    Index(None, "state", "id"),
    Index(None, "finished"),
)

job_items = Table(
    "job_items",
    metadata,
    Column("job", Text, ForeignKey("jobs.id"), primary_key=True),
    Column("position", Integer, primary_key=True, autoincrement=False),
    Column("key", Text, nullable=False),
    Column("item", Text, nullable=False),
    Column("blobs", Text, nullable=False),  # digests of what it refers to, JSON
    Column("state", Text, nullable=False),
    Column("attempts", Integer, nullable=False),  # also the fence: only the latest attempt may finish
    Column("deaths", Text, nullable=False),  # what was seen of attempts whose worker died, JSON
    Column("fraction", Float, nullable=False),
    Column("owner", Text, nullable=True),
    Column("lease_until", Text, nullable=True),
    Column("problem", Text, nullable=True),
    Column("started", Text, nullable=True),
    Column("finished", Text, nullable=True),
    _known("ck_job_items_state", ITEM_STATES),
    CheckConstraint("(state = 'running') = (owner IS NOT NULL)", name="ck_job_items_owner"),
    Index(None, "key"),
    Index(None, "job", "finished"),
    _index_of("queued", "ix_job_items_queued", "job", "attempts", "position"),
    _index_of("running", "ix_job_items_running", "job", "position"),
    _index_of("running", "uq_job_items_running", "key", unique=True),  # the same is never computed twice at a time
)

results = Table(
    "results",
    metadata,
    Column("key", Text, primary_key=True),
    Column("kind", Text, nullable=False),
    Column("summary", Text, nullable=False),
    Column("created", Text, nullable=False),
    Column("principal", Text, nullable=False, server_default=""),  # whose job computed it
    Column("size", BigInteger, nullable=False, server_default="0"),  # bytes of summary and files
    Column("is_good", Boolean, nullable=False, server_default=true()),  # whether its items have succeeded
    Column("digest", Text, nullable=False, server_default=""),  # sha256 of the summary; empty in older stores
    Column("seal", Text, nullable=False, server_default=""),  # of this server, with the files; empty in older stores
    Index(None, "principal", "size"),
)

result_files = Table(
    "result_files",
    metadata,
    Column("key", Text, ForeignKey("results.key"), primary_key=True),
    Column("name", Text, primary_key=True),
    Column("size", Integer, nullable=False),
    Column("content", LargeBinary, nullable=False),
    Column("digest", Text, nullable=False, server_default=""),  # sha256 of the content; empty in older stores
)

job_events = Table(
    "job_events",
    metadata,
    Column("job", Text, ForeignKey("jobs.id"), primary_key=True),
    Column("seq", Integer, primary_key=True, autoincrement=False),
    Column("time", Text, nullable=False),
    Column("type", Text, nullable=False),
    Column("data", Text, nullable=False),
)

uploads = Table(  # chunks of states, npz, named by their sha256
    "uploads",
    metadata,
    Column("digest", Text, primary_key=True),
    Column("content", LargeBinary, nullable=False),
    Column("touched", Text, nullable=False),  # when it was uploaded last
    Column("principal", Text, nullable=False, server_default=""),  # who uploaded it first
    Column("size", BigInteger, nullable=False, server_default="0"),  # bytes
    Index(None, "principal", "size"),
    Index(None, "touched"),
)

job_uploads = Table(
    "job_uploads",
    metadata,
    Column("job", Text, ForeignKey("jobs.id"), primary_key=True),
    Column("digest", Text, ForeignKey("uploads.digest"), primary_key=True),
    Index(None, "digest"),
)

state_changes = Table(
    "state_changes",
    metadata,
    Column("entity", Text, primary_key=True),
    Column("source", Text, primary_key=True),
    Column("target", Text, primary_key=True),
)
