"""Two owners with three keys on one server: what belongs to acme, private and public, and bolt's key."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.settings import Settings
from service.store import keys
from service.store.store import Store

from .conftest import PENDULUM, copied, make_client
from .fake_engine import FakeEngine, export, finished, running

Headers = dict[str, str]
MARK = "hush"  # stands in everything that is private, and nowhere else
NAMES = {"private": "hush", "public": "known"}
PART, TREE = "/v1/substructures", "/v1/trees"
FORM: dict[str, Any] = {"name": "{tree}", "gravity": [0, 0, 0], "instances": [{"name": "a", "substructure": "{part}"}]}
CAMERA = {"name": "b", "substructure": "{part}", "at": "arm.tip"}
PULL = {"name": "pull", "type": "joint", "coordinate": "arm.q", "force": 2}


@dataclass(frozen=True)
class World:
    """A store with what belongs to acme, and the headers of acme's key, of its key that only reads, and of bolt's."""

    path: Path
    keys: tuple[Headers, Headers, Headers]
    admin: Headers
    jobs: dict[str, str]
    sweeps: dict[str, str]


def store_of(client: TestClient) -> Store:
    found: Store = client.app.state.store  # type: ignore[attr-defined]
    return found


def key(store: Store, owner: str, *scopes: str) -> Headers:
    with store.database.write() as connection:
        return {"Authorization": f"Bearer {keys.create(connection, '', scopes, None, owner)}"}


def sweep(part: str, visibility: str) -> dict[str, Any]:
    template = {"name": "arm", "gravity": [0, 0, 0], "instances": [{"name": "arm", "substructure": part}]}
    columns = {"columns": {"mass": "mass"}, "pareto": {"minimise": ["mass"]}}
    return {"kind": "sweep", "template": template, "shared": visibility == "public", **columns}


@pytest.fixture(scope="module")
def world(tmp_path_factory: pytest.TempPathFactory) -> World:
    path = tmp_path_factory.mktemp("world") / "store.db"
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as store:
        acme, reads = key(store, "acme", "read", "write", "jobs"), key(store, "acme", "read")
        bolt, admin = key(store, "bolt", "read", "write", "jobs"), key(store, "root", "admin")
        client, jobs, sweeps = make_client(store), {}, {}
        with running(store, FakeEngine()):
            for visibility, name in NAMES.items():
                part = {**PENDULUM, "name": name, "title": name, "visibility": visibility}
                eye = {"name": "eye", "substructure": name, "at": "arm.tip"}
                arm = {"name": "arm", "substructure": name}
                tree = {"name": f"{name}-cell", "visibility": visibility, "instances": [arm, eye], "loads": [PULL]}
                for address, body in ((PART, part), (TREE, {**tree, "gravity": [0, 0, 0]})):
                    assert client.post(address, json=body, headers=acme).status_code == 201
                alias = client.put(f"{PART}/{name}/aliases/best", json={"version": 1}, headers=acme)
                assert alias.status_code == 201
                job = {**export(f"{name}-cell", "metric"), "shared": visibility == "public"}
                answer = client.post("/v1/jobs", json=job, headers=acme)
                assert answer.status_code == 202, answer.text
                jobs[visibility] = answer.json()["id"]
                answer = client.post("/v1/jobs", json=sweep(name, visibility), headers=acme)
                assert answer.status_code == 202, answer.text
                sweeps[visibility] = answer.json()["id"]
                client.headers.update(acme)
                for each in (jobs, sweeps):
                    finished(client, each[visibility])
                del client.headers["Authorization"]
        return World(path, (acme, reads, bolt), admin, jobs, sweeps)


@contextmanager
def serving(world: World, folder: Path) -> Iterator[TestClient]:
    """A server of a copy of the world."""
    copied(world.path, folder / "store.db")
    url = f"sqlite:///{folder / 'store.db'}"
    with open_store(Settings(database=url, catalogue=False, key_seconds=0)) as store, make_client(store) as client:
        yield client


@pytest.fixture
def served(world: World, tmp_path: Path) -> Iterator[TestClient]:
    with serving(world, tmp_path) as client:
        yield client
