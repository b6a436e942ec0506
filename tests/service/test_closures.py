"""Trees with closures over HTTP: stored, shown, printed in every format."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.messages.negotiation import MEDIA_TYPES
from substructures.expr.program import Program

from .conftest import make_client
from .one_store import copied

PART: dict[str, Any] = {
    "name": "bar",
    "bodies": [
        {"name": "bar", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 1, "com": [1, 0, 0]}
    ],
    "ports": [{"name": "end", "body": "bar", "position": [1, 0, 0]}],
}
TREE: dict[str, Any] = {
    "name": "ring",
    "instances": [
        {"name": "a", "definition": PART},
        {"name": "b", "definition": PART, "at": "a.end"},
        {"name": "c", "definition": PART, "at": "b.end"},
    ],
    "closures": [{"name": "pin", "type": "pin", "from": "c.end", "to": "world", "placement": {"position": [1, 0, 0]}}],
}


def test_a_tree_with_closures_is_stored_and_shown(client: TestClient) -> None:
    made = client.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    rows = {"name": "pin", "type": "pin", "from": "c.end", "to": "world", "rows": ["x", "y", "z", "rx", "ry"]}
    assert made.json()["closures"] == [rows]
    page = client.get("/trees/ring").text
    assert "<h2>Closures</h2>" in page
    assert "<td>c.end</td><td>world</td><td>5</td>" in page
    assert client.get("/v1/trees/ring").json()["closures"] == [rows]
    open_tree = client.post("/v1/trees", json={**TREE, "name": "chain", "closures": []})
    assert "closures" not in open_tree.json()


def test_loops_are_closed_and_opened_one_by_one(client: TestClient) -> None:
    assert client.post("/v1/trees", json={**TREE, "name": "chain", "closures": []}).status_code == 201
    first = client.get("/v1/trees/chain").json()["digest"]
    closed = client.post("/v1/trees/chain/closures", json=TREE["closures"][0])
    assert (closed.status_code, closed.json()["revision"]) == (201, 2)
    whole = client.post("/v1/trees", json={**TREE, "name": "chain"})
    assert (whole.status_code, whole.json()["digest"]) == (200, closed.json()["digest"])
    wrong = client.post("/v1/trees/chain/closures", json={"name": "rod", "type": "rod", "from": "c.end"})
    assert (wrong.status_code, wrong.json()["errors"][0]["code"]) == (422, "rod-length")
    assert client.delete("/v1/trees/chain/closures/pins").json()["code"] == "unknown-closure"
    tag = client.get("/v1/trees/chain").headers["etag"]
    opened = client.delete("/v1/trees/chain/closures/pin", headers={"If-Match": tag})
    assert (opened.status_code, opened.json()["digest"]) == (201, first)
    assert client.post("/v1/trees/chain/closures", json={}, headers={"If-Match": tag}).status_code == 412


def test_a_part_brings_its_closures_along(client: TestClient) -> None:
    """Stored, as YAML, in a tree with a name for each instance, and in its states and motions."""
    bodies = [{**PART["bodies"][0], "name": "b", "parent": "bar", "joint": {"type": "revolute", "coordinate": "p"}}]
    bodies[0]["joint"]["placement"] = {"position": [1, 0, 0]}
    closure = {"name": "stay", "type": "rod", "from": "tip", "to": "base", "length": 1.5}
    part = {**PART, "name": "knee", "bodies": [*PART["bodies"], *bodies], "closures": [closure]}
    part["ports"] = [{"name": "tip", "body": "b", "position": [1, 0, 0]}]
    assert client.post("/v1/substructures", json=part).status_code == 201
    again = client.get("/v1/substructures/knee/definition")
    assert again.json()["closures"] == [{"name": "stay", "type": "rod", "from": "tip", "length": 1.5}]
    two = [{"name": n, "substructure": "knee", "at": at} for n, at in (("k", "world"), ("l", "k.tip"))]
    made = client.post("/v1/trees", json={"name": "knees", "gravity": [0, -9.81, 0], "instances": two})
    assert [(c["name"], c["to"]) for c in made.json()["closures"]] == [("k.stay", "k.base"), ("l.stay", "l.base")]
    state = {"q": [0.3, 1.4, 0.2, -1.4]}
    found = client.post("/v1/trees/knees/loop-states", json=state).json()
    assert (found["mobility"]["degrees_of_freedom"], found["is_right"]) == (2, True), found
    motion = client.post("/v1/trees/knees/simulations", json={**state, "span": [0, 0.2], "step": 0.1}).json()
    assert motion["is_right"], motion
    names = [{"type": "closure", "name": "k.stay"}, {"type": "closure", "name": "l.stay"}]
    quasi = client.post("/v1/trees/knees/velocity-equations", json={"constraints": names}, params={"format": "json"})
    assert quasi.json()["constraints"] == ["k.stay.length", "l.stay.length"], quasi.text
    some = client.post("/v1/trees/knees/velocity-equations", json={"constraints": names[:1]}).json()
    assert "the closure 'l.stay' is not among them" in some["detail"]
    wrong = {**part, "closures": [{**closure, "to": "world"}]}
    answer = client.post("/v1/substructures", json=wrong)
    assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [("/closures/0/to", "unknown-frame")]


@pytest.fixture(scope="module")
def ring(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server that knows the tree."""
    with copied(template, tmp_path_factory.mktemp("ring")) as store, make_client(store) as client:
        assert client.post("/v1/trees", json=TREE).status_code == 201
        yield client


@pytest.mark.parametrize("name", MEDIA_TYPES)
def test_closures_in_every_format(ring: TestClient, name: str) -> None:
    answer = ring.get("/v1/trees/ring/closures", params={"format": name})
    assert answer.status_code == 200, answer.text
    if name == "json":
        outputs = Program.from_bytes(answer.content).outputs
        assert outputs["closure.jacobian"].shape == (5, 3)


def test_a_bad_closure_is_pointed_at(client: TestClient) -> None:
    bad = {**TREE, "closures": [{**TREE["closures"][0], "to": "d.end"}]}
    answer = client.post("/v1/trees", json=bad)
    assert answer.status_code == 422
    assert [(e["pointer"], e["code"]) for e in answer.json()["errors"]] == [("/closures/0/to", "unknown-instance")]
