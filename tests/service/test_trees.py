"""``/v1/trees`` and couplings (HTTP contract, section 3)."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.schemas.resources import TreePage, TreeView

from .conftest import HAND, PENDULUM, SLIDER, TREE, at_once, plain_tag

TREE_FIELDS = {
    "name", "revision", "digest", "dof", "coordinates", "parameters", "instances", "operations", "certificate", "links",
}  # fmt: skip


def test_create(filled: TestClient) -> None:
    tree = filled.get("/v1/trees/cell@1").json()
    TreeView.model_validate(tree)
    assert tree.keys() >= TREE_FIELDS
    assert (tree["name"], tree["revision"], tree["dof"], tree["coordinates"]) == ("cell", 1, 1, ["arm.q"])
    assert tree["parameters"]["g"] == {"value": 9.81, "unit": "m/s^2", "description": ""}
    assert set(tree["parameters"]) == {"g", "arm.l", "arm.m"}


def test_references_are_pinned(filled: TestClient) -> None:
    before = filled.get("/v1/trees/cell@1").json()
    digest = filled.get("/v1/substructures/pendulum").json()["digest"]
    assert before["instances"][0]["substructure"] == f"pendulum@{digest}"
    filled.post("/v1/substructures", json={**PENDULUM, "title": "Newer"})
    assert filled.get("/v1/trees/cell@1").json() == before
    assert filled.post("/v1/trees", json=before_spec(before)).status_code == 200


def before_spec(tree: dict[str, Any]) -> dict[str, Any]:
    return {**TREE, "instances": tree["instances"]}


def test_creating_the_same_tree_again_changes_nothing(filled: TestClient, rows: Any) -> None:
    before = rows()
    answer = filled.post("/v1/trees", json=TREE)
    assert (answer.status_code, answer.headers["location"]) == (200, "/v1/trees/cell@1")
    assert rows() == before


def test_coupling_makes_a_revision(filled: TestClient) -> None:
    first = filled.get("/v1/trees/cell@1").json()
    answer = filled.post("/v1/trees/cell/couplings", json=HAND)
    assert (answer.status_code, answer.headers["location"]) == (201, "/v1/trees/cell@2")
    second = answer.json()
    assert (second["revision"], second["based_on"], second["dof"]) == (2, 1, 2)
    assert second["coordinates"] == ["arm.q", "hand.q"]
    assert "hand.m" not in second["parameters"]
    assert filled.get("/v1/trees/cell").json() == second
    assert filled.get("/v1/trees/cell@1").json() == first
    assert filled.get(f"/v1/trees/cell@{second['digest']}").json() == second


def test_removing_gives_back_the_old_content(filled: TestClient) -> None:
    first = filled.get("/v1/trees/cell@1").json()
    filled.post("/v1/trees/cell/couplings", json=HAND)
    answer = filled.delete("/v1/trees/cell/couplings/hand")
    assert answer.status_code == 201
    third = answer.json()
    assert (third["revision"], third["based_on"], third["digest"]) == (3, 2, first["digest"])
    assert third["program"] == first["program"]


def test_a_carrier_cannot_be_removed(filled: TestClient, rows: Any) -> None:
    filled.post("/v1/trees/cell/couplings", json=HAND)
    before = rows()
    answer = filled.delete("/v1/trees/cell/couplings/arm")
    assert answer.status_code == 409
    assert "hand" in answer.json()["detail"]
    assert filled.delete("/v1/trees/cell/couplings/nobody").status_code == 404
    assert filled.delete("/v1/trees/nothing/couplings/arm").status_code == 404
    assert rows() == before


def test_an_instance_gets_another_part_and_keeps_what_it_carries(filled: TestClient) -> None:
    cart = {"name": "cart", "substructure": "slider", "at": "hand.tip"}
    for body in (HAND, cart):
        assert filled.post("/v1/trees/cell/couplings", json=body).status_code == 201
    longer = {**PENDULUM, "name": "longer", "parameters": {**PENDULUM["parameters"], "l": {"value": 2, "unit": "m"}}}
    assert filled.post("/v1/substructures", json=longer).status_code == 201
    answer = filled.patch("/v1/trees/cell/couplings/hand", json={"substructure": "longer", "parameters": None})
    assert answer.status_code == 201, answer.text
    made = answer.json()
    assert (made["revision"], made["based_on"], made["coordinates"]) == (4, 3, ["arm.q", "hand.q", "cart.x"])
    hand = {**{name: x for name, x in HAND.items() if name != "parameters"}, "substructure": "longer"}
    tree = {**TREE, "name": "other", "instances": [*TREE["instances"], hand, cart]}
    assert filled.post("/v1/trees", json=tree).json()["program"] == made["program"]


def test_an_instance_is_moved_and_moved_back(filled: TestClient) -> None:
    before = filled.post("/v1/trees/cell/couplings", json=HAND).json()
    for at, digest in (("world", None), (HAND["at"], before["digest"])):
        moved = filled.patch("/v1/trees/cell/couplings/hand", json={"at": at}).json()
        assert moved["instances"][-1].get("at", "world") == at
        assert digest in (None, moved["digest"])


@pytest.mark.parametrize("base", ["cell", "cell@1"])
def test_a_change_of_nothing_is_no_revision(filled: TestClient, rows: Any, base: str) -> None:
    filled.post("/v1/trees/cell@1/couplings", json=HAND)
    first, before = filled.get(f"/v1/trees/{base}"), rows()
    for body in ({}, {"at": "world"}):
        answer = filled.patch(f"/v1/trees/{base}/couplings/arm", json=body)
        assert (answer.status_code, answer.content) == (200, first.content)
        assert answer.headers["location"] == f"/v1/trees/cell@{first.json()['revision']}"
    assert rows() == before


@pytest.mark.parametrize(
    ("instance", "body", "status", "pointer"),
    [
        ("nobody", {"at": "world"}, 404, None),
        ("hand", {"at": "hand.tip"}, 422, "/at"),
        ("hand", {"substructure": "nothing"}, 422, "/substructure"),
        ("hand", {"substructure": None}, 422, ""),
        ("hand", {"name": "other"}, 422, "/name"),
        ("hand", {"weight": 3}, 422, "/weight"),
        ("hand", [1], 422, ""),
        ("arm", {"substructure": "slider"}, 422, "/instances/1/at"),  # of which the hand's place is none
    ],
)
def test_what_an_instance_cannot_become_changes_nothing(
    filled: TestClient, rows: Any, instance: str, body: Any, status: int, pointer: str | None
) -> None:
    filled.post("/v1/trees/cell/couplings", json=HAND)
    before = rows()
    answer = filled.patch(f"/v1/trees/cell/couplings/{instance}", json=body)
    assert answer.status_code == status, answer.text
    assert pointer is None or [each["pointer"] for each in answer.json()["errors"]] == [pointer]
    assert rows() == before


def test_inline_definition(filled: TestClient) -> None:
    instance = {"name": "cart", "definition": {**SLIDER, "name": "never-submitted"}, "at": "world"}
    answer = filled.post("/v1/trees", json={"name": "inline", "instances": [instance]})
    assert answer.status_code == 201, answer.text
    assert filled.get("/v1/substructures/never-submitted").status_code == 404
    coupled = filled.post(
        "/v1/trees/inline/couplings", json={"name": "p", "substructure": "pendulum", "at": "cart.top"}
    )
    assert coupled.json()["coordinates"] == ["cart.x", "p.q"]
    submitted = filled.post("/v1/substructures", json={**SLIDER, "name": "never-submitted"})
    assert submitted.status_code == 201


def test_every_level_can_be_mounted_on(filled: TestClient) -> None:
    for at in ("world", "arm.rod", "arm.tip"):
        body = {"name": f"on_{at.replace('.', '_')}", "substructure": "slider", "at": at}
        assert filled.post("/v1/trees/cell/couplings", json=body).status_code == 201
    assert filled.get("/v1/trees/cell").json()["dof"] == 4


def test_old_revisions_can_be_branched(filled: TestClient) -> None:
    filled.post("/v1/trees/cell/couplings", json=HAND)
    answer = filled.post("/v1/trees/cell@1/couplings", json={"name": "cart", "substructure": "slider", "at": "arm.tip"})
    assert (answer.json()["revision"], answer.json()["based_on"]) == (3, 1)
    assert answer.json()["coordinates"] == ["arm.q", "cart.x"]


def test_concurrent_couplings_lose_nothing(filled: TestClient) -> None:
    names = [f"s{k}" for k in range(6)]

    def couple(name: str) -> int:
        body = {"name": name, "substructure": "slider", "at": "arm.tip"}
        return filled.post("/v1/trees/cell/couplings", json=body).status_code

    assert at_once(couple, names) == [201] * 6
    tree = filled.get("/v1/trees/cell").json()
    assert tree["revision"] == 7
    assert {instance["name"] for instance in tree["instances"]} == {"arm", *names}


def test_if_match_guards_against_other_changes(filled: TestClient) -> None:
    # a list, of which a proxy has made one that it compresses
    seen = {"If-Match": f'"other", W/{plain_tag(filled, "/v1/trees/cell")}'}
    assert filled.post("/v1/trees/cell/couplings", json=HAND, headers=seen).status_code == 201
    for answer in (
        filled.post("/v1/trees/cell/couplings", json={**HAND, "name": "other"}, headers=seen),
        filled.delete("/v1/trees/cell/couplings/hand", headers=seen),
    ):
        assert (answer.status_code, answer.json()["code"]) == (412, "precondition-failed")
        assert answer.headers["etag"] == plain_tag(filled, "/v1/trees/cell")


def test_what_a_new_revision_and_a_removal_expect(filled: TestClient) -> None:
    def refused(answer: Any) -> bool:
        return (answer.status_code, answer.json()["code"]) == (412, "precondition-failed")

    old = plain_tag(filled, "/v1/trees/cell")
    coupled = filled.post("/v1/trees/cell/couplings", json=HAND, headers={"If-Match": old})
    tag = coupled.headers["etag"]
    assert tag == plain_tag(filled, "/v1/trees/cell") != old
    other = {**TREE, "gravity": [0, 0, -1]}
    for prefer in ({}, {"Prefer": "respond-async"}):
        assert refused(filled.post("/v1/trees", json=other, headers={"If-Match": old, **prefer}))
        assert refused(filled.post("/v1/trees", json=other, headers={"If-None-Match": "*", **prefer}))
    assert refused(filled.post("/v1/trees", json={**TREE, "name": "no-cell"}, headers={"If-Match": "*"}))
    assert refused(filled.delete("/v1/trees/cell", headers={"If-Match": old}))
    assert filled.get("/v1/trees/cell").json()["revision"] == 2
    made = filled.post("/v1/trees", json=other, headers={"If-Match": tag})
    assert (made.status_code, made.json()["revision"], made.json()["based_on"]) == (201, 3, 2)
    assert filled.delete("/v1/trees/cell", headers={"If-Match": made.headers["etag"]}).status_code == 204
    again = filled.post("/v1/trees", json=TREE, headers={"If-None-Match": "*"})
    assert (again.status_code, again.json()["revision"], again.json()["based_on"]) == (201, 4, None)


def test_a_tree_takes_other_gravity_and_parameters(filled: TestClient) -> None:
    moon = {"gravity": [0, {"value": "-1.62", "unit": "m/s^2"}, 0]}
    tag = plain_tag(filled, "/v1/trees/cell")
    changed = filled.patch("/v1/trees/cell", json=moon, headers={"If-Match": tag})
    assert (changed.status_code, changed.json()["revision"], changed.json()["based_on"]) == (201, 2, 1)
    made = filled.get("/v1/trees/cell").json()
    assert made["gravity"] == [0, {"unit": "m/s^2", "value": "-1.62"}, 0]
    assert made["instances"] == filled.get("/v1/trees/cell@1").json()["instances"]
    state = {"q": [0.0], "quantities": ["gravity"]}
    on_the_moon = filled.post("/v1/trees/cell/evaluations", json=state).json()["gravity"]
    assert on_the_moon == [pytest.approx(-2 * 1.62)]  # m g l cos q
    assert filled.patch("/v1/trees/cell", json=moon, headers={"If-Match": tag}).status_code == 412
    assert filled.patch("/v1/trees/cell", json=moon).status_code == 200, "nothing has changed"
    gone = filled.patch("/v1/trees/cell", json={"gravity": None, "parameters": {"h": {"value": 1}}})
    assert (gone.status_code, set(gone.json()["parameters"])) == (201, {"h", "arm.l", "arm.m"})
    assert "gravity-not-given" in {each["code"] for each in gone.json()["certificate"]["warnings"]}
    for wrong, code in (
        ({"name": "other"}, "extra-forbidden"),
        ({"instances": []}, "extra-forbidden"),
        ({"gravity": [0, 0]}, "missing"),
        ({"gravity": [0, 0, "-k"]}, "unknown-name"),
        ([], "object-expected"),
    ):
        answer = filled.patch("/v1/trees/cell", json=wrong)
        assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, code), answer.text
    assert filled.patch("/v1/trees/none", json=moon).status_code == 404


def test_of_those_that_expect_no_tree_one_makes_it(filled: TestClient) -> None:
    def make(k: int) -> int:
        document = {**TREE, "name": "first", "gravity": [0, 0, -k]}
        return filled.post("/v1/trees", json=document, headers={"If-None-Match": "*"}).status_code

    assert sorted(at_once(make, range(1, 6))) == [201] + 4 * [412]
    assert filled.get("/v1/trees/first").json()["revision"] == 1


def test_list(filled: TestClient) -> None:
    for k in range(4):
        filled.post("/v1/trees", json={**TREE, "name": f"t{k}"})
    found, url = [], "/v1/trees?page_size=2"
    while url:
        page = filled.get(url).json()
        TreePage.model_validate(page)
        found += [item["name"] for item in page["items"]]
        url = page["links"]["next"]
    assert found == ["cell", "t0", "t1", "t2", "t3"]


@pytest.mark.parametrize(
    ("change", "pointer", "culprit"),
    [
        ({"at": "arm.nowhere"}, "/at", "nowhere"),
        ({"at": "nobody.tip"}, "/at", "nobody"),
        ({"substructure": "nothing"}, "/substructure", "nothing"),
        ({"substructure": "pendulum@7"}, "/substructure", "pendulum@7"),
        ({"name": "arm"}, "/name", "arm"),
        ({"name": "1x"}, "/name", ""),
        ({"parameters": {"mass": 1}}, "/parameters/mass", "mass"),
        ({"parameters": {"m": "arm.m +"}}, "/parameters/m", "column"),
        ({"parameters": {"m": "arm.nothing"}}, "/parameters/m", "nothing"),
        ({"parameters": {"m": "hand.m"}}, "/parameters/m", "hand.m"),
        ({"placement": {"position": [0, 0]}}, "/placement/position/2", "missing"),
        ({"unknown": 1}, "/unknown", ""),
    ],
)
def test_wrong_couplings(filled: TestClient, rows: Any, change: dict[str, Any], pointer: str, culprit: str) -> None:
    before = rows()
    answer = filled.post("/v1/trees/cell/couplings", json={**HAND, **change})
    assert answer.status_code == 422, answer.text
    errors = answer.json()["errors"]
    assert [error["pointer"] for error in errors] == [pointer]
    assert culprit in errors[0]["message"]
    assert rows() == before


def test_hosts_in_a_cycle(filled: TestClient, rows: Any) -> None:
    before = rows()
    instances = [{"name": a, "substructure": "pendulum", "at": f"{b}.tip"} for a, b in (("a", "b"), ("b", "a"))]
    answer = filled.post("/v1/trees", json={"name": "loop", "instances": instances})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"] == "/instances/0/at"
    assert rows() == before


def test_an_instance_may_be_called_t(filled: TestClient) -> None:
    """The time is ``t``, what belongs to an instance of this name ``t.<name>``: they are never taken for each other."""
    slow = {**SLIDER, "name": "driven", "loads": [{"type": "joint", "coordinate": "x", "force": "3*t"}]}
    assert filled.post("/v1/substructures", json=slow).status_code == 201
    body = {"name": "clock", "gravity": [0, 0, 0], "instances": [{"name": "t", "substructure": "driven"}]}
    tree = filled.post("/v1/trees", json=body)
    assert tree.status_code == 201, tree.text
    assert tree.json()["coordinates"] == ["t.x"]
    request = {"quantities": ["forces"], "q": [0.5], "t": 2, "parameters": {"t.k": 4}, "inputs": {"tau.t.x": 1}}
    # tau + 3 t - k x
    assert filled.post("/v1/trees/clock/evaluations", json=request).json()["forces"] == [5.0]
    text = filled.get("/v1/trees/clock/forces", params={"format": "text"}).text
    assert "are of instance t\n" in text
    assert "forces[1] = tau_x + 3*t - k*x\n" in text
    text = filled.get("/v1/trees/clock/forces", params={"format": "text", "form": "compact"}).text
    assert "forces[1] = 3*t + tau_x - k*x" in text
    motion = {"q": [0], "span": [0, 1], "parameters": {"t.k": 0}, "inputs": {"tau.t.x": "t.x' - t.x'"}}
    found = filled.post("/v1/trees/clock/simulations", json=motion).json()
    assert found["q"][-1][0] == pytest.approx(3 / 0.5 / 6, rel=1e-8)  # m x'' = 3 t
