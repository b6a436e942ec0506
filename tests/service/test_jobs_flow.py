"""Jobs over HTTP with an engine without processes: submit, results, cancel, twins, pages."""

from __future__ import annotations

import io
import json
import zipfile
from typing import Any, get_args

import pytest
from fastapi.testclient import TestClient

from service.jobs.kinds import KINDS
from service.operations.jobs import jobs as operations
from service.routes.jobs import job_streams
from service.schemas.jobs import JobKind
from service.store.store import Store
from substructures.expr.program import read_program

from .conftest import PENDULUM, SLIDER
from .fake_engine import FakeEngine, eventually, export, finished, items, running, submitted

CELLS: dict[str, Any] = {
    "kind": "assemble",
    "template": {"name": "pair", "instances": [{"name": "a", "substructure": "pendulum"}]},
    "choices": {"a": ["pendulum", "slider"]},
}


def test_export(filled: TestClient, store: Store) -> None:
    with running(store, FakeEngine()):
        job = submitted(filled, export("cell", "metric", "gravity"))
        view = finished(filled, job)
    assert view["state"] == "succeeded"
    assert view["progress"] | {"rate": None} == {
        "done": 2,
        "failed": 0,
        "skipped": 0,
        "total": 2,
        "fraction": 1,
        "rate": None,
        "eta_seconds": None,
    }
    found = items(filled, job)
    assert [item["state"] for item in found] == ["succeeded"] * 2
    file = found[0]["files"][0]
    text = filled.get(file["href"])
    assert text.text == filled.get("/v1/trees/cell/metric?format=text").text
    assert text.headers["content-type"].startswith("text/plain")
    with zipfile.ZipFile(io.BytesIO(filled.get(f"/v1/jobs/{job}/archive").content)) as archive:
        assert archive.read("0/text.txt") == text.content
        assert json.loads(archive.read("1/item.json"))["state"] == "succeeded"
        assert archive.testzip() is None
    assert filled.get("/v1/jobs?kind=export&state=succeeded").json()["items"][0]["id"] == job
    assert filled.get("/v1/jobs?state=failed").json()["items"] == []
    for position in (-(10**20), -1, 2, 2**31, 10**20):
        answer = filled.get(f"/v1/jobs/{job}/items/{position}/files/text")
        assert (answer.status_code, answer.json()["code"]) == (404, "unknown-item")


def test_files_in_an_archive_have_the_endings_of_their_formats(filled: TestClient, store: Store) -> None:
    formats = {"c": ".c", "latex": ".tex", "json": ".json", "python": ".py", "mathml": ".xhtml", "fortran": ".f90"}
    swing = {"q": [0.5], "span": [0, 1], "count": 3}
    exports = [{"tree": "cell", "quantity": "metric", "format": each} for each in formats]
    targets = [{"tree": "cell", "target": each} for each in ("casadi", "c", "interface")]
    motions = [{"tree": "cell", "request": swing, "format": each} for each in ("npz", "csv", "svg", "json")]
    with running(store, FakeEngine()):
        for kind, given, expected in (
            ("export", exports, [f"text{ending}" for ending in formats.values()]),
            ("export", targets, ["text.c", "archive.zip", "text.json"]),
            ("simulate", motions, ["result.npz", "result.csv", "result.svg", "result.json"]),
        ):
            job = submitted(filled, {"kind": kind, "items": given})
            assert finished(filled, job, 60)["progress"]["failed"] == 0
            with zipfile.ZipFile(io.BytesIO(filled.get(f"/v1/jobs/{job}/archive").content)) as archive:
                names = [name for name in archive.namelist() if not name.endswith("item.json")]
            assert names == [f"{position}/{name}" for position, name in enumerate(expected)]


def test_an_archive_has_the_formulas_of_trees_and_parts(filled: TestClient, store: Store) -> None:
    """Once for all that share them."""
    derived = {"kind": "derive", "items": [{**PENDULUM, "title": "another"}]}
    alike = {**CELLS, "choices": {"/name": ["one", "two", "three"]}}
    with running(store, FakeEngine()):
        for body, of_job, count in ((CELLS, "/v1/trees/{tree}", 2), (derived, "", 1), (alike, "/v1/trees/{tree}", 1)):
            job = submitted(filled, body)
            assert finished(filled, job)["state"] == "succeeded"
            data = filled.get(f"/v1/jobs/{job}/archive").content
            with zipfile.ZipFile(io.BytesIO(data)) as archive:
                assert sum(name.startswith("programs/") for name in archive.namelist()) == count
                for item in items(filled, job):
                    formulas = archive.read(f"programs/{item['result']['program'].removeprefix('sha256:')}.json")
                    program = read_program(json.loads(formulas))
                    assert program.digest == item["result"]["program"]
                    if of_job:
                        tree = filled.get(of_job.format(tree=item["result"]["tree"])).json()
                        assert tree["program"] == program.digest
                        assert {"metric", "christoffel", "forces"} <= set(program.outputs)


def test_an_archive_breaks_off_where_its_job_is_removed(
    filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(job_streams, "ITEMS", 1)
    for count in (1, 2):  # before a file, before the next items
        with running(store, FakeEngine()):
            job = submitted(filled, export("cell", "metric", "gravity"))
            finished(filled, job)
        pieces = job_streams._archive(store, job)
        for _ in range(count):
            next(pieces)
        assert filled.delete(f"/v1/jobs/{job}").status_code == 204
        with pytest.raises(job_streams._Removed):
            list(pieces)


def test_filters_are_checked(client: TestClient) -> None:
    assert get_args(JobKind) == KINDS
    for filters in ("kind=bogus", "state=bogus"):
        assert client.get(f"/v1/jobs?{filters}").status_code == 422


def test_assembled_trees_are_those_of_requests(filled: TestClient, store: Store) -> None:
    with running(store, FakeEngine()):
        job = submitted(filled, CELLS)
        assert finished(filled, job)["state"] == "succeeded"
    for item in items(filled, job):
        result = item["result"]
        tree = filled.get(result["location"]).json()
        assert (tree["name"], tree["revision"]) == (result["name"], 1)
        spec = {"name": "twin", "instances": [{"name": "a", "substructure": tree["instances"][0]["substructure"]}]}
        twin = filled.post("/v1/trees", json=spec).json()
        assert (twin["program"], twin["parameters"]) == (tree["program"], tree["parameters"])
        q = {"quantities": ["metric"], "q": [[0.3]], "parameters": dict.fromkeys(tree["parameters"], 2)}
        one, two = (filled.post(f"/v1/trees/{name}/evaluations", json=q).json() for name in (tree["name"], "twin"))
        assert one["metric"] == two["metric"]


def test_inline_definitions_and_derived_parts(client: TestClient, store: Store) -> None:
    tree = {"name": "own", "instances": [{"name": "a", "definition": PENDULUM}]}
    with running(store, FakeEngine()):
        assert finished(client, submitted(client, {"kind": "assemble", "items": [tree]}))["state"] == "succeeded"
        job = submitted(client, {"kind": "derive", "items": [SLIDER]})
        assert finished(client, job)["state"] == "succeeded"
    assert client.get("/v1/trees/own").json()["coordinates"] == ["a.q"]
    location = items(client, job)[0]["result"]["location"]
    assert client.get(location).json()["name"] == "slider"
    assert client.post("/v1/substructures", json=SLIDER).status_code == 200


def test_equal_items_are_computed_once(filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """By software that is the same: what was wrong before is computed again."""
    with running(store, FakeEngine(slots=4, is_open=False)) as engine:
        jobs = [submitted(filled, export("cell", "metric", "metric", "gravity")) for _ in range(3)]
        eventually(filled, jobs[0], lambda _: len(engine.started) == 2)
        engine.open()
        assert {finished(filled, job)["state"] for job in jobs} == {"succeeded"}
        assert len(engine.started) == 2
        again = filled.post("/v1/jobs", json=export("cell@1", "gravity")).json()
        assert (again["state"], again["attempts"]) == ("succeeded", 0)
        monkeypatch.setattr(operations, "release", lambda: "a later one")
        assert finished(filled, submitted(filled, export("cell@1", "gravity")))["attempts"] == 1


def test_a_tree_that_was_removed_is_assembled_again(filled: TestClient, store: Store) -> None:
    """And one that has become another gets a revision, as by POST; what was verified is verified again."""
    trees = [{"name": "two", "instances": [{"name": name, "substructure": "pendulum"}]} for name in "ab"]

    def outcome(kind: str, item: dict[str, Any]) -> Any:
        """What a job of one item says of it."""
        job = submitted(filled, {"kind": kind, "items": [item]})
        assert finished(filled, job)["attempts"] == 1
        return items(filled, job)[0]["result"]

    with running(store, FakeEngine()):
        assert [outcome("assemble", trees[k])["revision"] for k in (0, 0, 1, 0)] == [1, 1, 2, 3]
        assert filled.delete("/v1/trees/two").status_code == 204
        assert outcome("assemble", trees[0])["revision"] == 4
        assert filled.get("/v1/trees/two@4").status_code == 200
        assert outcome("verify", {"tree": "two"}) == outcome("verify", {"tree": "two"})


def test_cancel(filled: TestClient, store: Store) -> None:
    with running(store, FakeEngine(slots=1, is_open=False)) as engine:
        job = submitted(filled, export("cell", "metric", "gravity", "forces"))
        eventually(filled, job, lambda view: view["state"] == "running")
        assert filled.post(f"/v1/jobs/{job}/cancel").json()["state"] == "cancelling"
        assert finished(filled, job, 2)["state"] == "cancelled"
        assert engine.stopped == [engine.started[0].id]
        assert filled.post(f"/v1/jobs/{job}/cancel").json()["state"] == "cancelled"
    assert {item["state"] for item in items(filled, job)} == {"cancelled"}
    assert filled.post("/v1/jobs/none/cancel").status_code == 404


def test_cancel_before_anything_runs(filled: TestClient) -> None:
    job = submitted(filled, export("cell", "metric"))
    assert filled.post(f"/v1/jobs/{job}/cancel").json()["state"] == "cancelled"


def test_results_in_part(filled: TestClient, store: Store) -> None:
    with running(store, FakeEngine(slots=1, is_open=False)) as engine:
        job = submitted(filled, export("cell", "metric", "gravity"))
        engine.allowed = 1
        eventually(filled, job, lambda view: view["progress"]["done"] == 1)
        first, second = items(filled, job)
        assert filled.get(first["files"][0]["href"]).status_code == 200
        assert (second["result"], second["files"]) == (None, [])
        with zipfile.ZipFile(io.BytesIO(filled.get(f"/v1/jobs/{job}/archive").content)) as archive:
            assert archive.namelist() == ["0/item.json", "0/text.txt"]
        engine.open()
        finished(filled, job)


def test_running_jobs_say_how_far_they_are(filled: TestClient, store: Store) -> None:
    limits = store.settings.limits.model_copy(update={"lease_seconds": 0.2})
    store.settings = store.settings.model_copy(update={"limits": limits})
    with running(store, FakeEngine(slots=1, is_open=False)) as engine:
        job = submitted(filled, export("cell", "metric", "gravity"))
        view = eventually(filled, job, lambda view: view["progress"]["fraction"] > 0)
        assert view["progress"]["fraction"] == 0.25
        assert view["progress"]["eta_seconds"] > 0
        found = items(filled, job)
        assert [item["state"] for item in found] == ["running", "queued"]
        engine.open()
        finished(filled, job)


def test_the_same_submission_is_queued_once(filled: TestClient, rows: Any) -> None:
    key = {"Idempotency-Key": "7"}
    first = filled.post("/v1/jobs", json=export("cell", "metric"), headers=key)
    before = rows()
    second = filled.post("/v1/jobs", json=export("cell", "metric"), headers=key)
    assert (first.status_code, second.content) == (202, first.content)
    assert rows() == before


def test_pages(filled: TestClient) -> None:
    jobs = [submitted(filled, export("cell", "metric", "gravity", "forces")) for _ in range(3)]
    page = filled.get("/v1/jobs?page_size=2").json()
    rest = filled.get(page["links"]["next"]).json()
    assert [job["id"] for job in page["items"] + rest["items"]] == jobs[::-1]
    page = filled.get(f"/v1/jobs/{jobs[0]}/items?page_size=2").json()
    rest = filled.get(page["links"]["next"]).json()
    assert [item["position"] for item in page["items"] + rest["items"]] == [0, 1, 2]
    assert filled.get("/v1/jobs/none").status_code == 404
    assert filled.get(f"/v1/jobs/{jobs[0]}/items/9/files/x").status_code == 404
    assert filled.get("/v1/jobs?state=odd").status_code == 422
