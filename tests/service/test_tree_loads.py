"""Loads of trees over HTTP: stored, changed by revisions, evaluated, printed, by jobs (HTTP contract, section 3)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.messages.negotiation import MEDIA_TYPES
from service.schemas.resources import TreeView

from .conftest import make_client
from .one_store import copied

PART: dict[str, Any] = {
    "name": "bar",
    "bodies": [
        {"name": "bar", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 1, "com": [1, 0, 0]}
    ],
    "inputs": {"v": {"unit": "N m"}},
    "ports": [{"name": "end", "body": "bar", "position": [1, 0, 0]}],
}
SPRING = {"name": "s", "type": "spring", "from": "a.end", "to": "b.end", "stiffness": "k", "length": 0.2}
TORQUE = {"name": "drive", "type": "torque", "from": "a.bar", "to": "b.bar", "vector": [0, 0, "u + a.v"]}
TREE: dict[str, Any] = {
    "name": "pair",
    "gravity": [0, 0, 0],
    "parameters": {"k": {"value": 3, "unit": "N/m"}},
    "inputs": {"u": {"unit": "N m", "description": "drive"}},
    "instances": [
        {"name": "a", "definition": PART},
        {"name": "b", "definition": PART, "placement": {"position": [0, 3, 0]}},
    ],
    "loads": [SPRING, TORQUE],
}


def numbers(client: TestClient, ref: str, **more: Any) -> list[float]:
    body = {"quantities": ["forces"], "q": [[0.3, 0.4]], **more}
    answer = client.post(f"/v1/trees/{ref}/evaluations", json=body)
    assert answer.status_code == 200, answer.text
    found: list[float] = answer.json()["forces"][0]
    return found


def test_tables_are_their_points(client: TestClient) -> None:
    curve = {"bump": "x,y\n0,0\n0.5,2\n1,0"}
    given = {"name": "j", "type": "joint", "coordinate": "a.q", "force": "table(a.q; bump)"}
    points = {**given, "force": "table(a.q; 0: 0, 0.5: 2, 1: 0)"}
    made = client.post("/v1/trees", json={**TREE, "loads": [SPRING, TORQUE, given], "tables": curve})
    assert made.status_code == 201, made.text
    assert made.json()["loads"][2] == points
    same = client.post("/v1/trees", json={**TREE, "loads": [SPRING, TORQUE, points]})
    assert (same.status_code, same.json()["digest"]) == (200, made.json()["digest"])
    assert client.delete("/v1/trees/pair/loads/j").status_code == 201
    again = client.post("/v1/trees/pair/loads", json={**given, "tables": curve})
    assert (again.status_code, again.json()["loads"][2]) == (201, points)
    wrong = client.post("/v1/trees/pair/loads", json={**given, "name": "k", "tables": {"bump": "0,0\n0,1"}})
    assert [(e["pointer"], e["code"]) for e in wrong.json()["errors"]] == [("/tables/bump", "bad-table")]
    loads = [{"type": "joint", "coordinate": "q", "force": "table(q; bump)"}]
    part = {**PART, "loads": loads, "tables": curve}
    stored = client.post("/v1/substructures", json=part)
    assert stored.status_code == 201, stored.text
    shown = client.get("/v1/substructures/bar/definition").json()
    assert "tables" not in shown
    assert shown["loads"][0]["force"] == "table(q; 0: 0, 0.5: 2, 1: 0)"
    missing = client.post("/v1/substructures", json={**part, "tables": {"other": "0,0\n1,1"}})
    assert [(e["pointer"], e["code"]) for e in missing.json()["errors"]] == [("/loads/0/force", "unknown-table")]


def test_loads_are_stored_shown_and_changed(client: TestClient) -> None:
    made = client.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    view = made.json()
    TreeView.model_validate(view)
    assert view["loads"] == [SPRING, TORQUE]
    assert view["inputs"]["u"] == {"unit": "N m", "description": "drive"}
    assert set(view["inputs"]) == {"u", "a.v", "b.v"}
    both, driven = numbers(client, "pair"), numbers(client, "pair", inputs={"u": 2, "a.v": 1})
    # the moment acts on b, and back on a
    assert [y - x for x, y in zip(both, driven, strict=True)] == pytest.approx([-3, 3])
    more = {"name": "j", "type": "joint", "coordinate": "a.q", "force": "5*distance'(a.end, b.end)"}
    second = client.post("/v1/trees/pair/loads", json=more)
    assert (second.status_code, second.headers["location"]) == (201, "/v1/trees/pair@2")
    assert second.json()["loads"] == [SPRING, TORQUE, more]
    third = client.delete("/v1/trees/pair/loads/drive")
    assert (third.status_code, third.json()["loads"], third.json()["based_on"]) == (201, [SPRING, more], 2)
    assert numbers(client, "pair@1") == both
    assert numbers(client, "pair@3") == pytest.approx(both)
    client.delete("/v1/trees/pair/loads/j")
    last = client.delete("/v1/trees/pair/loads/s")
    assert "loads" not in last.json()
    assert numbers(client, "pair@5") == [0, 0]


def test_ends_as_objects_are_the_same_load(client: TestClient) -> None:
    """The contract, section 11: a frame with a point of it."""
    spring = {**SPRING, "from": {"frame": "a.end", "at": [0, 0, 1]}, "to": {"frame": "b.base"}}
    force = {
        "name": "f",
        "type": "force",
        "from": "a.end",
        "to": {"frame": "b.end", "at": [0, 1, 0]},
        "vector": [2, 0, 0],
    }
    drive = {**TORQUE, "from": {"frame": "a.bar"}, "to": {"frame": "b.bar"}}
    plain = [
        {**SPRING, "from_at": [0, 0, 1], "to": "b.base"},
        {**force, "to": "b.end", "at": [0, 1, 0]},
        TORQUE,
    ]
    made = client.post("/v1/trees", json={**TREE, "loads": [spring, force, drive]})
    assert made.status_code == 201, made.text
    assert made.json()["loads"] == plain
    same = client.post("/v1/trees", json={**TREE, "loads": plain})
    assert (same.status_code, same.json()["digest"]) == (200, made.json()["digest"])
    more = client.post("/v1/trees/pair/loads", json={**spring, "name": "more"})
    assert more.status_code == 201
    assert more.json()["loads"][3] == {**plain[0], "name": "more"}


@pytest.mark.parametrize(
    ("load", "change", "pointer", "code"),
    [
        (SPRING, {"from": {"frame": "a.end", "at": [0, 0]}}, "/from/at", "point-expected"),
        (SPRING, {"from": {"at": [0, 0, 0]}}, "/from", "frame-missing"),
        (SPRING, {"to": {"frame": "b.end", "point": 3}}, "/to/point", "unknown-field"),
        (SPRING, {"to": {"frame": "b.end", "at": [0, 0, 1]}, "to_at": [0, 0, 1]}, "/to/at", "no-point"),
        (TORQUE, {"to": {"frame": "b.bar", "at": [0, 0, 1]}}, "/to/at", "no-point"),
        (SPRING, {"to": {"frame": "nowhere"}}, "/to", None),
    ],
)
def test_ends_that_are_no_frames(client: TestClient, load: Any, change: Any, pointer: str, code: str | None) -> None:
    client.post("/v1/trees", json=TREE)
    bad = client.post("/v1/trees/pair/loads", json={**load, "name": "x", **change})
    (fault,) = bad.json()["errors"]
    assert (bad.status_code, fault["pointer"]) == (422, pointer)
    assert code is None or fault["code"] == code


def test_faults_have_pointers(client: TestClient) -> None:
    client.post("/v1/trees", json=TREE)
    gone = client.delete("/v1/trees/pair/loads/none")
    assert (gone.status_code, gone.json()["code"]) == (404, "unknown-load")
    bad = client.post("/v1/trees/pair/loads", json={**SPRING, "name": "x", "to": "c.end"})
    assert bad.status_code == 422
    assert [(e["pointer"], e["code"]) for e in bad.json()["errors"]] == [("/to", "unknown-instance")]
    again = client.post("/v1/trees/pair/loads", json=SPRING)
    assert [(e["pointer"], e["code"]) for e in again.json()["errors"]] == [("/name", "duplicate-name")]
    used = client.delete("/v1/trees/pair/couplings/b")
    assert used.status_code == 422
    assert {e["code"] for e in used.json()["errors"]} >= {"unknown-instance"}


@pytest.fixture(scope="module")
def pair(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server that knows the tree, with a load in an angle more."""
    angle = {"name": "j", "type": "joint", "coordinate": "a.q", "force": "-2*angle(a.bar, b.bar)"}
    with copied(template, tmp_path_factory.mktemp("pair")) as store, make_client(store) as client:
        assert client.post("/v1/trees", json={**TREE, "loads": [SPRING, TORQUE, angle]}).status_code == 201
        yield client


@pytest.mark.parametrize("name", MEDIA_TYPES)
@pytest.mark.parametrize("quantity", ["forces", "forward_dynamics"])
def test_loads_in_every_format(pair: TestClient, name: str, quantity: str) -> None:
    answer = pair.get(f"/v1/trees/pair/{quantity}", params={"format": name})
    assert answer.status_code == 200, answer.text


def test_a_job_takes_them_and_refuses_bad_ones(client: TestClient) -> None:
    later = {"Prefer": "respond-async"}
    assert client.post("/v1/trees", json=TREE, headers=later).status_code == 202
    bad = {**TREE, "loads": [{**SPRING, "length": "k"}]}
    refused = client.post("/v1/trees", json=bad, headers=later)
    assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/loads/0/length")


def test_the_page_shows_them(client: TestClient) -> None:
    client.post("/v1/trees", json=TREE)
    page = client.get("/trees/pair").text
    assert "Loads" in page
    assert "drive" in page
    assert "<polyline" in client.get("/v1/trees/pair/picture").text


def test_the_kernel_knows_them(client: TestClient) -> None:
    """First numbers come from the parts, later ones from a kernel of the tree's own."""
    client.post("/v1/trees", json=TREE)
    before = numbers(client, "pair", inputs={"u": 2}, qd=[[0.1, 0.2]])
    assert client.post("/v1/trees/pair/kernels", json={"quantities": ["forces"]}).status_code in (200, 201)
    assert numbers(client, "pair", inputs={"u": 2}, qd=[[0.1, 0.2]]) == pytest.approx(before)
