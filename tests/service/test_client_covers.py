"""The client covers the interface: a method for every operation of the OpenAPI document, which sends that request."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx2
import pytest

import service
from substructures.client import Client

PART, TREE, JOB = "/v1/substructures/{ref}", "/v1/trees/{ref}", "/v1/jobs/{job}"
ANALYSES = (
    *(
        "abbreviations",
        "cost-gradients",
        "curvatures",
        "ensembles",
        "equilibria",
        "excitations",
        "identifications",
        "linearisations",
        "loop-states",
        "lyapunov-exponents",
        "frequency-responses",
        "regulators",
        "periodic-orbits",
        "poincare-sections",
    ),
    *(
        "optimal-controls",
        "optimal-parameters",
        "reduced-equations",
        "root-loci",
        "sensitivities",
        "simulations",
        "steady-motions",
    ),
)


def analysis(name: str) -> Callable[[Client], Any]:
    return lambda c: c.analyse("cell", name, q=[0])


METHODS: dict[str, Callable[[Client], Any]] = {
    "GET /livez": lambda c: c.alive(),
    "GET /metrics": lambda c: c.metrics(),
    "GET /readyz": lambda c: c.ready(),
    "GET /v1/audit": lambda c: list(c.audit(owner="local")),
    "GET /v1/bundles": lambda c: c.bundle(["a", "b@1"]),
    "POST /v1/bundles": lambda c: c.import_bundle(b"PK"),
    "POST /v1/equivalences": lambda c: c.compare("a", "b"),
    "POST /v1/imports": lambda c: c.import_file(b"<robot/>", cut=["a", "b"], store=True),
    "GET /v1/folder": lambda c: c.folder(),
    "GET /v1/jobs": lambda c: list(c.jobs(state="queued")),
    "POST /v1/jobs": lambda c: c.submit_job({}),
    f"DELETE {JOB}": lambda c: c.remove_job("x"),
    f"GET {JOB}": lambda c: c.job("x"),
    f"GET {JOB}/archive": lambda c: c.job_archive("x", Path("/dev/null")),
    f"POST {JOB}/cancel": lambda c: c.cancel_job("x"),
    f"GET {JOB}/events": lambda c: list(c.events("x", after=3)),
    f"GET {JOB}/items": lambda c: list(c.job_items("x", state="failed")),
    f"GET {JOB}/items/{{position}}/files/{{name}}": lambda c: c.job_file("x", 0),
    f"GET {JOB}/result": lambda c: list(c.job_items("x")),  # the same as items
    f"POST {JOB}/retry": lambda c: c.retry_job("x", label="again"),
    f"GET {JOB}/table": lambda c: c.table_file("x", "application/json", {"sort": "-mass"}),
    f"GET {JOB}/pareto": lambda c: c.table_file("x", "text/csv", {}, front=True),
    f"GET {JOB}/table/columns/{{column}}": lambda c: c.column("x", "mass", bins=3),
    f"POST {JOB}/rows/{{row}}/tree": lambda c: c.store_row("x", 3, "chosen"),
    "GET /v1/limits": lambda c: c.limits(),
    "GET /v1/substructures": lambda c: [list(c.substructures(tag=["a", "b"])), c.search(q="arm", facets=True)],
    "POST /v1/substructures": lambda c: c.submit({}),
    "GET /v1/substructures/{name}/aliases": lambda c: c.aliases("a"),
    "GET /v1/substructures/{name}/aliases/{alias}": lambda c: c.alias("a", "stable"),
    "PUT /v1/substructures/{name}/aliases/{alias}": lambda c: c.set_alias("a", "stable", 1),
    "GET /v1/substructures/{name}/versions": lambda c: list(c.versions("a")),
    "GET /v1/substructures/{name}/visibility": lambda c: c.visibility("a"),
    "PUT /v1/substructures/{name}/visibility": lambda c: c.set_visibility("a"),
    f"GET {PART}": lambda c: c.substructure("a@1"),
    f"GET {PART}/definition": lambda c: c.definition("a"),
    f"GET {PART}/difference": lambda c: c.difference("a", "b"),
    f"GET {PART}/export": lambda c: c.export_files("substructures", "a", "c"),
    f"GET {PART}/formulas": lambda c: c.part_formulas("a"),
    f"GET {PART}/formulas/{{quantity}}": lambda c: c.part_formula("a", "U", body="rod"),
    f"GET {PART}/levels": lambda c: c.levels("a"),
    f"GET {PART}/picture": lambda c: c.part_picture("a", [0.1]),
    f"GET {PART}/scene": lambda c: c.scene("substructures", "a"),
    f"GET {TREE}/scene": lambda c: c.scene("trees", "cell"),
    f"GET {PART}/program.json": lambda c: c.module_layout("substructures", "a"),
    f"GET {PART}/program.wasm": lambda c: c.module("substructures", "a"),
    f"GET {PART}/origins": lambda c: c.origins("substructures", "a"),
    f"GET {TREE}/program.json": lambda c: c.module_layout("trees", "cell"),
    f"GET {TREE}/program.wasm": lambda c: c.module("trees", "cell"),
    f"GET {TREE}/origins": lambda c: c.origins("trees", "cell"),
    f"GET {PART}/uses": lambda c: list(c.uses("a")),
    f"POST {PART}/withdraw": lambda c: c.withdraw("a@1", "wrong", successor="a@2"),
    "GET /v1/trees": lambda c: list(c.trees(uses="a")),
    "POST /v1/trees": lambda c: c.create_tree({}),
    "GET /v1/trees/{name}/revisions": lambda c: list(c.revisions("cell")),
    "GET /v1/trees/{name}/visibility": lambda c: c.tree_visibility("cell"),
    "PUT /v1/trees/{name}/visibility": lambda c: c.set_tree_visibility("cell"),
    f"GET {TREE}": lambda c: c.tree("cell@2"),
    f"DELETE {TREE}": lambda c: c.remove_tree("cell"),
    f"GET {TREE}/report": lambda c: c.report("cell"),
    f"GET {PART}/report": lambda c: c.part_report("a"),
    f"POST {TREE}/couplings": lambda c: c.couple("cell", {}),
    f"PATCH {TREE}": lambda c: c.change_tree("cell", gravity=[0, 0, -1]),
    f"PATCH {TREE}/couplings/{{instance}}": lambda c: c.change_coupling("cell", "hand", at="arm.tip"),
    f"DELETE {TREE}/couplings/{{instance}}": lambda c: c.uncouple("cell", "hand"),
    f"GET {TREE}/difference": lambda c: c.tree_difference("cell@1", "cell@2"),
    f"POST {TREE}/evaluations": lambda c: c.evaluate("cell", q=[0]),
    f"GET {TREE}/export": lambda c: c.export_files("trees", "cell", "c", quantities=["metric"]),
    f"POST {TREE}/kernels": lambda c: c.compile_kernels("cell", ["metric"]),
    f"POST {TREE}/closures": lambda c: c.close_loop("cell", {}),
    f"DELETE {TREE}/closures/{{closure}}": lambda c: c.open_loop("cell", "rod"),
    f"POST {TREE}/loads": lambda c: c.load("cell", {}),
    f"DELETE {TREE}/loads/{{load}}": lambda c: c.unload("cell", "spring"),
    f"GET {TREE}/picture": lambda c: c.tree_picture("cell"),
    f"POST {TREE}/publish": lambda c: c.publish("cell", name="a"),
    f"POST {TREE}/velocity-equations": lambda c: c.velocity_equations("cell", {"constraints": []}),
    f"GET {TREE}/{{quantity}}": lambda c: c.formula("cell", "metric"),
    **{f"POST {TREE}/{name}": analysis(name) for name in ANALYSES},
}


def document() -> dict[str, Any]:
    return json.loads((Path(service.__file__).parent / "openapi.json").read_text())["paths"]


def operations() -> dict[str, dict[str, Any]]:
    return {
        f"{method.upper()} {path}": each
        for path, methods in document().items()
        for method, each in methods.items()
        if method != "parameters"
    }


def test_every_operation_has_a_method() -> None:
    assert operations().keys() - METHODS.keys() == set()
    assert METHODS.keys() - operations().keys() == set()


@pytest.mark.parametrize("operation", METHODS)
def test_the_method_sends_that_request(operation: str) -> None:
    method, _, template = operation.partition(" ")
    template = template.replace("/result", "/items") if template.startswith("/v1/jobs") else template
    pattern = re.sub(r"\{\w+\}", "[^/]+", template)
    sent: list[httpx2.Request] = []

    def answer(request: httpx2.Request) -> httpx2.Response:
        """Something of everything that any method wants to read."""
        sent.append(request)
        body = {"items": [], "links": {"next": None}, "count": 0, "coordinates": []}
        return httpx2.Response(200, json=body, headers={"ETag": '"1"'})

    with Client("http://localhost") as client:
        client._http = httpx2.Client(base_url="http://localhost", transport=httpx2.MockTransport(answer))
        METHODS[operation](client)
    matching = [each for each in sent if each.method == method and re.fullmatch(pattern, each.url.path)]
    assert matching
    assert all(each in matching or each.url.path == sent[-1].url.path for each in sent)
    known = operations().get(operation, {}).get("parameters", [])
    queries = {parameter["name"] for parameter in known if parameter["in"] == "query"}
    asked = {name for each in matching for name in each.url.params}
    assert asked <= queries
