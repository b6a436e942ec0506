"""States of jobs and items in both databases: which may follow which, what is logged, cancelled and removed."""

from __future__ import annotations

from datetime import timedelta

import orjson
import pytest
import sqlalchemy as sa

from service.database.connections import Connection
from service.database.job_tables import ITEM_STATES, JOB_STATES, jobs, result_files, results
from service.database.tables import metadata
from service.queries import removal
from service.queries.common import now
from service.queries.jobs import jobs as queries
from service.queries.jobs.job_events import events_after
from service.queue.rounds import Ended
from service.store.store import Store

from .queue_rounds import DONE, OVER, add, item, job_of, opened, round_of, states, store

__all__ = ["opened", "store"]  # fixtures


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


def test_retention(store: Store) -> None:
    old, young = add(store, "a", "b"), add(store, "b", "c")
    claimed = round_of(store, "me", wanted=10).claimed
    round_of(store, "me", *(Ended(attempt, DONE) for attempt in claimed))
    running = add(store, "d")
    with store.database.write() as connection:
        connection.execute(jobs.update().where(jobs.c.id == old).values(finished=now(timedelta(days=-40))))
        before = now(timedelta(days=-30))
        assert [removal.remove_finished(connection, before, 1) for _ in range(2)] == [1, 0]
    left = {item("b").key, item("c").key}
    with store.database.read() as connection:
        assert queries.get_job(connection, old) is None
        assert set(connection.execute(sa.select(results.c.key)).scalars()) == left
        assert set(connection.execute(sa.select(result_files.c.key)).scalars()) == left
    assert (job_of(store, young).state, job_of(store, running).state) == ("succeeded", "queued")
