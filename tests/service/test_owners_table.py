"""Who sees, reads, changes and cancels what, at all endpoints there are: a row for each."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import bare_app
from service.http import openapi

from .conftest import PENDULUM
from .test_client_covers import ANALYSES as ANALYSED
from .two_owners import CAMERA, FORM, MARK, NAMES, PART, TREE, Headers, World, served, serving, world

__all__ = ["served", "world"]  # fixtures

ANALYSES = (*ANALYSED, "velocity-equations")


@dataclass(frozen=True)
class Row:
    """What answers a request about something of acme: to acme's key, to its key that only reads, to bolt's key.

    ``path`` has the places ``{part}``, ``{tree}``, ``{job}``. Where statuses are those of lists (``LISTED``) bolt finds
    nothing private in them. 0: the request is let in, whatever comes of it.
    """

    path: str
    private: tuple[int, int, int]
    public: tuple[int, int, int]
    body: Any = None


READ = (200, 200, 404), (200, 200, 200)
LISTED = (200, 200, 200), (200, 200, 200)
LET_IN = (0, 0, 404), (0, 0, 0)
RING = {"name": "ring", "type": "rod", "from": "arm.tip", "length": 1}
PUSH = {"name": "push", "type": "joint", "coordinate": "arm.q", "force": 1}
JOB = {"kind": "export", "items": [{"tree": "{tree}", "quantity": "metric", "format": "text"}]}
JOBS = "/v1/jobs/{job}"
TABLE: dict[str, Row] = {
    "get /livez": Row("/livez", *LISTED),
    "get /readyz": Row("/readyz", *LISTED),
    "get /metrics": Row("/metrics", *LISTED),
    "get /v1/limits": Row("/v1/limits", *LISTED),
    "get /v1/folder": Row("/v1/folder", (404, 404, 404), (404, 404, 404)),  # this server has none
    "get /v1/audit": Row("/v1/audit", (403, 403, 403), (403, 403, 403)),
    "get /v1/substructures": Row(f"{PART}?q=", *LISTED),
    "post /v1/substructures": Row(
        PART, (201, 403, 403), (201, 403, 403), {**PENDULUM, "name": "{part}", "title": "another"}
    ),
    "get /v1/substructures/{ref}": Row(PART + "/{part}", *READ),
    "get /v1/substructures/{ref}/definition": Row(PART + "/{part}@1/definition", *READ),
    "get /v1/substructures/{ref}/formulas": Row(PART + "/{part}@1/formulas", *READ),
    "get /v1/substructures/{ref}/formulas/{quantity}": Row(PART + "/{part}@1/formulas/metric", *READ),
    "get /v1/substructures/{ref}/report": Row(PART + "/{part}@1/report", *READ),
    "get /v1/trees/{ref}/report": Row(TREE + "/{tree}/report", *READ),
    "get /v1/substructures/{ref}/picture": Row(PART + "/{part}@1/picture", *READ),
    "get /v1/substructures/{name}/aliases": Row(PART + "/{part}/aliases", *READ),
    "get /v1/substructures/{name}/aliases/{alias}": Row(PART + "/{part}/aliases/best", *READ),
    "put /v1/substructures/{name}/aliases/{alias}": Row(
        PART + "/{part}/aliases/new", (201, 403, 404), (201, 403, 403), {"version": 1}
    ),
    "post /v1/substructures/{ref}/withdraw": Row(PART + "/{part}@1/withdraw", (200, 403, 404), (200, 403, 403), {}),
    "get /v1/substructures/{name}/visibility": Row(PART + "/{part}/visibility", *READ),
    "put /v1/substructures/{name}/visibility": Row(
        PART + "/{part}/visibility", (200, 403, 404), (200, 403, 403), {"visibility": "public"}
    ),
    "get /v1/substructures/{name}/versions": Row(PART + "/{part}/versions", *READ),
    "get /v1/substructures/{ref}/uses": Row(PART + "/{part}/uses", *READ),
    "get /v1/substructures/{ref}/difference": Row(PART + "/{part}/difference?to={part}@1", *READ),
    "get /v1/substructures/{ref}/levels": Row(PART + "/{part}/levels", *READ),
    "delete /v1/trees/{ref}": Row(TREE + "/{tree}", (204, 403, 404), (204, 403, 403)),
    "get /v1/bundles": Row("/v1/bundles?refs={part}@1", *READ),
    # that it has to be a zip; whose names may be added to: test_bundles.py
    "post /v1/bundles": Row("/v1/bundles", (415, 403, 415), (415, 403, 415), {}),
    "get /v1/trees/{ref}/difference": Row(TREE + "/{tree}/difference?to={tree}@1", *READ),
    "get /v1/trees/{name}/revisions": Row(TREE + "/{tree}/revisions", *READ),
    "post /v1/trees/{ref}/publish": Row(
        TREE + "/{tree}@1/publish", (201, 403, 404), (201, 403, 403), {"name": "{part}"}
    ),
    "get /v1/trees": Row(TREE, *LISTED),
    "post /v1/trees": Row(TREE, (201, 403, 403), (201, 403, 403), FORM),
    "get /v1/trees/{ref}": Row(TREE + "/{tree}", *READ),
    "get /v1/trees/{ref}/picture": Row(TREE + "/{tree}@1/picture", *READ),
    **{
        f"get /v1/{kind}/{{ref}}/{file}": Row(f"/v1/{kind}/{name}@1/{file}", *READ)
        for kind, name in (("trees", "{tree}"), ("substructures", "{part}"))
        for file in ("program.wasm", "program.json", "origins", "scene")
    },
    "get /v1/trees/{ref}/{quantity}": Row(TREE + "/{tree}@1/metric", *READ),
    "get /v1/trees/{name}/visibility": Row(TREE + "/{tree}/visibility", *READ),
    "put /v1/trees/{name}/visibility": Row(
        TREE + "/{tree}/visibility", (409, 403, 404), (200, 403, 403), {"visibility": "public"}
    ),
    "patch /v1/trees/{ref}": Row(TREE + "/{tree}", (201, 403, 404), (201, 403, 403), {"gravity": [0, 0, -1]}),
    "post /v1/trees/{ref}/couplings": Row(TREE + "/{tree}/couplings", (201, 403, 404), (201, 403, 403), CAMERA),
    "patch /v1/trees/{ref}/couplings/{instance}": Row(
        TREE + "/{tree}/couplings/eye", (201, 403, 404), (201, 403, 403), {"placement": {"position": [0, 0, 1]}}
    ),
    "delete /v1/trees/{ref}/couplings/{instance}": Row(
        TREE + "/{tree}/couplings/eye", (201, 403, 404), (201, 403, 403)
    ),
    "post /v1/trees/{ref}/closures": Row(TREE + "/{tree}/closures", (201, 403, 404), (201, 403, 403), RING),
    "delete /v1/trees/{ref}/closures/{closure}": Row(TREE + "/{tree}/closures/none", (404, 403, 404), (404, 403, 403)),
    "post /v1/trees/{ref}/loads": Row(TREE + "/{tree}/loads", (201, 403, 404), (201, 403, 403), PUSH),
    "delete /v1/trees/{ref}/loads/{load}": Row(TREE + "/{tree}/loads/pull", (201, 403, 404), (201, 403, 403)),
    "get /v1/substructures/{ref}/export": Row(PART + "/{part}@1/export?target=c", *READ),
    "get /v1/trees/{ref}/export": Row(TREE + "/{tree}@1/export?target=c", *READ),
    "post /v1/trees/{ref}/evaluations": Row(
        TREE + "/{tree}@1/evaluations", *READ, {"quantities": ["metric"], "q": [0.1, 0.2]}
    ),
    "post /v1/trees/{ref}/kernels": Row(TREE + "/{tree}@1/kernels", *LET_IN, {"quantities": ["metric"]}),
    **{f"post /v1/trees/{{ref}}/{name}": Row(TREE + f"/{{tree}}@1/{name}", *LET_IN, {}) for name in ANALYSES},
    # what a file becomes is stored as by the requests above, whose rows say who may
    "post /v1/imports": Row("/v1/imports", (0, 0, 0), (0, 0, 0), {}),
    "post /v1/equivalences": Row("/v1/equivalences", (200, 200, 422), (200, 200, 200), {"a": "{part}", "b": "{tree}"}),
    "get /v1/jobs": Row("/v1/jobs", *LISTED),
    "post /v1/jobs": Row("/v1/jobs", (202, 403, 422), (202, 403, 202), JOB),
    "get /v1/jobs/{job}": Row(JOBS, *READ),
    "get /v1/jobs/{job}/table": Row("/v1/jobs/{sweep}/table", *READ),
    "get /v1/jobs/{job}/pareto": Row("/v1/jobs/{sweep}/pareto", *READ),
    "get /v1/jobs/{job}/table/columns/{column}": Row("/v1/jobs/{sweep}/table/columns/mass", *READ),
    "post /v1/jobs/{job}/rows/{row}/tree": Row(
        "/v1/jobs/{sweep}/rows/0/tree", (201, 403, 404), (201, 403, 403), {"name": "{tree}"}
    ),
    "get /v1/jobs/{job}/archive": Row(JOBS + "/archive", *READ),
    "get /v1/jobs/{job}/events": Row(JOBS + "/events", *READ),
    "get /v1/jobs/{job}/items": Row(JOBS + "/items", *READ),
    "get /v1/jobs/{job}/items/{position}/files/{name}": Row(JOBS + "/items/0/files/text", *READ),
    "get /v1/jobs/{job}/result": Row(JOBS + "/result", *READ),
    "post /v1/jobs/{job}/retry": Row(JOBS + "/retry", (409, 403, 404), (409, 403, 403), {}),
    "delete /v1/jobs/{job}": Row(JOBS, (204, 403, 404), (204, 403, 403)),
    "post /v1/jobs/{job}/cancel": Row(JOBS + "/cancel", (200, 403, 404), (200, 403, 403), {}),
    # pages are not in the document
    "page /": Row("/", *LISTED),
    "page /trees": Row("/trees", *LISTED),
    "page /jobs": Row("/jobs", *LISTED),
    "page /substructures/{ref}": Row("/substructures/{part}", *READ),
    "page /trees/{ref}": Row("/trees/{tree}", *READ),
    "page /trees/{ref}/edit": Row("/trees/{tree}/edit", *READ),
    "page /trees/{ref}/motion": Row("/trees/{tree}/motion", *READ),
    **{
        f"page /{kind}/{{ref}}/{part}": Row(f"/{kind}/{name}/{part}{query}", *READ)
        for kind, name in (("trees", "{tree}"), ("substructures", "{part}"))
        for part, query in (("entry", "?entry=metric,0,0"), ("grid", "?tab=metric"))
    },
    "page /substructures/{ref}/difference": Row("/substructures/{part}/difference?to={part}", *READ),
    "page /trees/{ref}/difference": Row("/trees/{tree}/difference?to={tree}@1", *READ),
    "page /jobs/{job}": Row("/jobs/{job}", *READ),
    "page /account": Row("/account", *LISTED),
}


@pytest.fixture(scope="module")
def read(world: World, tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """For what changes nothing."""
    with serving(world, tmp_path_factory.mktemp("read")) as client:
        yield client


@pytest.fixture
def asked(endpoint: str, request: pytest.FixtureRequest) -> TestClient:
    """The server that an endpoint is asked on: one for all that only read, and else one of its own."""
    found: TestClient = request.getfixturevalue("read" if endpoint.startswith(("get ", "page ")) else "served")
    return found


def ask(client: TestClient, endpoint: str, row: Row, given: dict[str, str], headers: Headers) -> Any:
    def put(value: Any) -> Any:
        text = json.dumps(value)
        for place, what in given.items():
            text = text.replace(f"{{{place}}}", what)
        return json.loads(text)

    method = endpoint.split()[0].replace("page", "get")
    return client.request(method, put(row.path), json=put(row.body), headers=headers)


def places(world: World, visibility: str) -> dict[str, str]:
    name = NAMES[visibility]
    jobs = {"job": world.jobs[visibility], "sweep": world.sweeps[visibility]}
    return {"part": name, "tree": f"{name}-cell", **jobs}


def test_every_endpoint_has_a_row() -> None:
    """Whoever adds an endpoint says here who may use it."""
    paths = openapi.document(bare_app())["paths"]
    there = {f"{method} {path}" for path, methods in paths.items() for method in methods}
    assert there == {endpoint for endpoint in TABLE if not endpoint.startswith("page ")}


@pytest.mark.parametrize("visibility", NAMES)
@pytest.mark.parametrize("endpoint", TABLE)
def test_who_may_do_what(endpoint: str, visibility: str, asked: TestClient, world: World) -> None:
    row, given = TABLE[endpoint], places(world, visibility)
    expected = row.private if visibility == "private" else row.public
    is_open = endpoint in ("get /livez", "get /readyz")
    assert ask(asked, endpoint, row, given, {}).status_code == (200 if is_open else 401)
    for headers, status in reversed(list(zip(world.keys, expected, strict=True))):  # who changes it comes last
        answer = ask(asked, endpoint, row, given, headers)
        if status:
            assert answer.status_code == status, answer.text
        else:
            assert answer.status_code in (200, 201, 422), answer.text
    if not endpoint.startswith("delete") and set(expected) != {404}:  # it is gone, or there was none
        assert ask(asked, endpoint, row, given, world.admin).status_code not in (401, 403, 404)


@pytest.mark.parametrize("endpoint", TABLE)
def test_what_is_private_is_not_there_for_others(endpoint: str, asked: TestClient, world: World) -> None:
    """The answer about something private is the one about nothing, but for the name in it."""
    row, given, bolt = TABLE[endpoint], places(world, "private"), world.keys[2]
    answer = ask(asked, endpoint, row, given, bolt)
    size = len(world.jobs["private"])
    nothing = {"part": "mush", "tree": "mush-cell", "job": "0" * size, "sweep": "1" * size}
    other = ask(asked, endpoint, row, nothing, bolt)
    if endpoint in ("post /v1/substructures", "post /v1/trees"):  # the name is taken: nothing else is told
        assert (answer.status_code, answer.json()["code"], "acme" in answer.text) == (403, "name-taken", False)
        return
    if "{" not in row.path and row.body is None:
        assert MARK not in answer.text
        assert world.jobs["private"] not in answer.text
        assert world.jobs["private"][:16] not in answer.text
        return
    assert answer.status_code == other.status_code
    expected = other.text.replace("mush", MARK)
    for kind in ("job", "sweep"):
        expected = expected.replace(nothing[kind], given[kind])

    def told(text: str) -> Any:
        return {name: value for name, value in json.loads(text).items() if name != "request_id"}

    assert told(answer.text) == told(expected)
