"""Fixtures: a server on a fresh SQLite file, small definitions, and the number of rows in every table.

Tests that leave each other alone import the fixtures of :mod:`one_store`: one server for all of a file.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import func, select

from service.app import bare_app, create_app, open_store
from service.database.tables import metadata
from service.settings import Settings
from service.store.store import Store

from .databases import close
from .made_once import bare_app_from, upgrade_once

Given, Answer = TypeVar("Given"), TypeVar("Answer")

PENDULUM: dict[str, Any] = {
    "name": "pendulum",
    "title": "Pendulum",
    "tags": ["planar", "textbook"],
    "parameters": {"l": {"value": 1, "unit": "m"}, "m": {"value": 2, "unit": "kg"}},
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q"},
            "mass": "m",
            "com": ["l", 0, 0],
            "inertia": {"zz": "m*l^2/10", "xx": "m*l^2/10", "yy": "m*l^2/5"},
        }
    ],
    "ports": [{"name": "tip", "body": "rod", "position": ["l", 0, 0]}],
}
SLIDER: dict[str, Any] = {
    "name": "slider",
    "title": "Sliding mass",
    "tags": ["planar"],
    "parameters": {"m": {"value": "0.5", "unit": "kg"}, "k": {"unit": "N/m"}},
    "bodies": [
        {
            "name": "mass",
            "parent": "base",
            "joint": {"type": "prismatic", "coordinate": "x", "stiffness": "k"},
            "mass": "m",
        }
    ],
    "ports": [{"name": "top", "body": "mass"}],
}
TREE: dict[str, Any] = {
    "name": "cell",
    "gravity": [0, "-g", 0],
    "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
    "instances": [{"name": "arm", "substructure": "pendulum", "at": "world"}],
}
HAND: dict[str, Any] = {"name": "hand", "substructure": "pendulum", "at": "arm.tip", "parameters": {"m": "arm.m/4"}}


def copied(template: Path, path: Path) -> Path:
    """A copy of a store with the key of its seals, as the server knows it that made it."""
    shutil.copy(template, path)
    shutil.copy(f"{template}.key", f"{path}.key")
    return path


def make_client(store: Store) -> TestClient:
    """A client of an app around the store; the app must never raise into the server."""
    return TestClient(create_app(store), base_url="http://localhost", raise_server_exceptions=True)


def plain_tag(client: TestClient, path: str) -> str:
    """The ETag of what is not compressed."""
    found: str = client.get(path, headers={"Accept-Encoding": "identity"}).headers["etag"]
    return found


def at_once(call: Callable[[Given], Answer], given: Sequence[Given]) -> list[Answer]:
    """The results of calls that are made at the same time, each in a thread of its own."""
    with ThreadPoolExecutor(len(given)) as pool:
        return list(pool.map(call, given))


def pytest_sessionfinish() -> None:
    """Databases are dropped while other tests run."""
    close()


@pytest.fixture(autouse=True)
def _logs_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """A server's command run in this process would write all later log lines to a stderr that ends with its test."""
    monkeypatch.setattr("service.http.logs.configure", lambda: None)


@pytest.fixture(scope="session", autouse=True)
def _made_once() -> Iterator[None]:
    """Most tests open a store and an app of their own: 0.2 s of CPU each time for what is always the same."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("service.database.migrate.upgrade", upgrade_once())
        patch.setattr("service.app.bare_app", bare_app_from(bare_app()))
        yield


@pytest.fixture(scope="session")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A database that knows pendulum, slider and the tree cell@1; to be copied."""
    path = tmp_path_factory.mktemp("template") / "store.db"
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as opened:
        client = make_client(opened)
        for kind, body in (("substructures", PENDULUM), ("substructures", SLIDER), ("trees", TREE)):
            answer = client.post(f"/v1/{kind}", json=body)
            assert answer.status_code == 201, answer.text
    return path


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(database=f"sqlite:///{tmp_path / 'store.db'}", catalogue=False, key_seconds=0)


@pytest.fixture
def store(settings: Settings, request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    """The store of ``client``, and of ``filled`` when the test asks for that."""
    if "filled" in request.fixturenames:
        copied(request.getfixturevalue("template"), tmp_path / "store.db")
    with open_store(settings) as opened:
        yield opened


@pytest.fixture
def client(store: Store) -> Iterator[TestClient]:
    """A client of a server with an empty store."""
    with make_client(store) as opened:
        yield opened


@pytest.fixture
def filled(client: TestClient) -> TestClient:
    """A client of a server that knows pendulum, slider and the tree cell@1."""
    return client


@pytest.fixture
def rows(store: Store) -> Callable[[], dict[str, int]]:
    """Counts the rows of all tables."""

    def count() -> dict[str, int]:
        with store.database.read() as connection:
            return {
                name: connection.execute(select(func.count()).select_from(table)).scalar_one()
                for name, table in metadata.tables.items()
            }

    return count
