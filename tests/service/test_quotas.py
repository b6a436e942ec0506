"""Quotas in bytes, of one key and of all: uploads, results, kept answers; and the folder of kernels is pruned."""

from __future__ import annotations

import os
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sqlalchemy as sa

from service.app import open_store
from service.database.job_tables import results, uploads
from service.database.migrate import upgrade
from service.database.tables import idempotency
from service.settings import Limits, Settings
from service.store import usage
from service.store.store import Store
from substructures.compile import cache
from substructures.formats.arrays import write_npz

from .conftest import HAND, PENDULUM, TREE, make_client
from .databases import fresh
from .fake_engine import FakeEngine, export, finished, running, submitted
from .test_keys import new_key

ASYNC = {"Content-Type": "application/x-npz", "Prefer": "respond-async"}


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Sums are never taken for granted."""
    monkeypatch.setattr(usage, "FRESH", -1.0)


def states(seed: int) -> bytes:
    """About 8,000 bytes of states that nobody else has."""
    q = np.random.default_rng(seed).uniform(size=(1000, 1))
    return b"".join(write_npz({"q": q, "quantities": np.array(["metric"])}).pieces)


def limited(address: str, **limits: int) -> Settings:
    return Settings(database=address, catalogue=False, key_seconds=0, limits=Limits.model_validate(limits))


def kept(store: Store, table: sa.Table) -> int:
    with store.database.read() as connection:
        return int(connection.execute(sa.select(sa.func.coalesce(sa.func.sum(table.c.size), 0))).scalar_one())


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_uploads(kind: str, tmp_path: Path) -> None:
    with (
        fresh(kind, tmp_path) as address,
        open_store(limited(address, upload_bytes=40_000, upload_bytes_per_key=20_000)) as store,
    ):
        client, keys = make_client(store), [new_key(store, "admin") for _ in range(4)]
        for path, body in (("substructures", PENDULUM), ("trees", TREE)):
            assert client.post(f"/v1/{path}", json=body, headers=keys[0]).status_code == 201

        def post(key: dict[str, str], seed: int) -> Any:
            return client.post("/v1/trees/cell/evaluations", content=states(seed), headers={**key, **ASYNC})

        codes = [[post(key, 10 * k + seed).status_code for seed in range(3)] for k, key in enumerate(keys)]
        assert codes == [[202, 202, 503], [202, 202, 503], [503] * 3, [503] * 3]
        refused = post(keys[0], 99)
        assert refused.json()["code"] == "quota-exceeded"
        assert refused.headers["retry-after"]
        assert kept(store, uploads) <= 40_000
        limits = client.get("/v1/limits", headers=keys[0]).json()
        assert limits["upload_bytes_per_key"] == 20_000


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_results(kind: str, tmp_path: Path) -> None:
    """An item without room for its result fails with the reason, and no more jobs are taken."""
    with fresh(kind, tmp_path) as address, open_store(limited(address)) as store:
        client = make_client(store)
        for path, body in (("substructures", PENDULUM), ("trees", TREE)):
            assert client.post(f"/v1/{path}", json=body).status_code == 201
        with running(store, FakeEngine()):
            finished(client, submitted(client, export("cell", "coriolis")))
            most = 3 * kept(store, results)
            store.usage = usage.Usage(Limits(result_bytes_per_key=most))
            names = ("metric", "gravity", "forces", "bias", "kinematics", "christoffel")
            view = finished(client, submitted(client, export("cell", *names)))
            assert (view["progress"]["done"], 0 < view["progress"]["failed"] < 6) == (6, True)
            items = client.get(f"/v1/jobs/{view['id']}/items").json()["items"]
            codes = {item["problem"]["code"] for item in items if item["problem"]}
            assert codes == {"quota-exceeded"}
            assert kept(store, results) <= most
        with store.database.write() as connection:
            connection.execute(results.update().values(size=most))
        refused = client.post("/v1/jobs", json=export("cell", "U"))
        assert (refused.status_code, refused.json()["code"]) == (503, "quota-exceeded")


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_answers_under_keys(kind: str, tmp_path: Path) -> None:
    with fresh(kind, tmp_path) as address, open_store(limited(address, answer_bytes_per_key=10)) as store:
        client = make_client(store)
        body = {**PENDULUM, "name": "other"}
        assert client.post("/v1/substructures", json=PENDULUM, headers={"Idempotency-Key": "a"}).status_code == 201
        assert kept(store, idempotency) > 10
        refused = client.post("/v1/substructures", json=body, headers={"Idempotency-Key": "b"})
        assert (refused.status_code, refused.json()["code"]) == (503, "quota-exceeded")
        assert client.post("/v1/substructures", json=body).status_code == 201  # without a key nothing is kept
        computed = {"quantities": ["metric"], "q": [0, 0]}
        client.post("/v1/trees", json=TREE)
        client.post("/v1/trees/cell/couplings", json=HAND)
        answer = client.post("/v1/trees/cell/evaluations", json=computed, headers={"Idempotency-Key": "c"})
        assert answer.status_code == 200


def test_what_was_there_before_has_its_size(tmp_path: Path) -> None:
    """The migration, from a store of the version before."""
    settings = Settings(database=f"sqlite:///{tmp_path}/x.db", catalogue=False)
    engine = sa.create_engine(settings.database)
    upgrade(engine, "0006")
    engine.dispose()
    with closing(sqlite3.connect(tmp_path / "x.db")) as connection:
        connection.execute("INSERT INTO uploads VALUES ('d', x'000102', '')")
        connection.execute("INSERT INTO results VALUES ('k', 'export', '{}', '')")
        connection.execute("INSERT INTO result_files VALUES ('k', 'f', 5, x'0001020304')")
        connection.execute(
            "INSERT INTO idempotency (principal, key, fingerprint, owner, created) VALUES ('p', 'k', '', '', '9')"
        )
        connection.commit()
    with open_store(settings) as store:
        assert (kept(store, uploads), kept(store, results), kept(store, idempotency)) == (3, 7, 0)


def test_the_folder_of_kernels_is_pruned(tmp_path: Path) -> None:
    for k in range(5):
        cache.write(tmp_path, f"{k}", None, bytes(1000))
        os.utime(tmp_path / f"{k}.kernel", (k, k))
    assert cache.read(tmp_path, "0") is not None  # it is used again
    cache.prune(tmp_path, 3500)
    assert {path.name for path in tmp_path.iterdir()} == {"0.kernel", "3.kernel", "4.kernel"}
    cache.prune(tmp_path / "nowhere", 1)
