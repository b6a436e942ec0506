"""Small trees with known motions, on a server, for the tests of analyses."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.settings import Settings
from service.store.store import Store
from substructures import catalogue
from substructures.documents import write_json

from .conftest import make_client

G = 9.81


BAR: dict[str, Any] = {
    "name": "bar",
    "bodies": [
        {"name": "bar", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 1, "com": [1, 0, 0]}
    ],
    "ports": [{"name": "end", "body": "bar", "position": [1, 0, 0]}],
}


PIN = {"name": "pin", "type": "pin", "from": "c.end", "to": "world", "placement": {"position": [1, 0, 0]}}


SLED: dict[str, Any] = {
    "name": "sled",
    "bodies": [
        {
            "name": "sled",
            "parent": "base",
            "joint": {"type": "planar", "coordinate": ["x", "y", "phi"]},
            "mass": 2,
            "inertia": {"xx": 0.25, "yy": 0.25, "zz": 0.5},
        }
    ],
}


TREES: list[dict[str, Any]] = [
    {
        "name": "clock",
        "gravity": [0, 0, -G],
        "instances": [{"name": "p", "substructure": "simple-pendulum", "parameters": {"l": 1, "m": 2}}],
    },
    {"name": "cart", "gravity": [0, 0, -G], "instances": [{"name": "x", "substructure": "cart-pendulum"}]},
    {
        "name": "ring",
        "gravity": [0, -G, 0],
        "instances": [
            {"name": "a", "definition": BAR},
            {"name": "b", "definition": BAR, "at": "a.end"},
            {"name": "c", "definition": BAR, "at": "b.end"},
        ],
        "closures": [PIN],
    },
    {"name": "skate", "instances": [{"name": "s", "definition": SLED}]},
]


def submit(client: TestClient, name: str) -> None:
    """An entry of the catalogue, numbers exact."""
    body = write_json(catalogue.load(name))
    answer = client.post("/v1/substructures", content=body, headers={"Content-Type": "application/json"})
    assert answer.status_code == 201, answer.text


def client_with_trees(store: Store) -> TestClient:
    """A client of a server that knows the trees."""
    client = make_client(store)
    for name in ("simple-pendulum", "cart-pendulum"):
        submit(client, name)
    for tree in TREES:
        answer = client.post("/v1/trees", json=tree)
        assert answer.status_code == 201, answer.text
    return client


def ask(client: TestClient, path: str, **request: Any) -> Any:
    answer = client.post(f"/v1/trees/{path}", json=request)
    assert answer.status_code == 200, answer.text
    return answer.json()


def rest(client: TestClient) -> list[float]:
    """The stable equilibrium of the clock."""
    found = ask(client, "clock/equilibria", count=8)["found"]
    return next(e["q"] for e in found if e["at"]["stability"]["verdict"] == "stable")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    folder: Path = tmp_path_factory.mktemp("analyses")
    with open_store(Settings(database=f"sqlite:///{folder / 'store.db'}", catalogue=False)) as store:
        yield store


@pytest.fixture(scope="module")
def client(store: Store) -> TestClient:
    return client_with_trees(store)
