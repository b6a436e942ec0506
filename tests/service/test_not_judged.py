"""What the documents cannot decide, trees in which nothing moves, and velocities that fail somewhere are told."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from .analysis_trees import client, store
from .job_outcomes import outcomes
from .jobs_library import MemoryLibrary

__all__ = ["client", "store"]  # fixtures

#: the angle of the joint is real nowhere
NOWHERE = {
    "name": "nowhere",
    "parameters": {"w": {"value": 0.5}, "m": {"value": 2}},
    "bodies": [
        {
            "name": "b",
            "parent": "base",
            "mass": "m",
            "com": [1, 0, 0],
            "joint": {"type": "revolute", "tau": "sqrt(-1-w^2)"},
        }
    ],
}
BLOCK = {"name": "block", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "fixed"}, "mass": 1}]}
STATE = {"q": [0.1], "qd": [0.2], "qdd": [0.3]}


@pytest.fixture(scope="module")
def trees(client: TestClient) -> TestClient:
    for part, tree in ((NOWHERE, "lost"), (BLOCK, "still")):
        assert client.post("/v1/substructures", json=part).status_code == 201
        instances = [{"name": "x", "substructure": part["name"]}]
        made = client.post("/v1/trees", json={"name": tree, "gravity": [0, -9.81, 0], "instances": instances})
        assert made.status_code == 201, made.text
    return client


def _codes(answer: Any) -> list[str]:
    assert answer.status_code == 200, answer.text
    return [each["code"] for each in answer.json()["warnings"]]


@pytest.mark.parametrize("quantity", ["forces", "inverse_dynamics", "forward_dynamics", "kinetic_energy", "condition"])
def test_numbers_that_nothing_judges_are_marked(trees: TestClient, quantity: str) -> None:
    for _ in range(2):  # by one state prepared, too
        answer = trees.post("/v1/trees/lost/evaluations", json={"quantities": [quantity], **STATE})
        assert _codes(answer).count("not-judged") == 1
        assert f"'{quantity}'" in answer.json()["warnings"][-1]["message"]


@pytest.mark.parametrize("quantity", ["forces", "inverse_dynamics", "state_space", "regressor"])
def test_formulas_that_nothing_judges_are_marked(trees: TestClient, quantity: str) -> None:
    path = f"/v1/trees/lost/{quantity}"
    for bind in ("", "x.m:3"):
        assert _codes(trees.get(path, params={"format": "json", "bind": bind})) == ["not-judged"]
        for format_ in ("text", "latex", "mathml", "c", "python"):
            text = trees.get(path, params={"format": format_, "bind": bind}).text
            assert "Warning: " in text, format_
            assert "could not be judged" in text, format_
    assert "warnings" not in trees.get("/v1/trees/cart/forces", params={"format": "json"}).json()


def test_formulas_of_parts_and_exports_are_marked(trees: TestClient) -> None:
    assert _codes(trees.get("/v1/substructures/nowhere/formulas/f", params={"format": "json"})) == ["not-judged"]
    chosen = {"format": "json", "body": "b"}
    assert _codes(trees.get("/v1/substructures/nowhere/formulas/f", params=chosen)) == ["not-judged"]
    for path in ("trees/lost", "substructures/nowhere"):
        asked = {"target": "interface", "quantities": "metric,christoffel"}
        answer = trees.get(f"/v1/{path}/export", params=asked)
        assert _codes(answer) == ["not-judged"]
        assert "'metric'" in answer.json()["warnings"][0]["message"]
        for target in ("fortran", "text", "mathml"):
            text = trees.get(f"/v1/{path}/export", params={"target": target, "quantities": "metric"}).text
            assert "Warning: 'metric' could not be judged" in text, target


def test_analyses_of_what_nothing_judges_are_marked(trees: TestClient) -> None:
    answer = trees.post("/v1/trees/lost/linearisations", json={"q": [0.0]})
    assert "not-judged" in _codes(answer)


@pytest.mark.parametrize(
    ("kind", "item"),
    [
        ("evaluate", {"request": {"quantities": ["forces"], "q": [[0.1]]}}),
        ("simulate", {"request": {"q": [0.5], "span": [0, 1], "count": 3}}),
        ("analyse", {"analysis": "linearisations", "request": {"q": [0.0]}}),
    ],
)
def test_items_of_jobs_are_marked(kind: str, item: dict[str, Any]) -> None:
    tree = {"name": "lost", "gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": "nowhere"}]}
    library = MemoryLibrary([NOWHERE], [tree])
    (outcome,) = outcomes(library, kind, {"items": [{"tree": "lost", **item}]})
    assert outcome.problem is None
    assert "not-judged" in [each["code"] for each in outcome.summary["warnings"]]


def test_files_of_jobs_are_marked() -> None:
    tree = {"name": "lost", "gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": "nowhere"}]}
    library = MemoryLibrary([NOWHERE], [tree])
    items = [{"tree": "lost", "quantity": "forces", "format": format_} for format_ in ("text", "latex")]
    for outcome in outcomes(library, "export", {"items": items}):
        (data,) = outcome.files.values()
        assert b"Warning: " in data
        assert b"could not be judged" in data


def test_a_tree_without_coordinates_is_told(trees: TestClient) -> None:
    assert _codes(trees.get("/v1/trees/still")) == ["no-coordinates"]
    assert "no-coordinates" not in _codes(trees.get("/v1/trees/cart"))
    assert _codes(trees.post("/v1/trees/still/evaluations", json={"quantities": ["metric"], "q": []})) == [
        "no-coordinates"
    ]
