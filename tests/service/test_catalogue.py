"""``/v1/substructures``: submit, refer, search, alias, withdraw (HTTP contract, section 2)."""

from __future__ import annotations

import json
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.messages.paging import write_token
from service.schemas.resources import AliasView, FormulaIndex, VersionPage, VersionView
from substructures.printers import FORMATS

from .conftest import PENDULUM, SLIDER, at_once, plain_tag

VERSION_FIELDS = {
    "name", "version", "digest", "dof", "coordinates", "bodies", "joints", "ports", "parameters", "operations",
    "certificate", "created", "aliases", "is_withdrawn", "links",
}  # fmt: skip


def changed(**fields: Any) -> dict[str, Any]:
    return {**PENDULUM, **fields}


def test_submit_creates_a_version(client: TestClient) -> None:
    answer = client.post("/v1/substructures", json=PENDULUM)
    assert answer.status_code == 201
    assert answer.headers["location"] == "/v1/substructures/pendulum@1"
    version = answer.json()
    VersionView.model_validate(version)
    assert version.keys() >= VERSION_FIELDS
    assert (version["name"], version["version"], version["dof"], version["joints"]) == ("pendulum", 1, 1, "R")
    assert (version["coordinates"], version["bodies"], version["ports"]) == (["q"], ["rod"], ["tip"])
    assert version["parameters"]["l"]["value"] == 1
    assert version["operations"]["total"] > 0
    assert version["is_withdrawn"] is False


def test_submit_again_changes_nothing(client: TestClient, rows: Any) -> None:
    first = client.post("/v1/substructures", json=PENDULUM)
    before = rows()
    reordered = dict(reversed(PENDULUM.items()))
    second = client.post(
        "/v1/substructures", content=json.dumps(reordered, indent=3), headers={"Content-Type": "application/json"}
    )
    assert (second.status_code, second.json()) == (200, first.json())
    assert second.headers["location"] == first.headers["location"]
    assert rows() == before


def test_every_reference_means_the_same_version(client: TestClient) -> None:
    client.post("/v1/substructures", json=PENDULUM)
    newer = client.post("/v1/substructures", json=changed(title="Newer")).json()
    client.put("/v1/substructures/pendulum/aliases/stable", json={"version": 2})
    for ref in ("pendulum", "pendulum@2", "pendulum@stable", f"pendulum@{newer['digest']}"):
        found = client.get(f"/v1/substructures/{ref}").json()
        assert found == {**newer, "aliases": ["stable"]}
    assert client.get("/v1/substructures/pendulum@1").json()["title"] == "Pendulum"


@pytest.mark.parametrize(
    "ref", ["nothing", "pendulum@9", "pendulum@gone", f"pendulum@sha256:{'0' * 64}", "Pendulum", "a@b@c", "pendulum@0"]
)
def test_unknown_references(filled: TestClient, ref: str) -> None:
    answer = filled.get(f"/v1/substructures/{ref}")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


def test_definition_as_stored(filled: TestClient) -> None:
    text = filled.get("/v1/substructures/slider@1/definition").content
    again = filled.post("/v1/substructures", content=text, headers={"Content-Type": "application/json"})
    assert again.status_code == 200
    assert json.loads(text)["bodies"] == SLIDER["bodies"]


def test_numbers_stay_exact(client: TestClient) -> None:
    text = json.dumps(PENDULUM).replace('"value": 2', '"value": 2.10000000000000000000000000000000001')
    answer = client.post("/v1/substructures", content=text, headers={"Content-Type": "application/json"})
    assert answer.status_code == 201
    for path in ("", "/definition"):
        assert b"2.10000000000000000000000000000000001" in client.get(f"/v1/substructures/pendulum{path}").content


def test_formula_index(filled: TestClient) -> None:
    index = filled.get("/v1/substructures/pendulum/formulas").json()
    FormulaIndex.model_validate(index)
    assert index["count"] == len(index["formulas"]) > 0
    quantities = {formula["quantity"] for formula in index["formulas"]}
    assert quantities >= {"Omega", "R", "metric", "composite"}
    for quantity in quantities:
        assert filled.get(index["links"]["quantities"][quantity]).status_code == 200


def test_single_formulas(filled: TestClient) -> None:
    base = "/v1/substructures/pendulum@1/formulas"
    whole = filled.get(f"{base}/metric").json()
    assert whole["outputs"].keys() == {"metric"}
    single = filled.get(f"{base}/metric", params={"component": "0,0"}).json()
    assert single["outputs"]["metric[0,0]"]["shape"] == []
    twist = filled.get(f"{base}/Omega", params={"body": "rod", "coordinate": "q", "component": 2}).json()
    assert list(twist["outputs"]) == ["Omega[0,0,2]"]
    for wrong in ({"body": "nobody"}, {"coordinate": "q9"}):
        assert filled.get(f"{base}/Omega", params=wrong).status_code == 404
    assert filled.get(f"{base}/Omega", params={"component": "7"}).status_code == 422
    assert filled.get(f"{base}/nothing").status_code == 404


#: a pendulum has neither products of its one joint with others, nor springs; its mass centre hangs on its axis
VANISHING = {
    "kappa": [1, 1, 3],
    "christoffel": [1, 1, 1],
    "potential": [],
    "U?body=rod&coordinate=q": [3],
    "U?body=rod&coordinate=q&component=1": [],
    "christoffel?component=0,0,0": [],
    "kappa?coordinate=q": [3],
}


@pytest.mark.parametrize("what", VANISHING)
def test_formulas_that_vanish_are_zeros(filled: TestClient, what: str) -> None:
    answer = filled.get(f"/v1/substructures/pendulum/formulas/{what}")
    assert answer.status_code == 200, answer.text
    assert [(o["shape"], o["entries"]) for o in answer.json()["outputs"].values()] == [(VANISHING[what], [])]
    for form in FORMATS:
        assert filled.get(f"/v1/substructures/pendulum/formulas/{what}", params={"format": form}).status_code == 200


def test_groups_have_their_vanishing_members(filled: TestClient) -> None:
    outputs = filled.get("/v1/substructures/pendulum/formulas/interface").json()["outputs"]
    assert {"f", "n", "K", "kappa", "F", "N", "composite.m", "composite.s", "composite.J"} == outputs.keys()


@pytest.mark.parametrize("what", ["kappa?body=nobody", "U?coordinate=x", "nothing", "frame.E", "potential?body=rod"])
def test_what_a_part_does_not_have_is_not_found(filled: TestClient, what: str) -> None:
    answer = filled.get(f"/v1/substructures/pendulum/formulas/{what}")
    assert (answer.status_code, answer.json()["code"]) == (404, "unknown-formula")


@pytest.mark.parametrize("what", ["kappa?component=3", "christoffel?component=0,0,1", "potential?component=0"])
def test_components_beyond_a_formula_that_vanishes(filled: TestClient, what: str) -> None:
    answer = filled.get(f"/v1/substructures/pendulum/formulas/{what}")
    assert (answer.status_code, answer.json()["code"]) == (422, "component")


def test_every_format_counts_in_one_way_and_says_so(filled: TestClient) -> None:
    """F of joint 1 for coordinate 1 is (-m l cos q, -m l sin q, 0); places in the query count from 0."""

    def printed(form: str, **query: Any) -> str:
        answer = filled.get(
            "/v1/substructures/pendulum/formulas/F", params={"format": form, "form": "compact", **query}
        )
        assert answer.status_code == 200
        return answer.text

    text = printed("text", coordinate="q")
    assert "F[1,1]: 3, indices from 1" in text
    assert "F[1,1][2] = -sin(q)" in text
    assert "F[1,1,2]: one element, indices from 1" in printed("text", coordinate="q", component=1)
    assert "F[1, 1, 2] = -sin(q)" in printed("text")
    latex = printed("latex")
    assert "% indices from 1" in latex
    assert "F_{112} &= -" in latex
    document = json.loads(printed("json", coordinate="q", component=1))
    assert list(document["outputs"]) == ["F[0,0,1]"]
    assert json.loads(printed("json"))["outputs"]["F"]["index"] == [[0, 0, 0], [0, 0, 1]]
    from_zero, from_one = ("python", "c", "sympy"), ("matlab", "julia")
    assert all("indices from 0" in printed(form) for form in from_zero)
    assert all("indices from 1" in printed(form) for form in from_one)
    whole = filled.get("/v1/trees/cell/christoffel").json()
    assert whole["indices_from"] == 0


def test_formulas_stand_alone_unless_asked_otherwise(filled: TestClient) -> None:
    def symbols(**query: Any) -> set[str]:
        document = filled.get("/v1/substructures/pendulum@1/formulas/metric", params=query).json()
        return {symbol["name"] for symbol in document["symbols"]}

    assert symbols() == {"l", "m"}
    assert symbols(bind="l:2") == {"m"}
    assert symbols(inertia="symbols") == {"rod.Jxx", "rod.Jyy"}
    assert filled.get("/v1/substructures/pendulum@1/formulas/metric?inertia=x").status_code == 422
    text = filled.get("/v1/substructures/pendulum@1/formulas/metric?format=text&form=expanded").text
    assert "= 1.1*l^2*m" in text


def test_search(filled: TestClient) -> None:
    def names(**query: Any) -> list[str]:
        answer = filled.get("/v1/substructures", params=query)
        assert answer.status_code == 200, answer.text
        VersionPage.model_validate(answer.json())
        return [item["name"] for item in answer.json()["items"]]

    assert names() == ["pendulum", "slider"]
    assert names(q="sliding MASS") == ["slider"]
    assert names(q="%") == names(q="_") == []
    assert names(tag="textbook") == ["pendulum"]
    assert names(tag=["planar", "textbook"]) == ["pendulum"]
    assert names(dof_min=2) == []
    assert names(dof_max=1, joints="P") == ["slider"]
    assert names(sort="-name") == ["slider", "pendulum"]
    assert names(sort="-created") == ["slider", "pendulum"]
    facets = filled.get("/v1/substructures?facets=true").json()["facets"]
    assert facets == {"tags": {"planar": 2, "textbook": 1}, "joints": {"P": 1, "R": 1}, "dof": {"1": 2}}


def test_only_the_latest_versions_are_listed(filled: TestClient) -> None:
    filled.post("/v1/substructures", json=changed(title="Newer"))
    items = filled.get("/v1/substructures", params={"q": "pendulum"}).json()["items"]
    assert [(item["version"], item["title"]) for item in items] == [(2, "Newer")]


@pytest.mark.parametrize("sort", ["name", "-name", "dof", "-dof", "created", "-created"])
def test_pages_cover_everything_once(client: TestClient, sort: str) -> None:
    for k in range(7):
        assert (
            client.post(
                "/v1/substructures", json=changed(name=f"p{k}", tags=["even"] if k % 2 == 0 else [])
            ).status_code
            == 201
        )
    found, url = [], f"/v1/substructures?page_size=2&sort={sort}&q=p&facets=true"
    for _ in range(10):
        answer = client.get(url)
        found += [item["name"] for item in answer.json()["items"]]
        assert answer.json()["facets"]["tags"] == {"even": 4}
        if answer.json()["next_page_token"] is None:
            assert "link" not in answer.headers
            break
        url = answer.json()["links"]["next"]
        assert answer.headers["link"] == f'<{url}>; rel="next"'
    assert sorted(found) == [f"p{k}" for k in range(7)]


def test_foreign_page_tokens_are_refused(filled: TestClient) -> None:
    filled.post("/v1/substructures", json=changed(name="third"))
    token = filled.get("/v1/substructures?page_size=1").json()["next_page_token"]
    assert token
    for query in (
        {"page_token": token, "q": "x"},
        {"page_token": "nonsense"},
        {"page_token": token[:-2]},
        {"page_token": ""},
    ):
        answer = filled.get("/v1/substructures", params=query)
        assert answer.status_code == 422
        assert answer.json()["errors"][0]["pointer"] == "/query/page_token"


@pytest.mark.parametrize("position", [-1, 2**63, 2**64 - 1])
def test_page_tokens_that_somebody_made_up_are_refused(filled: TestClient, position: int) -> None:
    token = write_token(("versions", "pendulum"), position)
    answer = filled.get("/v1/substructures/pendulum/versions", params={"page_token": token})
    assert (answer.status_code, answer.json()["code"]) == (422, "page-token")


@pytest.mark.parametrize(
    "query", ["page_size=0", "page_size=1001", "page_size=x", "sort=mass", "dof_min=-1", "joints=RX"]
)
def test_wrong_queries(client: TestClient, query: str) -> None:
    answer = client.get(f"/v1/substructures?{query}")
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == f"/query/{query.split('=')[0]}"


def test_what_a_new_version_and_a_withdrawal_expect(filled: TestClient) -> None:
    def refused(answer: Any) -> bool:
        return (answer.status_code, answer.json()["code"]) == (412, "precondition-failed")

    old, other = plain_tag(filled, "/v1/substructures/pendulum"), {**PENDULUM, "title": "Another"}
    for prefer in ({}, {"Prefer": "respond-async"}):
        assert refused(filled.post("/v1/substructures", json=other, headers={"If-None-Match": "*", **prefer}))
        assert refused(filled.post("/v1/substructures", json=other, headers={"If-Match": '"other"', **prefer}))
        fresh = {**other, "name": "fresh"}
        assert refused(filled.post("/v1/substructures", json=fresh, headers={"If-Match": "*", **prefer}))
    assert refused(filled.post("/v1/substructures", json=PENDULUM, headers={"If-None-Match": "*"})), "the same, too"
    made = filled.post("/v1/substructures", json=other, headers={"If-Match": old})
    assert (made.status_code, made.json()["version"]) == (201, 2)
    tag = made.headers["etag"]
    assert tag == plain_tag(filled, "/v1/substructures/pendulum") != old
    assert refused(filled.post("/v1/substructures", json={**PENDULUM, "title": "Third"}, headers={"If-Match": old}))
    withdraw = "/v1/substructures/pendulum@2/withdraw"
    assert refused(filled.post(withdraw, json={"reason": "heavy"}, headers={"If-Match": old}))
    gone = filled.post(withdraw, json={"reason": "heavy"}, headers={"If-Match": tag})
    assert (gone.status_code, gone.json()["is_withdrawn"]) == (200, True)
    assert gone.headers["etag"] == plain_tag(filled, "/v1/substructures/pendulum@2") != tag
    assert filled.post("/v1/substructures/pendulum@1/withdraw", json={}).status_code == 200
    assert refused(filled.post("/v1/substructures", json=other, headers={"If-None-Match": "*"})), "all are withdrawn"
    assert refused(filled.post("/v1/substructures", json=other, headers={"If-Match": "*"}))
    free = filled.post("/v1/substructures", json={**PENDULUM, "name": "free"}, headers={"If-None-Match": "*"})
    assert free.status_code == 201


def test_of_those_that_expect_no_part_one_makes_it(filled: TestClient) -> None:
    def make(k: int) -> int:
        document = {**PENDULUM, "name": "first", "title": f"Number {k}"}
        return filled.post("/v1/substructures", json=document, headers={"If-None-Match": "*"}).status_code

    assert sorted(at_once(make, range(1, 6))) == [201] + 4 * [412]
    assert filled.get("/v1/substructures/first").json()["version"] == 1


def test_an_alias_that_is_expected_not_to_be_there(filled: TestClient) -> None:
    url = "/v1/substructures/pendulum/aliases/stable"
    assert filled.put(url, json={"version": 1}, headers={"If-None-Match": "*"}).status_code == 201
    again = filled.put(url, json={"version": 1}, headers={"If-None-Match": "*"})
    assert (again.status_code, again.json()["code"]) == (412, "precondition-failed")


@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("POST", "/v1/bundles"),
        ("POST", "/v1/imports?store=true"),
        ("POST", "/v1/jobs"),
        ("POST", "/v1/jobs/none/cancel"),
        ("POST", "/v1/jobs/none/retry"),
        ("DELETE", "/v1/jobs/none"),
        ("POST", "/v1/jobs/none/rows/1/tree"),
        ("PUT", "/v1/substructures/pendulum/visibility"),
        ("PUT", "/v1/trees/cell/visibility"),
        ("POST", "/v1/trees/cell/publish"),
    ],
)
def test_a_condition_that_has_no_meaning_is_not_passed_over(filled: TestClient, method: str, path: str) -> None:
    for header in ("If-Match", "If-None-Match"):
        headers = {header: "*", "Content-Type": "application/json"}
        answer = filled.request(method, path, content=b"{}", headers=headers)
        assert (answer.status_code, answer.json()["code"]) == (422, "unknown-precondition"), answer.text
        assert answer.json()["errors"][0]["pointer"] == f"/header/{header}"
    coupling = {"name": "hand", "substructure": "pendulum", "at": "arm.tip"}
    for tree_path, body in (("couplings", coupling), ("loads", {}), ("closures", {})):
        answer = filled.post(f"/v1/trees/cell/{tree_path}", json=body, headers={"If-None-Match": "*"})
        assert (answer.status_code, answer.json()["code"]) == (422, "unknown-precondition")
    numbers = filled.post(
        "/v1/trees/cell/evaluations", json={"q": [0.1], "quantities": ["metric"]}, headers={"If-None-Match": "*"}
    )
    assert numbers.status_code == 200, "nothing is changed"


def test_aliases_move_only_with_if_match(filled: TestClient) -> None:
    filled.post("/v1/substructures", json=changed(title="Newer"))
    url = "/v1/substructures/pendulum/aliases/stable"
    assert filled.get(url).status_code == 404
    assert filled.put(url.replace("pendulum", "nothing"), json={"version": 1}).status_code == 404
    assert filled.get("/v1/substructures/nothing/aliases").status_code == 404
    assert filled.put(url, json={"version": 1}, headers={"If-Match": '"1"'}).status_code == 412
    created = filled.put(url, json={"version": 1})
    assert (created.status_code, created.headers["etag"]) == (201, '"1"')
    assert filled.put(url, json={"version": 2}).status_code == 428
    assert filled.put(url, json={"version": 2}, headers={"If-Match": '"7"'}).status_code == 412
    moved = filled.put(url, json={"version": 2}, headers={"If-Match": f"W/{created.headers['etag']}"})
    assert (moved.status_code, moved.headers["etag"]) == (200, '"2"')
    AliasView.model_validate(moved.json())
    assert [change["version"] for change in filled.get(url).json()["history"]] == [2, 1]
    assert len(filled.get("/v1/substructures/pendulum/aliases").json()["items"]) == 1
    assert filled.get("/v1/substructures/pendulum@stable").json()["version"] == 2


@pytest.mark.parametrize(
    ("alias", "body"),
    [("stable", {"version": 9}), ("stable", {"version": "1"}), ("stable", {}), ("1st", {"version": 1})],
)
def test_wrong_aliases(filled: TestClient, rows: Any, alias: str, body: Any) -> None:
    before = rows()
    answer = filled.put(f"/v1/substructures/pendulum/aliases/{alias}", json=body)
    assert answer.status_code == 422
    assert rows() == before


def test_withdrawn_versions_stay_where_they_are_used(filled: TestClient) -> None:
    filled.post("/v1/substructures", json=changed(title="Newer"))
    withdrawn = filled.post("/v1/substructures/pendulum@2/withdraw", json={"reason": "wrong mass"}).json()
    assert (withdrawn["is_withdrawn"], withdrawn["withdrawal_reason"]) == (True, "wrong mass")
    assert filled.get("/v1/substructures/pendulum").json()["version"] == 1
    assert filled.get("/v1/substructures/pendulum@2").json() == withdrawn
    assert filled.post("/v1/substructures/pendulum@2/withdraw").json()["withdrawn_at"] == withdrawn["withdrawn_at"]
    assert filled.post("/v1/substructures/pendulum@1/withdraw").status_code == 200
    assert filled.get("/v1/substructures/pendulum").status_code == 404
    assert filled.post("/v1/substructures", json=changed(title="Third")).json()["version"] == 3
    assert filled.get("/v1/substructures/pendulum").json()["version"] == 3


def test_concurrent_submissions_give_one_version(client: TestClient) -> None:
    codes = at_once(lambda _: client.post("/v1/substructures", json=PENDULUM).status_code, range(8))
    assert sorted(codes) == [200] * 7 + [201]
    assert client.get("/v1/substructures/pendulum").json()["version"] == 1


def test_concurrent_versions_get_different_numbers(client: TestClient) -> None:
    def submit(k: int) -> int:
        return int(client.post("/v1/substructures", json=changed(title=f"Title {k}")).json()["version"])

    assert sorted(at_once(submit, range(8))) == list(range(1, 9))


def test_facets_are_counted_again_after_every_change(filled: TestClient) -> None:
    def tags() -> dict[str, int]:
        found: dict[str, int] = filled.get("/v1/substructures?facets=true").json()["facets"]["tags"]
        return found

    before = tags()
    assert tags() == before
    assert filled.post("/v1/substructures", json={**PENDULUM, "name": "counted", "tags": ["new"]}).status_code == 201
    assert tags() == {**before, "new": 1}
    assert filled.post("/v1/substructures/counted@1/withdraw", json={"reason": "wrong"}).status_code == 200
    assert tags() == before
