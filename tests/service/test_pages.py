"""What a person sees: pages and pictures, escaped, self-contained, and behind the same keys as the API."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.pages.html import Html, html, tag
from service.pages.words import certificate
from service.settings import Settings
from service.store.store import Store

from .conftest import HAND, PENDULUM, SLIDER, TREE, make_client
from .reading import Page, draw, read
from .test_conventions import problem
from .test_keys import new_key

PAGES = ("/", "/substructures/pendulum", "/trees/cell")
PICTURES = ("/v1/substructures/pendulum@1/picture", "/v1/trees/cell@1/picture")
HOSTILE = [
    "<script>alert(1)</script>",
    "\"><img src=x onerror=alert(1)>",
    "' onmouseover='alert(1)",
    "</title></style></script><svg onload=alert(1)>",
    "&lt;b&gt; &#60;b&#62;",
    "{{7*7}} ${7*7} <%= 7*7 %>",
    "javascript:alert(1)",
    "\u200f\u00ad right to left",
]  # fmt: skip


def test_unknown_references(filled: TestClient) -> None:
    for path in ("/substructures/nothing", "/v1/substructures/nothing/picture", "/substructures/pendulum@9"):
        problem(filled.get(path), 404, "unknown-substructure")
    for path in ("/trees/nothing", "/v1/trees/nothing/picture", "/trees/cell@9"):
        problem(filled.get(path), 404, "unknown-tree")


def test_a_tree_of_several_parts_is_drawn(filled: TestClient) -> None:
    assert filled.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
    own = {"name": "own", "definition": {**SLIDER, "name": "not-in-the-library"}, "at": "hand.tip"}
    assert filled.post("/v1/trees/cell/couplings", json=own).status_code == 201
    drawn = draw(filled, "/v1/trees/cell@3/picture", q="0.1,0.2,0.3")
    assert len(drawn) > len(draw(filled, "/v1/trees/cell@1/picture"))
    page = read(filled, "/trees/cell")
    assert "not-in-the-library (a definition of its own)" in page.text
    assert "/trees/cell@2" in page.links
    for name in ("arm.q", "hand.q", "own.x"):
        assert name in page.text


def test_the_first_page(filled: TestClient) -> None:
    page = read(filled, "/")
    for words in ("Pendulum", "pendulum@1", "1 dof, joints R", "planar, textbook", "Sliding mass", "2 of 2 parts"):
        assert words in page.text
    for path in ("/substructures/pendulum@1", "/trees/cell@1", "/openapi.json"):
        assert path in page.links
    for address in page.links:
        assert filled.get(address).status_code == 200, address
    for words in ("Joints", "local", "quantities agree to", "used by"):
        assert words in page.text


def test_the_example_can_be_sent(filled: TestClient) -> None:
    command = read(filled, "/", Host="localhost:1234").text
    assert "curl -s http://localhost:1234/v1/trees -H 'Content-Type: application/json' -d '" in command
    body = command.split("-d '")[1].split("'")[0]
    assert filled.post("/v1/trees", json=json.loads(body)).status_code == 201


@pytest.mark.parametrize("host", ["localhost:80'; touch x", "localhost:<b>", "localhost:$(x)"])
def test_the_address_cannot_be_made_up(filled: TestClient, host: str) -> None:
    assert filled.get("/", headers={"Host": host}).status_code == 400


def test_an_empty_store(client: TestClient) -> None:
    page = read(client, "/")
    assert "Nothing is stored yet" in page.text
    assert "0 of 0 parts" in page.text


def test_the_page_of_a_part(filled: TestClient) -> None:
    filled.put("/v1/substructures/pendulum/aliases/best", json={"version": 1})
    filled.post("/v1/substructures/pendulum@1/withdraw", json={"reason": "wrong mass"})
    page = read(filled, "/substructures/pendulum@1")
    for words in (
        *(
            "pendulum@best",
            "revolute",
            "at a random state; largest deviation",
            "positive definite",
        ),
        *("Withdrawn on", "wrong mass", "kg", "quantities compared"),
    ):
        assert words in page.text, words
    for address in page.links:
        assert filled.get(address).status_code == 200, address


def test_the_page_of_a_tree(filled: TestClient) -> None:
    page = read(filled, "/trees/cell")
    for words in (
        "arm.q",
        "arm.m",
        "9.81",
        "0, -g, 0 (world axes, m/s^2)",
        "quantities compared",
    ):
        assert words in page.text, words
    for address in page.links:
        assert filled.get(address).status_code == 200, address


def test_a_tree_that_was_removed_and_stored_again_has_its_pages(filled: TestClient) -> None:
    """Its revisions count on; nothing links to those that are gone."""
    tree = {**TREE, "name": "again"}
    filled.post("/v1/trees", json=tree)
    assert filled.delete("/v1/trees/again").status_code == 204
    for at in (TREE["gravity"], [0, 0, 0]):
        filled.post("/v1/trees", json={**tree, "gravity": at})
    assert [each["revision"] for each in filled.get("/v1/trees/again/revisions").json()["items"]] == [3, 2]
    for path in ("/trees/again", "/trees/again/edit", "/trees/again@2/edit"):
        answer = filled.get(path)
        assert (answer.status_code, "again@1" in answer.text) == (200, False), path
    assert "/trees/again@2/difference?to=again@3" in filled.get("/trees/again").text
    assert 'data-first="2"' in filled.get("/trees/again/edit").text
    assert filled.get("/v1/trees/again@1").json()["detail"] == "the tree 'again@1' was removed"
    assert filled.get("/v1/trees/again@9").json()["detail"] == "there is no tree 'again@9'; did you mean 'again'?"


def test_changes_of_another_window_are_told(filled: TestClient) -> None:
    """Of two that are made of one revision, the second lacks what the first has changed."""
    filled.post("/v1/trees", json={**TREE, "name": "contended"})
    for name in ("left", "right"):
        step = {"name": name, "substructure": "pendulum", "at": "world"}
        assert filled.post("/v1/trees/contended@1/couplings", json=step).status_code == 201
    first, second = (filled.get(f"/trees/contended@{number}/edit").text for number in (2, 3))
    assert "This was made of" not in first
    assert "This was made of @1, not of @2" in second
    assert "/trees/contended@3/difference?to=contended@2" in second


def test_parts_without_coordinates_or_values(client: TestClient) -> None:
    still = {"name": "block", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "fixed"}, "mass": 1}]}
    for definition in (still, SLIDER, {"name": "nothing", "bodies": []}):
        assert client.post("/v1/substructures", json=definition).status_code == 201
        draw(client, f"/v1/substructures/{definition['name']}/picture")
        for address in read(client, f"/substructures/{definition['name']}").links:
            assert client.get(address).status_code == 200, address
    assert "to be given" in read(client, "/substructures/slider").text
    assert client.get("/v1/substructures/block/picture", params={"q": ""}).status_code == 200


def test_long_formulas_are_not_shown(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.models.entries.LINES", 0)
    for path in PAGES[1:]:
        page = read(filled, f"{path}?entry=metric,0,0")
        assert "too long for a page: take it as code" in page.text
        assert "model_metric" in page.text


def test_formulas_and_numbers_without_scripts(filled: TestClient) -> None:
    assert filled.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
    double = filled
    """By links and a form alone: what the interface says, to the last digit."""
    told = double.post("/v1/trees/cell/evaluations", json={"q": [0.3, -0.8], "quantities": ["metric"]}).json()
    page = read(double, "/trees/cell?entry=metric,0,1&pose=0.3,-0.8")
    assert f"{told['metric'][0][1]!r} kg m²" in page.text
    for words in ("arm.q, hand.q", "hand.rod", "arm.l", "LaTeX", "certificate"):
        assert words in page.text
    grid = read(double, "/trees/cell?q=0.3&q=-0.8")
    assert f"{told['metric'][1][1]:.3g}" in grid.text
    assert "no body is moved" not in page.text
    assert "Zero in every pose: its formula vanishes" in read(double, "/trees/cell?entry=christoffel,0,0,0").text
    problem(double.get("/trees/cell?entry=metric,7,7"), 422, "component")
    problem(double.get("/trees/cell/entry?entry=metrics,0,0"), 404, "unknown-formula")
    problem(double.get("/trees/cell?pose=1"), 422, "q")


def test_scripts_are_kept_for_ever_under_their_digest(filled: TestClient) -> None:
    page = read(filled, "/trees/cell")
    files = [address for address in page.links if address.startswith("/assets/")]
    assert len(files) == 2
    for address in (*files, files[0].rpartition("/")[0] + "/view.js"):
        answer = filled.get(address)
        assert answer.status_code == 200
        assert "immutable" in answer.headers["cache-control"]
    assert filled.get("/assets/0/main.js").headers["cache-control"] == "no-store"
    problem(filled.get("/assets/0/..%2f..%2fshown.py"), 404, "unknown-asset")


@pytest.mark.parametrize("text", HOSTILE)
def test_texts_are_escaped(filled: TestClient, text: str) -> None:
    parameter = {"value": 1, "unit": text[:60], "description": text}
    definition = {
        **PENDULUM,
        "title": text,
        "description": text,
        "source": text,
        "license": text,
        "tags": [text[:60]],
        "parameters": {**PENDULUM["parameters"], "m": parameter},
    }
    answer = filled.post("/v1/substructures", json=definition)
    if answer.status_code == 422:  # tags and units may be refused; the texts may not
        definition |= {"tags": [], "parameters": {**PENDULUM["parameters"], "m": {**parameter, "unit": "kg"}}}
        answer = filled.post("/v1/substructures", json=definition)
    assert answer.status_code == 201, answer.text
    assert filled.post("/v1/trees", json={**TREE, "name": "hostile"}).status_code == 201
    filled.post("/v1/substructures/pendulum@2/withdraw", json={"reason": text})
    filled.post("/v1/substructures", json={**definition, "description": text + text})
    seen = text.replace("\u200f", "\ufffd")
    for path in ("/", "/substructures/pendulum", "/substructures/pendulum@2", "/trees/hostile"):
        page = read(filled, path)
        if path.startswith("/substructures"):
            assert " ".join(seen.split()) in page.text
        assert "\u200f" not in page.text
    draw(filled, "/v1/substructures/pendulum/picture")
    draw(filled, "/v1/trees/hostile/picture")


@pytest.mark.parametrize("path", PAGES)
def test_nothing_foreign_runs_in_a_page(filled: TestClient, path: str) -> None:
    answer = filled.get(path)
    policy = dict(item.split(" ", 1) for item in answer.headers["content-security-policy"].split("; "))
    assert policy["default-src"] == policy["base-uri"] == policy["frame-ancestors"] == "'none'"
    assert policy["img-src"] == ("'self' blob:" if path == "/" else "'self'")
    assert "unsafe-inline" not in str(policy)
    assert "'unsafe-eval'" not in str(policy)
    assert ("wasm" in policy["script-src"]) == (path != "/")
    assert answer.headers["x-content-type-options"] == "nosniff"
    for element, text in Page(answer.text).inline.items():
        digest = base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
        assert f"'sha256-{digest}'" in policy[f"{element}-src"].split()
        assert "//" not in text
    again = filled.get(path, headers={"If-None-Match": answer.headers["etag"]})
    assert (again.status_code, answer.headers["cache-control"]) == (304, "no-cache")


def test_pages_obey_keys(filled: TestClient, store: Store) -> None:
    assert "Bearer" not in read(filled, "/").text
    reader, writer = new_key(store, "read"), new_key(store, "write")
    for path in (*PAGES, *PICTURES):
        if path in PICTURES:
            problem(filled.get(path), 401, "key-missing")
        problem(filled.get(path, headers=writer), 403, "scope-missing")
        assert filled.get(path, headers=reader).status_code == 200
    assert '-H "Authorization: Bearer $SUBSTRUCTURES_KEY"' in read(filled, "/", **reader).text


def test_pages_are_not_part_of_the_api(client: TestClient) -> None:
    paths = client.get("/openapi.json").json()["paths"]
    assert not {"/", "/substructures/{ref}", "/trees/{ref}"} & paths.keys()
    drawn = paths["/v1/trees/{ref}/picture"]["get"]["responses"]["200"]["content"]
    assert list(drawn) == ["image/svg+xml"]


def test_html_escapes() -> None:
    assert tag("a", "<&>", href="\"'") == '<a href="&quot;&#x27;">&lt;&amp;&gt;</a>'
    assert html(["a", None, 3, Html("<b>"), ["<"]]) == "a3<b>&lt;"
    assert tag("img", alt=None, data_text="x") == '<img data-text="x">'
    assert html("a\u202eb\x00\ud800\n") == "a\ufffdb\ufffd\ufffd\n"


@pytest.fixture(scope="module")
def shipped(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server with the shipped catalogue."""
    path: Path = tmp_path_factory.mktemp("shipped") / "store.db"
    with open_store(Settings(database=f"sqlite:///{path}")) as store, make_client(store) as client:
        yield client


def test_the_whole_catalogue_can_be_seen(shipped: TestClient) -> None:
    """Every entry is derived, drawn and shown: 2 s and more."""
    items: list[dict[str, Any]] = shipped.get("/v1/substructures?page_size=1000").json()["items"]
    assert len(items) > 40
    assert len(shipped.get("/").content) < 200_000
    for item in items:
        drawn = shipped.get(item["links"]["picture"])
        assert len(drawn.content) < 20_000
        assert "nan" not in drawn.text
        # quaternions have a norm: those of the pose
        scene = shipped.get(f"/v1/substructures/{item['name']}/scene").json()
        q = scene["poses"]["home"] if scene.get("positions") else [0.1] * item["dof"]
        draw(shipped, item["links"]["picture"], q=",".join(map(str, q)))
        page = read(shipped, f"/substructures/{item['name']}")
        assert item["title"] in page.text
        assert len(page.text) < 100_000
    assert '"substructure": "puma560"' in read(shipped, "/").text


def test_certificates_of_older_versions_are_told() -> None:
    errors = {"metric": "1e-16", "christoffel": "2e-16", "bias": None}
    older = {"states": 4, "tolerance": "1e-9", "direct_form": {"max_relative_error": errors}}
    told = str(certificate(older))
    for words in ("2 quantities", "older version", "2.0e-16, in Christoffel symbols", "bias could not be compared"):
        assert words in told, told
    assert "own text" in str(certificate({**older, "compared_with": "documents"}))


def test_the_catalogue_is_searched_and_has_pages(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    found = filled.get("/?q=sliding").text
    assert "slider@1" in found
    assert "pendulum@1" not in found
    slipped = filled.get("/?q=pendlum").text
    assert "'pendlum' is nowhere; this is 'pendulum'." in slipped.replace("&#x27;", "'")
    assert "pendulum@1" in slipped
    monkeypatch.setattr("service.pages.routes.CARDS", 1)
    first = filled.get("/").text
    following = re.search(r'href="(/\?after=[^"]+)">More parts', first)
    assert following
    second = filled.get(following[1].replace("&amp;", "&")).text
    assert ("pendulum@1" in first, "slider@1" in second) == (True, True)
    assert "More parts" not in second


def test_facets_narrow_the_catalogue_by_links(filled: TestClient) -> None:
    links = read(filled, "/").links
    assert {"/?joints=R", "/?joints=P", "/?tag=planar", "/?tag=textbook"} <= set(links)
    for query, there, gone in (
        ("?joints=P", "slider@1", "pendulum@1"),
        ("?tag=textbook", "pendulum@1", "slider@1"),
        ("?dof=1&joints=r&sort=-created", "pendulum@1", "slider@1"),
        ("?owner=local&tag=textbook", "pendulum@1", "slider@1"),
    ):
        found = read(filled, f"/{query}")
        assert (there in found.text, gone in found.text) == (True, False)
        assert found.text.count("any") >= 1
    # trees have the same facets but tags
    assert ("/trees/cell@1" in read(filled, "/?dof=1").links) == ("/trees/cell@1" not in read(filled, "/?dof=2").links)
    problem(filled.get("/?sort=nothing"), 422, "sort")
    problem(filled.get("/?dof=x"), 422, "invalid-request")


def test_browsers_are_told_what_is_wrong_as_a_page(filled: TestClient) -> None:
    browser = {"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"}
    for path, status, said in (
        ("/substructures/pendulom", 404, "did you mean"),
        ("/nowhere", 404, "nothing at this path"),
        ("/trees/cell@9", 404, "cell@9"),
        ("/?colour=red", 422, "unknown query parameter"),
        ("/?dof=abc", 422, '/query/dof: a whole number of degrees of freedom is needed, as in 6, found "abc"'),
        ("/?joints=x", 422, "joints are R (revolute) and P (prismatic) in order"),
    ):
        answer = filled.get(path, headers=browser)
        assert (answer.status_code, answer.headers["content-type"]) == (status, "text/html; charset=utf-8"), path
        assert said in Page(answer.text).text.replace("\u00a0", " ") or said.replace(" ", "") in Page(answer.text).text
        assert "content-security-policy" in answer.headers
        assert filled.get(path, headers={"Accept": "application/json"}).json()["status"] == status
    assert "/substructures/pendulum" in Page(filled.get("/substructures/pendulom", headers=browser).text).links
    assert 'action="/" class="bar" id="search"' in filled.get("/?dof=abc", headers=browser).text
    hostile = Page(filled.get("/substructures/<script>alert(1)", headers=browser).text)
    assert "alert(1)" in hostile.text
    assert filled.get("/v1/trees/none", headers=browser).json()["code"] == "unknown-tree"


def test_the_tag_of_what_is_compressed_is_weak_and_as_good(filled: TestClient) -> None:
    """Other bytes than those that the strong one names; what was read under either can be changed, and is known."""
    path = "/v1/trees/cell"
    plain = filled.get(path, headers={"Accept-Encoding": "identity"})
    packed = filled.get(path, headers={"Accept-Encoding": "gzip"})
    assert (plain.headers.get("content-encoding"), packed.headers["content-encoding"]) == (None, "gzip")
    tag = plain.headers["etag"]
    assert tag.startswith('"')
    assert packed.headers["etag"] == f"W/{tag}"
    for coding in ("identity", "gzip"):
        for known in (tag, f"W/{tag}"):
            same = filled.get(path, headers={"If-None-Match": known, "Accept-Encoding": coding})
            assert same.status_code == 304
            assert same.headers["etag"] == known
    changed = filled.post(f"{path}/couplings", json=HAND, headers={"If-Match": packed.headers["etag"]})
    assert changed.status_code == 201
    assert filled.post(f"{path}/couplings", json=HAND, headers={"If-Match": f"W/{tag}"}).status_code == 412


def test_what_is_read_is_compressed(filled: TestClient) -> None:
    packed = filled.get("/trees/cell", headers={"Accept-Encoding": "gzip"})
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.text == filled.get("/trees/cell", headers={"Accept-Encoding": "identity"}).text
    for refused in ("gzip;q=0", "*, GZIP ; q=0.0"):
        answer = filled.get("/trees/cell", headers={"Accept-Encoding": refused})
        assert (answer.text, answer.headers.get("content-encoding")) == (packed.text, None)
    state = {"quantities": ["metric"], "q": [[0.1]] * 400}
    assert "content-encoding" not in filled.post("/v1/trees/cell/evaluations", json=state).headers
    icon = filled.get("/favicon.ico")
    assert (icon.status_code, icon.headers["content-type"]) == (200, "image/svg+xml")
