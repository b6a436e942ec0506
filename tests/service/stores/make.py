"""Make a store with the code of an earlier commit: ``PYTHONPATH=CHECKOUT python make.py FILE`` (README.md)."""

from __future__ import annotations

import gzip
import json
import sqlite3
import sys
from pathlib import Path

from fastapi.testclient import TestClient

from service.app import create_app, open_store
from service.settings import Settings
from substructures import catalogue

PENDULUM = {
    "name": "pendulum",
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
GRAVITY = {"gravity": [0, "-g", 0], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
TREE = {"name": "cell", **GRAVITY, "instances": [{"name": "arm", "substructure": "pendulum", "at": "world"}]}
HAND = {"name": "hand", "substructure": "pendulum", "at": "arm.tip", "parameters": {"m": "arm.m/4"}}
MACHINES = {"name": "machines", "instances": [{"name": "squeezer", "substructure": "andrews-squeezer", "at": "world"}]}


def main(path: Path) -> None:
    """Fill the store, and leave it packed beside."""
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        client = TestClient(create_app(store), base_url="http://localhost")
        squeezer = json.loads(json.dumps(catalogue.load("andrews-squeezer"), default=str))
        posts = [("substructures", PENDULUM), ("substructures", squeezer), ("trees", TREE), ("trees", MACHINES)]
        for where, body in [*posts, ("trees/cell/couplings", HAND)]:
            answer = client.post(f"/v1/{where}", json=body)
            print(where, answer.status_code, answer.text if answer.status_code >= 300 else "")
    connection = sqlite3.connect(path)
    connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    connection.execute("PRAGMA journal_mode=DELETE")
    connection.execute("VACUUM")
    connection.close()
    Path(f"{path}.gz").write_bytes(gzip.compress(path.read_bytes(), 9, mtime=0))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
