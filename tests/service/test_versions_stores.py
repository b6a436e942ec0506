"""Versions, uses, published trees and what is left of jobs, in both databases, and what of it others see."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient

from service.app import open_store
from service.database.job_tables import job_items, result_files, results, uploads
from service.settings import Settings
from service.store import keys
from service.store.store import Store

from .conftest import PENDULUM, TREE, make_client
from .databases import fresh
from .fake_engine import FakeEngine, finished, running

PART, TREES, JOBS = "/v1/substructures", "/v1/trees", "/v1/jobs"
Headers = dict[str, str]


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def store(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with (
        fresh(request.param, tmp_path_factory.mktemp("versions")) as address,
        open_store(Settings(database=address, catalogue=False, key_seconds=0)) as found,
    ):
        yield found


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    return make_client(store)


@pytest.fixture(scope="module")
def two(store: Store) -> tuple[Headers, Headers]:
    """The headers of acme's key and of bolt's."""
    with store.database.write() as connection:
        made = [keys.create(connection, "", ("read", "write", "jobs"), None, owner) for owner in ("acme", "bolt")]
    return {"Authorization": f"Bearer {made[0]}"}, {"Authorization": f"Bearer {made[1]}"}


def done(answer: Any, status: int = 201) -> Any:
    assert answer.status_code == status, answer.text
    return answer.json() if answer.content else None


def heavy(**more: Any) -> dict[str, Any]:
    return {**PENDULUM, "parameters": {**PENDULUM["parameters"], "m": {"value": 3, "unit": "kg"}}, **more}


def test_what_is_private_stays_so_through_versions(client: TestClient, two: tuple[Headers, Headers]) -> None:
    acme, bolt = two
    done(client.post(PART, json={**PENDULUM, "name": "hush", "visibility": "private"}, headers=acme))
    cell = {**TREE, "name": "hush-cell", "visibility": "private", "instances": [{"name": "a", "substructure": "hush"}]}
    done(client.post(TREES, json=cell, headers=acme))
    # a private tree becomes a private part, and no public one
    public = {"name": "shown", "visibility": "public"}
    refused = done(client.post(f"{TREES}/hush-cell/publish", json=public, headers=acme), 409)
    assert refused["code"] == "private-tree"
    module = done(client.post(f"{TREES}/hush-cell/publish", json={"name": "module"}, headers=acme))
    assert (module["visibility"], module["tree"]) == ("private", "hush-cell@1")
    assert client.get(f"{PART}/module", headers=bolt).status_code == 404
    wanted = {"visibility": "public"}
    assert done(client.put(f"{PART}/module/visibility", json=wanted, headers=acme), 409)["code"] == "private-part"
    # references to what is private are there for its owner alone
    done(client.post(PART, json=heavy(name="open", derived_from="hush"), headers=acme))
    point = {name: x for name, x in PENDULUM["bodies"][0].items() if name != "inertia"}
    done(client.post(PART, json=heavy(name="short", derived_from="hush", bodies=[point]), headers=acme))
    secret = heavy(name="secret", derived_from="short", bodies=[{**point, "com": [0, 0, 0]}], visibility="private")
    done(client.post(PART, json=secret, headers=acme))
    for headers, levels in ((acme, ["hush", "secret"]), (bolt, [])):
        items = done(client.get(f"{PART}/short/levels", headers=headers), 200)["items"]
        assert [each["name"] for each in items] == levels
    done(client.post(f"{PART}/open@1/withdraw", json={"successor": "hush@1"}, headers=acme), 200)
    for headers, seen in ((acme, "hush@1"), (bolt, None)):
        told = done(client.get(f"{PART}/open@1", headers=headers), 200)
        assert (told["derived_from"], told["successor"]) == (seen, seen)
        (listed,) = done(client.get(f"{PART}/open/versions", headers=headers), 200)["items"]
        assert (listed["derived_from"], listed["successor"]) == (seen, seen)
    for address in ("hush/versions", "hush/uses", "open@1/difference?to=hush", "hush/difference?to=open@1"):
        assert client.get(f"{PART}/{address}", headers=bolt).status_code in (404, 422)
    assert done(client.post(PART, json=heavy(name="mine", derived_from="hush"), headers=bolt), 422)["code"]
    # when the part is public the module may be, and its tree is named when that is public as well
    done(client.put(f"{PART}/hush/visibility", json=wanted, headers=acme), 200)
    done(client.put(f"{PART}/module/visibility", json=wanted, headers=acme), 200)
    assert done(client.get(f"{PART}/module", headers=bolt), 200)["tree"] is None
    kinds = [(use["kind"], use["name"]) for use in done(client.get(f"{PART}/hush/uses", headers=bolt), 200)["items"]]
    assert kinds == [("derived", "open"), ("derived", "short"), ("part", "module")]


def test_others_publish_under_names_of_their_own(client: TestClient, two: tuple[Headers, Headers]) -> None:
    acme, bolt = two
    done(client.post(PART, json={**PENDULUM, "name": "known"}, headers=acme))
    cell = {**TREE, "name": "known-cell", "instances": [{"name": "a", "substructure": "known"}]}
    done(client.post(TREES, json=cell, headers=acme))
    done(client.post(f"{TREES}/known-cell/publish", json={"name": "taken"}, headers=acme))
    refused = done(client.post(f"{TREES}/known-cell/publish", json={"name": "taken"}, headers=bolt), 403)
    assert refused["code"] == "name-taken"
    assert "'taken-bolt', and 'derived_from'" in refused["detail"]
    own = done(client.post(f"{TREES}/known-cell/publish", json={"name": "taken-bolt"}, headers=bolt))
    assert (own["owner"], own["tree"]) == ("bolt", "known-cell@1")
    uses = done(client.get(f"{PART}/known@1/uses?page_size=2", headers=bolt), 200)
    assert [use["name"] for use in uses["items"]] == ["taken", "taken-bolt"]
    rest = done(client.get(uses["links"]["next"], headers=bolt), 200)
    assert [(use["kind"], use["name"], use["instances"]) for use in rest["items"]] == [("tree", "known-cell", {"a": 1})]
    assert done(client.get(f"{PART}/taken@1/difference?to=taken-bolt@1", headers=bolt), 200)["same"]


def test_jobs_are_removed_with_what_is_theirs_alone(
    store: Store, client: TestClient, two: tuple[Headers, Headers]
) -> None:
    acme, bolt = two
    done(client.post(PART, json={**PENDULUM, "name": "swung"}, headers=acme))
    cell = {**TREE, "name": "swung-cell", "instances": [{"name": "a", "substructure": "swung"}]}
    done(client.post(TREES, json=cell, headers=acme))
    request = {"quantities": ["metric"], "q": [[0.1], [0.2]]}
    later, address = {**acme, "Prefer": "respond-async"}, f"{TREES}/swung-cell/evaluations"
    mine = make_client(store)
    mine.headers.update(acme)
    with running(store, FakeEngine()):
        jobs = [done(client.post(address, json=request, headers=later), 202)["id"] for _ in range(2)]
        for job in jobs:
            finished(mine, job)
        assert client.delete(f"{JOBS}/{jobs[0]}", headers=bolt).status_code == 404
        assert client.delete(f"{JOBS}/{jobs[0]}", headers=acme).status_code == 204
        assert client.get(f"{JOBS}/{jobs[0]}", headers=acme).status_code == 404
        (item,) = done(client.get(f"{JOBS}/{jobs[1]}/items", headers=acme), 200)["items"]
        assert client.get(item["files"][0]["href"], headers=acme).status_code == 200
        assert client.delete(f"{JOBS}/{jobs[1]}", headers=acme).status_code == 204
    with store.database.read() as connection:
        for table in (job_items, results, result_files, uploads):
            assert connection.execute(sa.select(sa.func.count()).select_from(table)).scalar_one() == 0


def test_a_job_that_runs_is_not_removed(client: TestClient, two: tuple[Headers, Headers]) -> None:
    acme, _ = two
    done(client.post(PART, json={**PENDULUM, "name": "slow"}, headers=acme))
    cell = {**TREE, "name": "slow-cell", "instances": [{"name": "a", "substructure": "slow"}]}
    done(client.post(TREES, json=cell, headers=acme))
    body = {
        "kind": "export",
        "label": "waits",
        "items": [{"tree": "slow-cell", "quantity": "metric", "format": "text"}],
    }
    job = done(client.post(JOBS, json=body, headers=acme), 202)
    assert job["label"] == "waits"
    refused = done(client.delete(f"{JOBS}/{job['id']}", headers=acme), 409)
    assert (refused["code"], "cancel it first" in refused["detail"]) == ("job-not-ended", True)
    again = done(client.post(f"{JOBS}/{job['id']}/retry", headers=acme), 409)
    assert "none of its items has failed so far" in again["detail"]
    done(client.post(f"{JOBS}/{job['id']}/cancel", headers=acme), 200)
    again = done(client.post(f"{JOBS}/{job['id']}/retry", json={"label": "once more"}, headers=acme), 202)
    assert (again["retry_of"], again["label"], again["progress"]["total"]) == (job["id"], "once more", 1)
