"""A queue in a database of its own, and rounds played on it, for the tests of queues."""

from __future__ import annotations

from datetime import timedelta
from typing import Any

from service.job_tables import job_events, job_items, job_uploads, jobs, result_files, results, uploads
from service.jobs.engine import Outcome
from service.operations.job_rounds import Ended, Played, Round, play
from service.queries import jobs as queries
from service.queries.jobs import NewItem
from service.store import Store


def clear(store: Store) -> None:
    """Remove all jobs."""
    with store.database.write() as connection:
        for table in (job_events, job_uploads, job_items, jobs, result_files, results, uploads):
            connection.execute(table.delete())


LEASE = timedelta(seconds=30)
OVER = timedelta(seconds=-1)
DONE = Outcome({"n": 1}, {"result": b"data"})


def add(store: Store, *keys: str) -> str:
    """A job with items of these keys."""
    with store.database.write() as connection:
        return queries.add_job(connection, "export", "local", [NewItem(key, "{}", "[]") for key in keys])


def round_of(store: Store, owner: str, *ended: Ended, wanted: int = 0, lease: timedelta = LEASE, **more: Any) -> Played:
    with store.database.write() as connection:
        return play(connection, Round(owner, lease, ended, wanted, **more))


def job_of(store: Store, identifier: str) -> queries.Job:
    with store.database.read() as connection:
        job = queries.get_job(connection, identifier)
    assert job is not None
    return job


def states(store: Store, job: str) -> list[str]:
    with store.database.read() as connection:
        return [item.state for item in queries.page_items(connection, job, None, -1, 100)]
