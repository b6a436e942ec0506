"""The queue in both databases: fencing, leases, fairness, twins."""

from __future__ import annotations

import pytest
import sqlalchemy as sa

from service.database.job_tables import job_items
from service.jobs.engines.engine import Outcome
from service.queries.attempts import Attempt
from service.queries.jobs import queue
from service.queue import rounds
from service.queue.rounds import Ended
from service.store.store import Store

from .queue_rounds import DONE, LEASE, OVER, add, item, job_of, opened, round_of, states, store

__all__ = ["opened", "store"]  # fixtures


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


def test_lost_owners_are_no_deaths_but_not_endless(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rounds, "MAX_ATTEMPTS", 20)
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
    a, b = sorted(claimed, key=lambda each: each.item)
    assert [a.key, b.key] == [item("a").key, item("b").key]
    played = round_of(store, "me", Ended(a, Outcome(problem={"status": 422})), wanted=10)
    (again,) = played.claimed  # a failure is the item's own: the next one tries for itself
    assert again.key == a.key
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


def test_what_was_lost_goes_behind_the_others(store: Store) -> None:
    add(store, "a", "b", "c")
    assert [a.position for a in round_of(store, "one", wanted=1, lease=OVER).claimed] == [0]
    claimed = round_of(store, "two", wanted=3, take_over=True).claimed
    assert [(a.position, a.number) for a in claimed] == [(1, 1), (2, 1), (0, 2)]
