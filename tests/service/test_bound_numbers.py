"""Stored trees whose parameters are bound to numbers: one program, and the answers of the tree with these numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.store.store import Store
from substructures import couple, derive, evaluate

from .conftest import PENDULUM, TREE
from .fake_engine import FakeEngine, finished, running, submitted

STATE = {"q": [0.3], "qd": [0.4], "quantities": ["metric", "forces", "bias"]}


def _tree(k: int, m: Any) -> dict[str, Any]:
    (arm,) = TREE["instances"]
    return {**TREE, "name": f"bound-{k}", "instances": [{**arm, "parameters": {"m": m, "l": "1.25"}}]}


def test_trees_with_other_numbers_have_one_program_and_their_own_answers(filled: TestClient) -> None:
    found = []
    for k, m in enumerate((0.4, 0.7)):
        made = filled.post("/v1/trees", json=_tree(k, m))
        assert made.status_code == 201, made.text
        tree = made.json()
        model = couple(_tree(k, m), {"arm": derive(PENDULUM)})
        answer = filled.post(f"/v1/trees/bound-{k}/evaluations", json=STATE).json()
        expected = evaluate(model, STATE["quantities"], q=[0.3], qd=[0.4])
        for name in ("metric", "forces", "bias"):
            assert np.allclose(answer[name], expected[name], rtol=1e-12), answer
        text = filled.get(f"/v1/trees/bound-{k}/kinematics?format=json").text
        assert "arm.q" in text
        assert "arm.m" not in text
        assert set(tree["parameters"]) == {"g"}
        found.append(tree["program"])
    assert found[0] == found[1]


@pytest.mark.parametrize("kind", ["verify", "upgrade"])
def test_they_are_derived_anew_as_they_are_stored(filled: TestClient, store: Store, kind: str) -> None:
    before = filled.post("/v1/trees", json=_tree(0, 0.4)).json()
    with running(store, FakeEngine()):
        job = submitted(filled, {"kind": kind, "items": [{"tree": "bound-0"}]})
        assert finished(filled, job, 60)["progress"]["failed"] == 0
    after = filled.get("/v1/trees/bound-0").json()
    assert {**after, "certificate": None} == {**before, "certificate": None}


def test_items_tell_the_numbers_beside_the_program(filled: TestClient, store: Store) -> None:
    with running(store, FakeEngine()):
        job = submitted(filled, {"kind": "assemble", "items": [_tree(k, m) for k, m in enumerate((0.4, 0.7))]})
        assert finished(filled, job, 60)["state"] == "succeeded"
    told = [each["result"] for each in filled.get(f"/v1/jobs/{job}/items").json()["items"]]
    assert [each["numbers"] for each in told] == [{"arm.l": "5/4", "arm.m": x} for x in ("2/5", "7/10")]
    assert len({each["program"] for each in told}) == 1
