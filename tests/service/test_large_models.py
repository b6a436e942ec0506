"""Parts and trees with too many Christoffel symbols to store, over HTTP; the limit is lowered to make them small."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from substructures import Definition, TreeSpec, couple, derive
from substructures.certificate import part_outputs
from substructures.mechanics import formula_size
from substructures.quantities.numbers.evaluation import evaluate

TREE = {"name": "long", "gravity": [0, 0, "-9.81"], "instances": [{"name": "a", "substructure": "arm"}]}
ZEROS = [0.0] * 6


def arm() -> dict[str, Any]:
    """Six joints: 91 Christoffel symbols."""
    joint = {"type": "revolute", "theta": "pi/3", "d": 0.5}
    bodies = [
        {
            "name": f"b{k}",
            "parent": f"b{k - 1}" if k else "base",
            "joint": {**joint, "coordinate": f"q{k}"},
            "mass": k + 1,
            "com": [0.1, 0.2, 0],
            "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1},
        }
        for k in range(6)
    ]
    return {"name": "arm", "bodies": bodies}


@pytest.fixture
def large(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> TestClient:
    """A server on which more than 50 are too many, with a part and a tree that have more."""
    monkeypatch.setattr(formula_size, "MOST_CHRISTOFFEL", 50)
    monkeypatch.setattr(part_outputs, "MOST_CHRISTOFFEL", 50)
    answer = client.post("/v1/substructures", json=arm())
    assert answer.status_code == 201, answer.text
    assert "christoffel" not in answer.json()["operations"]
    assert client.post("/v1/trees", json=TREE).status_code == 201
    return client


def test_numbers_are_those_of_a_model_that_has_all(large: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the Christoffel symbols too, for one state and several, beside outputs that are stored."""
    wanted = ["metric", "christoffel", "bias", "inverse_dynamics", "forward_dynamics"]
    monkeypatch.setattr(formula_size, "MOST_CHRISTOFFEL", 100_000)
    monkeypatch.setattr(part_outputs, "MOST_CHRISTOFFEL", 100_000)
    model = couple(TreeSpec.read(TREE), {"a": derive(Definition.read(arm()))})
    q, qd, qdd = np.random.default_rng(0).uniform(-1, 1, (3, 3, 6))
    for rows in (0, slice(0, 3)):
        body = {"q": q[rows].tolist(), "qd": qd[rows].tolist(), "qdd": qdd[rows].tolist()}
        expected = evaluate(model, wanted, q[rows], qd[rows], qdd[rows])
        for names in (wanted, ["christoffel"]):
            answer = large.post("/v1/trees/long/evaluations", json={"quantities": names, **body})
            assert answer.status_code == 200, answer.text
            for name in names:
                np.testing.assert_allclose(answer.json()[name], expected[name], rtol=1e-10, atol=1e-10, err_msg=name)


@pytest.mark.parametrize("path", ["christoffel", "christoffel?format=text", "coriolis", "curvature"])
def test_formulas_of_them_are_refused_by_name(large: TestClient, path: str) -> None:
    answer = large.get(f"/v1/trees/long/{path}")
    assert answer.status_code == 422, answer.text
    assert [fault["code"] for fault in answer.json()["errors"]] == ["not-stored"]


def test_what_else_the_part_and_the_tree_answer(large: TestClient) -> None:
    assert large.get("/v1/trees/long/metric?format=text").status_code == 200
    assert large.get("/trees/long").status_code == 200
    assert large.get("/substructures/arm").status_code == 200
    assert large.get("/v1/substructures/arm/formulas/metric").status_code == 200
    assert large.get("/v1/substructures/arm/formulas/christoffel").status_code == 404
    states = {"quantities": ["coriolis"], "q": ZEROS, "qd": ZEROS}
    assert large.post("/v1/trees/long/evaluations", json=states).status_code == 422
    assert large.post("/v1/trees/long/kernels", json={"quantities": ["christoffel"]}).status_code == 422
    made = large.post("/v1/trees/long/kernels", json={"quantities": ["metric", "inverse_dynamics"]})
    assert made.status_code == 201
