"""``Idempotency-Key``: the same request acts once, also after a restart."""

from __future__ import annotations

import threading
import time
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import Engine, event

from service.app import open_store
from service.messages.refusals import StaleError
from service.operations import trees
from service.operations.jobs import jobs
from service.queries import idempotency
from service.settings import Settings
from service.store import idempotency as claims
from service.store.runtime import COMPUTED, Computed

from .conftest import HAND, PENDULUM, TREE, make_client
from .databases import fresh

KEY = {"Idempotency-Key": "3f6b"}
DEAD = idempotency.Claim("local", "3f6b", "dead")


def test_replay(filled: TestClient, rows: Any) -> None:
    first = filled.post("/v1/trees/cell/couplings", json=HAND, headers=KEY)
    before = rows()
    second = filled.post("/v1/trees/cell/couplings", json=HAND, headers=KEY)
    assert (first.status_code, second.status_code) == (201, 201)
    assert second.content == first.content
    assert second.headers["location"] == first.headers["location"]
    assert second.headers["idempotency-replayed"] == "true"
    assert rows() == before


def test_a_removal_that_is_sent_again(filled: TestClient) -> None:
    """It takes nothing away that is new, and is no failure; the client sends it again where no answer comes."""
    removed = [filled.delete("/v1/trees/cell", headers=KEY)]
    assert filled.post("/v1/trees", json=TREE).status_code == 201
    removed += [filled.delete("/v1/trees/cell", headers=KEY)]
    assert [answer.status_code for answer in removed] == [204, 204]
    assert filled.get("/v1/trees/cell").status_code == 200


def test_other_requests_under_the_same_key(filled: TestClient) -> None:
    filled.post("/v1/trees/cell/couplings", json=HAND, headers=KEY)
    for path, body in (("cell/couplings", {**HAND, "name": "other"}), ("cell@1/couplings", HAND)):
        answer = filled.post(f"/v1/trees/{path}", json=body, headers=KEY)
        assert (answer.status_code, answer.json()["code"]) == (422, "idempotency-key-reused")


def test_survives_a_restart(settings: Settings) -> None:
    with open_store(settings) as store:
        first = make_client(store).post("/v1/substructures", json=PENDULUM, headers=KEY)
    with open_store(settings) as store:
        second = make_client(store).post("/v1/substructures", json=PENDULUM, headers=KEY)
    assert (first.status_code, second.status_code) == (201, 201)
    assert second.content == first.content


def test_failures_free_the_key(filled: TestClient, rows: Any) -> None:
    before = rows()
    assert filled.post("/v1/trees/cell/couplings", json={**HAND, "at": "arm.x"}, headers=KEY).status_code == 422
    assert rows() == before
    assert filled.post("/v1/trees/cell/couplings", json=HAND, headers=KEY).status_code == 201


def test_in_flight(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    started, finish = threading.Event(), threading.Event()
    prepare = trees.prepare_change

    def slow(*arguments: Any) -> Any:
        started.set()
        assert finish.wait(10)
        return prepare(*arguments)

    monkeypatch.setattr("service.operations.trees.prepare_change", slow)
    answers: list[Any] = []

    def post() -> None:
        answers.append(filled.post("/v1/trees/cell/couplings", json=HAND, headers=KEY))

    thread = threading.Thread(target=post)
    thread.start()
    assert started.wait(10)
    second = filled.post("/v1/trees/cell/couplings", json=HAND, headers=KEY)
    assert (second.status_code, second.json()["code"]) == (409, "idempotency-in-flight")
    assert second.headers["retry-after"] == "1"
    finish.set()
    thread.join()
    assert answers[0].status_code == 201


def test_claims_of_a_dead_server_are_dropped(settings: Settings) -> None:
    with open_store(settings) as store:
        client = make_client(store)
        with store.database.write() as connection:
            assert idempotency.claim(connection, DEAD, "x") is None
        assert client.post("/v1/substructures", json=PENDULUM, headers=KEY).status_code == 422
    with open_store(settings) as store:
        assert make_client(store).post("/v1/substructures", json=PENDULUM, headers=KEY).status_code == 201


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_claims_end_soon_after_their_server(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """That of a server that was killed is taken over when its lease is over; that of one that works is renewed."""
    assert timedelta(seconds=5) >= claims.LEASE
    monkeypatch.setattr("service.http.idempotency.LEASE", timedelta(seconds=0.6))
    monkeypatch.setattr(claims, "RENEWAL", 0.05)
    monkeypatch.setattr(claims, "FORGET", 1e9)  # by those who want them alone
    living = idempotency.Claim("local", "living", "we")
    with fresh(kind, tmp_path) as address, open_store(Settings(database=address, catalogue=False)) as store:
        client = make_client(store)
        with store.database.write() as connection:
            assert idempotency.claim(connection, DEAD, "x") is None
            assert idempotency.claim(connection, living, "x") is None
        store.claims.hold(living)

        def post(key: str) -> int:
            return client.post("/v1/substructures", json=PENDULUM, headers={"Idempotency-Key": key}).status_code

        while post(DEAD.key) == 422:  # it is another request's
            time.sleep(0.05)
        assert post(DEAD.key) == 201
        for _ in range(20):
            assert post(living.key) == 422
            time.sleep(0.05)
        with store.database.write() as connection:
            idempotency.release(connection, living)
        assert post(living.key) == 200
        while store.claims.count:  # what is no claim any more is forgotten
            time.sleep(0.05)


def test_evaluations_are_computed_again(filled: TestClient, rows: Any) -> None:
    body = {"quantities": ["metric"], "q": [0.1]}
    first = filled.post("/v1/trees/cell/evaluations", json=body, headers=KEY)
    count = rows()
    second = filled.post("/v1/trees/cell/evaluations", json=body, headers=KEY)
    assert (first.status_code, second.content) == (200, first.content)
    assert rows() == count
    assert filled.post("/v1/trees/cell/evaluations", json={**body, "q": [0.2]}, headers=KEY).status_code == 422


def test_computations_write_nothing(filled: TestClient) -> None:
    writes: list[str] = []

    def written(*given: Any) -> None:
        if not given[2].lstrip().upper().startswith(("SELECT", "PRAGMA", "BEGIN")):
            writes.append(given[2])

    body = {"quantities": ["metric"], "q": [0.1]}
    filled.post("/v1/trees/cell/evaluations", json=body)
    event.listen(Engine, "before_cursor_execute", written)
    try:
        answers = [filled.post("/v1/trees/cell/evaluations", json=body, headers=KEY) for _ in range(2)]
    finally:
        event.remove(Engine, "before_cursor_execute", written)
    assert [answer.status_code for answer in answers] == [200, 200]
    assert not writes


def test_a_computation_becomes_one_job(filled: TestClient) -> None:
    body = {"quantities": ["metric"], "q": [0.1]}
    headers = {**KEY, "Prefer": "respond-async"}
    first, second = (filled.post("/v1/trees/cell/evaluations", json=body, headers=headers) for _ in range(2))
    assert (first.status_code, second.status_code) == (202, 202)
    assert second.content == first.content
    assert second.headers["idempotency-replayed"] == "true"
    assert filled.post("/v1/trees/cell/evaluations", json=body, headers=KEY).content == first.content
    other = filled.post("/v1/trees/cell/evaluations", json={**body, "q": [0.2]}, headers=headers)
    assert (other.status_code, other.json()["code"]) == (422, "idempotency-key-reused")


def test_a_job_that_is_tried_again_keeps_its_key(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Others have changed something meanwhile: the claim is ours already."""
    submit, tries = jobs.submit, list[int]()

    def stale(*given: Any) -> Any:
        tries.append(1)
        if len(tries) == 1:
            raise StaleError
        return submit(*given)

    monkeypatch.setattr(jobs, "submit", stale)
    body = {"quantities": ["metric"], "q": [0.1]}
    headers = {**KEY, "Prefer": "respond-async"}
    first, second = (filled.post("/v1/trees/cell/evaluations", json=body, headers=headers) for _ in range(2))
    assert (first.status_code, second.content, len(tries)) == (202, first.content, 2)


def test_a_process_remembers_some_computations() -> None:
    computed = Computed()
    assert [computed.first("local", f"{i}", "a") for i in range(COMPUTED + 1)] == ["a"] * (COMPUTED + 1)
    assert (computed.first("local", "1", "b"), computed.first("local", "0", "b")) == ("a", "b")


@pytest.mark.parametrize("key", ["", "x" * 256])
def test_wrong_keys(client: TestClient, key: str) -> None:
    assert client.post("/v1/substructures", json=PENDULUM, headers={"Idempotency-Key": key}).status_code == 422
