"""Those who derive do not take the time of those who ask for numbers, and share their own."""

from __future__ import annotations

from concurrent.futures import Future
from threading import Event, Thread
from time import sleep
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.jobs.engines.pool import THREADS, InProcess
from service.messages.viewer import ANYBODY
from service.operations import catalogue
from service.processes.threads import SharedThreads
from service.schemas.entries import PLAIN
from service.settings import Limits
from service.store.store import Store
from substructures import Definition, derive

from .conftest import PENDULUM
from .fake_engine import FakeEngine, finished, running
from .jobs_library import chain


def test_everybody_gets_a_turn() -> None:
    threads, gate, order = SharedThreads(1, "test"), Event(), list[str]()
    begun = Event()
    first = threads.submit("many", lambda: begun.set() or gate.wait(10))
    assert begun.wait(10)
    works = [threads.submit(share, lambda share=share: order.append(share)) for share in [*["many"] * 3, "one", "two"]]
    gate.set()
    for work in (first, *works):
        work.result(10)
    assert order == ["many", "one", "two", "many", "many"]
    failing = threads.submit("one", lambda: 1 // 0)
    with pytest.raises(ZeroDivisionError):
        failing.result(10)
    threads.close()


def test_what_is_not_begun_is_dropped_at_the_end() -> None:
    threads, gate = SharedThreads(1, "test"), Event()
    has_begun = Event()
    begun = threads.submit("a", lambda: has_begun.set() or gate.wait(10))
    assert has_begun.wait(10)
    waiting = threads.submit("a", gate.wait)
    closing = Thread(target=threads.close)
    closing.start()
    while not waiting.done():
        sleep(0.001)
    gate.set()
    closing.join(10)
    assert (begun.result(10), waiting.cancelled()) == (True, True)


def busy(store: Store, gate: Event, count: int = THREADS) -> list[Future[bool]]:
    """So many works of another one, which end when the gate is open."""
    assert isinstance(store.workers, InProcess)
    begun = [Event() for _ in range(count)]
    works = [store.workers.threads.submit("other", lambda one=one: one.set() or gate.wait(60)) for one in begun]
    assert all(one.wait(10) for one in begun)
    return works


def test_evaluations_do_not_wait_for_derivations(filled: TestClient, store: Store) -> None:
    gate = Event()
    waiting = busy(store, gate)
    assert filled.post("/v1/substructures", json=chain(2), headers={"Prefer": "wait=1"}).status_code == 202
    assert filled.post("/v1/trees/cell/evaluations", json={"quantities": ["metric"], "q": [0.1]}).status_code == 200
    assert not any(each.done() for each in waiting)
    gate.set()
    assert all(each.result(10) for each in waiting)


def test_what_has_waited_too_long_is_not_begun(
    client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[Any] = []
    monkeypatch.setattr("service.jobs.kinds.derive.derive", lambda *given: begun.append(given))
    store.settings = store.settings.model_copy(update={"limits": Limits(sync_seconds=0.3)})
    gate = Event()
    waiting = busy(store, gate)
    assert client.post("/v1/substructures", json=chain(2)).status_code == 202
    gate.set()
    assert all(each.result(10) for each in waiting)
    store.workers.close()  # whatever waited has had its turn
    assert begun == []


def test_what_is_large_becomes_a_job_before_it_is_begun(
    client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    store.settings = store.settings.model_copy(update={"limits": Limits(sync_nodes=1000)})
    begun: list[Any] = []
    monkeypatch.setattr("substructures.part.derive.formulas", lambda *given: begun.append(given))
    answer = client.post("/v1/substructures", json=chain(6))
    assert (answer.status_code, answer.json()["kind"], begun) == (202, "derive", [])
    monkeypatch.undo()
    assert client.post("/v1/substructures", json=PENDULUM).status_code == 201


def test_couplings_too(filled: TestClient, store: Store) -> None:
    store.settings = store.settings.model_copy(update={"limits": Limits(sync_nodes=500)})
    tree = {"name": "two", "instances": [{"name": name, "substructure": "slider"} for name in ("a", "b")]}
    with running(store, FakeEngine()):
        answer = filled.post("/v1/trees", json=tree)
        assert answer.status_code == 202
        finished(filled, answer.json()["id"])
    assert filled.get("/v1/trees/two").json()["dof"] == 2


@pytest.mark.parametrize("dof", [6, 12])
def test_the_size_is_known_before(store: Store, dof: int) -> None:
    told: list[int] = []
    part = derive(Definition.read(chain(dof)), admit=told.append)
    assert told[0] == pytest.approx(len(part.program), rel=0.6)
    assert catalogue.prepare(store, ANYBODY, part.definition, PLAIN).content is not None
