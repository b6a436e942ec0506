"""Formulas of coupled trees: quantities, formats, binding (HTTP contract, section 4)."""

from __future__ import annotations

import math
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.messages.negotiation import MEDIA_TYPES
from substructures.expr.interpret import interpret
from substructures.expr.program import Program

from .conftest import SLIDER
from .one_store import double, filled, store

__all__ = ["double", "filled", "store"]  # fixtures

QUANTITIES = (
    "metric", "christoffel", "forces", "gravity", "coriolis", "bias", "inverse_dynamics", "kinetic_energy",
    "potential_energy", "kinematics", "momentum",
)  # fmt: skip


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("name", MEDIA_TYPES)
def test_every_quantity_in_every_format(double: TestClient, quantity: str, name: str) -> None:
    answer = double.get(f"/v1/trees/cell/{quantity}", params={"format": name})
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"].startswith(MEDIA_TYPES[name].partition(";")[0])
    assert answer.text
    chosen = double.get(f"/v1/trees/cell/{quantity}", headers={"Accept": MEDIA_TYPES[name]})
    assert chosen.status_code == 200


def test_json_is_a_program(double: TestClient) -> None:
    program = Program.from_bytes(double.get("/v1/trees/cell/metric").content)
    values = {"arm.l": 1.0, "arm.m": 2.0, "hand.l": 1.0, "hand.q": 0.3, "arm.q": 0.1}
    metric = interpret(program, {s.name: values[s.name] for s in program.symbols})["metric"]
    inertia = 2.0 / 10 + 2.0 + 0.5 * 1
    assert metric[0, 1] == pytest.approx(0.5 * 1 + 0.05 + 0.5 * math.cos(0.3))
    assert metric[0, 0] == pytest.approx(inertia + 0.5 + 0.05 + 2 * 0.5 * math.cos(0.3))


def test_christoffel_is_a_sparse_list(double: TestClient) -> None:
    document = double.get("/v1/trees/cell/christoffel", params={"bind": "defaults"}).json()
    assert document["coordinates"] == ["arm.q", "hand.q"]
    assert "Gamma" in document["symmetry_rule"]
    assert [(e["a"], e["b"], e["c"]) for e in document["entries"]] == [(0, 0, 1), (0, 1, 1)]
    assert all("hand.q" in entry["formula"] for entry in document["entries"])
    Program.from_bytes(double.get("/v1/trees/cell/christoffel").content)


@pytest.mark.parametrize("form", ["compact", "expanded"])
def test_forms(double: TestClient, form: str) -> None:
    assert double.get("/v1/trees/cell/metric", params={"form": form, "format": "latex"}).status_code == 200


@pytest.mark.parametrize(
    ("bind", "left"),
    [
        ("", {"arm.l", "arm.m", "hand.l", "hand.q"}),
        ("arm.m:2", {"arm.l", "hand.l", "hand.q"}),
        ("arm.m:2.5,hand.l:arm.l/2", {"arm.l", "hand.q"}),
        ("defaults", {"hand.q"}),
        ("defaults,arm.m:3", {"hand.q"}),
    ],
)
def test_binding(double: TestClient, bind: str, left: set[str]) -> None:
    program = Program.from_bytes(double.get("/v1/trees/cell/metric", params={"bind": bind}).content)
    assert {symbol.name for symbol in program.symbols} == left


@pytest.mark.parametrize(
    "bind", ["arm.m", "nobody.m:1", "arm.m:1/0", "arm.m:2+", "arm.m:nan", "hand.q:1", "arm.m:2^9999"]
)
def test_wrong_bindings(double: TestClient, bind: str) -> None:
    answer = double.get("/v1/trees/cell/metric", params={"bind": bind})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] == "/query/bind"


def test_wrong_requests(double: TestClient) -> None:
    assert double.get("/v1/trees/cell/nothing").status_code == 404
    assert double.get("/v1/trees/nothing/metric").status_code == 404
    assert double.get("/v1/trees/cell/metric", params={"format": "pdf"}).status_code == 422
    assert double.get("/v1/trees/cell/metric", params={"form": "pretty"}).status_code == 422
    assert double.get("/v1/trees/cell/metric", headers={"Accept": "image/png"}).status_code == 406


@pytest.mark.parametrize(
    ("accept", "found"),
    [
        ("application/json;q=0, */*", "text/plain"),
        ("*/*, application/json;q=0.1", "text/plain"),
        ("text/*;q=0.2, text/x-c, application/*;q=0.1", "text/x-c"),
        ("text/plain;q=0.5, application/json;q=0.5", "text/plain"),
        ("application/json;q=0, application/*", "application/x-latex"),
        ("*/*;q=0", None),
    ],
)
def test_what_is_most_wanted(double: TestClient, accept: str, found: str | None) -> None:
    answer = double.get("/v1/trees/cell/metric", headers={"Accept": accept})
    media = answer.headers["content-type"].partition(";")[0]
    assert (answer.status_code, media) == ((406, "application/problem+json") if found is None else (200, found))


def test_immutable_formulas_are_cached_by_clients(double: TestClient) -> None:
    first = double.get("/v1/trees/cell@2/metric")
    assert "immutable" in first.headers["cache-control"]
    same = double.get("/v1/trees/cell@2/metric", headers={"If-None-Match": f'"x", {first.headers["etag"]}'})
    assert (same.status_code, same.content) == (304, b"")
    other = double.get("/v1/trees/cell@2/metric?format=c", headers={"If-None-Match": first.headers["etag"]})
    assert other.status_code == 200
    assert "immutable" not in double.get("/v1/trees/cell/metric").headers["cache-control"]


def evaluate(client: TestClient, tree: str = "cell", **request: Any) -> Any:
    return client.post(f"/v1/trees/{tree}/evaluations", json=request)


def test_one_state(double: TestClient) -> None:
    result = evaluate(double, quantities=["metric", "christoffel", "forces"], q=[0.1, 0.2], qd=[0, 0]).json()
    assert (result["coordinates"], result["count"]) == (["arm.q", "hand.q"], 1)
    assert len(result["metric"]) == len(result["forces"]) == 2
    assert result["metric"][0][1] == result["metric"][1][0] == pytest.approx(0.55 + 0.5 * math.cos(0.2))
    assert result["christoffel"][0][1][1] == pytest.approx(-0.5 * math.sin(0.2))
    assert result["digest"] == double.get("/v1/trees/cell").json()["digest"]


def test_many_states(double: TestClient) -> None:
    states = [[0.0, 0.0], [0.1, 0.2], [1.0, -1.0]]
    result = evaluate(double, quantities=["metric", "gravity"], q=states, parameters={"arm.m": [1, 2, 3]}).json()
    assert result["count"] == 3
    assert len(result["metric"]) == len(result["gravity"]) == 3
    named = evaluate(
        double, quantities=["metric"], q={"arm.q": [0, 0.1, 1], "hand.q": [0, 0.2, -1]}, parameters={"arm.m": [1, 2, 3]}
    )
    assert named.json()["metric"] == result["metric"]


def test_every_quantity(double: TestClient) -> None:
    names = [
        "metric", "christoffel", "forces", "gravity", "coriolis", "bias", "inverse_dynamics", "forward_dynamics",
        "kinetic_energy", "potential_energy", "kinematics", "momentum",
    ]  # fmt: skip
    state = {"q": [0.1, 0.2], "qd": [1, 2], "qdd": [0, 1], "inputs": {"tau.arm.q": 1.5}, "t": 0}
    result = evaluate(double, quantities=names, **state).json()
    assert result.keys() >= set(names)
    assert set(result["kinematics"]) >= {"position", "rotation", "U", "Omega"}


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"q": [0.1]}, "/q"),
        ({"q": [[0.1, 0.2], [0.3]]}, "/q"),
        ({"q": {"arm.q": [0], "nobody.q": [0]}}, "/q/nobody.q"),
        ({"q": ["x", 0]}, "/q/0"),
        ({"q": None}, "/q"),
        ({"qd": [0, 0, 0]}, "/qd"),
        ({"quantities": ["nothing"]}, "/quantities/0"),
        ({"quantities": 7}, "/quantities"),
        ({"quantities": ["inverse_dynamics"]}, "/qdd"),
        ({"parameters": {"arm.mass": 1}}, "/parameters/arm.mass"),
        ({"parameters": {"arm.m": "1"}}, "/parameters/arm.m"),
        ({"parameters": {"arm.m": [1, 2]}}, "/parameters/arm.m"),
        ({"inputs": {"tau.nobody": 1}}, "/inputs/tau.nobody"),
        ({"t": "now"}, "/t"),
        ({"unknown": 1}, "/unknown"),
    ],
)
def test_wrong_evaluations(double: TestClient, change: dict[str, Any], pointer: str) -> None:
    answer = evaluate(double, **{"quantities": ["metric"], "q": [[0, 0], [0, 0], [0, 0]], **change})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] == pointer, answer.text


def test_a_parameter_without_value_is_named(filled: TestClient) -> None:
    tree = {"name": "spring", "instances": [{"name": "cart", "substructure": "slider"}]}
    assert filled.post("/v1/trees", json=tree).status_code == 201
    answer = evaluate(filled, "spring", quantities=["forces"], q=[1])
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/parameters/cart.k"
    assert evaluate(filled, "spring", quantities=["forces"], q=[1], parameters={"cart.k": 3}).json()["forces"] == [-3]


def test_failures_are_null(filled: TestClient) -> None:
    definition = {**SLIDER, "name": "singular", "loads": [{"type": "joint", "coordinate": "x", "force": "1/x"}]}
    assert filled.post("/v1/substructures", json=definition).status_code == 201
    tree = {"name": "singular", "instances": [{"name": "a", "substructure": "singular", "parameters": {"k": 0}}]}
    assert filled.post("/v1/trees", json=tree).status_code == 201
    result = evaluate(filled, "singular", quantities=["forces", "metric"], q=[[1], [0], [2]]).json()
    assert result["forces"] == [[1], None, [0.5]]
    assert result["failures"]


def test_formulas_for_people(filled: TestClient) -> None:
    """The textbook form is the default of text and LaTeX, not of JSON; documents and MathML."""

    def got(**query: str) -> str:
        answer = filled.get("/v1/trees/cell/metric", params=query)
        assert answer.status_code == 200
        return answer.text

    assert got(format="text") == got(format="text", form="textbook") != got(format="text", form="compact")
    assert got() == got(form="compact")
    assert got(format="latex", document="true") == got(format="latex-document")
    assert got(format="latex-document").startswith("\\documentclass")
    assert got(format="text", document="true") == got(format="text")
    page = filled.get("/v1/trees/cell/metric", headers={"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"})
    assert page.headers["content-type"] == "application/xhtml+xml; charset=utf-8"
    assert "<math " in page.text
    assert filled.get("/v1/trees/cell/metric", params={"form": "pretty"}).status_code == 422
