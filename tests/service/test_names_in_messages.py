"""Who writes a name that there is not is told the one that is most like it, or which there are."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.cli.main import main

from .conftest import HAND, PENDULUM, TREE
from .one_store import filled, store

__all__ = ["filled", "store"]  # fixtures

ROD = PENDULUM["bodies"][0]
TARGET = {"tree": "cell", "target": "cassadi"}


def said(answer: Any) -> str:
    assert 400 <= answer.status_code < 500, answer.text
    told = answer.json()
    return "; ".join([told["detail"], *(f"{each['pointer']} {each['message']}" for each in told["errors"])])


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("substructures/pendulum/formulas/U?body=lnk", "'pendulum' has no body 'lnk'; there are rod, tip"),
        ("substructures/pendulum/formulas/U?body=rdo", "'pendulum' has no body 'rdo'; did you mean 'rod'?"),
        ("substructures/pendulum/formulas/U?coordinate=p", "'pendulum' has no coordinate 'p'; there are q"),
        ("substructures/pendulum/formulas/metric?body=rod", "no such formula of 'metric'; its index lists all"),
        ("substructures/pendulum/formulas/metric?format=latx", "unknown format 'latx'; did you mean 'latex'?"),
        ("substructures/pendulum/formulas/metric?format=zz", "unknown format 'zz'; there are json"),
        ("substructures/pendulum/formulas/metric?form=textbok", "did you mean 'textbook'?"),
        ("substructures?sort=nam", "unknown sort 'nam'; there are name"),
        ("substructures?sort=nam", "did you mean 'name'?"),
        ("trees/cell/export?target=cassadi", "did you mean 'casadi'?"),
        ("trees/cell/export?target=c&quantities=metrik", "no quantity 'metrik'; did you mean 'metric'?"),
        ("trees/cell/linearisation", "there is no quantity 'linearisation'; did you mean 'linearisations'?"),
        ("trees/cell/linearisations", "'linearisations' are numbers, not formulas: POST a request to this path"),
        ("trees/cell/metric?bind=arm.l:1 mmm", "'arm.l': the unit 'mmm' is not known; did you mean 'mm'?"),
        ("trees/cell/first_integrals?zero=arm.k", "unknown parameter 'arm.k'; did you mean 'arm.m'?"),
        ("trees?uses=pendulum@1", "'uses' is the name of a part alone; GET /v1/substructures/pendulum@1/uses, or "),
    ],
)
def test_in_queries(filled: TestClient, path: str, words: str) -> None:
    assert words in said(filled.get(f"/v1/{path}"))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bodies": [{**ROD, "parent": "bas"}]}, "unknown parent 'bas' of body 'rod'; did you mean 'base'?"),
        ({"bodies": [{**ROD, "parent": "x"}]}, "unknown parent 'x' of body 'rod'; there are base, rod"),
        ({"ports": [{"name": "tip", "body": "rdo"}]}, "body 'rdo'; did you mean 'rod'?"),
        (
            {"loads": [{"type": "torque", "body": "rdo", "vector": [0, 0, 1]}]},
            "unknown body 'rdo'; did you mean 'rod'?",
        ),
        ({"loads": [{"type": "joint", "coordinate": "p", "force": 1}]}, "unknown coordinate 'p'; there are q"),
        (
            {"loads": [{"type": "friction", "coordinate": "p", "coulomb": 1, "velocity": 1}]},
            "unknown coordinate 'p'; there are q",
        ),
        ({"bodies": [{**ROD, "mass": {"value": 1, "unit": "kgg"}}]}, "the unit 'kgg' is not known; did you mean 'kg'?"),
        (
            {"inputs": {"drive": {}}, "loads": [{"type": "joint", "coordinate": "q", "force": "drv"}]},
            "unknown name 'drv' (column 1); did you mean 'drive'?",
        ),
    ],
)
def test_in_definitions(filled: TestClient, change: dict[str, Any], words: str) -> None:
    assert words in said(filled.post("/v1/substructures", json={**copy.deepcopy(PENDULUM), **change}))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"gravity": [0, 0, "gg"]}, "unknown name 'gg' (column 1); did you mean 'g'?"),
        ({"gravity": [0, 0, {"value": 1, "unit": "m/s2"}]}, "did you mean 'm/s^2'?"),
        ({"instances": [{**HAND, "at": "amr.tip"}]}, "unknown instance 'amr'; there are hand"),
        ({"closures": [{"name": "a", "type": "pin", "from": "arm.tp"}]}, "it has base, rod, tip; did you mean 'tip'?"),
        (
            {"loads": [{"name": "a", "type": "joint", "coordinate": "arm.p", "force": 1}]},
            "unknown coordinate 'arm.p'; there are arm.q; did you mean 'arm.q'?",
        ),
        (
            {"loads": [{"name": "a", "type": "joint", "coordinate": "arm.q", "force": "am.q"}]},
            "unknown name 'am.q' (column 1); did you mean 'arm.q'?",
        ),
    ],
)
def test_in_trees(filled: TestClient, change: dict[str, Any], words: str) -> None:
    assert words in said(filled.post("/v1/trees", json={**TREE, **change}))


@pytest.mark.parametrize(
    ("path", "body", "words"),
    [
        ("evaluations", {"quantities": ["metric"], "q": [0], "parametrs": {}}, "did you mean 'parameters'?"),
        (
            "evaluations",
            {"quantities": ["metric"], "q": [0], "parameters": {"arm.m": {"value": 1, "unit": "kgg"}}},
            "did you mean 'kg'?",
        ),
        ("simulations", {"q": [0], "span": [0, 1], "prescribed": {"arm.p": 1}}, "did you mean 'arm.q'?"),
        ("simulations", {"q": [0], "span": [0, 1], "series": {"e": "am.q"}}, "did you mean 'arm.q'?"),
        ("equilibria", {"fixed": ["x"]}, "unknown field 'fixed'; there are "),
        ("evaluations", {"quantities": ["metric"], "q": [0], "float32": "yess"}, "true or false is needed"),
        (
            "evaluations",
            {"quantities": ["reactions"], "q": [0], "joints": 3},
            "a list is needed, as in [1, 2, 3], found 3",
        ),
    ],
)
def test_in_requests(filled: TestClient, path: str, body: dict[str, Any], words: str) -> None:
    assert words in said(filled.post(f"/v1/trees/cell/{path}", json=body))


@pytest.mark.parametrize(
    ("kind", "item", "words"),
    [
        ("evaluat", {}, "did you mean 'evaluate'?"),
        (
            "evaluate",
            {"tree": "cel", "request": {"quantities": ["metric"], "q": [0]}},
            "'cel'; did you mean 'cell'?",
        ),
        (
            "evaluate",
            {"tree": "cell", "request": {"quantities": ["metric"]}, "grid": {"arm.p": [1]}},
            "no coordinate, parameter or input 'arm.p'; did you mean 'arm.q'?",
        ),
        ("evaluate", {"tre": "cell", "request": {}}, "unknown field 'tre'; did you mean 'tree'?"),
        ("analyse", {"tree": "cell", "analysis": "simulatons", "request": {}}, "did you mean 'simulations'?"),
        ("export", TARGET, "unknown target 'cassadi'; there are"),
        ("export", TARGET, "did you mean 'casadi'?"),
        ("derive", {**PENDULUM, "bodies": [{**ROD, "mass": "mm"}]}, "unknown name 'mm'; did you mean 'm'?"),
        ("compare", {"a": "pendulm", "b": "cell"}, "no substructure or tree 'pendulm'; did you mean 'pendulum'?"),
    ],
)
def test_in_jobs(filled: TestClient, kind: str, item: dict[str, Any], words: str) -> None:
    assert words in said(filled.post("/v1/jobs", json={"kind": kind, "items": [item]}))


def test_a_part_whose_versions_are_all_withdrawn_is_told_as_such_in_jobs_too(filled: TestClient) -> None:
    withdrawn = {"reason": "wrong mass", "successor": "pendulum@1"}
    assert filled.post("/v1/substructures/slider@1/withdraw", json=withdrawn).status_code == 200
    tree = {"name": "sled", "instances": [{"name": "a", "substructure": "slider"}]}
    why = "all versions of 'slider' are withdrawn, the last one as slider@1: wrong mass; take pendulum@1"
    assert f"instance 'a': {why}" in said(filled.post("/v1/trees", json=tree))
    assert f"instance 'a': {why}" in said(filled.post("/v1/jobs", json={"kind": "assemble", "items": [tree]}))
    item = {"a": "slider", "b": "cell"}
    assert why in said(filled.post("/v1/jobs", json={"kind": "compare", "items": [item]}))
    assert why in said(filled.post("/v1/equivalences", json=item))


@pytest.mark.parametrize(
    "load",
    [
        {"name": "a", "type": "spring", "to": "arm.tp"},
        {"name": "a", "type": "joint", "coordinate": "arm.q", "force": "distance(world, arm.tp)"},
    ],
)
def test_nothing_else_is_said_of_a_load_whose_end_is_not_known(load: dict[str, Any], filled: TestClient) -> None:
    answer = filled.post("/v1/trees/cell/loads", json=load)
    (fault,) = answer.json()["errors"]
    assert fault["message"] == "'arm' has no port or body 'tp'; it has base, rod, tip; did you mean 'tip'?"


@pytest.mark.parametrize("ports", [([], PENDULUM["ports"]), (PENDULUM["ports"], [])])
def test_nothing_else_is_said_of_a_host_whose_name_occurs_twice(ports: tuple[Any, Any], filled: TestClient) -> None:
    twice = [{"name": "arm", "definition": {**PENDULUM, "ports": each}} for each in ports]
    tree = {"name": "twice", "instances": [*twice, {"name": "hand", "substructure": "pendulum", "at": "arm.tip"}]}
    for answer in (
        filled.post("/v1/trees", json=tree),
        filled.post("/v1/jobs", json={"kind": "assemble", "items": [tree]}),
    ):
        (fault,) = answer.json()["errors"]
        assert fault["message"].endswith("duplicate instance 'arm'")


def test_names_of_aliases(filled: TestClient) -> None:
    told = said(filled.put("/v1/substructures/pendulum/aliases/new", json={"version": 7}))
    assert "there is no substructure 'pendulum@7'; the last version is pendulum@1" in told
    told = said(filled.put("/v1/substructures/pendulm/aliases/new", json={"version": 1}))
    assert "there is no substructure 'pendulm'; did you mean 'pendulum'?" in told


def test_either_a_part_or_a_tree(filled: TestClient) -> None:
    for name, meant in (("pendulm", "pendulum"), ("cel", "cell")):
        told = said(filled.post("/v1/equivalences", json={"a": name, "b": "cell"}))
        assert f"there is no substructure or tree '{name}'; did you mean '{meant}'?" in told


def test_an_analysis_that_is_no_formula(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["analyse", "cell", "simulatons", str(tmp_path / "request.yaml")]) == 1
    assert "'simulatons' is a formula: it has options, but no request; did you mean 'simulations'?" in (
        capsys.readouterr().err
    )
