"""Versions with their origin, notes, successors and uses; trees that are published as parts."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.store.store import Store

from .conftest import PENDULUM
from .seals import seal_again

PART, TREE = "/v1/substructures", "/v1/trees"
PAIR: dict[str, Any] = {
    "name": "pair",
    "gravity": [0, 0, "-9.81"],
    "instances": [
        {"name": "a", "substructure": "pendulum@1"},
        {"name": "b", "substructure": "pendulum@1", "at": "a.tip", "parameters": {"l": 0.5}},
    ],
}


def stored(client: TestClient, address: str, body: Any, status: int = 201) -> Any:
    answer = client.post(address, json=body)
    assert answer.status_code == status, answer.text
    return answer.json()


def items(client: TestClient, address: str) -> list[Any]:
    """Of all pages, one item each."""
    found, link = [], f"{address}?page_size=1"
    while link:
        page = client.get(link).json()
        found += page["items"]
        link = page["links"]["next"]
    return found


def test_versions_tell_where_they_come_from(filled: TestClient) -> None:
    second = {**PENDULUM, "title": "heavier", "note": "for the new drive", "derived_from": "pendulum"}
    told = stored(filled, PART, second)
    assert (told["version"], told["note"], told["origin"]) == (2, "for the new drive", "definition")
    assert (told["derived_from"], told["tree"], told["successor"]) == ("pendulum@1", None, None)
    assert "note" not in filled.get(f"{PART}/pendulum@2/definition").json()
    again = stored(filled, PART, {**second, "note": "another note"}, 200)
    assert again["note"] == "for the new drive"
    listed = items(filled, f"{PART}/pendulum/versions")
    assert [(each["version"], each["note"], each["is_withdrawn"]) for each in listed] == [
        (2, "for the new drive", False),
        (1, "", False),
    ]
    assert listed[0]["operations"] == told["operations"]
    assert listed[0]["links"]["difference"] == f"{PART}/pendulum@1/difference?to=pendulum@2"
    refused = filled.post(PART, json={**PENDULUM, "title": "x", "derived_from": "pendulam"})
    assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/derived_from")
    assert "did you mean 'pendulum'" in refused.json()["detail"]
    assert len(items(filled, f"{PART}/pendulum/versions")) == 2


def test_a_withdrawn_version_is_told_wherever_it_is_used(filled: TestClient) -> None:
    stored(filled, TREE, PAIR)
    stored(filled, PART, {**PENDULUM, "title": "better"})
    before = filled.get(f"{TREE}/pair@1")
    assert before.json()["withdrawn"] == []
    bad = filled.post(f"{PART}/pendulum@1/withdraw", json={"successor": "pendulum@9"})
    assert (bad.status_code, bad.json()["errors"][0]["pointer"]) == (422, "/successor")
    assert (
        filled.post(f"{PART}/pendulum@1/withdraw", json={"successor": "pendulum@1"}).json()["code"] == "own-successor"
    )
    assert not filled.get(f"{PART}/pendulum@1").json()["is_withdrawn"]
    told = stored(filled, f"{PART}/pendulum@1/withdraw", {"reason": "too light", "successor": "pendulum"}, 200)
    assert (told["is_withdrawn"], told["withdrawal_reason"], told["successor"]) == (True, "too light", "pendulum@2")
    after = filled.get(f"{TREE}/pair@1", headers={"If-None-Match": before.headers["etag"]})
    gone = {"substructure": "pendulum@1", "reason": "too light", "successor": "pendulum@2"}
    assert after.json()["withdrawn"] == [{"instance": name, **gone} for name in "ab"]
    listed = items(filled, f"{PART}/pendulum/versions")
    assert [each["successor"] for each in listed] == [None, "pendulum@2"]


def test_uses(filled: TestClient) -> None:
    stored(filled, TREE, PAIR)
    stored(filled, PART, {**PENDULUM, "name": "copy", "derived_from": "pendulum@1"})
    stored(filled, f"{TREE}/pair@1/publish", {})
    stored(filled, f"{TREE}/pair/couplings", {"name": "c", "substructure": "pendulum", "at": "b.tip"})
    two = {"a": 1, "b": 1}
    expected = [
        ("derived", "copy", 1, {}),
        ("part", "pair", 1, two),
        ("tree", "cell", 1, {"arm": 1}),
        ("tree", "pair", 1, two),
        ("tree", "pair", 2, {**two, "c": 1}),
    ]
    found = [
        tuple(each[name] for name in ("kind", "name", "number", "instances"))
        for each in items(filled, f"{PART}/pendulum/uses")
    ]
    assert found == expected
    assert items(filled, f"{PART}/copy/uses") == []
    assert filled.get(f"{PART}/pendulum@2/uses").status_code == 404


def test_a_tree_becomes_a_part(filled: TestClient) -> None:
    """With a certificate of its own, and mounted twice it does what its instances do, mounted one by one."""
    stored(filled, TREE, PAIR)
    wanted = {"name": "module", "ports": {"end": "b.tip"}, "free": ["b.l"], "note": "as one piece"}
    module = stored(filled, f"{TREE}/pair/publish", wanted)
    assert (module["tree"], module["origin"], module["note"]) == ("pair@1", "tree", "as one piece")
    assert (module["ports"], module["names"]["b.l"], module["parameters"]["b_l"]["value"]) == (["end"], "b_l", 0.5)
    errors = module["certificate"]["direct_form"]["max_relative_error"]
    assert max(x for x in errors.values() if x is not None) < 1e-10
    assert stored(filled, f"{TREE}/pair/publish", wanted, 200)["version"] == 1
    two = [{"name": "x", "substructure": "module"}, {"name": "y", "substructure": "module", "at": "x.end"}]
    stored(filled, TREE, {"name": "two", "gravity": PAIR["gravity"], "instances": two})
    four = [
        *PAIR["instances"],
        {"name": "c", "substructure": "pendulum", "at": "b.tip"},
        {"name": "d", "substructure": "pendulum", "at": "c.tip", "parameters": {"l": 0.5}},
    ]
    stored(filled, TREE, {"name": "four", "gravity": PAIR["gravity"], "instances": four})
    dof = filled.get(f"{TREE}/four").json()["dof"]
    request = {"quantities": ["metric", "forces", "bias"], "q": [0.3] * dof, "qd": [0.1] * dof}
    ours, theirs = (stored(filled, f"{TREE}/{name}/evaluations", request, 200) for name in ("two", "four"))
    for name in request["quantities"]:
        assert ours[name] == pytest.approx(theirs[name], rel=1e-12) if name != "metric" else True
    for row, other in zip(ours["metric"], theirs["metric"], strict=True):
        assert row == pytest.approx(other, rel=1e-12)
    published = stored(filled, f"{TREE}/two/publish", {"name": "module-of-modules"})
    assert published["dof"] == dof


@pytest.mark.parametrize(
    ("body", "pointer", "said"),
    [
        ({"ports": {"end": "b.tup"}}, "/ports/end", "did you mean 'b.tip'"),
        ({"free": ["b.ll"]}, "/free/0", "did you mean 'b.l'"),
        ({"defaults": {"b.l": 3}}, "/defaults/b.l", "name it in 'free'"),
        ({"name": "No Name"}, "/name", "a name here is"),
        ({"portz": {}}, "/portz", "did you mean 'ports'"),
    ],
)
def test_publishing_is_refused_with_place_and_remedy(
    body: dict[str, Any], pointer: str, said: str, filled: TestClient
) -> None:
    stored(filled, TREE, PAIR)
    answer = filled.post(f"{TREE}/pair/publish", json=body)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, pointer), answer.text
    assert said in answer.text
    assert filled.get(f"{PART}/pair").status_code == 404


def test_a_tree_with_closures_becomes_a_part_that_has_them(filled: TestClient) -> None:
    loop = {"name": "loop", "type": "ball", "from": "b.tip", "to": "world"}
    stored(filled, TREE, {**PAIR, "name": "closed", "closures": [loop]})
    stored(filled, f"{TREE}/closed/publish", {"name": "ring"})
    twice = [{"name": "x", "substructure": "ring"}, {"name": "y", "substructure": "ring", "at": "x.b_tip"}]
    found = stored(filled, TREE, {"name": "rings", "gravity": PAIR["gravity"], "instances": twice})
    rows = [(each["name"], each["from"], each["to"]) for each in found["closures"]]
    assert rows == [(f"{x}.loop", f"{x}.b_tip_frame", f"{x}.base") for x in "xy"]
    refused = filled.delete(f"{TREE}/rings/closures/x.loop")
    assert refused.json()["code"] == "unknown-closure"


def test_trees_of_nothing_are_no_parts(filled: TestClient) -> None:
    stored(filled, TREE, {"name": "empty"})
    refused = filled.post(f"{TREE}/empty/publish", json={})
    assert (refused.status_code, refused.json()["errors"][0]["code"]) == (422, "empty-tree")


def test_publishing_by_a_job(filled: TestClient) -> None:
    stored(filled, TREE, PAIR)
    answer = filled.post(f"{TREE}/pair/publish", json={"note": "later"}, headers={"Prefer": "respond-async"})
    assert (answer.status_code, answer.json()["kind"]) == (202, "derive")


def test_ten_thousand_versions(filled: TestClient, store: Store) -> None:
    """The list has pages, the newest one is found, one more is stored, and all of it at once."""
    with store.database.write() as connection:
        digest = connection.exec_driver_sql("SELECT digest FROM versions WHERE name = 'pendulum'").scalar_one()
        columns = [row[1] for row in connection.exec_driver_sql("PRAGMA table_info(parts)") if row[1] != "digest"]
        numbers = "WITH RECURSIVE n(i) AS (SELECT 2 UNION ALL SELECT i + 1 FROM n WHERE i < 10000)"
        copied = (
            f"INSERT INTO parts (digest, {', '.join(columns)}) {numbers} SELECT 'sha256:' || i, {', '.join(columns)}"
        )
        connection.exec_driver_sql(f"{copied} FROM n, parts WHERE digest = '{digest}'")
        row = "INSERT INTO versions (name, version, digest, created)"
        connection.exec_driver_sql(f"{row} {numbers} SELECT 'pendulum', i, 'sha256:' || i, '' FROM n")  # noqa: S608
    seal_again(store.database.file, only=["sha256:10000", "sha256:9999"])
    told = stored(filled, PART, {**PENDULUM, "title": "one more"})
    assert told["version"] == 10_001
    first = filled.get(f"{PART}/pendulum/versions?page_size=1000").json()
    assert [each["version"] for each in first["items"]] == list(range(10_001, 9_001, -1))
    following = filled.get(first["links"]["next"]).json()
    assert following["items"][0]["version"] == 9_001
    for number in (10_001, 10_000):
        stored(filled, f"{PART}/pendulum@{number}/withdraw", {}, 200)
    assert filled.get(f"{PART}/pendulum").json()["version"] == 9_999


def test_differences(filled: TestClient) -> None:
    document = {**PENDULUM, "parameters": {**PENDULUM["parameters"], "m": {"value": 2.1, "unit": "kg"}}}
    stored(filled, PART, document)
    told = filled.get(f"{PART}/pendulum@1/difference?to=pendulum").json()
    assert (told["a"], told["b"], told["same"]) == ("pendulum@1", "pendulum@2", False)
    assert told["words"] == ["parameter m 2 -> 2.1 kg: changes 1 of 1 entries of M, at most 5 %"]
    assert told["definition"][0]["place"] == "/parameters/m/value"
    assert {"equal": 1, "moved": 1}.items() <= told["quantities"]["metric"].items()
    other = filled.get(f"{PART}/pendulum/difference?to=slider").json()
    assert any("body" in words for words in other["words"])
    stored(filled, TREE, PAIR)
    stored(filled, f"{TREE}/pair/couplings", {"name": "c", "substructure": "pendulum@1", "at": "b.tip"})
    trees = filled.get(f"{TREE}/pair@1/difference?to=pair@2")
    size, mounted = trees.json()["words"]
    assert size == "coordinates 2 -> 3 (c.q new), compared in a.q, b.q"
    assert mounted.startswith("instance c is new: changes ")
    assert "immutable" in trees.headers["cache-control"]
    stored(filled, TREE, {**PAIR, "instances": [{**PAIR["instances"][0], "substructure": "pendulum@2"}]})
    nested = filled.get(f"{TREE}/pair@1/difference?to=pair@3").json()
    assert "/instances/a/definition/parameters/m/value" in [each["place"] for each in nested["definition"]]
    assert "instance a: pendulum version 1 -> 2" in nested["words"]
    assert "in instance a: parameter m 2 -> 2.1 kg" in nested["words"]
    assert not any("sha256" in words for words in nested["words"])


def test_levels_and_their_errors(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """M = m l^2 + m l^2/10; without the second term it is wrong by 1/11 of itself. Links lead there and back."""
    rod = {name: x for name, x in PENDULUM["bodies"][0].items() if name != "inertia"}
    point = {**PENDULUM, "name": "point", "bodies": [rod], "derived_from": "pendulum@1"}
    stored(filled, PART, point)
    heavier = {**PENDULUM, "parameters": {**PENDULUM["parameters"], "m": {"value": 3, "unit": "kg"}}}
    stored(filled, PART, {**heavier, "name": "heavier", "derived_from": "pendulum@1"})  # a correction is no level
    answer = filled.get(f"{PART}/pendulum/levels").json()
    (short,) = answer["items"]
    assert (answer["states"], answer["range"]) == (16, [-1.5, 1.5])
    assert [short[name] for name in ("name", "version", "level", "dof")] == ["point", 1, "abbreviated", 1]
    assert short["error"]["metric"] == pytest.approx(1 / 11, rel=1e-12)
    assert short["rms"]["metric"] == pytest.approx(1 / 11, rel=1e-12)  # at all states
    assert "composite.m" not in short["error"]  # both have the same mass
    assert filled.get(short["links"]["difference"]).json()["quantities"]["metric"]["change"] == short["error"]["metric"]
    (full,) = filled.get(short["links"]["levels"]).json()["items"]
    assert [full[name] for name in ("name", "version", "level", "error")] == ["pendulum", 1, "full", short["error"]]
    assert full["links"]["difference"] == short["links"]["difference"]
    assert filled.get(full["links"]["self"]).json()["links"]["levels"] == full["links"]["levels"]
    for name, other in (("pendulum", "point"), ("point", "pendulum")):
        shown = filled.get(f"/substructures/{name}").text.partition('id="levels"')[2].partition("</table>")[0]
        assert f'href="/substructures/{other}@1"' in shown
        assert "M 9.1 % (9.1 %)" in shown
        assert "at 16 states, q and q&#x27; from -1.5 to 1.5" in shown.replace("&#39;", "&#x27;")
    with monkeypatch.context() as large:
        large.setattr("service.pages.model.routes.MOST_COMPARED", 0)  # then the page does not wait for the numbers
        shown = filled.get("/substructures/point").text.partition('id="levels"')[2].partition("</table>")[0]
    assert 'href="/substructures/pendulum@1/difference?to=point@1">what changed</a>' in shown
    stored(filled, f"{PART}/point@1/withdraw", {}, 200)
    assert filled.get(f"{PART}/pendulum/levels").json()["items"] == []
    assert filled.get(f"{PART}/nothing/levels").status_code == 404


def test_a_level_of_fewer_coordinates(filled: TestClient) -> None:
    """Held at q2 = 0, M_11 = 6.4 + 4 cos q2 is 10.4 for ever; entries of q2 are no part of the error."""
    outer = {**PENDULUM["bodies"][0], "name": "outer", "parent": "rod"}
    place = {"d": "l", "type": "revolute", "coordinate": "q2"}
    double = {**PENDULUM, "name": "double", "bodies": [PENDULUM["bodies"][0], {**outer, "joint": place}], "ports": []}
    stored(filled, PART, double)
    held = {**double, "bodies": [double["bodies"][0], {**outer, "joint": {**place, "type": "fixed"}}]}
    del held["bodies"][1]["joint"]["coordinate"]
    stored(filled, PART, {**held, "name": "held", "derived_from": "double"})
    (short,) = filled.get(f"{PART}/double/levels").json()["items"]
    assert [short[name] for name in ("level", "dof")] == ["reduced", 1]
    assert 0.1 < short["error"]["metric"] <= 8 / 10.4
    assert short["error"]["metric"] / 4 < short["rms"]["metric"] < short["error"]["metric"]
    assert "M " in filled.get("/substructures/double").text.partition('id="levels"')[2].partition("</table>")[0]


def test_a_withdrawn_part_is_told_two_levels_up(filled: TestClient) -> None:
    stored(filled, TREE, PAIR)
    stored(filled, f"{TREE}/pair/publish", {"name": "module"})
    stored(filled, TREE, {"name": "cell2", "instances": [{"name": "m", "substructure": "module"}]})
    stored(filled, f"{TREE}/cell2/publish", {"name": "cell2-part"})
    known = filled.get(f"{TREE}/cell2").headers["etag"]
    stored(filled, f"{PART}/pendulum@1/withdraw", {"reason": "too light"}, 200)
    for address in (f"{TREE}/cell2", f"{TREE}/cell2@1", f"{PART}/cell2-part"):
        gone = filled.get(address, headers={"If-None-Match": known}).json()["withdrawn"]
        assert [(each["instance"], each["substructure"]) for each in gone] == [
            ("m.a", "pendulum@1"),
            ("m.b", "pendulum@1"),
        ]


def test_differences_that_cannot_be_told(filled: TestClient) -> None:
    assert filled.get(f"{PART}/pendulum/difference").status_code == 422
    assert filled.get(f"{PART}/nothing/difference?to=pendulum").status_code == 404
    for address in (f"{PART}/pendulum/difference?to=pendulun", f"{TREE}/cell/difference?to=cel"):
        refused = filled.get(address)
        assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/query/to")
        assert "did you mean" in refused.json()["detail"]


def test_pages(filled: TestClient) -> None:
    stored(filled, TREE, PAIR)
    stored(filled, PART, {**PENDULUM, "title": "better", "note": "for <b>you</b>"})
    stored(filled, f"{TREE}/pair/publish", {"name": "module"})
    stored(filled, f"{PART}/pendulum@1/withdraw", {"reason": "too light", "successor": "pendulum@2"}, 200)
    part = filled.get("/substructures/pendulum@1").text
    assert "for &lt;b&gt;you&lt;/b&gt;" in part
    assert 'href="/substructures/pendulum@1/difference?to=pendulum@2"' in part
    assert "too light; take <a href=" in part
    assert 'href="/trees/pair@1"' in part
    gone = filled.get(f"{PART}/module").json()["withdrawn"]
    assert [(each["instance"], each["successor"]) for each in gone] == [("a", "pendulum@2"), ("b", "pendulum@2")]
    for address in ("/trees/pair", "/substructures/module"):
        assert "is withdrawn: too light; take " in filled.get(address).text
    assert "title" in filled.get("/substructures/pendulum@1/difference?to=pendulum@2").text
    stored(filled, f"{TREE}/pair/couplings", {"name": "c", "substructure": "pendulum", "at": "b.tip"})
    assert "instance c is new" in filled.get("/trees/pair@1/difference?to=pair@2").text
