"""A queue in a database of its own, and rounds played on it, for the tests of queues."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import timedelta
from typing import Any

import pytest

from service.app import open_store
from service.content.derivation import release
from service.database.job_tables import job_events, job_items, job_uploads, jobs, result_files, results, uploads
from service.jobs.engines.engine import Outcome
from service.messages.viewer import ANYBODY
from service.operations.jobs.submission import key_of
from service.queries.jobs import jobs as queries
from service.queries.jobs.jobs import NewItem
from service.queue.rounds import Ended, Played, Round, play
from service.settings import Settings
from service.store.store import Store
from substructures.documents import write_json

from .databases import fresh


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def opened(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with (
        fresh(request.param, tmp_path_factory.mktemp("queue")) as address,
        open_store(Settings(database=address, catalogue=False)) as store,
    ):
        yield store


@pytest.fixture
def store(opened: Store) -> Iterator[Store]:
    """A store without jobs."""
    yield opened
    clear(opened)


def clear(store: Store) -> None:
    """Remove all jobs."""
    with store.database.write() as connection:
        for table in (job_events, job_uploads, job_items, jobs, result_files, results, uploads):
            connection.execute(table.delete())


LEASE = timedelta(seconds=30)
OVER = timedelta(seconds=-1)
DONE = Outcome({"n": 1}, {"result": b"data"})


def item(name: str) -> NewItem:
    """An item with its key, as it is submitted."""
    content = write_json({"name": name})
    return NewItem(key_of("export", {}, content, release()), content.decode(), "[]")


def add(store: Store, *names: str) -> str:
    """A job with items of these names."""
    with store.database.write() as connection:
        return queries.add_job(connection, "export", ANYBODY, [item(name) for name in names])


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
