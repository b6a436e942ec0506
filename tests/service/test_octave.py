"""From Octave and MATLAB: what ``webwrite`` sends is taken, and the package of functions works in Octave."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest
from fastapi.testclient import TestClient

import substructures.client
from service.app import open_store
from service.server import background
from service.settings import Settings
from service.store import keys

from .conftest import PENDULUM, TREE
from .test_conventions import problem

PACKAGE = Path(substructures.__file__).parent / "client" / "matlab"
FORM = {"Content-Type": "application/x-www-form-urlencoded"}
EVALUATIONS = "/v1/trees/cell/evaluations"
ONE = {"quantities": ["metric"], "q": [0.5]}
SCRIPT = """
address = getenv ("SUBSTRUCTURES_SERVER");
% options are an object that webread and webwrite change
headers = @() weboptions ("HeaderFields", {"Authorization", ["Bearer " getenv("SUBSTRUCTURES_KEY")]});
% as they are
found = jsondecode (webread ([address "/v1/substructures"], headers ()));
assert (found.items(1).name, "pendulum")
request = struct ("quantities", "metric", "q", 0.5);
answer = jsondecode (webwrite ([address "/v1/trees/cell/evaluations"], "json", jsonencode (request), headers ()));
assert (answer.metric, 2.2, 1e-12)
% the package
answer = substructures.evaluate ("cell", {"metric", "forces"}, 0.5);
assert (answer.metric, 2.2, 1e-12)
assert (answer.forces, -2 * 9.81 * cos (0.5), 1e-9)
q = [0.5; 1; 2];
answer = substructures.evaluate ("cell", "forces", q, "qd", [1; 2; 3], "parameters", containers.Map ("arm.m", 4));
assert (answer.forces, -4 * 9.81 * cos (q), 1e-9)
arm = struct ("name", "arm", "substructure", "pendulum");
tree = substructures.couple ("alone", arm, "gravity", [0 0 -9.81]);
assert (tree.dof, 1)
hand = struct ("name", "hand", "substructure", "pendulum", "at", "arm.tip");
tree = substructures.couple ("both", {arm, hand}, "gravity", [0 0 -9.81]);
assert (tree.coordinates, {"arm.q"; "hand.q"})
answer = substructures.evaluate ("both", "metric", [0 0; 0.1 0.2; 1 2]);
assert (size (answer.metric), [3 2 2])
answer = substructures.evaluate ("both", "metric", [0.1 0.2]);
assert (size (answer.metric), [2 2])
motion = substructures.request ("/v1/trees/alone/simulations", struct ("q", 0.5, "span", [0 0.1], "step", 0.05));
assert (numel (motion.t), 3)
text = substructures.request ("/v1/trees/alone/metric?format=text");
assert (ischar (text) && ! isempty (strfind (text, "metric[1, 1] = ")))
program = substructures.request ("/v1/trees/alone/metric");
assert (program.format, "substructures.program")
% what fails says where, and what helps
function message = said (path)
  message = "";
  try
    substructures.request (path);
  catch failed
    message = failed.message;
  end
end
message = said ("/v1/trees/nothing");
assert (! isempty (strfind (message, [address "/v1/trees/nothing: "])))
assert (! isempty (strfind (message, "curl and other clients")))
setenv ("SUBSTRUCTURES_SERVER", "http://127.0.0.1:9")
assert (! isempty (strfind (said ("/v1/trees"), "substructures serve")))
disp ("all of it")
"""


@pytest.mark.parametrize(
    "given",
    ["application/json", "Application/JSON; charset=UTF-8", "application/json;charset=utf-8", "APPLICATION/JSON"],
)
def test_json_in_any_case_and_with_parameters(filled: TestClient, given: str) -> None:
    for address, body in ((EVALUATIONS, ONE), ("/v1/substructures", PENDULUM)):
        answer = filled.post(address, content=json.dumps(body), headers={"Content-Type": given})
        assert answer.status_code == 200, answer.text


def test_what_was_received_is_said(filled: TestClient) -> None:
    for headers, said in (({"Content-Type": "text/plain"}, "Content-Type 'text/plain'"), ({}, "no Content-Type")):
        told = problem(filled.post("/v1/trees", content=b"{}", headers=headers), 415, "unsupported-media-type")
        assert said in told["detail"]


@pytest.mark.parametrize("body", [urlencode({"json": json.dumps(ONE)}), json.dumps(ONE)])
def test_forms_bring_json(filled: TestClient, body: str) -> None:
    answer = filled.post(EVALUATIONS, content=body, headers=FORM)
    assert answer.json()["metric"] == [[2.2]]
    tree = urlencode({"json": json.dumps({**TREE, "name": "a=b&c" if "=" in body else "x"})})
    assert filled.post("/v1/trees", content=tree, headers=FORM).status_code in (201, 422)


@pytest.mark.parametrize(
    "sent", [{"Origin": "http://evil.example"}, {"Origin": "null"}, {"Referer": "x"}, {"Sec-Fetch-Site": "cross-site"}]
)
def test_forms_of_pages_are_refused(filled: TestClient, sent: dict[str, str]) -> None:
    """Another site must not write to a server on loopback that has no keys."""
    for address, body in ((EVALUATIONS, ONE), ("/v1/substructures", {**PENDULUM, "name": "evil"})):
        answer = filled.post(address, content=urlencode({"json": json.dumps(body)}), headers={**FORM, **sent})
        problem(answer, 415, "unsupported-media-type")
    assert filled.get("/v1/substructures/evil").status_code == 404


@pytest.mark.parametrize("body", ["q=0.5&quantities=metric", "json=1&json=2", "json=%7B", "", "x=%00"])
def test_other_forms_say_how(filled: TestClient, body: str) -> None:
    answer = filled.post("/v1/trees/cell/linearisations", content=body, headers=FORM)
    assert answer.status_code == 422
    assert ("webwrite" in answer.text) == (body != "json=%7B")


@pytest.mark.parametrize("q", [0.5, [0.5], [[0.5]], {"arm.q": 0.5}, {"value": 30, "unit": "deg"}])
def test_a_number_for_one_coordinate(filled: TestClient, q: Any) -> None:
    for address in (EVALUATIONS, "/v1/trees/cell@1/evaluations"):
        answer = filled.post(address, json={"quantities": "metric", "q": q, "qd": 0}).json()
        assert answer["metric"] in ([[2.2]], [[[2.2]]])
        assert answer["count"] == 1


def test_a_number_for_each_state(filled: TestClient) -> None:
    flat, rows = (
        filled.post(EVALUATIONS, json={"quantities": ["forces"], "q": q}).json()["forces"]
        for q in ([0.1, 0.2, 0.3], [[0.1], [0.2], [0.3]])
    )
    assert flat == rows


def test_what_stands_alone_is_a_list_of_one(filled: TestClient) -> None:
    body = {**PENDULUM["bodies"][0], "name": "lone"}
    part = {**PENDULUM, "name": "lone", "tags": "planar", "bodies": body, "ports": {"name": "tip", "body": "lone"}}
    stored = filled.post("/v1/substructures", json=part).json()
    same = {**part, "tags": ["planar"], "bodies": [body], "ports": [part["ports"]]}
    assert filled.post("/v1/substructures", json=same).json()["digest"] == stored["digest"]
    tree = {**TREE, "name": "single", "instances": {"name": "a", "substructure": "lone"}}
    assert filled.post("/v1/trees", json=tree).status_code == 201
    motion = filled.post("/v1/trees/single/simulations", json={"q": 0.5, "qd": 0, "span": [0, 0.1]})
    assert motion.status_code == 200, motion.text
    wrong = filled.post("/v1/trees", json={**tree, "gravity": 9.81})  # one number is no vector
    assert problem(wrong, 422, "invalid-document")["errors"][0]["pointer"] == "/gravity"


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.m")), ids=lambda path: path.name)
def test_code_is_that_of_matlab(path: Path) -> None:
    """Strings in brackets are not joined in MATLAB, where texts in single quotes are; Octave joins both."""
    for line in path.read_text().splitlines():
        code = re.sub(r"'(?:[^']|'')*'|%.*", "''", line)
        assert not re.search(r'["#!]|\b(?:end(?:if|for|function|_try_catch)|printf|unwind_protect)\b|[-+]=', code), line


@pytest.mark.skipif(shutil.which("octave-cli") is None, reason="needs Octave")
def test_from_octave(tmp_path: Path) -> None:
    settings = Settings(database=f"sqlite:///{tmp_path / 'x.db'}", catalogue=False)
    with open_store(settings) as store, store.database.write() as connection:
        key = keys.create(connection, "octave", ["read", "write"], None, "acme")
    (tmp_path / "script.m").write_text(f'addpath ("{PACKAGE}");{SCRIPT}')
    with background(settings) as address:
        given = {**os.environ, "SUBSTRUCTURES_SERVER": address, "SUBSTRUCTURES_KEY": key}
        with substructures.client.Client(address, key) as client:
            client.submit(PENDULUM)
            client.create_tree(TREE)
        command = ["octave-cli", "--no-init-file", "--no-site-file", str(tmp_path / "script.m")]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=given, cwd=tmp_path)
    assert "all of it" in done.stdout, done.stdout + done.stderr
