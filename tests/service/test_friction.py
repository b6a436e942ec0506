"""Friction of joints over HTTP: in a part, in simulations that stick exactly, and where it is refused."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

URL = "/v1/trees/incline/simulations"
START = {"q": [0], "qd": [1], "span": [0, 1], "count": 3}


@pytest.fixture
def incline(client: TestClient) -> TestClient:
    """A block that gravity pulls back along a slide with 2 N, and friction holds with up to 3 N."""
    friction = {"coulomb": "F", "static": 3, "velocity": {"value": 1, "unit": "mm/s"}}
    joint = {"type": "prismatic", "coordinate": "x", "friction": friction}
    definition = {
        "name": "block", "parameters": {"F": {"value": 2.5, "unit": "N"}},
        "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": joint}],
    }  # fmt: skip
    tree = {"name": "incline", "gravity": [0, 0, -2], "instances": [{"name": "a", "definition": definition}]}
    answer = client.post("/v1/trees", json=tree)
    assert answer.status_code == 201, answer.text
    return client


def test_a_simulation_that_sticks(incline: TestClient) -> None:
    motion = incline.post(URL, json={**START, "friction": "exact", "reactions": ["a.x"]}).json()
    assert (motion["is_right"], motion["qd"][-1]) == (True, [0.0])
    # 1 m/s, 2 + 2.5 m/s^2
    assert motion["q"][-1][0] == pytest.approx(1 / 9, abs=1e-12)
    assert motion["series"]["friction"][-1] == pytest.approx([2.0], abs=1e-12)
    assert motion["series"]["reaction_force"][-1][0] == pytest.approx([0, 0, 2.0], abs=1e-12)
    creeping = incline.post(URL, json=START).json()
    assert creeping["qd"][-1][0] < 0
    csv = incline.post(URL, json={**START, "friction": "exact"}, headers={"Accept": "text/csv"}).text
    assert "friction.1" in csv.splitlines()[0]


def test_its_numbers_are_an_output(incline: TestClient) -> None:
    text = incline.get("/v1/trees/incline/friction?format=json").json()
    assert text["outputs"]["friction"]["shape"] == [1, 4]


@pytest.mark.parametrize(
    ("change", "url", "pointer"),
    [
        ({"friction": "sticky"}, URL, "/friction"),
        ({"friction": "exact", "fixed_step": {"step": 0.01}}, URL, "/friction"),
        ({"friction": "exact", "prescribed": {"a.x": "t"}}, URL, "/friction"),
        ({"friction": "exact", "by": ["a.F"]}, "/v1/trees/incline/sensitivities", "/friction"),
        ({"friction": "exact", "parameters": {"a.F": -1}}, URL, "/parameters"),
    ],
)
def test_what_is_refused(incline: TestClient, change: dict[str, Any], url: str, pointer: str) -> None:
    answer = incline.post(url, json={**START, **change})
    assert answer.status_code == 422, answer.text
    assert [e["pointer"] for e in answer.json()["errors"]] == [pointer]
