"""Wrong definitions: a problem document with a pointer and the culprit, and nothing is left behind."""

from __future__ import annotations

import copy
import json
from typing import Any

import pytest
from fastapi.testclient import TestClient

from .conftest import PENDULUM, SLIDER
from .one_store import filled, store

__all__ = ["filled", "store"]  # fixtures

JSON = {"Content-Type": "application/json"}


def edited(path: str, value: Any) -> dict[str, Any]:
    """The pendulum with the value at an RFC 6901 pointer replaced; ``-`` appends."""
    document = copy.deepcopy(PENDULUM)
    here: Any = document
    *steps, last = path.strip("/").split("/")
    for step in steps:
        here = here[int(step)] if isinstance(here, list) else here[step]
    if last == "-":
        here.append(value)
    else:
        here[int(last) if isinstance(here, list) else last] = value
    return document


BODY = SLIDER["bodies"][0]
CYCLE = [
    {**BODY, "name": a, "parent": b, "joint": {"type": "revolute", "coordinate": f"q{a}"}}
    for a, b in (("a", "b"), ("b", "a"))
]
FORCE = {"type": "force", "body": "nobody", "vector": [0, 0, 1]}
WRONG: dict[str, tuple[Any, str, str]] = {
    "unknown parent": (edited("/bodies/0/parent", "nobody"), "/bodies/0/parent", "nobody"),
    "own parent": (edited("/bodies/0/parent", "rod"), "/bodies/0/parent", "rod"),
    "cycle": ({**PENDULUM, "bodies": CYCLE, "ports": []}, "/bodies/0/parent", "a"),
    "duplicate body": (edited("/bodies/-", PENDULUM["bodies"][0]), "/bodies/1/name", "rod"),
    "duplicate coordinate": (
        edited("/bodies/-", {**PENDULUM["bodies"][0], "name": "b"}),
        "/bodies/1/joint/coordinate",
        "q",
    ),
    "duplicate port": (edited("/ports/-", PENDULUM["ports"][0]), "/ports/1/name", "tip"),
    "illegal body name": (edited("/bodies/0/name", "1rod"), "/bodies/0/name", "1rod"),
    "illegal name": (edited("/name", "Pendulum!"), "/name", "Pendulum!"),
    "reserved body name": (edited("/bodies/0/name", "base"), "/bodies/0/name", "base"),
    "unknown body of a port": (edited("/ports/0/body", "nobody"), "/ports/0/body", "nobody"),
    "unknown parameter": (edited("/bodies/0/mass", "mass"), "/bodies/0/mass", "mass"),
    "expression": (edited("/bodies/0/mass", "m + * 2"), "/bodies/0/mass", "column 5"),
    "unknown function": (edited("/bodies/0/mass", "exec(m)"), "/bodies/0/mass", "exec"),
    "coordinate in a mass": (edited("/bodies/0/mass", "q"), "/bodies/0/mass", "q"),
    "division by zero": (edited("/bodies/0/mass", "m/0"), "/bodies/0/mass", "zero"),
    "hidden division by zero": (edited("/bodies/0/mass", "m/(l-l)"), "/bodies/0/mass", "zero"),
    "array length": (edited("/bodies/0/com", ["l", 0]), "/bodies/0/com/2", "missing"),
    "array of arrays": (edited("/bodies/0/com", [[0, 0, 0]]), "/bodies/0/com/0", "number"),
    "negative mass": (edited("/bodies/0/mass", -1), "/bodies/0/mass", "negative"),
    "impossible inertia": (edited("/bodies/0/inertia", {"xx": 1, "yy": 1, "zz": 3}), "/bodies/0/inertia", "triangle"),
    "indefinite inertia": (
        edited("/bodies/0/inertia", {"xx": 1, "yy": 1, "zz": 1, "xy": 5}),
        "/bodies/0/inertia",
        "rod",
    ),
    "exponent": (edited("/bodies/0/mass", "m^65"), "/bodies/0/mass", "64"),
    "exponent tower": (edited("/bodies/0/mass", "2^9^9^9"), "/bodies/0/mass", "column"),
    "nested powers": (edited("/bodies/0/mass", "(((3^64)^64)^64)^64"), "/bodies/0/mass", ""),
    "symbolic exponent": (edited("/bodies/0/mass", "2^m"), "/bodies/0/mass", "column"),
    "deep expression": (edited("/bodies/0/mass", "(" * 200 + "m" + ")" * 200), "/bodies/0/mass", ""),
    "long expression": (edited("/bodies/0/mass", "m" + "+m" * 20_000), "/bodies/0/mass", ""),
    "joint type": (edited("/bodies/0/joint/type", "hinge"), "/bodies/0/joint/type", "hinge"),
    "too many coordinates": (edited("/bodies/0/joint/coordinate", ["a", "b"]), "/bodies/0/joint/coordinate", ""),
    "unknown field": (edited("/bodies/0/colour", "red"), "/bodies/0/colour", ""),
    "boolean": (edited("/bodies/0/mass", True), "/bodies/0/mass", ""),
    "null": (edited("/bodies/0/mass", None), "/bodies/0/mass", ""),
    "unknown body of a load": (edited("/loads", [FORCE]), "/loads/0/body", "nobody"),
    "unknown coordinate of a load": (
        edited("/loads", [{"type": "joint", "coordinate": "x", "force": 1}]),
        "/loads/0/coordinate",
        "x",
    ),
    "unknown name in a load": (
        edited("/loads", [{"type": "joint", "coordinate": "q", "force": "p'"}]),
        "/loads/0/force",
        "p'",
    ),
    "not an object": ([PENDULUM], "", "object"),
    "no name": ({"bodies": []}, "/name", ""),
}


@pytest.mark.parametrize("what", WRONG)
def test_wrong_definitions(filled: TestClient, rows: Any, what: str) -> None:
    definition, pointer, culprit = WRONG[what]
    before = rows()
    answer = filled.post("/v1/substructures", json=definition)
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    errors = answer.json()["errors"]
    assert any(e["pointer"] == pointer and culprit in e["message"] for e in errors), errors
    assert rows() == before


@pytest.mark.parametrize("what", WRONG)
def test_wrong_inline_definitions(filled: TestClient, rows: Any, what: str) -> None:
    definition, pointer, _ = WRONG[what]
    before = rows()
    tree = {"name": "t", "instances": [{"name": "a", "definition": definition}]}
    answer = filled.post("/v1/trees", json=tree)
    assert answer.status_code == 422, answer.text
    errors = answer.json()["errors"]
    assert any(e["pointer"] == f"/instances/0/definition{pointer}" for e in errors), errors
    assert rows() == before


TEXTS = {
    "truncated": b'{"name": "a"',
    "nan": b'{"name": "a", "bodies": NaN}',
    "infinity": b'{"name": "a", "parameters": {"m": {"value": -Infinity}}}',
    "overflow": b'{"name": "a", "parameters": {"m": {"value": 1e999999999}}}',
    "digits": b'{"name": "a", "parameters": {"m": {"value": ' + b"9" * 401 + b"}}}",
    "duplicate key": b'{"name": "a", "name": "b"}',
    "utf-8": b'{"name": "\xff"}',
    "surrogate": b'{"name": "a", "title": "\\ud800"}',
    "deep lists": b'{"name": ' + b"[" * 100_000 + b"]" * 100_000 + b"}",
    "deep objects": b'{"a":' * 50_000 + b"1" + b"}" * 50_000,
    "number": b"17",
    "empty": b"",
}


@pytest.mark.parametrize("what", TEXTS)
@pytest.mark.parametrize("path", ["substructures", "trees", "trees/cell/couplings", "trees/cell/evaluations"])
def test_wrong_texts(filled: TestClient, rows: Any, what: str, path: str) -> None:
    before = rows()
    answer = filled.post(f"/v1/{path}", content=TEXTS[what], headers=JSON)
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["errors"]
    assert rows() == before


def test_warnings_for_what_depends_on_parameters(filled: TestClient) -> None:
    definition = edited("/bodies/0/inertia", {"xx": "m*l^2", "yy": "m*l^2", "zz": "9*m*l^2"})
    answer = filled.post("/v1/substructures", content=json.dumps(definition), headers=JSON)
    assert answer.status_code == 201, answer.text
    assert "rod" in json.dumps(answer.json()["certificate"]["warnings"])


MANY: dict[str, tuple[str, Any]] = {
    "bodies": ("substructures", {"name": "a", "bodies": [1] * 50_000}),
    "values": ("trees/cell/root-loci", {"parameter": "arm.m", "values": ["x"] * 9000, "q": [0]}),
    "quantities": ("trees/cell/evaluations", {"quantities": [f"x{k}" for k in range(50_000)], "q": [0]}),
}


@pytest.mark.parametrize("what", MANY)
def test_many_faults_are_counted_and_few_are_shown(filled: TestClient, what: str) -> None:
    path, body = MANY[what]
    answer = filled.post(f"/v1/{path}", json=body)
    assert answer.status_code == 422
    assert (len(answer.json()["errors"]), answer.json()["count"] >= 1000) == (20, True)
    assert len(answer.content) < 20_000


@pytest.mark.parametrize("q", [{"arm.q": []}, [[0], [0, 1]], {"arm.q": [1, 2]}, [], [[]], {}, {"arm.q": [[1]]}])
@pytest.mark.parametrize("kind", ["root-loci", "loop-states"])
def test_one_state_is_one_state(filled: TestClient, kind: str, q: Any) -> None:
    body = {"q": q} | ({"parameter": "arm.m", "values": [1, 2]} if kind == "root-loci" else {})
    answer = filled.post(f"/v1/trees/cell/{kind}", json=body)
    assert answer.status_code in (200, 422), answer.text
