"""A queue in a database of its own, and rounds played on it, for the tests of queues."""

from __future__ import annotations

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from sqlalchemy.engine import make_url

from service.job_tables import job_events, job_items, job_uploads, jobs, result_files, results, uploads
from service.jobs.engine import Outcome
from service.operations.job_rounds import Ended, Played, Round, play
from service.queries import jobs as queries
from service.queries.jobs import NewItem
from service.store import Store

from .test_postgres import server


def clear(store: Store) -> None:
    """Remove all jobs."""
    with store.database.write() as connection:
        for table in (job_events, job_uploads, job_items, jobs, result_files, results, uploads):
            connection.execute(table.delete())


LEASE = timedelta(seconds=30)


OVER = timedelta(seconds=-1)


DONE = Outcome({"n": 1}, {"result": b"data"})


@contextmanager
def fresh(kind: str, folder: Path) -> Iterator[str]:
    """The address of an empty database."""
    if kind == "sqlite":
        yield f"sqlite:///{folder / 'queue.db'}"
        return
    base = server()
    if base is None:
        pytest.skip("no PostgreSQL server answers at TEST_POSTGRES_URL or 127.0.0.1:5432")
    name = f"substructures_jobs_{secrets.token_hex(6)}"
    engine = sa.create_engine(base, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.exec_driver_sql(f'CREATE DATABASE "{name}"')
    try:
        yield make_url(base).set(database=name).render_as_string(hide_password=False)
    finally:
        with engine.connect() as connection:
            connection.exec_driver_sql(f'DROP DATABASE "{name}" WITH (FORCE)')
        engine.dispose()


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
