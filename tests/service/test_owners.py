"""Two owners with three keys on one server: who sees, reads, changes and cancels what, at all endpoints there are."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient

from service.app import bare_app, open_store
from service.cli.main import main
from service.database.migrate import upgrade
from service.http import openapi
from service.messages.viewer import Viewer
from service.queries.jobs.jobs import get_job
from service.settings import Settings
from service.store import keys
from service.store.store import Store

from .conftest import PENDULUM, copied, make_client
from .fake_engine import FakeEngine, export, finished, running

Headers = dict[str, str]
MARK = "hush"  # stands in everything that is private, and nowhere else
NAMES = {"private": "hush", "public": "known"}
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
        "velocity-equations",
    ),
)


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
FORM: dict[str, Any] = {"name": "{tree}", "gravity": [0, 0, 0], "instances": [{"name": "a", "substructure": "{part}"}]}
CAMERA = {"name": "b", "substructure": "{part}", "at": "arm.tip"}
PULL = {"name": "pull", "type": "joint", "coordinate": "arm.q", "force": 2}
RING = {"name": "ring", "type": "rod", "from": "arm.tip", "length": 1}
PUSH = {"name": "push", "type": "joint", "coordinate": "arm.q", "force": 1}
JOB = {"kind": "export", "items": [{"tree": "{tree}", "quantity": "metric", "format": "text"}]}
PART, TREE, JOBS = "/v1/substructures", "/v1/trees", "/v1/jobs/{job}"
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


@dataclass(frozen=True)
class World:
    """A store with what belongs to acme, and the headers of acme's key, of its key that only reads, and of bolt's."""

    path: Path
    keys: tuple[Headers, Headers, Headers]
    admin: Headers
    jobs: dict[str, str]
    sweeps: dict[str, str]


def store_of(client: TestClient) -> Store:
    found: Store = client.app.state.store  # type: ignore[attr-defined]
    return found


def key(store: Store, owner: str, *scopes: str) -> Headers:
    with store.database.write() as connection:
        return {"Authorization": f"Bearer {keys.create(connection, '', scopes, None, owner)}"}


def sweep(part: str, visibility: str) -> dict[str, Any]:
    template = {"name": "arm", "gravity": [0, 0, 0], "instances": [{"name": "arm", "substructure": part}]}
    columns = {"columns": {"mass": "mass"}, "pareto": {"minimise": ["mass"]}}
    return {"kind": "sweep", "template": template, "shared": visibility == "public", **columns}


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    path = tmp_path_factory.mktemp("world") / "store.db"
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as store:
        acme, reads = key(store, "acme", "read", "write", "jobs"), key(store, "acme", "read")
        bolt, admin = key(store, "bolt", "read", "write", "jobs"), key(store, "root", "admin")
        client, jobs, sweeps = make_client(store), {}, {}
        with running(store, FakeEngine()):
            for visibility, name in NAMES.items():
                part = {**PENDULUM, "name": name, "title": name, "visibility": visibility}
                eye = {"name": "eye", "substructure": name, "at": "arm.tip"}
                arm = {"name": "arm", "substructure": name}
                tree = {"name": f"{name}-cell", "visibility": visibility, "instances": [arm, eye], "loads": [PULL]}
                for address, body in ((PART, part), (TREE, {**tree, "gravity": [0, 0, 0]})):
                    assert client.post(address, json=body, headers=acme).status_code == 201
                alias = client.put(f"{PART}/{name}/aliases/best", json={"version": 1}, headers=acme)
                assert alias.status_code == 201
                job = {**export(f"{name}-cell", "metric"), "shared": visibility == "public"}
                answer = client.post("/v1/jobs", json=job, headers=acme)
                assert answer.status_code == 202, answer.text
                jobs[visibility] = answer.json()["id"]
                answer = client.post("/v1/jobs", json=sweep(name, visibility), headers=acme)
                assert answer.status_code == 202, answer.text
                sweeps[visibility] = answer.json()["id"]
                client.headers.update(acme)
                for each in (jobs, sweeps):
                    finished(client, each[visibility])
                del client.headers["Authorization"]
        return World(path, (acme, reads, bolt), admin, jobs, sweeps)


@contextmanager
def serving(world: World, folder: Path) -> Iterator[TestClient]:
    """A server of a copy of the world."""
    copied(world.path, folder / "store.db")
    url = f"sqlite:///{folder / 'store.db'}"
    with open_store(Settings(database=url, catalogue=False, key_seconds=0)) as store, make_client(store) as client:
        yield client


@pytest.fixture
def served(world: World, tmp_path: Path) -> Iterator[TestClient]:
    with serving(world, tmp_path) as client:
        yield client


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


def test_lists_have_what_one_sees(served: TestClient, world: World) -> None:
    acme, reads, bolt = world.keys
    for address, names in ((f"{PART}?facets=true", ("hush", "known")), (TREE, ("hush-cell", "known-cell"))):
        for headers, expected in ((acme, names), (reads, names), (bolt, names[1:]), (world.admin, names)):
            found = served.get(address, headers=headers).json()
            assert tuple(item["name"] for item in found["items"]) == expected
            if "facets" in found:
                assert found["facets"]["dof"] == {"1": len(expected)}
    for query, expected in (("owner=acme", ["known"]), ("owner=bolt", []), ("q=hus", [])):
        found = served.get(f"{PART}?{query}", headers=bolt).json()["items"]
        assert [item["name"] for item in found] == expected
    for query, expected in (("q=cell", ["known-cell"]), ("uses=known", ["known-cell"]), ("uses=hush", [])):
        found = served.get(f"{TREE}?{query}", headers=bolt).json()["items"]
        assert [item["name"] for item in found] == expected
    assert [item["name"] for item in served.get(f"{TREE}?uses=hush", headers=acme).json()["items"]] == ["hush-cell"]


def put(client: TestClient, headers: Headers, address: str, body: Any, status: int = 201) -> Any:
    answer = client.post(address, json=body, headers=headers)
    assert answer.status_code == status, answer.text
    return answer.json()


def test_what_is_private_shows_in_no_list_of_a_public_part(served: TestClient, world: World) -> None:
    """What acme has of bolt's public part: made from it, built with it, published with it, named as its successor."""
    acme, reads, bolt = world.keys
    put(served, bolt, PART, {**PENDULUM, "name": "open", "title": "of bolt"})
    hidden = {"visibility": "private"}
    put(served, acme, PART, {**PENDULUM, "name": "hush-made", "title": MARK, "derived_from": "open@1", **hidden})
    instances = [{"name": "a", "substructure": "open"}]
    put(served, acme, TREE, {"name": "hush-tree", "gravity": [0, 0, 0], "instances": instances, **hidden})
    put(served, acme, f"{TREE}/hush-tree/publish", {"name": "hush-built", **hidden})
    used = f"{PART}/open@1/uses"
    everything = {("derived", "hush-made"), ("part", "hush-built"), ("tree", "hush-tree")}
    for headers, expected in ((acme, everything), (reads, everything), (world.admin, everything), (bolt, set())):
        found = served.get(used, headers=headers).json()
        assert {(each["kind"], each["name"]) for each in found["items"]} == expected
        assert served.get(f"{PART}/open/uses", headers=headers).json()["items"] == found["items"]
    for address in (
        *(f"{PART}/open{rest}" for rest in ("", "@1", "/versions", "/uses", "@1/uses?page_size=1", "/visibility")),
        *(f"{TREE}?uses=open", f"{PART}?q=open&facets=true", "/substructures/open@1", "/substructures/open"),
    ):
        answer = served.get(address, headers=bolt)
        assert MARK not in answer.text, address
        assert "next_page_token" not in answer.text or answer.json()["next_page_token"] is None


def test_what_is_public_does_not_name_what_is_private(served: TestClient, world: World) -> None:
    """A public version that was made from a private one, and one whose successor is private."""
    acme, reads, bolt = world.keys
    put(served, acme, PART, {**PENDULUM, "name": "open", "title": "made", "derived_from": "hush@1"})
    put(served, acme, PART, {**PENDULUM, "name": "old", "title": "old"})
    put(served, acme, f"{PART}/old@1/withdraw", {"reason": "", "successor": "hush@1"}, 200)
    names = {"open@1": "derived_from", "old@1": "successor"}
    for ref, member in names.items():
        for headers, is_seen in ((acme, True), (reads, True), (world.admin, True), (bolt, False)):
            found = served.get(f"{PART}/{ref}", headers=headers).json()
            assert (found[member] is not None) == is_seen, (ref, member)
        for address in (f"{PART}/{ref}", f"{PART}/{ref.partition('@')[0]}/versions", f"/substructures/{ref}"):
            assert MARK not in served.get(address, headers=bolt).text, address


def test_tokens_of_pages_do_not_count_what_is_private(served: TestClient, world: World) -> None:
    """The same search has the same token, however much of others there is that is not seen."""
    acme, _, bolt = world.keys

    def token(*names: str) -> str:
        for name in names:
            put(served, bolt, PART, {**PENDULUM, "name": name, "title": name})
        found = served.get(f"{PART}?q=pair&page_size=1", headers=bolt).json()
        assert [each["name"] for each in found["items"]] == ["pair-one"]
        following = served.get(f"{PART}?q=pair&page_size=1&page_token={found['next_page_token']}", headers=bolt).json()
        assert [each["name"] for each in following["items"]] == ["pair-two"]
        return str(found["next_page_token"])

    for k in range(3):
        put(served, acme, PART, {**PENDULUM, "name": f"hush-{k}", "title": MARK, "visibility": "private"})
    text = base64.urlsafe_b64decode(token("pair-one", "pair-two") + "==").decode()
    assert json.loads(text)[1:] == [1, "pair-one"]
    mark = json.loads(text)[0]
    for name in ("hush", "nothing"):  # what is not seen is not there
        forged = base64.urlsafe_b64encode(json.dumps([mark, 1, name]).encode()).decode().rstrip("=")
        answer = served.get(f"{PART}?q=pair&page_size=1&page_token={forged}", headers=bolt)
        assert (answer.status_code, answer.json()["code"]) == (422, "page-token")


def test_evaluations_at_hand_are_kept_for_their_owner(served: TestClient, world: World) -> None:
    """The short way, which looks into no database, is closed to others."""
    acme, reads, bolt = world.keys
    body = {"quantities": ["metric"], "q": [0.1, 0.2]}
    assert served.post(f"{TREE}/hush-cell@1/kernels", json=body, headers=acme).status_code == 201
    for headers, status in ((acme, 200), (acme, 200), (reads, 200), (bolt, 404), (world.admin, 200), (bolt, 404)):
        answer = served.post(f"{TREE}/hush-cell@1/evaluations", json=body, headers=headers)
        assert answer.status_code == status
    kept = store_of(served).caches.evaluations
    assert kept.get(("acme", "hush-cell@1", "metric")) is not None  # otherwise nothing was tested


@pytest.mark.parametrize("how", ["tree", "job", "coupling"])
def test_no_private_part_in_a_public_tree(how: str, served: TestClient, world: World) -> None:
    acme = world.keys[0]
    if how == "coupling":
        answer = served.post(f"{TREE}/known-cell/couplings", json={**CAMERA, "substructure": "hush"}, headers=acme)
        assert answer.json()["errors"][0]["pointer"] == "/substructure"
    else:
        tree = {**FORM, "name": "one", "instances": [{"name": "a", "substructure": "hush"}]}
        if how == "tree":
            answer = served.post(TREE, json=tree, headers=acme)
            pointer = "/instances/0/substructure"
        else:
            answer = served.post("/v1/jobs", json={"kind": "assemble", "items": [tree]}, headers=acme)
            pointer = "/items/0/instances/0/substructure"
        assert answer.json()["errors"][0]["pointer"] == pointer
        private = {**tree, "visibility": "private"}
        again = served.post(TREE, json=private, headers=acme)
        assert (again.status_code, again.json().get("visibility")) == (201, "private")
    assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "private-part")
    assert "'hush' is private" in answer.text


def test_what_jobs_store_belongs_to_their_owner(served: TestClient, world: World) -> None:
    """Also where two owners ask for the same: the second does not get the first one's tree."""
    acme, _, bolt = world.keys
    store: Store = store_of(served)
    item = {**FORM, "name": "both", "instances": [{"name": "a", "substructure": "known"}], "visibility": "private"}
    ids = [
        served.post("/v1/jobs", json={"kind": "assemble", "items": [item]}, headers=headers).json()["id"]
        for headers in (acme, bolt)
    ]
    part = {**PENDULUM, "name": "derived", "visibility": "private"}
    ids.append(served.post("/v1/jobs", json={"kind": "derive", "items": [part]}, headers=bolt).json()["id"])
    with running(store, FakeEngine()):
        for headers, job in zip((acme, bolt, bolt), ids, strict=True):
            served.headers.update(headers)
            finished(served, job)
    results = [
        served.get(f"/v1/jobs/{job}/result", headers=headers).json()["items"][0]
        for headers, job in zip((acme, bolt, bolt), ids, strict=True)
    ]
    assert [each["state"] for each in results] == ["succeeded", "failed", "succeeded"]
    assert results[1]["problem"]["code"] == "name-taken"
    assert served.get(f"{TREE}/both", headers=acme).json()["owner"] == "acme"
    assert served.get(f"{TREE}/both", headers=bolt).status_code == 404
    assert served.get(f"{PART}/derived", headers=bolt).json()["visibility"] == "private"
    assert served.get(f"{PART}/derived", headers=acme).status_code == 404
    taken = served.post("/v1/jobs", json={"kind": "assemble", "items": [item]}, headers=bolt)
    assert taken.json()["errors"][0]["pointer"] == "/items/0/name"


def test_shared_jobs_show_nothing_private(served: TestClient, world: World) -> None:
    acme = world.keys[0]
    answer = served.post("/v1/jobs", json={**export("hush-cell", "metric"), "shared": True}, headers=acme)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/shared")


def test_what_becomes_public(served: TestClient, world: World) -> None:
    acme, _, bolt = world.keys
    assert served.put(f"{TREE}/hush-cell/visibility", json={"visibility": "public"}, headers=acme).status_code == 409
    assert served.put(f"{PART}/hush/visibility", json={"visibility": "public"}, headers=acme).status_code == 200
    assert served.get(f"{PART}/hush", headers=bolt).json()["visibility"] == "public"
    assert served.put(f"{TREE}/hush-cell/visibility", json={"visibility": "public"}, headers=acme).status_code == 200
    assert served.get(f"{TREE}/hush-cell", headers=bolt).status_code == 200
    for address in (f"{TREE}/hush-cell", f"{PART}/hush"):
        back = served.put(f"{address}/visibility", json={"visibility": "private"}, headers=acme)
        assert (back.status_code, back.json()["code"]) == (409, "was-public")
    again = served.post(PART, json={**PENDULUM, "name": "hush", "visibility": "private"}, headers=acme)
    assert (again.status_code, again.json()["code"]) == (409, "visibility-differs")


def test_what_is_private_is_not_kept_by_caches(served: TestClient, world: World) -> None:
    acme = world.keys[0]
    for address in (f"{PART}/{{}}@1/definition", f"{TREE}/{{}}-cell@1/metric", f"{TREE}/{{}}-cell@1/picture"):
        kept = {
            name: served.get(address.format(name), headers=acme).headers["cache-control"] for name in NAMES.values()
        }
        assert (kept["hush"], "immutable" in kept["known"]) == ("no-cache", True)


def test_inline_definitions_do_not_tell_what_is_private(
    served: TestClient, world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever sends the content of a private part, it is derived as if nobody had it: it takes as long."""
    derived: list[str] = []
    original: Callable[..., Any] = __import__("service.jobs.kinds.assemble", fromlist=["derive"]).derive

    def noted(definition: Any, *rest: Any) -> Any:
        derived.append(definition.name)
        return original(definition, *rest)

    monkeypatch.setattr("service.jobs.kinds.assemble.derive", noted)
    definition = {**PENDULUM, "name": "hush", "title": "hush"}
    for k, headers in enumerate((world.keys[2], world.keys[0])):
        tree = {"name": f"own-{k}", "visibility": "private", "instances": [{"name": "a", "definition": definition}]}
        assert served.post(TREE, json=tree, headers=headers).status_code == 201
        assert derived == ["hush"]
        derived.clear()


def test_names_are_taken_by_who_comes_first(served: TestClient, world: World) -> None:
    """Nobody puts another arm under a name that others use; whoever sends the same again is told that it is there."""
    acme, _, bolt = world.keys
    other = {**PENDULUM, "name": "known", "title": "known", "tags": ["changed"]}
    refused = served.post(PART, json=other, headers=bolt)
    assert (refused.status_code, refused.json()["code"]) == (403, "name-taken")
    assert "belongs to 'acme'; take another name, for example 'known-bolt'" in refused.json()["detail"]
    assert served.get(f"{PART}/known", headers=bolt).json()["version"] == 1
    same = served.post(PART, json={**PENDULUM, "name": "known", "title": "known"}, headers=bolt)
    assert (same.status_code, same.json()["owner"], same.json()["version"]) == (200, "acme", 1)
    assert served.post(PART, json={**other, "name": "known-bolt"}, headers=bolt).json()["owner"] == "bolt"
    assert served.post(PART, json=other, headers=acme).json()["version"] == 2
    assert served.post(PART, json={**other, "tags": ["admin"]}, headers=world.admin).json()["owner"] == "acme"


def test_the_audit(served: TestClient, world: World) -> None:
    acme, _, bolt = world.keys
    served.post(f"{PART}/known@1/withdraw", json={"reason": "old"}, headers=acme)
    entries = served.get("/v1/audit?owner=acme&page_size=1000", headers=world.admin).json()["items"]
    actions = [entry["action"] for entry in entries]
    assert actions[0] == "substructure.withdraw"
    assert entries[0]["detail"] == {"reason": "old"}
    assert {"key.create", "substructure.submit", "tree.store", "alias.set", "job.submit"} <= set(actions)
    assert [entry["seq"] for entry in entries] == sorted((entry["seq"] for entry in entries), reverse=True)
    served.post(f"{PART}/known@1/withdraw", json={"reason": "not mine"}, headers=bolt)
    again = served.get("/v1/audit?subject=known@1&action=substructure.withdraw", headers=world.admin).json()["items"]
    assert len(again) == 1
    first = served.get("/v1/audit?page_size=1", headers=world.admin).json()
    following = served.get(first["links"]["next"], headers=world.admin).json()
    assert following["items"][0]["seq"] == first["items"][0]["seq"] - 1


@pytest.mark.parametrize("change", ["UPDATE audit SET owner = 'x'", "DELETE FROM audit"])
def test_the_audit_stays_as_it_is(change: str, served: TestClient) -> None:
    store: Store = store_of(served)
    with pytest.raises(Exception, match="append-only"), store.database.write() as connection:
        connection.exec_driver_sql(change)


def test_what_was_there_before_has_an_owner(tmp_path: Path) -> None:
    """Names and keys are local's, a job stays with its key; shipped names go to the catalogue."""
    url = f"sqlite:///{tmp_path / 'store.db'}"
    with open_store(Settings(database=url)) as store, store.database.write() as connection:
        identifier = keys.create(connection, "", ["read", "jobs"]).split("_")[1]
        other = keys.create(connection, "", ["read", "jobs"]).split("_")[1]
        connection.exec_driver_sql("UPDATE substructures SET owner = 'local'")
        connection.exec_driver_sql("INSERT INTO substructures (name) VALUES ('own')")
        row = f"('old', 'export', '{identifier}', 'queued', 1, 0, 0, 0, '', '{identifier}')"
        names = "id, kind, principal, state, total, done, failed, attempts, created, owner"
        connection.exec_driver_sql(f"INSERT INTO jobs ({names}) VALUES {row}")  # noqa: S608 -- ours
    with open_store(Settings(database=url)) as store, store.database.read() as connection:
        owners = dict(connection.exec_driver_sql("SELECT name, owner FROM substructures").all())
        assert (owners.pop("own"), set(owners.values())) == ("local", {"catalogue"})
        job = get_job(connection, "old")
        assert job is not None
        seen = [job.is_seen_by(Viewer(key, "local", ("read",))) for key in (identifier, other)]
        assert seen == [True, False]


def test_migrating_jobs(tmp_path: Path) -> None:
    engine = sa.create_engine(f"sqlite:///{tmp_path / 'x.db'}")
    upgrade(engine, "0007")
    names = "id, kind, principal, state, total, done, failed, attempts, created"
    with engine.begin() as connection:
        row = "('old', 'export', 'k', 'queued', 1, 0, 0, 0, '')"
        connection.exec_driver_sql(f"INSERT INTO jobs ({names}) VALUES {row}")  # noqa: S608 -- ours
    upgrade(engine)
    with engine.connect() as connection:
        assert connection.exec_driver_sql("SELECT owner FROM jobs").scalar() == "k"
    engine.dispose()


def test_rotating_and_deleting_keys(served: TestClient, world: World) -> None:
    store, acme = store_of(served), world.keys[0]
    identifier = acme["Authorization"].split("_")[1]
    with store.database.write() as connection:
        with pytest.raises(ValueError, match="in use"):
            keys.delete(connection, identifier)
        text = keys.rotate(connection, identifier)
    new = {"Authorization": f"Bearer {text}"}
    assert served.get(f"{PART}/hush", headers=acme).json()["code"] == "key-revoked"
    assert served.get(f"{PART}/hush", headers=new).status_code == 200
    assert served.get(f"{PART}/hush", headers=new).json()["owner"] == "acme"
    with store.database.write() as connection:
        again = {"Authorization": f"Bearer {keys.rotate(connection, text.split('_')[1], hours=1)}"}
        keys.delete(connection, identifier)
        with pytest.raises(ValueError, match="there is no key"):
            keys.rotate(connection, identifier)
    for headers in (new, again):
        assert served.get(f"{PART}/hush", headers=headers).status_code == 200
    with store.database.write() as connection:
        keys.revoke(connection, text.split("_")[1])
        with pytest.raises(ValueError, match="is revoked"):
            keys.rotate(connection, text.split("_")[1])


def test_the_command_key(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    database = ["--database", f"sqlite:///{tmp_path / 'x.db'}"]
    assert main(["key", "create", "--owner", "acme", "--scope", "write", *database]) == 0
    identifier = capsys.readouterr().out.split("_")[1]
    assert main(["key", "rotate", identifier, *database]) == 0
    new = capsys.readouterr().out.split("_")[1]
    assert main(["key", "list", *database]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in listed] == [[identifier, "acme", "write"], [new, "acme", "write"]]
    assert main(["key", "delete", new, *database]) == 1
    assert "revoke it first" in capsys.readouterr().err
    assert main(["key", "revoke", new, *database]) == 0
    assert "the last key" in capsys.readouterr().err
    for each in (identifier, new):
        assert main(["key", "delete", each, *database]) == 0
    assert main(["key", "list", *database]) == 0
    assert capsys.readouterr().out == ""
    assert main(["key", "create", "--owner", "No Such", *database]) == 1
    assert "is no owner" in capsys.readouterr().err
