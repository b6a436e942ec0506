"""Contacts over HTTP: a ball that comes to rest, and where there are none."""

from __future__ import annotations

import io
import zipfile
from typing import Any

import pytest
from contact_models import BALL
from fastapi.testclient import TestClient

FLOOR = {"name": "floor", "point": "b.body", "restitution": 0.8}
BODY = {"q": [1], "span": [0, 5], "count": 11, "contacts": [FLOOR]}


@pytest.fixture
def address(client: TestClient) -> str:
    tree = {"name": "toss", "gravity": [0, 0, -9.81], "instances": [{"name": "b", "definition": BALL}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    return "/v1/trees/toss"


def test_a_ball_comes_to_rest(client: TestClient, address: str) -> None:
    found = client.post(f"{address}/simulations", json=BODY)
    assert (found.status_code, found.headers["Trajectory-Right"]) == (200, "true")
    answer = found.json()
    first, *_, last = answer["events"]
    assert {"name", "kind", "t", "q", "qd", "after", "impulse", "energy_change"} == set(first)
    assert (first["name"], first["kind"], last["kind"]) == ("floor", "impact", "slip")
    assert answer["series"]["contact_forces"][-1] == [pytest.approx([2 * 9.81, 0, 0])]
    names = {check["name"] for check in answer["checks"]}
    assert {"penetration", "contacts", "impact-energy", "impacts"} <= names
    table = client.post(f"{address}/simulations", json=BODY, headers={"Accept": "text/csv"})
    assert "contact_forces.1" in table.text.splitlines()[0]


def stored(client: TestClient, *contacts: dict[str, Any], **more: Any) -> Any:
    """The answer to a tree with contacts of its own."""
    tree = {"name": "bouncy", "gravity": [0, 0, -9.81], "instances": [{"name": "b", "definition": BALL}]}
    return client.post("/v1/trees", json=tree | {"contacts": list(contacts)} | more)


def test_contacts_of_a_tree_are_in_its_simulations(client: TestClient, address: str) -> None:
    own = FLOOR | {"rest_velocity": {"value": 0.1, "unit": "mm/s"}}
    made = stored(client, own)
    assert made.status_code == 201, made.text
    assert made.json()["contacts"] == [
        {"name": "floor", "point": "b.body", "restitution": "0.8", "rest_velocity": "0.0001"}
    ]
    body = {name: x for name, x in BODY.items() if name != "contacts"}
    found = client.post("/v1/trees/bouncy/simulations", json=body)
    assert (found.status_code, found.headers["Trajectory-Right"]) == (200, "true")
    with_its_own, as_asked = found.json(), client.post(f"{address}/simulations", json=BODY).json()
    for name in ("q", "qd", "events"):
        assert with_its_own[name] == as_asked[name]
    assert {check["name"] for check in with_its_own["checks"]} == {check["name"] for check in as_asked["checks"]}
    other = client.post("/v1/trees/bouncy/simulations", json=BODY | {"contacts": [FLOOR | {"friction": 0.5}]})
    fault = other.json()["errors"][0]
    assert (other.status_code, fault["pointer"], fault["code"]) == (422, "/contacts", "has-contacts")
    assert "<h2>Contacts</h2>" in client.get("/trees/bouncy").text


def test_every_member_of_an_ensemble_has_contacts(client: TestClient, address: str) -> None:
    body = BODY | {"q": [[1], [-1], [2]], "relative_tolerance": 1e-10, "absolute_tolerance": 1e-12}
    found = client.post(f"{address}/ensembles", json=body)
    assert found.status_code == 200, found.text
    answer = found.json()
    assert (answer["one_by_one"], answer["right"], answer["failed"]) == (True, 2, 1)
    assert [failure["member"] for failure in answer["failures"]] == [1]
    alone = client.post(f"{address}/simulations", json=BODY).json()
    assert answer["q"][0] == alone["q"]
    hits = [event for event in alone["events"] if event["kind"] == "impact"]
    assert answer["impacts"][0] == len(hits)
    assert answer["energy_change"][0] == pytest.approx(sum(hit["energy_change"] for hit in hits), rel=1e-12)
    told = answer["events"][0]
    assert (told["member"], told["name"], told["kind"], told["t"]) == (0, "floor", "impact", hits[0]["t"])
    bounce = {"name": "bounce", "quantity": "b.z", "direction": "falling", "reset": {"b.z'": "-b.z'"}}
    jumps = client.post(
        f"{address}/ensembles", json=BODY | {"contacts": [], "events": [bounce], "q": [[1], [2]]}
    ).json()
    assert (jumps["is_right"], jumps["impacts"]) == (True, [0, 0])
    plain = client.post(f"{address}/ensembles", json={"q": [[1], [2]], "span": [0, 1]}).json()
    assert plain["one_by_one"] is False


@pytest.mark.parametrize(
    ("contact", "more", "pointer", "code"),
    [
        ({"point": "b.bdy"}, {}, "/contacts/0/point", "unknown-frame"),
        ({"restitution": 2}, {}, "/contacts/0/restitution", "less-than-equal"),
        ({"restitution": "e"}, {}, "/contacts/0", "number-expected"),
        ({"force": 2}, {}, "/contacts/0/force", "extra-forbidden"),
        ({"point": "b.base"}, {}, "/contacts/0", "immovable"),
        ({"when": "b.z"}, {}, "/contacts/0/when", "not-a-comparison"),
        ({"rest_velocity": {"value": 1, "unit": "m"}}, {}, "/contacts/0/rest_velocity", "unit-mismatch"),
        ({}, {"ignored": {"b.z": 1}}, "/ignored", "not-supported"),
        (
            {},
            {"velocity_constraints": [{"type": "linear", "name": "c", "expression": "b.z'"}]},
            "/contacts",
            "not-supported",
        ),
    ],
)
def test_contacts_that_are_none_are_refused_with_the_tree(
    client: TestClient, contact: dict[str, Any], more: dict[str, Any], pointer: str, code: str
) -> None:
    found = stored(client, FLOOR | contact, **more)
    assert found.status_code == 422
    fault = found.json()["errors"][0]
    assert (fault["pointer"], fault["code"]) == (pointer, code), fault


@pytest.mark.parametrize("version", ["3.0", "2.0"])
def test_an_fmu_has_contacts(client: TestClient, version: str) -> None:
    assert stored(client, FLOOR).status_code == 201
    found = client.get(f"/v1/trees/bouncy/export?target=fmu&fmi={version}")
    assert found.status_code == 200, found.text
    packed = zipfile.ZipFile(io.BytesIO(found.content))
    assert "sources/contacts.c" in packed.namelist()
    assert "contact.floor.gap" in packed.read("modelDescription.xml").decode()


def test_an_fmu_has_both_tangents(client: TestClient) -> None:
    assert stored(client, FLOOR | {"friction": 0.5}).status_code == 201
    found = client.get("/v1/trees/bouncy/export?target=fmu")
    assert found.status_code == 200, found.text
    with zipfile.ZipFile(io.BytesIO(found.content)) as packed:
        assert b'"contact.floor.friction_force_y"' in packed.read("modelDescription.xml")


@pytest.mark.parametrize("path", ["publish", "linearisations", "forward_dynamics", "export?target=simulink"])
def test_what_would_pass_through_the_floor_says_so(client: TestClient, path: str) -> None:
    assert stored(client, FLOOR).status_code == 201
    address = f"/v1/trees/bouncy/{path}"
    is_read = path in ("forward_dynamics", "export?target=simulink")
    found = client.get(address) if is_read else client.post(address, json={} if path == "publish" else {"q": [1]})
    assert found.status_code == 422
    fault = found.json()["errors"][0]
    assert (fault["code"], "'floor'" in fault["message"]) == ("has-contacts", True), fault


@pytest.mark.parametrize(
    ("name", "more", "pointer", "code"),
    [
        ("simulations", {"contacts": [FLOOR | {"point": "b.bdy"}]}, "/contacts/0/point", "unknown-frame"),
        ("simulations", {"contacts": [FLOOR | {"restitution": 2}]}, "/contacts/0/restitution", "less-than-equal"),
        ("simulations", {"contacts": [FLOOR | {"force": 2}]}, "/contacts/0/force", "extra-forbidden"),
        ("simulations", {"contacts": [FLOOR, FLOOR | {"plane": "b.body"}]}, "/contacts/1/plane", "same-frame"),
        ("simulations", {"contacts": [FLOOR | {"point": "b.base"}]}, "/contacts/0", "immovable"),
        ("simulations", {"q": [-1]}, "/q", "penetration"),
        ("simulations", {"method": "BDF"}, "/method", "not-supported"),
        ("simulations", {"fixed_step": {"step": 0.1}}, "/fixed_step", "not-supported"),
        ("simulations", {"reactions": True}, "/reactions", "not-supported"),
        ("simulations", {"powers": True}, "/powers", "not-supported"),
        ("simulations", {"geodesic": True}, "/contacts", "not-supported"),
        ("simulations", {"friction": "loaded"}, "/friction", "not-supported"),
        ("simulations", {"prescribed": {"b.z": "t"}}, "/contacts", "extra-forbidden"),
        ("sensitivities", {"of_start": True}, "/contacts", "not-supported"),
        ("ensembles", {"contacts": [FLOOR | {"point": "b.bdy"}]}, "/contacts/0/point", "unknown-frame"),
        (
            "ensembles",
            {"columns": {"x": {"expression": "b.z", "take": "integral"}}},
            "/columns/x/take",
            "not-supported",
        ),
        (
            "ensembles",
            {"constraints": [{"type": "linear", "name": "c", "expression": "b.z'"}]},
            "/contacts",
            "not-supported",
        ),
    ],
)
def test_where_there_are_none(
    client: TestClient, address: str, name: str, more: dict[str, Any], pointer: str, code: str
) -> None:
    found = client.post(f"{address}/{name}", json=BODY | more)
    assert found.status_code == 422
    faults = {fault["pointer"]: fault["code"] for fault in found.json()["errors"]}
    assert faults.get(pointer) == code


def test_bodies_that_turn_by_quaternions_have_contacts(client: TestClient) -> None:
    """Of the tree, of an ensemble and in an FMU; `reactions` are refused as elsewhere."""
    turns = {"bodies": [{**BALL["bodies"][0], "joint": {"type": "floating"}, "inertia": {"xx": 1, "yy": 2, "zz": 3}}]}
    tree = {"name": "spun", "gravity": [0, 0, -9.81], "instances": [{"name": "b", "definition": {**BALL, **turns}}]}
    made = client.post("/v1/trees", json=tree)
    assert made.status_code == 201, made.text
    state = {"q": [0, 0, 1, 1, 0, 0, 0], "qd": [0, 0, 0, 1, 2, 3]}
    given = client.post("/v1/trees/spun/simulations", json=BODY | state)
    assert (given.status_code, given.headers["Trajectory-Right"]) == (200, "true"), given.text
    assert client.patch("/v1/trees/spun", json={"contacts": [FLOOR]}).status_code == 201
    body = {name: x for name, x in BODY.items() if name != "contacts"} | state
    found = client.post("/v1/trees/spun/simulations", json=body)
    assert (found.status_code, found.headers["Trajectory-Right"]) == (200, "true"), found.text
    answer = found.json()
    assert len(answer["positions"]) == 7
    for name in ("q", "qd", "events"):
        assert answer[name] == given.json()[name]
    many = client.post("/v1/trees/spun/ensembles", json=body | {"q": [state["q"]] * 2})
    assert (many.status_code, many.json()["is_right"]) == (200, True), many.text
    assert many.json()["q"][1][-1] == pytest.approx(answer["q"][-1], abs=1e-7)
    packed = client.get("/v1/trees/spun/export?target=fmu")
    assert packed.status_code == 200, packed.text
    refused = client.post("/v1/trees/spun/simulations", json=body | {"reactions": True})
    assert refused.json()["errors"][0]["pointer"] == "/reactions"
    fixed = client.post("/v1/trees/spun/simulations", json=body | {"fixed_step": {"step": 0.01}})
    assert fixed.json()["errors"][0]["code"] == "not-supported"
    assert "<h2>Contacts</h2>" in client.get("/trees/spun").text
