"""Friction of joints over HTTP: in a part, in simulations that stick exactly, and where it is refused."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from .one_store import filled, store

__all__ = ["filled", "store"]  # fixtures

URL = "/v1/trees/incline/simulations"
START = {"q": [0], "qd": [1], "span": [0, 1], "count": 3}
FRICTION = {"coulomb": "F", "static": 3, "velocity": {"value": 1, "unit": "mm/s"}}
JOINT = {"type": "prismatic", "coordinate": "x", "friction": FRICTION}
BLOCK = {
    "name": "block", "parameters": {"F": {"value": 2.5, "unit": "N"}},
    "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": JOINT}],
}  # fmt: skip


@pytest.fixture(scope="module")
def incline(filled: TestClient) -> TestClient:
    """A block that gravity pulls back along a slide with 2 N, and friction holds with up to 3 N."""
    tree = {"name": "incline", "gravity": [0, 0, -2], "instances": [{"name": "a", "definition": BLOCK}]}
    answer = filled.post("/v1/trees", json=tree)
    assert answer.status_code == 201, answer.text
    return filled


def test_a_simulation_that_sticks(incline: TestClient) -> None:
    motion = incline.post(URL, json={**START, "friction": "exact", "reactions": ["a.x"]}).json()
    assert (motion["is_right"], motion["qd"][-1]) == (True, [0.0])
    # 1 m/s, 2 + 2.5 m/s^2
    assert motion["q"][-1][0] == pytest.approx(1 / 9, abs=1e-12)
    assert motion["series"]["friction"][-1] == pytest.approx([2.0], abs=1e-12)
    assert motion["series"]["reaction_force"][-1][0] == pytest.approx([0, 0, 2.0], abs=1e-12)
    (event,) = motion["events"]
    assert (event["name"], event["kind"], event["t"]) == ("a.x", "stick", pytest.approx(1 / 4.5, abs=1e-12))
    creeping = incline.post(URL, json=START).json()
    assert creeping["qd"][-1][0] < 0
    csv = incline.post(URL, json={**START, "friction": "exact"}, headers={"Accept": "text/csv"}).text
    assert "friction.1" in csv.splitlines()[0]


def test_its_numbers_are_an_output(incline: TestClient) -> None:
    text = incline.get("/v1/trees/incline/friction?format=json").json()
    assert text["outputs"]["friction"]["shape"] == [1, 4]


def test_a_closed_simulation_that_sticks(incline: TestClient) -> None:
    """Two such blocks that are tied together do the same, each held by its own share, or where both are driven."""
    instances = [{"name": name, "definition": BLOCK} for name in ("a", "b")]
    weld = {"name": "tie", "type": "ball", "from": "a.b", "to": "b.b"}
    tree = {"name": "pair", "gravity": [0, 0, -2], "instances": instances, "closures": [weld]}
    answer = incline.post("/v1/trees", json=tree)
    assert answer.status_code == 201, answer.text
    body = {**START, "q": [0, 0], "qd": [1, 1], "friction": "exact", "reactions": True, "powers": True}
    motion = incline.post("/v1/trees/pair/simulations", json=body).json()
    assert motion["is_right"], motion["checks"]
    assert {(event["name"], event["kind"]) for event in motion["events"]} == {("a.x", "stick"), ("b.x", "stick")}
    assert {"friction", "power", "energy"} <= {check["name"] for check in motion["checks"]}
    assert motion["q"][-1] == pytest.approx([1 / 9] * 2, abs=1e-12)
    assert motion["series"]["friction"][-1] == pytest.approx([2.0, 2.0], abs=1e-12)
    driven = incline.post(URL, json={**START, "friction": "exact", "prescribed": {"a.x": "t"}}).json()
    assert driven["is_right"], driven["checks"]
    # 2 N of gravity, 2.5 N of friction
    assert driven["series"]["actuation"][-1] == pytest.approx([4.5], abs=1e-12)


@pytest.fixture(scope="module")
def loaded(filled: TestClient) -> TestClient:
    """A block on an incline with mu = 0.25, and a second one published from a tree of it."""
    friction = {"coulomb": 0, "velocity": 0.001, "load": {"coefficient": "mu"}}
    joint = {"type": "prismatic", "coordinate": "x", "friction": friction}
    definition = {
        "name": "sledge", "parameters": {"mu": {"value": "1/4"}},
        "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": joint}],
    }  # fmt: skip
    tree = {"name": "slope", "gravity": [0, -8, 6], "instances": [{"name": "a", "definition": definition}]}
    answer = filled.post("/v1/trees", json=tree)
    assert answer.status_code == 201, answer.text
    return filled


def test_friction_by_the_load_of_joints(loaded: TestClient) -> None:
    """a = 6 - 8/4, in a simulation that asks for it; others tell that they leave it out."""
    url, body = "/v1/trees/slope/simulations", {**START, "friction": "loaded"}
    motion = loaded.post(url, json=body).json()
    assert (motion["is_right"], motion["warnings"]) == (True, [])
    assert motion["q"][-1][0] == pytest.approx(1 + 4 / 2, abs=1e-12)
    assert motion["series"]["friction"][-1] == pytest.approx([-2.0], abs=1e-12)
    assert "friction-load" in {check["name"] for check in motion["checks"]}
    without = loaded.post(url, json=START).json()
    assert [each["code"] for each in without["warnings"]] == ["friction-left-out"]
    assert without["q"][-1][0] == pytest.approx(1 + 6 / 2, abs=1e-12)
    text = loaded.get("/v1/trees/slope/friction_load?format=json").json()
    assert text["outputs"]["friction_load"]["shape"] == [1, 2]


def test_a_published_part_keeps_it(loaded: TestClient) -> None:
    answer = loaded.post("/v1/trees/slope/publish", json={"name": "slope-part"})
    assert answer.status_code == 201, answer.text
    tree = {"name": "again", "gravity": [0, -8, 6], "instances": [{"name": "a", "substructure": "slope-part"}]}
    answer = loaded.post("/v1/trees", json=tree)
    assert answer.status_code == 201, answer.text
    motion = loaded.post("/v1/trees/again/simulations", json={**START, "friction": "loaded"}).json()
    assert motion["q"][-1][0] == pytest.approx(1 + 4 / 2, abs=1e-12)


@pytest.mark.parametrize(
    ("change", "url", "pointer"),
    [
        ({"friction": "sticky"}, URL, "/friction"),
        ({"friction": "exact", "fixed_step": {"step": 0.01}}, URL, "/friction"),
        ({"friction": "exact", "by": ["a.F"]}, "/v1/trees/incline/sensitivities", "/friction"),
        ({"friction": "exact", "parameters": {"a.F": -1}}, URL, "/parameters"),
        ({"friction": "loaded"}, URL, "/friction"),
        ({"friction": "loaded", "fixed_step": {"step": 0.01}}, URL, "/friction"),
        ({"friction": "loaded", "prescribed": {"a.x": "t"}}, URL, "/friction"),
        ({"friction": "loaded", "by": ["a.F"]}, "/v1/trees/incline/sensitivities", "/friction"),
    ],
)
def test_what_is_refused(incline: TestClient, change: dict[str, Any], url: str, pointer: str) -> None:
    answer = incline.post(url, json={**START, **change})
    assert answer.status_code == 422, answer.text
    assert [e["pointer"] for e in answer.json()["errors"]] == [pointer]
