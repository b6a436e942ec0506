"""Requests that become jobs: what takes too long, and what is asked for with ``Prefer``."""

from __future__ import annotations

from threading import Event
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.operations import trees
from service.settings import Settings
from service.store.keys import create
from service.store.runtime import THREADS
from service.store.store import Store
from substructures import InvalidDocument

from .conftest import HAND, PENDULUM, SLIDER, TREE, make_client
from .fake_engine import FakeEngine, finished, running

ASYNC = {"Prefer": "respond-async"}
EVALUATION = {"quantities": ["metric"], "q": [[0.1], [0.2]]}


def deferred(client: TestClient, path: str, body: Any, headers: dict[str, str], seconds: float = 10) -> Any:
    """The only item of the job that a request became."""
    answer = client.post(path, json=body, headers=headers)
    assert answer.status_code == 202, answer.text
    job = finished(client, answer.headers["location"].rpartition("/")[2], seconds)
    assert job["progress"]["total"] == 1
    return client.get(job["result"]).json()["items"][0]


def set_limit(store: Store, seconds: float) -> None:
    """Let requests compute so long."""
    limits = store.settings.limits.model_copy(update={"sync_seconds": seconds})
    store.settings = store.settings.model_copy(update={"limits": limits})


@pytest.mark.parametrize("headers", [ASYNC, {"Prefer": "wait=0"}, {"Prefer": "wait=10, Respond-Async; x=y"}])
def test_everything_that_computes(filled: TestClient, store: Store, headers: dict[str, str]) -> None:
    with running(store, FakeEngine()):
        hand = deferred(filled, "/v1/trees/cell/couplings", HAND, headers)
        assert (hand["result"]["tree"], hand["state"]) == ("cell@2", "succeeded")
        tree = {"name": "other", "instances": [{"name": "a", "substructure": "slider"}]}
        assert deferred(filled, "/v1/trees", tree, headers)["result"]["tree"] == "other@1"
        part = deferred(filled, "/v1/substructures", {**PENDULUM, "name": "late"}, headers)
        assert part["result"]["location"] == "/v1/substructures/late@1"
        numbers = deferred(filled, "/v1/trees/cell@1/evaluations", EVALUATION, headers)
        assert numbers["files"][0]["name"] == "result"
    assert filled.get("/v1/trees/cell").json()["based_on"] == 1
    assert filled.get("/v1/trees/cell").json()["coordinates"] == ["arm.q", "hand.q"]
    twin = filled.post("/v1/trees/cell@1/couplings", json=HAND).json()
    assert twin["digest"] == filled.get("/v1/trees/cell@2").json()["digest"]


def test_too_long_requests_become_jobs(filled: TestClient, store: Store, rows: Any) -> None:
    set_limit(store, 1e-6)
    before = rows()
    with running(store, FakeEngine(is_open=False)) as engine:
        first = filled.post("/v1/trees/cell/couplings", json=HAND, headers={"Idempotency-Key": "1"})
        second = filled.post("/v1/trees/cell/couplings", json=HAND, headers={"Idempotency-Key": "1"})
        assert (first.status_code, second.content) == (202, first.content)
        assert rows()["trees"] == before["trees"]
        engine.open()
        finished(filled, first.json()["id"])
        key = {"Idempotency-Key": "2"}
        numbers = [filled.post("/v1/trees/cell@1/evaluations", json=EVALUATION, headers=key) for _ in range(2)]
        assert numbers[1].content == numbers[0].content
    assert rows()["trees"] == before["trees"] + 1
    assert rows()["jobs"] == 2


def test_a_change_of_a_tree_that_was_removed_meanwhile(filled: TestClient, store: Store) -> None:
    """It does not bring the tree back."""
    with running(store, FakeEngine(is_open=False)) as engine:
        places = [f"/v1/trees/{ref}/couplings" for ref in ("cell", "cell@1")]
        jobs = [filled.post(place, json=HAND, headers=ASYNC).json() for place in places]
        assert filled.delete("/v1/trees/cell").status_code == 204
        engine.open()
        for job in jobs:
            finished(filled, job["id"])
            (item,) = filled.get(f"/v1/jobs/{job['id']}/items").json()["items"]
            assert (item["state"], item["problem"]["code"]) == ("failed", "conflict")
    assert filled.get("/v1/trees/cell").status_code == 404


def test_a_tree_that_a_job_makes_is_what_its_request_expected(filled: TestClient, store: Store) -> None:
    """What was expected of the tree when the job was submitted has to be so when the tree is stored."""
    tag = filled.get("/v1/trees/cell").headers["etag"]
    with running(store, FakeEngine(is_open=False)) as engine:
        given = [("none", {"If-None-Match": "*"}), ("new", {"If-None-Match": "*"}), ("cell", {"If-Match": tag})]
        tree = {**TREE, "gravity": [0, 0, -3]}
        jobs = {n: filled.post("/v1/trees", json={**tree, "name": n}, headers=ASYNC | h).json() for n, h in given}
        for name in ("new", "cell"):
            assert filled.post("/v1/trees", json={**TREE, "name": name, "gravity": [0, 0, -1]}).status_code == 201
        engine.open()
        items = {}
        for name, job in jobs.items():
            finished(filled, job["id"])
            (items[name],) = filled.get(f"/v1/jobs/{job['id']}/items").json()["items"]
    assert items["none"]["result"]["tree"] == "none@1"
    assert [items[name]["problem"]["code"] for name in ("new", "cell")] == ["conflict"] * 2


def test_a_part_that_a_job_makes_is_what_its_request_expected(filled: TestClient, store: Store) -> None:
    """What was expected of the part when the job was submitted has to be so when the part is stored."""
    tag = filled.get("/v1/substructures/pendulum").headers["etag"]
    with running(store, FakeEngine(is_open=False)) as engine:
        given = [("none", {"If-None-Match": "*"}), ("new", {"If-None-Match": "*"}), ("pendulum", {"If-Match": tag})]
        made = {n: {**PENDULUM, "name": n, "title": "By a job"} for n, _ in given}
        jobs = {n: filled.post("/v1/substructures", json=made[n], headers=ASYNC | h).json() for n, h in given}
        for name in ("new", "pendulum"):
            assert filled.post("/v1/substructures", json={**PENDULUM, "name": name, "tags": []}).status_code == 201
        engine.open()
        items = {}
        for name, job in jobs.items():
            finished(filled, job["id"])
            (items[name],) = filled.get(f"/v1/jobs/{job['id']}/items").json()["items"]
    assert items["none"]["result"]["version"] == 1, items
    assert [items[name]["problem"]["code"] for name in ("new", "pendulum")] == ["precondition-failed"] * 2


@pytest.mark.parametrize("fails", [False, True])
def test_work_that_is_given_up_acts_once(
    filled: TestClient, store: Store, rows: Any, monkeypatch: pytest.MonkeyPatch, fails: bool
) -> None:
    """The thread goes on after the answer, and neither stores its result nor gives the key up."""
    set_limit(store, 0.2)
    before, prepare, answered, ended = rows(), trees.prepare, Event(), Event()

    def slow(*arguments: Any, **options: Any) -> Any:
        answered.wait(10)
        ended.set()
        if fails:
            raise InvalidDocument.at("", "late", "too late to be told")
        return prepare(*arguments, **options)

    monkeypatch.setattr(trees, "prepare", slow)
    tree = {"name": "other", "instances": [{"name": "a", "substructure": "slider"}]}
    with running(store, FakeEngine()):
        first = filled.post("/v1/trees", json=tree, headers={"Idempotency-Key": "1"})
        answered.set()
        assert (first.status_code, ended.wait(10)) == (202, True)
        again = filled.post("/v1/trees", json=tree, headers={"Idempotency-Key": "1"})
        assert (again.status_code, again.content) == (202, first.content)
        finished(filled, first.json()["id"])
    assert (rows()["trees"], rows()["jobs"]) == (before["trees"] + 1, before["jobs"] + 1)


def test_requests_that_no_thread_is_free_for(filled: TestClient, store: Store) -> None:
    set_limit(store, 0.2)
    gate = Event()
    others = [
        store.runtime.threads[task].submit("other", lambda: gate.wait(10))
        for task, count in THREADS.items()
        for _ in range(count)
    ]
    assert filled.post("/v1/trees/cell/evaluations", json=EVALUATION).status_code == 202
    assert filled.post("/v1/trees/cell@1/kernels", json={"quantities": ["metric"]}).status_code == 503
    gate.set()
    assert all(other.result() for other in others)
    assert filled.post("/v1/trees/cell/evaluations", json=EVALUATION).status_code == 200


def test_faults_have_the_pointers_of_the_request(filled: TestClient, rows: Any) -> None:
    before = rows()
    for path, body, pointer in (
        ("/v1/trees", {"name": "x", "instances": [{"name": "a", "substructure": "no"}]}, "/instances/0/substructure"),
        ("/v1/trees/cell/couplings", {**HAND, "substructure": "no"}, "/substructure"),
        ("/v1/substructures", {**SLIDER, "name": "No"}, "/name"),
        ("/v1/trees/cell/evaluations", {"quantities": ["nothing"]}, "/quantities/0"),
    ):
        now, later = (filled.post(path, json=body, headers=headers) for headers in ({}, ASYNC))
        assert (now.status_code, later.status_code) == (422, 422)
        assert now.json()["errors"][0]["pointer"] == later.json()["errors"][0]["pointer"] == pointer
    assert filled.post("/v1/trees/none/couplings", json=HAND, headers=ASYNC).status_code == 404
    assert rows() == before


def test_changes_of_a_changed_tree_are_conflicts(filled: TestClient, store: Store) -> None:
    answer = filled.post("/v1/trees/cell/couplings", json=HAND, headers=ASYNC)
    assert filled.post("/v1/trees/cell/couplings", json={**HAND, "name": "first"}).status_code == 201
    with running(store, FakeEngine()):
        job = finished(filled, answer.json()["id"])
    item = filled.get(job["result"]).json()["items"][0]
    assert (item["state"], item["problem"]["status"]) == ("failed", 409)


def test_scopes(settings: Settings) -> None:
    with open_store(settings) as store:
        with store.database.write() as connection:
            scopes = (["admin"], ["write"], ["jobs"], ["read"], ["jobs", "read"])
            owned = {
                " ".join(s): create(connection, "", s, None, "another" if s == ["read"] else "one") for s in scopes
            }
            keys = {scope: {"Authorization": f"Bearer {key}"} for scope, key in owned.items()}
        client = make_client(store)
        client.post("/v1/substructures", json=PENDULUM, headers=keys["admin"])
        assemble = {
            "kind": "assemble",
            "items": [{"name": "x", "instances": [{"name": "a", "substructure": "pendulum"}]}],
        }
        verify = {"kind": "verify", "items": [{"substructure": "*"}]}

        def post(path: str, body: Any, key: str, **headers: str) -> int:
            return client.post(path, json=body, headers={**keys[key], **headers}).status_code

        assert [post("/v1/jobs", verify, key) for key in ("read", "write", "jobs", "admin")] == [403, 403, 202, 202]
        assert post("/v1/jobs", assemble, "jobs") == 403
        assert post("/v1/substructures", PENDULUM, "write", Prefer="respond-async") == 403
        job = client.post("/v1/jobs", json=verify, headers=keys["jobs read"]).json()["id"]
        assert client.get(f"/v1/jobs/{job}", headers=keys["jobs"]).status_code == 403
        assert client.get(f"/v1/jobs/{job}", headers=keys["read"]).status_code == 404  # of another owner
        assert client.get(f"/v1/jobs/{job}", headers=keys["jobs read"]).status_code == 200
        assert post(f"/v1/jobs/{job}/cancel", {}, "jobs") == 200  # of the same owner
        assert post(f"/v1/jobs/{job}/cancel", {}, "jobs read") == 200
        assert post(f"/v1/jobs/{job}/cancel", {"x": 1}, "admin") == 422
