"""Jobs over HTTP that meet faults: of the submission, of items, of workers, and full queues."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.jobs.engines.engine import Work
from service.settings import Limits
from service.store.store import Store

from .conftest import TREE
from .fake_engine import FakeEngine, export, finished, items, running, submitted


def test_faults_name_the_items_and_queue_nothing(filled: TestClient, rows: Any) -> None:
    before = rows()
    for body, pointer in (
        ({"kind": "export", "items": []}, "/items"),
        ({"kind": "fly", "items": [{}]}, "/kind"),
        ({"items": [{}]}, "/kind"),
        ([], ""),
        ({"kind": "export"}, "/items"),
        (export("cell", "metric") | {"x": 1}, "/x"),
        (
            {"kind": "assemble", "items": [TREE, {**TREE, "instances": [{"name": "arm", "substructure": "no"}]}]},
            "/items/1/instances/0/substructure",
        ),
    ):
        answer = filled.post("/v1/jobs", json=body)
        assert answer.status_code == 422, answer.text
        assert answer.json()["errors"][0]["pointer"] == pointer, answer.text
    bad = [{"tree": f"none{k}", "quantity": "metric", "format": "text"} for k in range(30)]
    answer = filled.post("/v1/jobs", json={"kind": "export", "items": [*export("cell", "metric")["items"], *bad]})
    problem = answer.json()
    assert (len(problem["errors"]), problem["count"]) == (20, 30)
    assert problem["errors"][0]["pointer"] == "/items/1/tree"
    assert rows() == before


def test_a_bad_item_does_not_sink_the_rest(filled: TestClient, store: Store) -> None:
    (good,) = export("cell", "metric")["items"]
    wrong = {**good, "bind": "arm.l:nose"}
    with running(store, FakeEngine()):
        some = submitted(filled, {"kind": "export", "items": [good, wrong]})
        view = finished(filled, some)
        assert (view["state"], view["progress"]["failed"]) == ("succeeded", 1)
        none = finished(filled, submitted(filled, {"kind": "export", "items": [wrong]}))
    assert (none["state"], none["error"]["code"]) == ("failed", "all-items-failed")
    bad = filled.get(f"/v1/jobs/{some}/items?state=failed").json()["items"]
    assert [(item["position"], item["attempts"]) for item in bad] == [(1, 1)]
    assert bad[0]["problem"]["status"] == 422
    assert filled.get(f"/v1/jobs/{some}/items/1/files/text").status_code == 404


def test_dead_workers_are_replaced_three_times(filled: TestClient, store: Store) -> None:
    deaths: dict[str, int] = {}

    def death(work: Work) -> str:
        quantity = work.item["quantity"]
        deaths[quantity] = deaths.get(quantity, 0) + 1
        return "killed by signal 9" if quantity == "metric" or deaths[quantity] < 3 else ""

    with running(store, FakeEngine(death=death)):
        job = submitted(filled, export("cell", "metric", "gravity"))
        assert finished(filled, job)["progress"]["failed"] == 1
    bad, good = items(filled, job)
    assert (bad["state"], bad["attempts"], bad["deaths"]) == ("failed", 3, ["killed by signal 9"] * 3)
    assert bad["problem"]["code"] == "worker-died"
    assert "signal 9" in bad["problem"]["detail"]
    assert (good["state"], good["attempts"], len(good["deaths"])) == ("succeeded", 3, 2)
    text = filled.get("/metrics").text
    assert 'substructures_job_items_total{state="queued"} 4.0' in text
    assert 'substructures_queue{state="succeeded",what="jobs"} 1.0' in text


def test_attempts_that_cannot_start_are_no_deaths(filled: TestClient, store: Store) -> None:
    class Shy(FakeEngine):
        refusals = 2

        def start(self, work: Work) -> None:
            self.refusals -= 1
            if self.refusals >= 0:
                raise ConnectionError("nobody there")
            super().start(work)

    limits = store.settings.limits.model_copy(update={"lease_seconds": 0.2})
    store.settings = store.settings.model_copy(update={"limits": limits})
    with running(store, Shy(slots=1)):
        job = submitted(filled, export("cell", "metric"))
        assert finished(filled, job)["state"] == "succeeded"
        (item,) = items(filled, job)
        assert (item["attempts"], item["deaths"]) == (3, [])


def test_items_that_take_too_long_are_stopped(filled: TestClient, store: Store) -> None:
    limits = store.settings.limits.model_copy(update={"job_seconds": 0.1})
    store.settings = store.settings.model_copy(update={"limits": limits})
    with running(store, FakeEngine(slots=1, is_open=False)) as engine:
        job = submitted(filled, export("cell", "metric"))
        assert finished(filled, job)["state"] == "failed"
        assert engine.stopped == [engine.started[0].id]
    assert items(filled, job)[0]["problem"]["code"] == "took-too-long"


@pytest.mark.parametrize("name", ["job_queue", "job_queue_per_key"])
def test_full_queue(filled: TestClient, store: Store, rows: Any, name: str) -> None:
    limits = store.settings.limits.model_copy(update={name: 3})
    store.settings = store.settings.model_copy(update={"limits": limits})
    submitted(filled, export("cell", "metric", "gravity"))
    before = rows()
    answer = filled.post("/v1/jobs", json=export("cell", "forces", "coriolis"))
    assert (answer.status_code, answer.json()["code"]) == (503, "queue-full")
    assert int(answer.headers["retry-after"]) > 0
    assert "2 items wait, 2 more exceed 3" in answer.json()["detail"]
    never = filled.post("/v1/jobs", json=export("cell", "metric", "forces", "coriolis", "bias"))
    assert (never.status_code, never.json()["code"]) == (422, "too-many-items")
    assert "4 items are more than the queue takes, 3" in never.json()["detail"]
    assert rows() == before


def test_too_many_items_and_bytes(filled: TestClient, store: Store) -> None:
    limits = Limits(job_items=2, job_bytes=10_000)
    store.settings = store.settings.model_copy(update={"limits": limits})
    answer = filled.post("/v1/jobs", json=export("cell", "metric", "gravity", "forces"))
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/items")
    assert filled.post("/v1/jobs", json=export("x" * 10_000, "metric")).status_code == 413
    assert filled.get("/v1/limits").json()["job_items"] == 2
