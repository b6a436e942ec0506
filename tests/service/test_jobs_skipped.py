"""Submissions that leave bad items out: what is taken, what is told, and what is refused as ever."""

from __future__ import annotations

import re
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.store.store import Store

from .conftest import HAND, TREE
from .fake_engine import FakeEngine, finished, items, running
from .test_conventions import problem


def tree(name: str, at: str = "arm.tip") -> dict[str, Any]:
    return {**TREE, "name": name, "instances": [*TREE["instances"], {**HAND, "at": at}]}


def submission(*given: Any, **more: Any) -> dict[str, Any]:
    return {"kind": "assemble", "items": list(given), "on_invalid": "skip", **more}


def test_the_good_ones_are_taken(filled: TestClient, store: Store) -> None:
    given = [tree("one"), tree("two", "arm.tp"), tree("three"), 5, tree("Four")]
    with running(store, FakeEngine()):
        answer = filled.post("/v1/jobs", json=submission(*given))
        assert answer.status_code == 202, answer.text
        job = answer.json()
        finished(filled, job["id"])
    assert (job["progress"]["total"], job["progress"]["skipped"]) == (2, 3)
    assert [each["item"] for each in job["skipped"]] == [1, 3, 4]
    (fault,) = job["skipped"][0]["errors"]
    assert (fault["pointer"], fault["code"]) == ("/instances/1/at", "unknown-port")
    assert [item["state"] for item in items(filled, job["id"])] == ["succeeded", "succeeded"]
    assert filled.get("/v1/trees/three").status_code == 200
    assert filled.get("/v1/trees/two").status_code == 404
    seen = filled.get(f"/v1/jobs/{job['id']}").json()
    assert "skipped" not in seen
    assert seen["progress"]["skipped"] == 3
    assert "2 of 2, 3 skipped" in re.sub("<[^>]*>", "", filled.get(f"/jobs/{job['id']}").text)


def test_combinations(filled: TestClient) -> None:
    template = {"template": tree("pair"), "choices": {"hand": ["pendulum", "nothing", "slider"]}}
    template["template"]["instances"][1].pop("parameters")
    answer = filled.post("/v1/jobs", json={"kind": "assemble", "on_invalid": "skip", **template})
    assert answer.status_code == 202, answer.text
    assert [each["item"] for each in answer.json()["skipped"]] == [1]
    assert answer.json()["progress"]["total"] == 2


def test_refusing_stays_the_default(filled: TestClient) -> None:
    body = submission(tree("one"), tree("two", "arm.tp"))
    for given in ({**body, "on_invalid": "refuse"}, {k: v for k, v in body.items() if k != "on_invalid"}):
        told = problem(filled.post("/v1/jobs", json=given), 422, "invalid-items")
        assert told["errors"][0]["pointer"] == "/items/1/instances/1/at"
    assert filled.get("/v1/jobs").json()["items"] == []


def test_none_is_good(filled: TestClient) -> None:
    told = problem(filled.post("/v1/jobs", json=submission(5, tree("two", "arm.tp"))), 422, "invalid-items")
    assert [each["pointer"] for each in told["errors"]] == ["/items/0", "/items/1/instances/1/at"]
    assert filled.get("/v1/jobs").json()["items"] == []


@pytest.mark.parametrize("wrong", ["skip all", 1, None, ["skip"]])
def test_other_choices(filled: TestClient, wrong: Any) -> None:
    answer = filled.post("/v1/jobs", json=submission(tree("one"), on_invalid=wrong))
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/on_invalid")
