"""Jobs and their items: submit, look, cancel, remove. Whoever changes items of a job holds the lock on its row."""

from __future__ import annotations

import secrets
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from time import time_ns
from typing import Any

from sqlalchemy import Connection, and_, bindparam, case, exists, func, insert, literal, or_, select, update

from service.database.clock import time_now
from service.database.job_tables import job_items, jobs, results
from service.messages.viewer import Viewer
from service.queries.common import now
from service.queries.jobs.job_events import add_event
from service.queries.jobs.results import TOGETHER, are_ours, as_kept, vouched
from service.queries.jobs.states import OPEN, QUEUED, RUNNING


@dataclass(frozen=True, slots=True)
class Job:
    """A job as stored; ``done`` items have succeeded or failed, ``error`` is a problem document as JSON."""

    id: str
    kind: str
    principal: str
    state: str
    total: int
    done: int
    failed: int
    attempts: int
    created: str
    started: str | None
    finished: str | None
    error: str | None
    shared: bool
    owner: str
    label: str
    retry_of: str | None
    skipped: int

    def is_seen_by(self, viewer: Viewer) -> bool:
        """Whether the job is there for a viewer."""
        return self.shared or viewer.may_change(self.owner) or viewer.key == self.principal

    @property
    def is_final(self) -> bool:
        """Whether nothing will change any more."""
        return self.state not in OPEN


@dataclass(frozen=True, slots=True)
class JobItem:
    """An item as stored, with the summary of its result; ``deaths``, ``problem``, ``summary`` and ``item``, which is
    read of those that failed, are JSON. ``computed_here``: whether the result has the seal of this server, where there
    is one.
    """

    position: int
    key: str
    state: str
    attempts: int
    deaths: str
    fraction: float
    problem: str | None
    started: str | None
    finished: str | None
    item: str | None
    summary: str | None
    computed_here: bool | None


@dataclass(frozen=True, slots=True)
class NewItem:
    """What is to be computed: ``item`` and ``blobs`` (digests) are JSON."""

    key: str
    item: str
    blobs: str


def new_id() -> str:
    """An identifier that cannot be guessed and sorts by time: milliseconds, then 64 random bits."""
    return f"{time_ns() // 10**6:012x}{secrets.token_hex(8)}"


def add_job(
    connection: Connection,
    kind: str,
    viewer: Viewer,
    items: Sequence[NewItem],
    shared: bool = False,
    label: str = "",
    retry_of: str | None = None,
    skipped: int = 0,
) -> str:
    """Queue a job. Items whose result is known already have succeeded at once."""
    share_results(connection)
    identifier = new_id()
    counts = {"total": len(items), "done": 0, "failed": 0, "attempts": 0}
    row = {"id": identifier, "kind": kind, "state": "queued", "created": now(), **counts}
    row |= {"principal": viewer.key, "owner": viewer.owner, "shared": shared, "label": label, "retry_of": retry_of}
    row["skipped"] = skipped
    connection.execute(insert(jobs).values(**row))
    common = {"job": identifier, "state": "queued", "attempts": 0, "deaths": "[]", "fraction": 0.0}
    rows = [
        {"position": k, "key": item.key, "item": item.item, "blobs": item.blobs, **common}
        for k, item in enumerate(items)
    ]
    connection.execute(insert(job_items), rows)
    known = succeed_known(connection, identifier)
    if known:
        count(connection, {identifier: (len(known), 0)})
        add_event(connection, identifier, "items", {"succeeded": known})
    settle(connection, [identifier])
    return identifier


def share_results(connection: Connection, exclusive: bool = False) -> None:
    """Keep results from being removed while they are taken for granted; SQLite has one writer anyway."""
    if connection.dialect.name == "postgresql":
        kind = "pg_advisory_xact_lock" if exclusive else "pg_advisory_xact_lock_shared"
        connection.exec_driver_sql(f"SELECT {kind}(7305512)")


def succeed_known(connection: Connection, job: str) -> list[int]:
    """Queued items of a locked job whose result is there, under the seal of this server, succeed: their positions."""
    is_there = exists().where(results.c.key == job_items.c.key, results.c.is_good)
    there = select(job_items.c.key).distinct().where(job_items.c.job == job, QUEUED, is_there)
    known = sorted(vouched(connection, connection.execute(there).scalars().all()))
    parts = (known[start : start + TOGETHER] for start in range(0, len(known), TOGETHER))
    return sorted(position for keys in parts for position in succeed_equal(connection, [job], keys).get(job, ()))


def succeed_equal(connection: Connection, ids: Collection[str], keys: Sequence[str]) -> dict[str, list[int]]:
    """Queued items of these keys, whose results are there, succeed in the locked jobs: their positions by job."""
    equal = select(job_items.c.job, job_items.c.position).where(QUEUED, job_items.c.key.in_(keys))
    done: dict[str, list[int]] = {}
    for job, position in connection.execute(equal):
        if job in ids:
            done.setdefault(job, []).append(position)
    rows = [{"of_job": job, "at": position} for job, positions in done.items() for position in positions]
    if rows:
        these = and_(job_items.c.job == bindparam("of_job"), job_items.c.position == bindparam("at"), QUEUED)
        values = {"state": "succeeded", "fraction": 1.0, "finished": now()}
        connection.execute(update(job_items).where(these).values(**values), rows)
    return done


def count(connection: Connection, finished: Mapping[str, tuple[int, int]]) -> None:
    """Add (done, failed) to the counts of jobs."""
    for job, (done, failed) in finished.items():
        values = {"done": jobs.c.done + done, "failed": jobs.c.failed + failed}
        connection.execute(update(jobs).where(jobs.c.id == job).values(values))


def settle(connection: Connection, ids: Iterable[str]) -> None:
    """Finish those of the locked jobs that have nothing left to be done.

    A job fails when all of its items have failed, and only then: a bad item does not sink the rest.
    """
    is_left = exists().where(job_items.c.job == jobs.c.id, or_(QUEUED, RUNNING))
    all_failed = jobs.c.failed == jobs.c.total
    cancelled = and_(jobs.c.state == "cancelling", ~is_left)
    complete = and_(jobs.c.state.in_(("queued", "running")), jobs.c.done == jobs.c.total)
    state = case((jobs.c.state == "cancelling", "cancelled"), (all_failed, "failed"), else_="succeeded")
    chosen = and_(jobs.c.id.in_(list(ids)), or_(cancelled, complete))
    connection.execute(update(jobs).where(chosen).values(state=state, finished=now()))


def lock(connection: Connection, ids: Iterable[str]) -> None:
    """Lock the rows of jobs until the transaction ends, always in the same order."""
    connection.execute(select(jobs.c.id).where(jobs.c.id.in_(list(ids))).order_by(jobs.c.id).with_for_update())


def fail_whole(connection: Connection, ids: Iterable[str], error: str) -> None:
    """Give failed jobs the error that stands for all of their items."""
    chosen = and_(jobs.c.id.in_(list(ids)), jobs.c.state == "failed", jobs.c.error.is_(None))
    connection.execute(update(jobs).where(chosen).values(error=error))


def get_job(connection: Connection, identifier: str) -> Job | None:
    """One job."""
    row = connection.execute(_all_jobs().where(jobs.c.id == identifier)).first()
    return None if row is None else Job(*row)


def submitters(connection: Connection, ids: Collection[str]) -> dict[str, Viewer]:
    """Who submitted jobs: what they store is stored with the right to write."""
    query = select(jobs.c.id, jobs.c.principal, jobs.c.owner).where(jobs.c.id.in_(list(ids)))
    return {row[0]: Viewer(row[1], row[2], ("write",)) for row in connection.execute(query)} if ids else {}


def page_jobs(
    connection: Connection, viewer: Viewer, wanted: Mapping[str, str | None], before: str | None, size: int
) -> list[Job]:
    """Up to ``size`` jobs that a viewer sees, the newest first; ``wanted``: state, kind, label (or a word of it)."""
    query = _all_jobs()
    if not viewer.is_admin:
        query = query.where(or_(jobs.c.owner == viewer.owner, jobs.c.principal == viewer.key, jobs.c.shared))
    for name in ("state", "kind"):
        if wanted.get(name) is not None:
            query = query.where(jobs.c[name] == wanted[name])
    if (label := wanted.get("label")) is not None:
        words = literal(" ") + jobs.c.label + " "
        query = query.where(or_(jobs.c.label == label, words.contains(f" {label} ", autoescape=True)))
    if before is not None:
        query = query.where(jobs.c.id < before)
    return [Job(*row) for row in connection.execute(query.order_by(jobs.c.id.desc()).limit(size))]


def page_items(connection: Connection, job: str, state: str | None, after: int, size: int) -> list[JobItem]:
    """Up to ``size`` items that follow the position ``after``. Raises Refused (``damaged-content``)."""
    names = [name for name in JobItem.__slots__ if name not in ("summary", "item", "computed_here")]
    is_its = results.c.is_good == (job_items.c.state == "succeeded")
    summary = case((job_items.c.state.in_(("succeeded", "failed")) & is_its, results.c.summary)).label("summary")
    item = case((job_items.c.state == "failed", job_items.c.item))
    columns: list[Any] = [*(job_items.c[name] for name in names), item, summary, results.c.digest]
    query = select(*columns).select_from(job_items.outerjoin(results, results.c.key == job_items.c.key))
    query = query.where(job_items.c.job == job, job_items.c.position > after)
    if state is not None:
        query = query.where(job_items.c.state == state)
    rows = connection.execute(query.order_by(job_items.c.position).limit(size)).all()
    ours = are_ours(connection, {row.key for row in rows if row.summary is not None})
    return [_item(*row, None if row.summary is None else ours[row.key]) for row in rows]


def _item(*columns: Any) -> JobItem:
    """Raises Refused (``damaged-content``) for a summary that is not the one that was kept."""
    found, digest = (*columns[:-2], columns[-1]), columns[-2]
    item = JobItem(*found)
    if item.summary is not None:
        as_kept("a result", digest, item.summary.encode())
    return item


def unsuccessful(connection: Connection, job: str) -> list[NewItem]:
    """The items of a job that failed or were cancelled, as they were submitted."""
    chosen = (job_items.c.job == job) & job_items.c.state.in_(("failed", "cancelled"))
    query = select(job_items.c.key, job_items.c.item, job_items.c.blobs).where(chosen)
    return [NewItem(*row) for row in connection.execute(query.order_by(job_items.c.position))]


def finished_since(connection: Connection, job: str, seconds: float) -> int:
    """How many items of a job ended within the last seconds."""
    since = now(-timedelta(seconds=seconds))
    query = select(func.count()).where(job_items.c.job == job, job_items.c.finished > since)
    return connection.execute(query).scalar_one()


def seconds_since(time: str) -> float:
    """The age of a time of the store."""
    return (time_now() - datetime.fromisoformat(time)).total_seconds()


def partial_work(connection: Connection, job: str) -> float:
    """The sum of the fractions done of the running items of a job."""
    query = select(func.coalesce(func.sum(job_items.c.fraction), 0.0)).where(RUNNING, job_items.c.job == job)
    return float(connection.execute(query).scalar_one())


def waiting(connection: Connection, principal: str | None = None) -> int:
    """How many items of open jobs are not done, of one principal or of all."""
    query = select(func.coalesce(func.sum(jobs.c.total - jobs.c.done), 0)).where(jobs.c.state.in_(OPEN))
    if principal is not None:
        query = query.where(jobs.c.principal == principal)
    return int(connection.execute(query).scalar_one())


def counts(connection: Connection) -> dict[str, dict[str, int]]:
    """How many jobs there are in every state, and how many items are queued and running."""
    states = connection.execute(select(jobs.c.state, func.count()).group_by(jobs.c.state))
    items = {
        name: connection.execute(select(func.count()).select_from(job_items).where(condition)).scalar_one()
        for name, condition in (("queued", QUEUED), ("running", RUNNING))
    }
    return {"jobs": {row[0]: row[1] for row in states}, "items": items}


def cancel(connection: Connection, identifier: str) -> None:
    """Cancel what is queued; running items are stopped by whoever computes them. Finished jobs stay as they are."""
    lock(connection, [identifier])
    open_job = and_(jobs.c.id == identifier, jobs.c.state.in_(("queued", "running")))
    if connection.execute(select(jobs.c.id).where(open_job)).first() is None:
        return
    queued = and_(job_items.c.job == identifier, QUEUED)
    dropped = update(job_items).where(queued).values(state="cancelled", finished=now())
    positions = sorted(connection.execute(dropped.returning(job_items.c.position)).scalars())
    if positions:
        add_event(connection, identifier, "items", {"cancelled": positions})
    runs = connection.execute(select(exists().where(job_items.c.job == identifier, RUNNING))).scalar_one()
    values = {"state": "cancelling"} if runs else {"state": "cancelled", "finished": now()}
    connection.execute(update(jobs).where(open_job).values(values))


def _all_jobs() -> Any:
    return select(*(jobs.c[name] for name in Job.__slots__))
