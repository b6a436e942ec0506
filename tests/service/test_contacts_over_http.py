"""Contacts over HTTP: a ball that comes to rest, and where there are none."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from tests.contact_models import BALL

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
        ("ensembles", {}, "/contacts", "extra-forbidden"),
    ],
)
def test_where_there_are_none(
    client: TestClient, address: str, name: str, more: dict[str, Any], pointer: str, code: str
) -> None:
    found = client.post(f"{address}/{name}", json=BODY | more)
    assert found.status_code == 422
    faults = {fault["pointer"]: fault["code"] for fault in found.json()["errors"]}
    assert faults.get(pointer) == code
