"""Modules of WebAssembly and origins over HTTP: as the page uses them, with the interface's numbers beside them."""

from __future__ import annotations

import json
import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np
from fastapi.testclient import TestClient
from run_code import tool

from service.store.store import Store

from .one_store import double, filled, store
from .test_conventions import problem

__all__ = ["double", "filled", "store"]
TREE, PART = "/v1/trees/cell@2", "/v1/substructures/pendulum@1"


def test_a_module_is_kept_for_ever_with_its_layout(double: TestClient) -> None:
    for path, shape in ((TREE, [2, 2]), (PART, [1, 1])):
        wasm, layout = double.get(f"{path}/program.wasm"), double.get(f"{path}/program.json").json()
        assert wasm.headers["content-type"] == "application/wasm"
        assert "immutable" in wasm.headers["cache-control"]
        again = double.get(f"{path}/program.wasm", headers={"If-None-Match": wasm.headers["etag"]})
        assert again.status_code == 304
        assert "immutable" not in double.get(f"{path.partition('@')[0]}/program.wasm").headers["cache-control"]
        assert [f["outputs"][0]["shape"] for f in layout["functions"] if f["quantity"] == "metric"] == [shape]
        places = [v["at"] for v in layout["vectors"].values() if "at" in v]
        places += [o["at"] for f in layout["functions"] for o in f["outputs"]]
        assert min(places) >= layout["heap"]
        assert max(places) < 65536 * layout["pages"]


def test_what_a_page_has_made_is_ready_before_it_is_asked_for(filled: TestClient, store: Store) -> None:
    tree = {"name": "soon", "instances": [{"name": "a", "substructure": "pendulum"}]}

    def is_kept(made: dict[str, Any]) -> bool:
        key = made["digest"], made["program"], f"soon@{made['revision']}", "program"
        return store.caches.printed.get(key) is not None

    others = filled.post("/v1/trees", json=tree).json()
    page = {"Sec-Fetch-Site": "same-origin"}
    made = filled.post("/v1/trees", json={**tree, "gravity": [0, 1, 0]}, headers=page).json()
    until = time.monotonic() + 20
    while not is_kept(made) and time.monotonic() < until:
        time.sleep(0.01)
    assert is_kept(made)
    assert not is_kept(others)


def test_what_there_is_not(double: TestClient) -> None:
    problem(double.get(f"{TREE}/program.json?quantities=metrc"), 422, "invalid-document")
    problem(double.get("/v1/trees/nothing/program.wasm"), 404, "unknown-tree")
    problem(double.get("/v1/substructures/nothing/origins"), 404, "unknown-substructure")


def test_origins_name_bodies_symbols_and_zeros(double: TestClient) -> None:
    told = double.get(f"{TREE}/origins").json()
    assert told["bodies"] == ["arm.rod", "hand.rod"]
    assert told["moved"] == [[0, 1], [1]]
    entries = {tuple(e["index"]): e for e in told["quantities"]["metric"]["entries"]}
    assert [told["bodies"][k] for k in entries[1, 1]["bodies"]] == ["hand.rod"]
    assert "arm.q" not in {told["symbols"][k] for k in entries[0, 1]["symbols"]}
    assert {"hand.q", "arm.l"} <= {told["symbols"][k] for k in entries[0, 1]["symbols"]}


RUN = """
const { readFileSync } = require("node:fs");
const layout = JSON.parse(readFileSync("program.json")), module = new WebAssembly.Module(readFileSync("program.wasm"));
const { exports } = new WebAssembly.Instance(module, { math: Math }), memory = exports.memory;
memory.grow(layout.pages - memory.buffer.byteLength / 65536);
const write = ({ at }, values) => new Float64Array(memory.buffer, at, values.length).set(values);
write(layout.vectors.p, layout.vectors.p.defaults);
write(layout.vectors.q, [0.3, -0.8]);
write(layout.vectors.qd, [1.5, 0.25]);
write(layout.vectors.u, [0, 0]);
const results = layout.functions.map(({ name, quantity, arguments: given, outputs }) => {
    const [{ at, shape }] = outputs;
    exports[name](...given.map((s) => (s === "t" ? 0 : layout.vectors[s].at)), ...outputs.map((o) => o.at));
    return [quantity, [...new Float64Array(memory.buffer, at, shape.reduce((a, b) => a * b, 1))]];
});
console.log(JSON.stringify(Object.fromEntries(results)));
"""


def test_the_module_computes_what_the_interface_does(double: TestClient, tmp_path: Path) -> None:
    for file in ("program.json", "program.wasm"):
        (tmp_path / file).write_bytes(double.get(f"{TREE}/{file}").content)
    command = [tool("node"), "-e", RUN]
    found = json.loads(subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True).stdout)
    state = {"q": [0.3, -0.8], "qd": [1.5, 0.25], "quantities": ["metric", "christoffel", "forces", "kinematics"]}
    told = double.post(f"{TREE}/evaluations", json=state).json()
    told |= {"position": told["kinematics"]["position"], "rotation": told["kinematics"]["rotation"]}
    for quantity, values in found.items():
        np.testing.assert_allclose(np.reshape(values, np.shape(told[quantity])), told[quantity], rtol=1e-14, atol=1e-14)
