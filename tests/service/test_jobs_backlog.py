"""What is claimed ahead: enough of short items, nothing behind long ones, and every job gets its turn."""

from __future__ import annotations

import time
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.queries.attempts import Attempt
from service.queue import backlog
from service.queue.backlog import AHEAD, Backlog
from service.store.store import Store

from .fake_engine import FakeEngine, eventually, export, finished, items, running, submitted

MECHANICAL = ("metric", "gravity", "forces", "christoffel", "bias", "coriolis", "kinematics")
QUANTITIES = (*MECHANICAL, "potential_energy", "kinetic_energy")
OTHER = {"kind": "export", "items": [{"tree": "cell", "quantity": "metric", "format": "latex"}]}


def attempt(job: str, position: int = 0) -> Attempt:
    return Attempt(job, position, 1, "export", "key", "{}", "[]")


def test_short_items_are_claimed_ahead_and_long_ones_are_not() -> None:
    waiting = Backlog()
    ahead = waiting.ahead(2, [])
    assert [ahead(job) for job in ("new", "newer", "newest")] == [1, 1, 0]
    assert waiting.ahead(2, ["new"])("new") == 0
    waiting.note_end("short", 0.05)
    waiting.note_end("long", 100.0)
    waiting.note_end("tiny", 1e-9)
    assert waiting.ahead(2, ["short"])("short") == 16
    assert waiting.ahead(2, ["short", "long"])("short") == 8
    assert waiting.ahead(2, ["long"])("long") == 0
    assert waiting.ahead(2, ["tiny"])("tiny") == AHEAD
    waiting.attempts.extend(attempt("short", k) for k in range(15))
    assert waiting.ahead(2, ["short"])("short") == 1
    assert waiting.ahead(2, ["short"])("new") == 1
    waiting.forget({attempt("short", k).id for k in range(14)})
    assert [a.position for a in waiting.attempts] == [14]


def test_jobs_are_forgotten() -> None:
    waiting = Backlog()
    for k in range(1000):
        waiting.note_end(str(k), 0.01)
    assert waiting.ahead(1, ["0"])("0") == 0
    assert waiting.ahead(1, ["999"])("999") > 0


@pytest.fixture
def soon(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backlog, "STALE", 0.3)


@pytest.mark.usefixtures("soon")
def test_what_waits_behind_long_items_goes_back(filled: TestClient, store: Store) -> None:
    """Short items first, so that the rest of them is claimed ahead; then the engine is busy with two for long."""
    engine = FakeEngine(slots=2, is_open=False)
    engine.allowed = 4
    with running(store, engine):
        job = submitted(filled, export("cell", *QUANTITIES))

        def states() -> list[Any]:
            return [item["state"] for item in items(filled, job)]

        eventually(filled, job, lambda view: view["progress"]["done"] == 4)
        eventually(filled, job, lambda _: states().count("queued") == 3)
        assert sorted(states()) == ["queued"] * 3 + ["running"] * 2 + ["succeeded"] * 4
        assert filled.get(f"/v1/jobs/{job}").json()["attempts"] == 6
        time.sleep(1.2)
        assert states().count("queued") == 3
        other = submitted(filled, OTHER)
        engine.allowed = 1
        eventually(filled, other, lambda _: engine.works.keys() & {f"{other}.0.1"} != set())
        engine.open()
        assert finished(filled, other)["state"] == finished(filled, job)["state"] == "succeeded"
        assert [(item["state"], item["attempts"]) for item in items(filled, job)] == [("succeeded", 1)] * 9


@pytest.mark.usefixtures("soon")
def test_a_job_gets_its_turn_beside_one_of_many_short_items(filled: TestClient, store: Store) -> None:
    engine = FakeEngine(slots=1, is_open=False)
    with running(store, engine):
        many = submitted(filled, export("cell", *QUANTITIES))
        engine.allowed = 2
        eventually(filled, many, lambda view: view["progress"]["done"] == 2)
        other = submitted(filled, OTHER)
        eventually(filled, other, lambda view: view["attempts"] == 1 or engine.allowed == 0)
        engine.open()
        assert finished(filled, other)["state"] == finished(filled, many)["state"] == "succeeded"
