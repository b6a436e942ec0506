"""Reactions of joints over HTTP: numbers in all formats, formulas, code, jobs, chosen joints, and what is refused."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.store.store import Store
from substructures.expr.interpret import interpret
from substructures.expr.program import Program
from substructures.formats import arrow

from .conftest import HAND
from .fake_engine import FakeEngine, finished, items, running, submitted

URL = "/v1/trees/cell/evaluations"
ROWS = ["arm.q", "hand.q", "arm.base", "hand.base"]
STATE: dict[str, Any] = {"quantities": ["reactions"], "q": [0.4, -0.7], "qd": [1.0, 2.0]}


@pytest.fixture
def double(filled: TestClient) -> TestClient:
    assert filled.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
    return filled


def ask(client: TestClient, **request: Any) -> dict[str, Any]:
    answer = client.post(URL, json={**STATE, **request})
    assert answer.status_code == 200, answer.text
    result: dict[str, Any] = answer.json()
    assert result["failures"] == []
    return result


def test_numbers_for_states_and_for_their_own_motion(double: TestClient) -> None:
    own = ask(double, quantities=["reactions", "forward_dynamics"])
    assert own["joints"] == ROWS
    assert {name: np.shape(x) for name, x in own["reactions"].items()} == dict.fromkeys(
        ("force", "moment", "force_world", "moment_world"), (4, 3)
    )
    given = ask(double, qdd=own["forward_dynamics"])
    for name, numbers in own["reactions"].items():
        np.testing.assert_allclose(numbers, given["reactions"][name], atol=1e-12)
    # a hinge without spring and actuator gives nothing about its axis
    np.testing.assert_allclose(np.array(own["reactions"]["moment"])[:2, 2], 0, atol=1e-12)
    driven = ask(double, inputs={"tau.hand.q": 0.3})
    assert driven["reactions"]["moment"][1][2] == pytest.approx(0.3, abs=1e-12)


def test_chosen_joints_in_every_format(double: TestClient) -> None:
    whole = ask(double)["reactions"]["force"]
    for joints in (["hand.q"], ["hand.base", "arm.q"]):
        some = ask(double, joints=joints)
        assert some["joints"] == joints
        np.testing.assert_allclose(some["reactions"]["force"], [whole[ROWS.index(name)] for name in joints], atol=1e-14)
    stream = io.BytesIO()
    np.savez(stream, quantities=np.array(["reactions"]), joints=np.array(["hand.q"]), q=[STATE["q"]], qd=[STATE["qd"]])
    answer = double.post(URL, content=stream.getvalue(), headers={"Content-Type": "application/x-npz"})
    arrays = np.load(io.BytesIO(answer.content))
    assert arrays["joints"].tolist() == ["hand.q"]
    np.testing.assert_allclose(arrays["reactions.force"], [[whole[1]]], atol=1e-14)
    table = arrow.ArrowTable({name: np.array([STATE[name]]) for name in ("q", "qd")})
    content = b"".join(
        bytes(x) for x in arrow.write_tables([table], {"quantities": ["reactions"], "joints": ["hand.q"]})
    )
    answer = double.post(URL, content=content, headers={"Content-Type": arrow.MEDIA_TYPE})
    (columns,) = arrow.read_tables(io.BytesIO(answer.content))
    np.testing.assert_allclose(columns["reactions.force"], [[whole[1]]], atol=1e-14)


def test_formulas_equal_numbers(double: TestClient) -> None:
    numbers = ask(double, qdd=[0.3, -0.2])["reactions"]
    values = dict(
        zip(("arm.q", "hand.q", "arm.q'", "hand.q'", "arm.q''", "hand.q''"), (0.4, -0.7, 1, 2, 0.3, -0.2), strict=True)
    )
    for joints in (None, "hand.q,arm.base"):
        params = {"bind": "defaults"} | ({} if joints is None else {"joints": joints})
        answer = double.get("/v1/trees/cell/reactions", params=params)
        rows = ROWS if joints is None else joints.split(",")
        assert answer.json()["joints"] == rows
        found = interpret(Program.from_bytes(answer.content), values)
        for name, shown in numbers.items():
            expected = [shown[ROWS.index(row)] for row in rows]
            np.testing.assert_allclose(found[f"reaction_{name}"], expected, atol=1e-12)


def test_code_has_one_signature(double: TestClient) -> None:
    text = double.get("/v1/trees/cell/reactions?format=c&name=cell&joints=hand.q").text
    head = " ".join(text.split())
    assert "cell_reactions(const double *q, const double *qd, const double *qdd, const double *u," in head
    answer = double.get("/v1/trees/cell/export?target=interface&quantities=reactions&name=cell")
    (function,) = answer.json()["functions"]
    assert function["arguments"] == ["q", "qd", "qdd", "u", "p"]


def test_jobs_compute_them_too(double: TestClient, store: Store) -> None:
    wanted = {"tree": "cell", "quantity": "reactions", "format": "text", "options": {"joints": ["hand.q"]}}
    with running(store, FakeEngine()):
        made = submitted(double, {"kind": "export", "items": [wanted]})
        finished(double, made)
        later = double.post(URL, json={**STATE, "joints": ["hand.q"]}, headers={"Prefer": "respond-async"})
        finished(double, later.json()["id"])
    (text,) = items(double, made)
    known = double.get("/v1/trees/cell/reactions?format=text&joints=hand.q")
    assert double.get(text["files"][0]["href"]).text == known.text
    (numbers,) = items(double, later.json()["id"])
    arrays = np.load(io.BytesIO(double.get(numbers["files"][0]["href"]).content))
    np.testing.assert_allclose(arrays["reactions.force"].reshape(3), ask(double)["reactions"]["force"][1], atol=1e-14)


def test_along_motions(double: TestClient, store: Store) -> None:
    """Those of its states, as series, as columns of CSV and by jobs."""
    url = "/v1/trees/cell/simulations"
    request = {"q": [0.4, -0.7], "span": [0, 1], "count": 4, "inputs": {"tau.hand.q": "0.3*t"}, "reactions": ["hand.q"]}
    motion = double.post(url, json=request).json()
    assert (motion["joints"], motion["is_right"]) == (["hand.q"], True)
    states = {"q": motion["q"], "qd": motion["qd"], "inputs": {"tau.hand.q": (0.3 * np.array(motion["t"])).tolist()}}
    known = ask(double, **states, joints=["hand.q"])["reactions"]
    for name, numbers in known.items():
        np.testing.assert_allclose(motion["series"][f"reaction_{name}"], numbers, atol=1e-12)
    np.testing.assert_allclose(
        np.array(motion["series"]["reaction_moment"])[:, 0, 2], 0.3 * np.array(motion["t"]), atol=1e-12
    )
    lines = double.post(url, json=request, headers={"Accept": "text/csv"}).text.splitlines()
    at = lines[0].split(",").index("reaction_force.hand.q.y")
    assert float(lines[2].split(",")[at]) == motion["series"]["reaction_force"][1][0][1]
    with running(store, FakeEngine()):
        later = double.post(url, json=request, headers={"Prefer": "respond-async"})
        finished(double, later.json()["id"])
    (item,) = items(double, later.json()["id"])
    found = double.get(item["files"][0]["href"]).json()
    np.testing.assert_allclose(found["series"]["reaction_force"], motion["series"]["reaction_force"], atol=1e-9)
    refused = double.post(url, json={**request, "reactions": ["hand.q", "hand.p"]})
    assert [(e["pointer"], e["code"]) for e in refused.json()["errors"]] == [("/reactions/1", "unknown-joint")]


@pytest.mark.parametrize(
    ("request_", "pointer", "code"),
    [
        ({"joints": ["hand.q", "hand.p"]}, "/joints/1", "unknown-joint"),
        ({"joints": []}, "/joints", "missing"),
        ({"joints": ["hand.q"], "quantities": ["metric"]}, "/joints", "not-supported"),
    ],
)
def test_what_is_refused(double: TestClient, request_: dict[str, Any], pointer: str, code: str) -> None:
    answer = double.post(URL, json={**STATE, **request_})
    assert answer.status_code == 422, answer.text
    assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [(pointer, code)]


def test_unknown_joints_of_formulas(double: TestClient) -> None:
    answer = double.get("/v1/trees/cell/reactions?joints=hand.p")
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/query/joints/0")
    assert "hand.q" in answer.json()["detail"]
    assert double.get("/v1/trees/cell/metric?joints=hand.q").status_code == 422
