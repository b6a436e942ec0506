"""What is said to who made a mistake: the rule in words, what was found, and what to do instead."""

from __future__ import annotations

import copy
import json
import os
import re
import socket
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.cli.main import main
from substructures.client import Client
from substructures.documents import write_yaml
from substructures.errors import meant

from .conftest import HAND, PENDULUM, TREE
from .one_store import filled, store

__all__ = ["filled", "store"]  # fixtures

JOINT = {"type": "revolute", "coordinate": "q"}
#: needs no server
TREE_OF_ITS_OWN = {**TREE, "instances": [{"name": "arm", "definition": PENDULUM}]}
EVALUATIONS = "/v1/trees/cell/evaluations"


def said(answer: Any) -> str:
    assert 400 <= answer.status_code < 500, answer.text
    told = answer.json()
    return "; ".join([told["detail"], *(f"{each['pointer']} {each['message']}" for each in told["errors"])])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"name": "My Pendulum"}, ("/name", "a to z", "'my-pendulum'")),
        ({"name": "---"}, ("/name", "a to z")),
        ({"inertia": 5}, ("/bodies/0/inertia", "an object is needed, with", "xx", "found 5")),
        ({"inertia": [1, 2]}, ("an object is needed",)),
        ({"body": "rod 1"}, ("/bodies/0/name", "letters, digits and '_'", "'rod_1'")),
        ({"mass": "500 g"}, ("/bodies/0/mass", '{"value": 500, "unit": "g"}')),
        ({"mass": "500g"}, ('{"value": 500, "unit": "g"}',)),
        ({"mass": "2 furlongs per"}, ("expected an operator",)),
        ({"joint": {**JOINT, "theta": "90 deg"}}, ("/bodies/0/joint/theta", '{"value": 90, "unit": "deg"}')),
        ({"joint": {**JOINT, "type": "revolut"}}, ("did you mean 'revolute'?",)),
        ({"boddies": []}, ("unknown field 'boddies'; did you mean 'bodies'?",)),
        ({"joint": {**JOINT, "stifness": 1}}, ("did you mean 'stiffness'?",)),
    ],
)
def test_definitions(filled: TestClient, change: dict[str, Any], words: tuple[str, ...]) -> None:
    part = copy.deepcopy(PENDULUM)
    for name, value in change.items():
        if name == "body":
            part["bodies"][0]["name"] = value
        elif name in ("inertia", "mass", "joint"):
            part["bodies"][0][name] = value
        else:
            part[name] = value
    told = said(filled.post("/v1/substructures", json=part))
    for word in words:
        assert word in told, told
    assert "match pattern" not in told
    assert "dictionary" not in told


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"gravity": -9.81}, ("/gravity", "a list is needed", "found -9.81")),
        ({"gravity": {"x": 0}}, ("a list is needed",)),
        ({"at": "tip"}, ("/instances/1/at", "'instance.port'", "; there are arm.tip")),
        ({"at": "arm"}, ("/instances/1/at", "; there are arm.base, arm.rod, arm.tip")),
        ({"at": "flange"}, ("/instances/1/at", "; there are arm.base, arm.rod, arm.tip, hand")),
        ({"at": "arm tip"}, ("/instances/1/at", "'instance.port'")),
        ({"at": "arm.tp"}, ("it has base, rod, tip",)),
        ({"at": "amr.tip"}, ("unknown instance 'amr'; did you mean 'arm'?",)),
        ({"substructure": "pendulm"}, ("/instances/1/substructure", "did you mean 'pendulum'?")),
        ({"parameters": {"mm": 1}}, ("/instances/1/parameters/mm", "did you mean 'm'?")),
    ],
)
def test_trees(filled: TestClient, change: dict[str, Any], words: tuple[str, ...]) -> None:
    tree = {**TREE, "name": "another", "instances": [*TREE["instances"], copy.deepcopy(HAND)]}
    target = tree if "gravity" in change else tree["instances"][1]
    target.update(change)
    told = said(filled.post("/v1/trees", json=tree))
    for word in words:
        assert word in told, told
    assert "tuple" not in told


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("/v1/substructures/pendulm", "did you mean 'pendulum'?"),
        ("/v1/trees/cel", "did you mean 'cell'?"),
        ("/v1/substructures/pendulum@9", "there is no substructure 'pendulum@9'; the last version is pendulum@1"),
        ("/v1/trees/cell@9", "there is no tree 'cell@9'; did you mean 'cell'?"),
        ("/v1/trees/cell/metrik", "did you mean 'metric'?"),
        ("/v1/substructures/pendulum/formulas/metrik", "has no formula of 'metrik'; did you mean 'metric'?"),
        ("/v1/substructures/pendulum/formulas/zzzzzz", "has no formula of 'zzzzzz'; its index lists all"),
        ("/v1/trees/cell/metric?fromat=text", "unknown query parameter 'fromat'; did you mean 'format'?"),
        ("/v1/trees?dofs=2", "unknown query parameter 'dofs'; there are q, uses, page_size, page_token, dof_min"),
        ("/v1/limits?x=1", "there are none"),
    ],
)
def test_names(filled: TestClient, path: str, words: str) -> None:
    assert words in said(filled.get(path))


def test_numbers_that_are_none(filled: TestClient) -> None:
    assert "found null, as MATLAB writes NaN" in said(
        filled.post(EVALUATIONS, json={"quantities": ["metric"], "q": [None]})
    )


@pytest.mark.parametrize("path", [EVALUATIONS, "/v1/trees", "/v1/bundles", "/v1/imports"])
def test_another_content_type_is_named(filled: TestClient, path: str) -> None:
    answer = filled.post(path, content=b"<a/>", headers={"Content-Type": "text/odd; x=1"})
    assert answer.status_code == 415
    assert "text/odd" in answer.json()["detail"]
    assert "was received" in answer.json()["detail"]


def test_units_in_states(filled: TestClient) -> None:
    told = said(filled.post(EVALUATIONS, json={"quantities": ["metric"], "q": ["90 deg"]}))
    assert 'found \'90 deg\'; a number with a unit is written {"value": 90, "unit": "deg"}' in told
    told = said(filled.post(EVALUATIONS, json={"quantities": ["metric"], "q": [0], "parameters": {"arm.m": "500 g"}}))
    assert 'a number with a unit is written {"value": 500, "unit": "g"}' in told


def test_names_in_expressions(filled: TestClient) -> None:
    body = {**PENDULUM["bodies"][0], "mass": "lenth"}
    wrong = {"name": "wrong", "parameters": {"length": {"value": 1}}, "bodies": [body]}
    assert "unknown name 'lenth' (column 1); did you mean 'length'?" in said(
        filled.post("/v1/substructures", json=wrong)
    )


def test_a_server_that_is_not_there(capsys: pytest.CaptureFixture[str], tmp_path: Any) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listener:
        address = f"http://127.0.0.1:{listener.getsockname()[1]}"
    (tmp_path / "part.yaml").write_text("name: x")
    assert main(["submit", str(tmp_path / "part.yaml"), "--server", address]) == 1
    told = capsys.readouterr().err
    assert address in told
    assert "substructures serve" in told


def test_what_was_meant() -> None:
    assert meant("Metric", ["metric", "forces"]) == "; did you mean 'metric'?"
    assert meant("x" * 10_000, ["metric"]) == meant("nothing", []) == ""


def test_angles_that_are_meant_in_degrees(client: TestClient) -> None:
    for k, (theta, pointers) in enumerate(
        ((90, ["/bodies/0/joint/theta"]), ("pi/2", []), ({"value": 90, "unit": "deg"}, []), (-3.2, []))
    ):
        part = copy.deepcopy(PENDULUM)
        part["name"], part["bodies"][0]["joint"]["theta"] = f"turned-{k}", theta
        warnings = client.post("/v1/substructures", json=part).json()["warnings"]
        assert [each["pointer"] for each in warnings] == pointers
        assert all('{"value": 90, "unit": "deg"}' in each["message"] for each in warnings)


def test_faults_of_files_have_line_and_column(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Those of the text as well as those of what it says, in YAML and in JSON."""
    texts = {
        "syntax.yaml": ("name: x\ntags: [a\n", "(line 3, column 1)"),
        "syntax.json": ('{"name": "x",\n "bodies": [1,,2]}', "(line 2, column 15)"),
        "parent.yaml": (
            "name: x\nbodies:\n  - name: a\n    joint: {type: fixed}\n    parent: basse\n",
            "parent.yaml#/bodies/0/parent: unknown parent 'basse' of body 'a'; did you mean 'base'?"
            " (line 5, column 13)",
        ),
        "mass.json": (
            '{"name": "x", "bodies": [{"name": "a", "parent": "base",\n  "joint": {"type": "fixed"}, "mass": "2*k"}]}',
            "mass.json#/bodies/0/mass: unknown name 'k' (column 3) (line 2, column 39)",
        ),
        "field.yaml": (
            "name: x\nbodys: []\n",
            "field.yaml#/bodys: unknown field 'bodys'; did you mean 'body'? (line 2, column 8)",
        ),
    }
    for name, (text, said) in texts.items():
        (tmp_path / name).write_text(text)
        assert main(["derive", str(tmp_path / name)]) == 1
        assert said in capsys.readouterr().err


@pytest.mark.parametrize("is_there", [False, True])
def test_restoring_what_is_not_there(is_there: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if is_there:
        (tmp_path / "x.db").write_text("a store")
    before = list(tmp_path.iterdir())
    database = ["--database", f"sqlite:///{tmp_path / 'x.db'}"]
    assert main(["restore", str(tmp_path / "nothing.db"), *database]) == 1
    assert "there is no file" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == before


def test_settings_are_named_as_they_were_given(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert main(["serve", "--port", "99999"]) == 1
    assert "--port: at most 65535 is allowed, found 99999" in capsys.readouterr().err
    monkeypatch.setenv("SUBSTRUCTURES_PORT", "-1")
    assert main(["serve"]) == 1
    assert 'SUBSTRUCTURES_PORT: at least 0 is needed, found "-1"' in capsys.readouterr().err


def test_a_document_comes_through_a_pipe(capsys: pytest.CaptureFixture[str]) -> None:
    """As of a shell, <(...), which has no size and is read once."""
    read, write = os.pipe()
    os.write(write, json.dumps(PENDULUM).encode())
    os.close(write)
    assert main(["derive", f"/dev/fd/{read}"]) == 0
    os.close(read)
    assert capsys.readouterr().out.startswith("pendulum: 1 coordinate (R)")


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("empty.yaml", "", "; there is nothing"),
        ("remark.yaml", "# nothing yet", "; there is nothing"),
        ("empty.json", "", "; there is nothing"),
        ("list.yaml", "- a", ', found ["a"]'),
        ("text.yaml", "hello", ', found "hello"'),
    ],
)
@pytest.mark.parametrize("words", [("derive",), ("simulate", "TREE"), ("submit",), ("jobs", "submit")])
def test_files_that_hold_no_object(
    words: tuple[str, ...],
    name: str,
    text: str,
    found: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path, tree = tmp_path / name, tmp_path / "cell.yaml"
    path.write_text(text)
    tree.write_bytes(write_yaml(TREE_OF_ITS_OWN))
    server = [] if words[0] in ("derive", "simulate") else ["--server", "http://127.0.0.1:9"]
    assert main([*(str(tree) if word == "TREE" else word for word in words), str(path), *server]) == 1
    assert f'{path}: an object of fields is needed, as in {{"name": "arm"}}{found}' in capsys.readouterr().err


def test_requests_in_files_are_told_of_as_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tree, request = tmp_path / "cell.yaml", tmp_path / "request.yaml"
    tree.write_bytes(write_yaml(TREE_OF_ITS_OWN))
    request.write_text("q: [0]\nspan: [0, 1]\ninputs:\n  tau.arm.p: 1\n")
    assert main(["simulate", str(tree), str(request)]) == 1
    told = "/inputs/tau.arm.p: unknown input 'tau.arm.p'; did you mean 'tau.arm.q'? (line 4, column 14)"
    assert f"{request}#{told}" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("address", "advice"),
    [
        ("localhost:8000", "begins with http:// or https://: write http://localhost:8000"),
        ("ftp://localhost", "'ftp://localhost' is no address of a server: write http://HOST:PORT"),
        ("http://", "'http://' is no address of a server"),
        ("http://localhost:80x", "'http://localhost:80x' is no address of a server"),
    ],
)
def test_addresses_of_servers(address: str, advice: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match=re.escape(advice)):
        Client(address)
    assert main(["list", "--server", address]) == 1
    assert advice in capsys.readouterr().err


def test_jobs_that_cannot_be_removed(filled: TestClient) -> None:
    told = said(filled.delete("/v1/jobs/abc"))
    assert "there is no job 'abc'; GET /v1/jobs, or 'substructures jobs list', tells which there are" in told
    job = {"kind": "export", "items": [{"tree": "cell", "quantity": "metric", "format": "text"}]}
    number = filled.post("/v1/jobs", json=job).json()["id"]
    told = said(filled.delete(f"/v1/jobs/{number}"))
    assert (
        f"is queued: cancel it first (POST /v1/jobs/{number}/cancel, or 'substructures jobs cancel {number}')" in told
    )


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"quantities": ["metrik"]}, "unknown quantity 'metrik'; did you mean 'metric'?"),
        ({"parameters": {"arm.mm": 1}}, "unknown parameter 'arm.mm'; did you mean 'arm.m'?"),
        ({"inputs": {"tau.arm.p": 1}}, "unknown input 'tau.arm.p'; did you mean 'tau.arm.q'?"),
        ({"q": {"arm.qq": [0]}}, "unknown coordinate 'arm.qq'; did you mean 'arm.q'?"),
        ({"parameters": {"xyz": 1}}, "unknown parameter 'xyz'; there are arm.l, arm.m"),
    ],
)
def test_evaluations_say_which_name_was_meant(more: dict[str, Any], said: str, filled: TestClient) -> None:
    answer = filled.post("/v1/trees/cell/evaluations", json={"quantities": ["metric"], "q": [0.1], **more})
    assert (answer.status_code, said in answer.json()["detail"]) == (422, True), answer.text
