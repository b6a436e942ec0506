"""Clients that others' programs make of the OpenAPI document: they are generated, compiled, and used against a server.

MathWorks' generator for MATLAB runs in MATLAB alone: its functions are made by a script of ours, and run in Octave.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from matlab_operations import PLACE, functions

import service
from service.server import background
from service.settings import Settings

from .conftest import PENDULUM, TREE

DOCUMENT = Path(service.__file__).parent / "openapi.json"
#: M of a rod with its mass m at the end of l, and a tenth of that more
METRIC = 2 * 1.0**2 * 1.1
PYTHON = f"""
from made import Client
from made.api.analyses import compute_simulations
from made.api.catalogue import get_substructure, list_substructures, submit_substructure
from made.api.models import evaluate_tree
from made.api.trees import create_tree
from made.models import EvaluationRequest, Problem, SimulationRequest, SubmittedDefinition, SubmittedTree

client = Client(base_url=ADDRESS)
stored = submit_substructure.sync(client=client, body=SubmittedDefinition.from_dict({PENDULUM!r}))
assert (stored.name, stored.version) == ("pendulum", 1), stored
tree = create_tree.sync(client=client, body=SubmittedTree.from_dict({TREE!r}))
assert tree.coordinates == ["arm.q"], tree
request = EvaluationRequest.from_dict({{"quantities": ["metric"], "q": [0]}})
found = evaluate_tree.sync("cell", client=client, body=request)
assert abs(found["metric"][0][0] - {METRIC}) < 1e-12, found
motion = SimulationRequest.from_dict({{"q": [0.1], "span": [0, 0.1]}})
assert compute_simulations.sync("cell", client=client, body=motion)["is_right"] is True
assert [each.name for each in list_substructures.sync(client=client).items] == ["pendulum"]
problem = get_substructure.sync("pendulm", client=client)
assert isinstance(problem, Problem) and problem.code == "unknown-substructure", problem
print("ok")
"""
TYPESCRIPT = f"""
import createClient from "openapi-fetch";
import type {{ components, paths }} from "./schema.js";

const client = createClient<paths>({{ baseUrl: process.argv[2] }});
const rod: components["schemas"]["SubmittedDefinition"] = {json.dumps(PENDULUM)};
const stored = await client.POST("/v1/substructures", {{ body: rod }});
if (stored.error) throw new Error(stored.error.detail);
const cell: components["schemas"]["SubmittedTree"] = {json.dumps(TREE)};
const tree = await client.POST("/v1/trees", {{ body: cell }});
if (tree.error) throw new Error(tree.error.detail);
const path = {{ ref: "cell" }};
const found = await client.POST("/v1/trees/{{ref}}/evaluations", {{
    params: {{ path }}, body: {{ quantities: ["metric"], q: [0] }},
}});
const metric = (found.data as unknown as {{ metric: number[][] }}).metric[0]?.[0] ?? NaN;
if (!(Math.abs(metric - {METRIC}) < 1e-12)) throw new Error(`${{metric}}`);
const listed = await client.GET("/v1/substructures", {{ params: {{ query: {{ tag: ["planar"] }} }} }});
if (listed.data?.items[0]?.name !== "pendulum") throw new Error("not listed");
const absent = await client.GET("/v1/substructures/{{ref}}", {{ params: {{ path: {{ ref: "pendulm" }} }} }});
if (absent.error?.code !== "unknown-substructure") throw new Error("no problem");
console.log("ok");
"""
MATLAB = """
stored = substructures.api.submit_substructure (fileread ("pendulum.json"));
assert (stored.digest(1:7), "sha256:")
listed = substructures.api.list_substructures ("tag", "planar", "page_size", 5, "port", {"tip"});
assert (listed.items(1).name, "pendulum")
assert (isempty (substructures.api.list_substructures ("q", "a&b=c", "dof_min", 2).items))
tree = substructures.api.create_tree (fileread ("tree.json"));
assert (tree.revision, 1)
answer = substructures.api.evaluate_tree ("cell", struct ("quantities", "metric", "q", 0.5));
assert (answer.metric, METRIC, 1e-12)
text = substructures.api.get_tree_quantity ("cell", "metric", "format", "latex", "document", true);
assert (ischar (text) && ! isempty (strfind (text, "documentclass")))
alias = substructures.api.set_alias ("pendulum", "stable", struct ("version", 1));
assert (substructures.api.get_alias ("pendulum", "stable").version, 1)
hand = struct ("name", "hand", "substructure", "pendulum", "at", "arm.tip");
assert (substructures.api.add_coupling ("cell", hand).revision, 2)
answer = substructures.api.evaluate_tree ("cell@2", struct ("quantities", "metric", "q", [0 0]), "Prefer", "wait=20");
assert (size (answer.metric), [2 2])
tree = substructures.api.remove_coupling ("cell", "hand");
assert (tree.coordinates, {"arm.q"})
moved = substructures.api.compute_simulations ("cell", struct ("q", 0.1, "span", [0 0.1]));
assert (moved.is_right)
published = substructures.api.publish_tree ("cell", struct ());
substructures.api.remove_tree ("cell");
assert (isempty (substructures.api.list_trees ().items))
disp ("ok")
"""


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    settings = Settings(database=f"sqlite:///{tmp_path / 'x.db'}", port=0, catalogue=False, workers=1)
    with background(settings) as found:
        yield found


def run(folder: Path, *command: str) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_names_are_those_that_a_person_would_choose() -> None:
    document = json.loads(DOCUMENT.read_text())
    names = [each["operationId"] for methods in document["paths"].values() for each in methods.values()]
    assert len(set(names)) == len(names)
    verbs = "get list create submit import export set add change remove publish evaluate compute compare compile store"
    verbs += " cancel retry stream withdraw"
    assert [name for name in names if not re.fullmatch(rf"({'|'.join(verbs.split())})_[a-z]+(_[a-z]+)*", name)] == []
    assert [name for name in document["components"]["schemas"] if not re.fullmatch(r"([A-Z][a-z]+)+", name)] == []


@pytest.mark.deep
def test_a_client_in_python(address: str, tmp_path: Path) -> None:
    pytest.importorskip("openapi_python_client", reason="pip install openapi-python-client")
    generate = ("-m", "openapi_python_client", "generate", "--path", str(DOCUMENT), "--meta", "none")
    told = run(tmp_path, sys.executable, *generate, "--output-path", "made")
    assert "Endpoint will not be generated" not in told.replace("/v1/bundles within catalogue. Endpoint", "")
    (tmp_path / "use.py").write_text(PYTHON.replace("ADDRESS", repr(address)))
    assert run(tmp_path, sys.executable, "use.py") == "ok\n"


@pytest.mark.deep
def test_a_client_in_typescript(address: str, tmp_path: Path) -> None:
    if shutil.which("npm") is None:
        pytest.skip("npm is not there")
    (tmp_path / "package.json").write_text('{"type": "module"}')
    wanted = ("openapi-typescript@7", "openapi-fetch@0", "typescript@5", "@types/node@20")
    command = ["npm", "install", "--no-audit", "--no-fund", "--ignore-scripts", *wanted]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"npm cannot install: {done.stderr.strip()[:200]}")
    tool = tmp_path / "node_modules" / ".bin"
    run(tmp_path, str(tool / "openapi-typescript"), str(DOCUMENT), "-o", "schema.ts", "--default-non-nullable=false")
    (tmp_path / "use.ts").write_text(TYPESCRIPT)
    strict = ("--strict", "--noUncheckedIndexedAccess", "--module", "nodenext", "--target", "es2022", "--skipLibCheck")
    run(tmp_path, str(tool / "tsc"), *strict, "use.ts")
    assert run(tmp_path, "node", "use.js", address) == "ok\n"


def test_the_functions_for_matlab_are_those_of_the_document() -> None:
    """``python tests/matlab_operations.py`` writes them; a bundle is bytes, which webwrite of Octave does not send."""
    text = functions()
    assert PLACE.read_text() == text
    named = set(re.findall(r"function answer = (\w+)", text))
    paths = json.loads(DOCUMENT.read_text())["paths"].values()
    assert {each["operationId"] for methods in paths for each in methods.values()} - named == {"import_bundle"}


@pytest.mark.deep
def test_functions_in_octave(address: str, tmp_path: Path) -> None:
    if shutil.which("octave-cli") is None:
        pytest.skip("Octave is not there")
    (tmp_path / "pendulum.json").write_text(json.dumps(PENDULUM))
    (tmp_path / "tree.json").write_text(json.dumps(TREE))
    script = MATLAB.replace("METRIC", repr(METRIC))
    (tmp_path / "use.m").write_text(f'addpath ("{PLACE.parent.parent}");{script}')
    given = {**os.environ, "SUBSTRUCTURES_SERVER": address}
    command = ["octave-cli", "--no-init-file", "--no-site-file", "use.m"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300, env=given)
    assert done.stdout == "ok\n", done.stdout + done.stderr
