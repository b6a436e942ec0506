"""Ensembles over HTTP: samples, columns, formats, verdicts, and what is refused."""

from __future__ import annotations

import io
from statistics import stdev
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from .analysis_trees import ask, client, store  # noqa: F401 -- fixtures

COLUMNS = {"end": {"expression": "x.q1"}, "energy": {"quantity": "kinetic_energy", "take": "largest"}}
URL = "/v1/trees/cart/ensembles"


def test_members_are_simulations(client: TestClient) -> None:  # noqa: F811
    lengths, q = [0.5, 1.0, 1.5], [[0, -0.2], [0, 0.1], [0.1, 0.4]]
    given = {"q": q, "qd": [0.1, 0.3], "parameters": {"x.l0": lengths}, "span": [0, 2], "columns": COLUMNS}
    found = ask(client, "cart/ensembles", **given)
    assert (found["count"], found["is_right"], found["right"], found["failed"]) == (3, True, 3, 0)
    assert "q" not in found
    for k in range(3):
        own = {"q": q[k], "qd": [0.1, 0.3], "parameters": {"x.l0": lengths[k]}, "span": [0, 2]}
        alone = ask(client, "cart/simulations", **own)
        assert found["columns"]["end"][k] == pytest.approx(alone["q"][-1][1], abs=1e-6)
    assert found["statistics"]["end"]["mean"] == pytest.approx(np.mean(found["columns"]["end"]))
    assert found["statistics"]["end"]["deviation"] == pytest.approx(stdev(found["columns"]["end"]))
    alone = ask(client, "cart/ensembles", q=q[0], span=[0, 0.1], columns=COLUMNS)
    assert alone["statistics"]["end"]["deviation"] is None


def test_units_and_samples(client: TestClient) -> None:  # noqa: F811
    drawn = {"method": "latin-hypercube", "count": 5, "seed": 1, "of": {"p.q1": {"uniform": [0, 90], "unit": "deg"}}}
    found = ask(client, "clock/ensembles", samples=drawn, span=[0, 1], times=[{"value": 1000, "unit": "ms"}])
    assert np.array(found["q"]).shape == (5, 2, 1)
    begin = np.sort(np.array(found["q"])[:, 0, 0]) / (np.pi / 2)
    assert (np.floor(begin * 5) == np.arange(5)).all()


def test_as_arrays(client: TestClient) -> None:  # noqa: F811
    body = {"q": [[0, 0.1], [0, 0.2]], "span": [0, 1], "count": 3}
    answer = client.post(URL, json=body, headers={"Accept": "application/x-npz"})
    assert answer.status_code == 200, answer.text
    with np.load(io.BytesIO(answer.content)) as found:
        assert found["q"].shape == found["qd"].shape == (2, 3, 2)
        assert (found["violation"] <= 1).all()


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({}, "/span"),
        ({"span": [1, 0]}, "/span"),
        ({"span": [0, 1], "q": [[0, 1, 2]]}, "/q"),
        ({"span": [0, 1], "method": "Radau"}, "/method"),
        ({"span": [0, 1], "columns": {"a": {}}}, "/columns/a"),
        ({"span": [0, 1], "columns": {"a": {"quantity": "metrix"}}}, "/columns/a/quantity"),
        ({"span": [0, 1], "samples": {"of": {"x.q9": {"values": [1]}}}}, "/samples/of/x.q9"),
        ({"span": [0, 1], "samples": {"of": {"x.l0": {"values": [1], "unit": "kg"}}}}, "/samples/of/x.l0/unit"),
        ({"span": [0, 1], "inputs": {"tau.x.q1": {"times": [0, 1], "values": [0, 1]}}}, "/inputs/tau.x.q1"),
        ({"span": [0, 1], "parameters": {"x.l0": [1, {"value": 2, "unit": "kg"}]}}, "/parameters/x.l0/1"),
    ],
)
def test_what_is_refused(client: TestClient, body: dict[str, Any], pointer: str) -> None:  # noqa: F811
    answer = client.post(URL, json={"q": [[0, 0.1]], **body} if body else body)
    assert answer.status_code == 422, answer.text
    assert pointer in [error["pointer"] for error in answer.json()["errors"]], answer.text


def test_loops_stay_closed(client: TestClient) -> None:  # noqa: F811
    answer = client.post("/v1/trees/ring/ensembles", json={"q": [1.8, -2.0, -1.5], "span": [0, 0.2], "count": 3})
    assert answer.status_code == 200, answer.text
    assert answer.json()["right"] == 1
    assert "gaps" in [check["name"] for check in answer.json()["checks"]]


def test_a_large_answer_is_refused(client: TestClient) -> None:  # noqa: F811
    drawn = {"method": "random", "count": 10**6, "of": {"x.q1": {"uniform": [0, 1]}}}
    answer = client.post(URL, json={"samples": drawn, "span": [0, 1]})
    assert (answer.status_code, answer.json()["code"]) == (422, "too-large")
