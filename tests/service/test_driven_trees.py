"""Trees with given motions over HTTP: stored, shown, printed, evaluated, compared, and what refuses them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from service.jobs.kinds import sweep
from service.messages.negotiation import MEDIA_TYPES
from substructures.documents import read_json

from .job_outcomes import joined, outcomes
from .jobs_library import MemoryLibrary

TREE: dict[str, Any] = {
    "name": "shaken",
    "gravity": [0, 0, -9.81],
    "parameters": {"A": {"value": 0.05, "unit": "m"}, "w": {"value": 9, "unit": "rad/s"}},
    "instances": [
        {
            "name": "cart",
            "definition": {
                "name": "cart",
                "bodies": [
                    {"name": "deck", "parent": "base", "mass": 2, "joint": {"type": "prismatic", "coordinate": "z"}},
                    {"name": "rod", "parent": "deck", "mass": 1, "com": [0, 0.5, 0],
                     "joint": {"type": "revolute", "coordinate": "q", "theta": "-pi/2"}},
                ],
            },
        }
    ],
    "driven": {"cart.z": "A*cos(w*t)"},
}  # fmt: skip


@pytest.fixture
def shaken(client: TestClient) -> TestClient:
    made = client.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    assert made.json()["driven"] == ["cart.z"]
    assert made.json()["coordinates"] == ["cart.q"]
    return client


def test_it_is_shown_and_printed(shaken: TestClient) -> None:
    page = shaken.get("/trees/shaken").text
    assert "<h2>Given motions</h2>" in page
    assert "<td>cart.z</td><td>A*cos(w*t)</td>" in page
    for name in ("metric", "bias", "g_a0", "Gamma_a00", "T_0", "drive_forces", "first_integrals", "reactions"):
        for kind in MEDIA_TYPES:
            answer = shaken.get(f"/v1/trees/shaken/{name}?format={kind}")
            assert answer.status_code == 200, (name, kind, answer.text[:300])
    assert "Gamma_a00[1] = -1/2*A*w^2*sin(q)*cos(w*t)" in shaken.get("/v1/trees/shaken/Gamma_a00?format=text").text
    report = shaken.get("/v1/trees/shaken/report?format=text").text
    assert "Inertia forces of the given motions" in report
    for path in ("scene", "picture", "program.json", "origins", "program.wasm"):
        assert shaken.get(f"/v1/trees/shaken/{path}").status_code == 200
    for path in ("edit", "motion"):
        assert shaken.get(f"/trees/shaken/{path}").status_code == 200


def test_it_is_evaluated_and_simulated(shaken: TestClient) -> None:
    asked = {"quantities": ["g_a0", "drive_forces", "U_0", "forward_dynamics"], "q": [0.5], "qdd": [0], "t": 0.2}
    found = shaken.post("/v1/trees/shaken/evaluations", json=asked)
    assert found.status_code == 200, found.text
    assert found.json()["driven"] == ["cart.z"]
    moved = shaken.post("/v1/trees/shaken/simulations", json={"q": [0.5], "span": [0, 1], "count": 5})
    assert moved.json()["is_right"] is True
    wrong = shaken.post(
        "/v1/trees/shaken/evaluations", json={"quantities": ["metric"], "q": {"cart.z": 0, "cart.q": 0}}
    )
    assert wrong.json()["errors"][0]["pointer"] == "/q/cart.z"
    assert wrong.json()["errors"][0]["message"] == "the motion of 'cart.z' is given ('driven'): leave it out"


def test_revisions_differ_in_their_motions(shaken: TestClient) -> None:
    given = shaken.post("/v1/trees", json={**TREE, "driven": {"cart.z": {"input": True}}})
    assert (given.status_code, given.json()["revision"]) == (201, 2)
    assert list(given.json()["inputs"]) == ["cart.z", "cart.z'", "cart.z''"]
    assert "an input, with two derivatives" in shaken.get("/trees/shaken").text
    table = {"times": [0, 1, 2], "values": [0, 0.1, 0], "interpolation": "monotone"}
    assert shaken.post("/v1/trees", json={**TREE, "driven": {"cart.z": table}}).status_code == 201
    assert "through 3 points, monotone" in shaken.get("/trees/shaken").text
    told = shaken.get("/v1/trees/shaken@1/difference?to=shaken@2").json()
    assert [each["place"] for each in told["definition"]] == ["/driven/cart.z"]
    assert shaken.get("/trees/shaken@1/difference?to=shaken@2").status_code == 200
    free = shaken.post("/v1/trees", json={**TREE, "driven": {}})
    assert (free.status_code, "driven" in free.json()) == (201, False)


@pytest.mark.parametrize(
    ("path", "body"),
    [
        ("publish", {}),
        ("equilibria", {}),
        ("steady-motions", {}),
        ("curvatures", {"q": [0.1]}),
        ("regulators", {"q": [0]}),
    ],
)
def test_what_refuses_it_says_why(shaken: TestClient, path: str, body: dict[str, Any]) -> None:
    answer = shaken.post(f"/v1/trees/shaken/{path}", json=body)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["code"] in ("has-driven", "not-steady"), answer.text


def test_what_is_wrong_is_told_with_its_place(client: TestClient) -> None:
    for given, code in (({"cart.y": "t"}, "unknown-coordinate"), ({"cart.z": "abs(t)"}, "kink")):
        answer = client.post("/v1/trees", json={**TREE, "driven": given})
        assert answer.status_code == 422
        assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [(f"/driven/{next(iter(given))}", code)]


def test_jobs_take_it() -> None:
    """Assembled, evaluated, simulated, verified, exported and swept as other trees are."""
    (instance,) = TREE["instances"]
    stored = {**TREE, "instances": [{"name": "cart", "substructure": "cart"}]}
    library = MemoryLibrary([instance["definition"]], [stored])
    (assembled,) = outcomes(library, "assemble", {"items": [stored]})
    assert read_json(assembled.files["form"])["driven"] == ["cart.z"]
    asked = {"quantities": ["metric", "drive_forces"], "q": [[0.1], [0.2]], "qdd": [[0], [0]], "t": 0.1}
    made = outcomes(library, "evaluate", {"items": [{"tree": "shaken", "request": asked}]})
    assert joined(made, "drive_forces").shape == (2, 1)
    simulation = {"analysis": "simulations", "request": {"q": [0.1], "span": [0, 1]}}
    given: list[tuple[str, dict[str, Any]]] = [("verify", {}), ("analyse", simulation)]
    given += [("export", {"target": target}) for target in ("c", "fmu")]
    for kind, request in given:
        for outcome in outcomes(library, kind, {"items": [{"tree": "shaken", **request}]}):
            assert outcome.problem is None, (kind, outcome.problem)
    column = {"quantity": "bias", "of": "cart.q", "over": {"q": [0.3], "t": 0.1}, "take": "largest_absolute"}
    choices = {"cart": ["cart", {"substructure": "cart", "at": "world"}]}
    swept = {"template": stored, "choices": choices, "samples": {"of": {"A": {"values": [0.1, 0.2]}}}, "proof": 10}
    (item,) = library.items("sweep", {**swept, "columns": {"bias": column}})
    found = sweep.rows_of(sweep.KINDS["sweep"].run(item, library.blobs, lambda _: None).files["rows"])["bias"]
    assert found.shape == (4,)
    np.testing.assert_allclose(found[1::2], 2 * found[::2])
