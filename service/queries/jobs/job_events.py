"""What happened to a job, in order; changes of its state are logged by the database itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import orjson
from sqlalchemy import Connection, func, insert, select

from service.database.job_tables import job_events, jobs
from service.queries.common import now

TOGETHER = 500  # jobs of one statement


@dataclass(frozen=True, slots=True)
class JobEvent:
    """One entry of the log; ``data`` is JSON."""

    seq: int
    time: str
    type: str
    data: str


def add_event(connection: Connection, job: str, kind: str, data: Mapping[str, Any]) -> None:
    """Append to the log of a job whose row is locked."""
    following = select(func.coalesce(func.max(job_events.c.seq), 0) + 1).where(job_events.c.job == job)
    row = {"job": job, "seq": following.scalar_subquery(), "time": now(), "type": kind}
    connection.execute(insert(job_events).values(**row, data=orjson.dumps(data).decode()))


def events_after(connection: Connection, job: str, seq: int, size: int) -> list[JobEvent]:
    """Up to ``size`` entries that follow the number ``seq``."""
    columns = select(*(job_events.c[name] for name in JobEvent.__slots__))
    query = columns.where(job_events.c.job == job, job_events.c.seq > seq).order_by(job_events.c.seq).limit(size)
    return [JobEvent(*row) for row in connection.execute(query)]


def latest(connection: Connection, identifiers: Iterable[str]) -> dict[str, tuple[int, bool]]:
    """Of each job that is there the number of its last entry, and whether it is finished."""
    known = sorted(identifiers)
    last = select(func.max(job_events.c.seq)).where(job_events.c.job == jobs.c.id).scalar_subquery()
    columns = select(jobs.c.id, last, jobs.c.finished.is_not(None))
    found: dict[str, tuple[int, bool]] = {}
    for start in range(0, len(known), TOGETHER):
        for row in connection.execute(columns.where(jobs.c.id.in_(known[start : start + TOGETHER]))):
            found[row[0]] = row[1] or 0, bool(row[2])
    return found
