"""The queue in both databases: which state may follow which, fencing, leases, fairness, twins, retention."""

from __future__ import annotations

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import timedelta
from pathlib import Path
from typing import Any

import orjson
import pytest
import sqlalchemy as sa
from sqlalchemy.engine import make_url

from service.app import open_store
from service.database import Connection
from service.job_tables import ITEM_STATES, JOB_STATES, job_events, job_items, jobs, result_files, results
from service.jobs.engine import Outcome
from service.operations.job_rounds import Ended, Played, Round, play
from service.queries import jobs as queries
from service.queries import queue
from service.queries.attempts import Attempt
from service.queries.common import now
from service.queries.job_events import events_after
from service.queries.jobs import NewItem
from service.settings import Settings
from service.store import Store
from service.tables import metadata

from .test_postgres import server

LEASE = timedelta(seconds=30)
OVER = timedelta(seconds=-1)
DONE = Outcome({"n": 1}, {"result": b"data"})
CHANGES = {
    "jobs": {
        "queued": {"running", "succeeded", "cancelled"},
        "running": {"cancelling", "succeeded", "failed", "cancelled"},
        "cancelling": {"cancelled"},
    },
    "job_items": {
        "queued": {"running", "succeeded", "cancelled"},
        "running": {"queued", "succeeded", "failed", "cancelled"},
    },
}


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
    with opened.database.write() as connection:
        for table in (job_events, job_items, jobs, result_files, results):
            connection.execute(table.delete())


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


def force(connection: Connection, table: str, state: str) -> None:
    """Bring rows to a state by a way that is allowed."""
    path = {
        "queued": [],
        "cancelling": ["running", "cancelling"],
        "failed": ["running", "failed"],
        "running": ["running"],
    }.get(state, [state])
    for step in path:
        change(connection, table, step)


def change(connection: Connection, table: str, state: str) -> None:
    owner = {} if table == "jobs" else {"owner": "me" if state == "running" else None}
    connection.execute(metadata.tables[table].update().values(state=state, **owner))


@pytest.mark.parametrize("table", ["jobs", "job_items"])
def test_impossible_changes_are_refused(store: Store, table: str) -> None:
    add(store, "a")
    known = JOB_STATES if table == "jobs" else ITEM_STATES
    for old in known:
        for new in known:
            with store.database.writer.connect() as connection:
                force(connection, table, old)
                if new == old or new in CHANGES[table].get(old, ()):
                    change(connection, table, new)
                else:
                    with pytest.raises(sa.exc.IntegrityError, match="impossible change"):
                        change(connection, table, new)
                connection.rollback()
    with pytest.raises(sa.exc.IntegrityError), store.database.write() as connection:
        change(connection, table, "odd")
    row = {"id": "x", "kind": "k", "principal": "p", "state": "running", "total": 1, "done": 0, "failed": 0}
    with pytest.raises(sa.exc.IntegrityError, match="impossible first state"), store.database.write() as connection:
        connection.execute(jobs.insert().values(**row, attempts=0, created=now()))


def test_changes_of_state_are_logged(store: Store) -> None:
    job = add(store, "a", "b")
    one, two = round_of(store, "me", wanted=2).claimed
    round_of(store, "me", Ended(one, DONE), Ended(two, None, "killed"))
    (two,) = round_of(store, "me", wanted=1).claimed
    round_of(store, "me", Ended(two, DONE))
    with store.database.read() as connection:
        events = events_after(connection, job, 0, 100)
    assert [event.seq for event in events] == list(range(1, len(events) + 1))
    changes = [orjson.loads(event.data) for event in events if event.type == "state"]
    assert [(each["was"], each["state"]) for each in changes] == [
        (None, "queued"),
        ("queued", "running"),
        ("running", "succeeded"),
    ]
    assert changes[-1]["done"] == 2
    moves = [orjson.loads(event.data) for event in events if event.type == "items"]
    assert moves == [{"running": [0, 1]}, {"succeeded": [0], "queued": [1]}, {"running": [1]}, {"succeeded": [1]}]


def test_late_attempts_change_nothing(store: Store) -> None:
    job = add(store, "a")
    (first,) = round_of(store, "one", wanted=1, lease=OVER).claimed
    assert round_of(store, "two", wanted=1, take_over=True).claimed[0].number == 2
    played = round_of(store, "one", Ended(first, DONE))
    assert played.states == {}
    played = round_of(store, "one", Ended(first, None, "died"))
    assert (played.states, states(store, job)) == ({}, ["running"])
    second = Attempt(first.job, 0, 2, *(getattr(first, name) for name in ("kind", "key", "item", "blobs")))
    assert round_of(store, "one", Ended(second, DONE)).states == {}  # right number, wrong owner
    assert round_of(store, "two", Ended(second, DONE)).states == {"succeeded": 1}
    assert round_of(store, "two", Ended(second, DONE)).states == {}
    assert (job_of(store, job).state, job_of(store, job).done) == ("succeeded", 1)


def test_leases(store: Store) -> None:
    add(store, "a")
    (attempt,) = round_of(store, "one", wanted=1, lease=OVER).claimed
    with store.database.write() as connection:
        assert queue.renew(connection, "one", LEASE) == {attempt.id}
    assert round_of(store, "two", wanted=1, take_over=True).claimed == []
    assert round_of(store, "two", wanted=1, take_over=True, alone=True).claimed[0].number == 2
    with store.database.write() as connection:
        assert queue.renew(connection, "one", LEASE) == set()


def test_lost_owners_are_no_deaths_but_not_endless(store: Store) -> None:
    job = add(store, "a")
    for number in range(1, 21):
        (attempt,) = round_of(store, f"owner{number}", wanted=1, take_over=True, lease=OVER).claimed
        assert attempt.number == number
    assert round_of(store, "last", wanted=1, take_over=True).claimed == []
    assert (job_of(store, job).state, job_of(store, job).failed) == ("failed", 1)


def test_free_places_are_shared_between_jobs(store: Store) -> None:
    long, short = add(store, *map(str, range(10))), add(store, "x", "y")
    claimed = round_of(store, "me", wanted=4).claimed
    assert [(a.job, a.position) for a in claimed] == [(long, 0), (long, 1), (short, 0), (short, 1)]
    late = add(store, "z")
    assert [a.job for a in round_of(store, "me", wanted=2).claimed] == [late, long]
    assert len(round_of(store, "me", wanted=100).claimed) == 7


def test_twins_wait_for_each_other(store: Store) -> None:
    one, two = add(store, "a", "a", "b"), add(store, "a")
    claimed = round_of(store, "me", wanted=10).claimed
    assert sorted(a.key for a in claimed) == ["a", "b"]
    a, b = sorted(claimed, key=lambda each: each.key)
    played = round_of(store, "me", Ended(a, Outcome(problem={"status": 422})), wanted=10)
    (again,) = played.claimed  # a failure is the item's own: the next one tries for itself
    assert again.key == "a"
    played = round_of(store, "me", Ended(again, DONE), Ended(b, DONE), wanted=10)
    assert played.claimed == []
    assert {job_of(store, one).state, job_of(store, two).state} == {"succeeded"}
    assert job_of(store, add(store, "b")).state == "succeeded"


def test_nothing_is_claimed_twice(store: Store) -> None:
    add(store, *map(str, range(20)))
    claimed = [round_of(store, f"owner{k % 3}", wanted=3).claimed for k in range(10)]
    positions = [attempt.position for some in claimed for attempt in some]
    assert sorted(positions) == list(range(20))
    with pytest.raises(sa.exc.IntegrityError), store.database.write() as connection:  # the database refuses it too
        connection.execute(job_items.update().values(key="0"))


def test_cancelled_jobs_end_when_nothing_runs(store: Store) -> None:
    job = add(store, "a", "b", "c")
    one, two = round_of(store, "me", wanted=2).claimed
    with store.database.write() as connection:
        queries.cancel(connection, job)
    assert (job_of(store, job).state, states(store, job)) == ("cancelling", ["running", "running", "cancelled"])
    round_of(store, "other", wanted=5)
    assert job_of(store, job).state == "cancelling"
    played = round_of(store, "me", Ended(one, DONE))
    assert sorted(played.stopped) == sorted([one.id, two.id])
    assert (job_of(store, job).state, states(store, job)) == ("cancelled", ["cancelled"] * 3)


def test_cancelled_jobs_of_dead_owners_end(store: Store) -> None:
    job = add(store, "a")
    round_of(store, "dead", wanted=1, lease=OVER)
    with store.database.write() as connection:
        queries.cancel(connection, job)
    round_of(store, "me", wanted=1, take_over=True)
    assert job_of(store, job).state == "cancelled"


def test_outcomes_that_cannot_be_kept_fail_alone(store: Store) -> None:
    job = add(store, "a", "b")
    with store.database.write() as connection:
        connection.exec_driver_sql("UPDATE jobs SET kind = 'assemble'")
    bad, good = round_of(store, "me", wanted=2).claimed
    good = Attempt(
        *(getattr(good, name) for name in Attempt.__slots__[:3]), "export", *(good.key, good.item, good.blobs)
    )
    round_of(store, "me", Ended(bad, DONE), Ended(good, DONE))
    assert states(store, job) == ["failed", "succeeded"]
    assert job_of(store, job).state == "succeeded"


def test_retention(store: Store) -> None:
    old, young = add(store, "a", "b"), add(store, "b", "c")
    claimed = round_of(store, "me", wanted=10).claimed
    round_of(store, "me", *(Ended(attempt, DONE) for attempt in claimed))
    running = add(store, "d")
    with store.database.write() as connection:
        connection.execute(jobs.update().where(jobs.c.id == old).values(finished=now(timedelta(days=-40))))
        before = now(timedelta(days=-30))
        assert [queries.remove_finished(connection, before, 1) for _ in range(2)] == [1, 0]
    with store.database.read() as connection:
        assert queries.get_job(connection, old) is None
        assert set(connection.execute(sa.select(results.c.key)).scalars()) == {"b", "c"}
        assert set(connection.execute(sa.select(result_files.c.key)).scalars()) == {"b", "c"}
    assert (job_of(store, young).state, job_of(store, running).state) == ("succeeded", "queued")
