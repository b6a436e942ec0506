"""The queue: claim items under a lease, keep the lease, end attempts. A late attempt changes nothing (fencing).

All functions run in write transactions; rows of jobs are locked before those of their items.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from datetime import timedelta
from typing import Any

import orjson
from sqlalchemy import ColumnElement, Connection, and_, bindparam, exists, func, select, tuple_, update

from service.database.job_tables import job_items, jobs
from service.queries.attempts import Attempt, Changes, Lost, attempt_id
from service.queries.common import now
from service.queries.jobs import jobs as job_queries
from service.queries.jobs.results import vouched
from service.queries.jobs.states import QUEUED, RUNNING

_FINISH = (
    update(job_items)
    .where(job_items.c.job == bindparam("of_job"), job_items.c.position == bindparam("at"), RUNNING)
    .values(
        state=bindparam("state"),
        problem=bindparam("problem"),
        finished=bindparam("finished"),
        fraction=1.0,
        owner=None,
        lease_until=None,
    )
)
JOBS = 64  # jobs that share what is free, the oldest first


def claim(
    connection: Connection,
    owner: str,
    lease: timedelta,
    wanted: int,
    changes: Changes,
    ahead: Callable[[str], int],
) -> list[Attempt]:
    """Up to ``wanted`` items to be computed by the owner, shared out between jobs; those with few running go first.

    ``ahead``: how many to claim of a job even where that is more than its share; at most half of what is left, since
    other hosts may share the queue.
    """
    candidates = _candidates(connection)
    share = max(1, wanted // max(1, len(candidates)))
    taken: list[Attempt] = []
    for size in (share, wanted):  # a fair share for each first, then whatever there is
        for job, kind, _ in candidates:
            if len(taken) < wanted:
                room = min(size, wanted - len(taken))
                taken += _take(connection, owner, lease, (job, kind), room, changes)
    mine = Counter(attempt.job for attempt in taken)
    for job, kind, left in candidates:
        if (room := min(ahead(job), (left + 1) // 2) - mine[job]) > 0:
            taken += _take(connection, owner, lease, (job, kind), room, changes)
    return taken


def _candidates(connection: Connection) -> list[tuple[str, str, int]]:
    """Jobs with queued items: id, kind and how many items are not done; those with few running items first."""
    has_queued = exists().where(job_items.c.job == jobs.c.id, QUEUED)
    rows: list[Any] = []
    for state in ("running", "queued"):  # one state a query, so that an index gives the order
        columns = select(jobs.c.id, jobs.c.kind, jobs.c.total - jobs.c.done)
        query = columns.where(jobs.c.state == state, has_queued).order_by(jobs.c.id)
        rows += connection.execute(query.limit(JOBS).with_for_update(skip_locked=True)).all()
    rows = sorted(rows)[:JOBS]
    running = select(job_items.c.job, func.count()).where(RUNNING).group_by(job_items.c.job)
    busy = {row[0]: row[1] for row in connection.execute(running)}
    return sorted((tuple(row) for row in rows), key=lambda each: (busy.get(each[0], 0), each[0]))


def _take(
    connection: Connection, owner: str, lease: timedelta, job: tuple[str, str], size: int, changes: Changes
) -> list[Attempt]:
    identifier, kind = job
    twin = job_items.alias()
    is_computed = exists().where(twin.c.key == job_items.c.key, twin.c.state == RUNNING.right)
    names = ("position", "attempts", "key", "item", "blobs")
    query = select(*(job_items.c[name] for name in names)).where(job_items.c.job == identifier, QUEUED, ~is_computed)
    # what was lost before goes behind the others, so that it neither holds them up nor uses its attempts up
    rows = connection.execute(query.order_by(job_items.c.attempts, job_items.c.position).limit(size)).all()
    keys = [row.key for row in rows]
    known = vouched(connection, keys)
    for found, positions in job_queries.succeed_equal(connection, [identifier], sorted(known)).items() if known else ():
        changes.add(found, "succeeded", positions)
    first = {row.key: row for row in reversed(rows) if row.key not in known}
    attempts = [
        Attempt(identifier, row.position, row.attempts + 1, kind, row.key, row.item, row.blobs)
        for row in sorted(first.values(), key=lambda row: (row.attempts, row.position))
    ]
    _start(connection, owner, lease, identifier, attempts, changes)
    return attempts


def _start(
    connection: Connection, owner: str, lease: timedelta, job: str, attempts: Sequence[Attempt], changes: Changes
) -> None:
    if not attempts:
        return
    started = now()
    positions = [attempt.position for attempt in attempts]
    chosen = and_(job_items.c.job == job, job_items.c.position.in_(positions))
    values = {"owner": owner, "lease_until": now(lease), "attempts": job_items.c.attempts + 1, "started": started}
    connection.execute(update(job_items).where(chosen).values(state="running", **values))
    total = {"attempts": jobs.c.attempts + len(attempts)}
    connection.execute(update(jobs).where(jobs.c.id == job).values(total))
    first = and_(jobs.c.id == job, jobs.c.state == "queued")
    connection.execute(update(jobs).where(first).values(state="running", started=started))
    changes.add(job, "running", positions)


def held(connection: Connection, owner: str, attempts: Sequence[Attempt]) -> list[Lost]:
    """The items of those of the attempts that are the latest and still the owner's."""
    these = tuple_(job_items.c.job, job_items.c.position).in_([(a.job, a.position) for a in attempts])
    found = _lost(connection, these & RUNNING & (job_items.c.owner == owner))
    ids = {attempt.id for attempt in attempts}
    return [lost for lost in found if lost.id in ids]


def twins(connection: Connection, keys: Sequence[str]) -> set[str]:
    """The jobs with queued items of these keys."""
    query = select(job_items.c.job).where(QUEUED, job_items.c.key.in_(keys)).distinct()
    return set(connection.execute(query).scalars())


def finish(connection: Connection, ended: Sequence[tuple[Attempt, str | None]]) -> None:
    """End attempts that are held: without a problem they have succeeded."""
    finished = now()
    rows = [
        {
            "of_job": attempt.job,
            "at": attempt.position,
            "state": "succeeded" if problem is None else "failed",
            "problem": problem,
            "finished": finished,
        }
        for attempt, problem in ended
    ]
    if rows:
        connection.execute(_FINISH, rows)


def put_back(connection: Connection, job: str, position: int, deaths: Sequence[str]) -> None:
    """Queue a running item again."""
    _end(connection, job, position, {"state": "queued", "deaths": orjson.dumps(list(deaths)).decode(), "fraction": 0.0})


def uncount(connection: Connection, job: str, position: int) -> None:
    """Take back that an attempt was made; its id, which nobody computes any more, will be given again."""
    chosen = and_(job_items.c.job == job, job_items.c.position == position, RUNNING)
    connection.execute(update(job_items).where(chosen).values(attempts=job_items.c.attempts - 1))
    connection.execute(update(jobs).where(jobs.c.id == job).values(attempts=jobs.c.attempts - 1))


def drop(connection: Connection, job: str, position: int) -> None:
    """Cancel a running item."""
    _end(connection, job, position, {"state": "cancelled", "finished": now()})


def give_up(connection: Connection, job: str, position: int, deaths: Sequence[str], problem: str) -> None:
    """Fail a running item whose attempts did not live."""
    values = {"state": "failed", "problem": problem, "deaths": orjson.dumps(list(deaths)).decode(), "finished": now()}
    _end(connection, job, position, values)


def _end(connection: Connection, job: str, position: int, values: dict[str, Any]) -> None:
    chosen = and_(job_items.c.job == job, job_items.c.position == position, RUNNING)
    connection.execute(update(job_items).where(chosen).values(owner=None, lease_until=None, **values))


def renew(connection: Connection, owner: str, lease: timedelta) -> set[str]:
    """Prolong the leases of an owner; the ids of the attempts that still are its own."""
    chosen = (job_items.c.owner == owner) & RUNNING
    query = update(job_items).where(chosen).values(lease_until=now(lease))
    columns = (job_items.c.job, job_items.c.position, job_items.c.attempts)
    return {attempt_id(*row) for row in connection.execute(query.returning(*columns))}


def note_fractions(connection: Connection, fractions: Sequence[tuple[Attempt, float]]) -> None:
    """Keep how far running attempts are."""
    for attempt, fraction in fractions:
        chosen = and_(job_items.c.job == attempt.job, job_items.c.position == attempt.position, RUNNING)
        connection.execute(update(job_items).where(chosen).values(fraction=fraction))


def expired(connection: Connection, owner: str, alone: bool) -> list[Lost]:
    """Running items of others whose lease has ended; all of them when there can be no other owner."""
    condition = RUNNING & (job_items.c.owner != owner)
    return _lost(connection, condition if alone else condition & (job_items.c.lease_until < now()))


def unwanted(connection: Connection, owner: str) -> list[Lost]:
    """The owner's running items of jobs that are to be cancelled."""
    return [lost for lost in owned(connection, owner) if lost.is_cancelling]


def owned(connection: Connection, owner: str) -> list[Lost]:
    """All running items of an owner."""
    return _lost(connection, RUNNING & (job_items.c.owner == owner))


def _lost(connection: Connection, condition: ColumnElement[bool]) -> list[Lost]:
    names = ("job", "position", "attempts", "deaths")
    columns = select(*(job_items.c[name] for name in names), jobs.c.state).join(jobs, jobs.c.id == job_items.c.job)
    rows = connection.execute(columns.where(condition).order_by(job_items.c.job, job_items.c.position))
    return [Lost(*row[:3], tuple(orjson.loads(row.deaths)), row.state == "cancelling") for row in rows]
