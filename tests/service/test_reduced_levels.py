"""Instances of the reduced level over HTTP: stored, shown, evaluated, exported, swept and changed to the full level."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from mechanics.reduced_parts import PARTS

from service.operations.renewal import renew_tree
from service.store.store import Store
from substructures.documents import read_json, write_json

from .fake_engine import FakeEngine, finished, running, submitted

LINKAGE = next(each for each in PARTS if each["name"] == "crank-rocker")
TREE: dict[str, Any] = {
    "name": "press",
    "gravity": [0, "-9.81", 0],
    "instances": [{"name": "x", "substructure": "crank-rocker"}],
}


@pytest.fixture
def press(client: TestClient) -> TestClient:
    assert client.post("/v1/substructures", json=LINKAGE).status_code == 201
    made = client.post("/v1/trees", json=TREE)
    assert made.status_code == 201, made.text
    assert made.json()["coordinates"] == ["x.phi"]
    assert made.json()["reduced"] == [
        {
            "instance": "x",
            "independent": ["x.phi"],
            "dependent": ["x.psi", "x.chi"],
            "closures": ["x.loop"],
        }
    ]
    assert "closures" not in made.json()
    return client


def test_one_state_and_many_are_the_same_and_those_of_the_full_level(press: TestClient) -> None:
    """Through kernels, and in independent coordinates of the tree with closures."""
    states = np.linspace(0, 6, 200).tolist()
    many = press.post("/v1/trees/press/evaluations", json={"quantities": ["metric", "forces"], "q": {"x.phi": states}})
    assert many.status_code == 200, many.text
    one = press.post("/v1/trees/press/evaluations", json={"quantities": ["metric", "forces"], "q": [states[40]]}).json()
    for name in ("metric", "forces"):
        np.testing.assert_allclose(many.json()[name][40], one[name], rtol=1e-12)
    changed = press.patch("/v1/trees/press/couplings/x", json={"level": "full"})
    assert changed.status_code == 201, changed.text
    assert changed.json()["dof"] == 3
    assert "reduced" not in changed.json()
    full = press.post("/v1/trees/press/reduced-equations", json={"q": {"x.phi": states[40]}}).json()
    np.testing.assert_allclose(one["metric"], full["metric"], rtol=1e-11)


@pytest.mark.parametrize(
    "path",
    [
        "",
        "/picture",
        "/scene",
        "/report",
        "/origins",
        "/metric?format=python",
        "/export?target=fmu&quantities=metric",
        "/export?target=mjcf",
    ],
)
def test_it_is_shown_and_exported(press: TestClient, path: str) -> None:
    found = press.get(f"/v1/trees/press{path}")
    assert found.status_code == 200, found.text
    page = press.get("/trees/press")
    assert page.status_code == 200
    assert "<td>x.loop</td><td>x.phi</td><td>x.psi, x.chi</td>" in page.text


def test_what_it_is_asked_wrongly(press: TestClient) -> None:
    away = press.post("/v1/trees/press/evaluations", json={"quantities": ["metric"], "q": {"x.phi": 1, "x.chi": 1}})
    assert away.json()["errors"][0]["message"].startswith("'x.chi' depends on 'x.phi'")
    wrong = press.post("/v1/trees", json={**TREE, "instances": [{**TREE["instances"][0], "level": "short"}]})
    assert wrong.json()["errors"][0]["pointer"] == "/instances/0/level"


def stored(store: Store) -> dict[str, Any]:
    with store.database.read() as connection:
        return read_json(connection.exec_driver_sql("SELECT spec FROM trees WHERE revision = 1").scalar_one().encode())


def test_documents_say_their_level(press: TestClient, store: Store) -> None:
    """Those of another software, too, whatever level that takes by itself; the same tree is no other one."""
    assert [each["level"] for each in stored(store)["instances"]] == ["reduced"]
    assert press.post("/v1/trees", json=TREE).status_code == 200
    assert press.post("/v1/trees", json={**TREE, "name": "other"}).json()["dof"] == 1
    found = renew_tree(store.database, "press", 1)
    assert found.tree.dof == 1


def test_documents_from_before_there_were_levels_keep_all_coordinates(press: TestClient, store: Store) -> None:
    """Derived anew, and as what others are made from."""
    document = stored(store)
    del document["instances"][0]["level"]
    text = write_json(document).decode()
    digest = "sha256:" + sha256(text.encode()).hexdigest()
    with store.database.write() as connection:
        connection.exec_driver_sql("UPDATE trees SET spec = ?, digest = ? WHERE revision = 1", (text, digest))
    assert renew_tree(store.database, "press", 1).tree.dof == 3
    seen = press.get("/v1/trees/press").json()
    assert (seen["dof"], [each["name"] for each in seen["closures"]]) == (3, ["x.loop"])
    with running(store, FakeEngine()):
        for kind in ("verify", "upgrade"):
            done = finished(press, submitted(press, {"kind": kind, "items": [{"tree": "press@1"}]}))
            assert (done["state"], done["progress"]["failed"]) == ("succeeded", 0), done
    assert press.get("/v1/trees/press@1").json()["dof"] == 3
    grown = press.post("/v1/trees/press/couplings", json={"name": "y", "substructure": "crank-rocker", "at": "world"})
    assert grown.status_code == 201, grown.text
    assert grown.json()["coordinates"] == ["x.phi", "x.psi", "x.chi", "y.phi"]


def test_sweeps_have_its_columns(press: TestClient, store: Store) -> None:
    """Torques of rows that are proven as full trees of their own."""
    job = {
        "kind": "sweep",
        "template": TREE,
        "samples": {"of": {"x.l2": {"uniform": [0.85, 1.0], "count": 5}}},
        "columns": {"torque": {"quantity": "gravity", "of": "x.phi", "over": {"q": [0.7]}, "take": "largest_absolute"}},
        "proof": 5,
    }
    with running(store, FakeEngine()):
        found = submitted(press, job)
        assert finished(press, found)["state"] == "succeeded"
    table = press.get(f"/v1/jobs/{found}/table").json()
    assert table["count"] == table["proven"] == 5
    assert len({row["torque"] for row in table["items"]}) == 5
