"""What happened to a job, in order; changes of its state are logged by the database itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import orjson
from sqlalchemy import Connection, func, insert, select

from service.database.job_tables import job_events
from service.queries.common import now


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
