"""Stores of all earlier versions: opened by today's code they have the same digests and right answers."""

from __future__ import annotations

import gzip
import logging
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from math import cos
from pathlib import Path
from time import sleep
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.database.schema import NEWEST
from service.jobs.engines.engine import AttemptReport, Work
from service.operations.renewing import Renewal
from service.operations.verification import verify_all
from service.queries import renewals
from service.server import background
from service.settings import Settings
from service.store.store import Store
from substructures.client import Client

from .conftest import make_client

STORES = Path(__file__).parent / "stores"
OLD = sorted(path.name.partition(".")[0] for path in STORES.glob("*.gz"))
STATE = {"q": [0.3, -0.2], "qd": [1, 0.5], "quantities": ["metric", "forces"]}
#: M of two pendulums with l = 1, m = 2 and 1/2, inertia m l^2 / 10, by hand
L, M, N = 1.0, 2.0, 0.5


def metric(bend: float) -> list[list[float]]:
    """Of the double pendulum of cell@2, whose bodies have their mass at the ends."""
    own = N * L**2 * 1.1
    cross = own + N * L**2 * cos(bend)
    return [[M * L**2 * 1.1 + N * L**2 + own + 2 * N * L**2 * cos(bend), cross], [cross, own]]


def unpacked(name: str, folder: Path) -> Path:
    path = folder / "store.db"
    path.write_bytes(gzip.decompress((STORES / f"{name}.db.gz").read_bytes()))
    return path


def digests(path: Path) -> list[Any]:
    """Digests of definitions and of documents, as they are stored."""
    with closing(sqlite3.connect(path)) as connection:
        queries = "SELECT name, version, digest FROM versions", "SELECT name, revision, digest FROM trees"
        return [sorted(connection.execute(query).fetchall()) for query in queries]


@pytest.fixture(params=OLD)
def path(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return unpacked(request.param, tmp_path)


@pytest.fixture
def store(path: Path) -> Iterator[Store]:
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as opened:
        yield opened


def test_there_is_one_of_each_schema() -> None:
    """0010 came with 0011: no version has had it."""
    schemas = [f"{number:04}" for number in range(1, int(NEWEST))]
    assert [name for name in schemas if name != "0010"] == OLD


def _is_right(client: TestClient | Client) -> None:
    answer = client.request("POST", "/v1/trees/cell/evaluations", json=STATE)
    assert answer.status_code == 200, answer.text
    for found, right in zip(answer.json()["metric"], metric(-0.2), strict=True):
        assert found == pytest.approx(right, rel=1e-13)


@pytest.mark.parametrize("path", [OLD[0], OLD[-1]], indirect=True)
def test_a_request_is_answered_before_all_is_derived_anew(path: Path, store: Store) -> None:
    """The numbers are right at once, and of what is asked for nothing old is left."""
    client = make_client(store)
    _is_right(client)
    squeezer = client.get("/v1/trees/machines").json()
    state = {"q": [0.1] * squeezer["dof"], "quantities": ["metric"]}
    assert client.post("/v1/trees/machines/evaluations", json=state).status_code == 200
    tree = {"name": "new", "instances": [{"name": "a", "substructure": "andrews-squeezer", "at": "world"}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    listed = {each["name"]: each["derived_here"] for each in client.get("/v1/substructures").json()["items"]}
    assert listed == {"andrews-squeezer": True, "pendulum": True}
    versions = {each["name"]: each["digest"] for each in client.get("/v1/substructures").json()["items"]}
    assert versions["pendulum"] in str(digests(path))


def test_all_is_derived_anew(path: Path, store: Store, caplog: pytest.LogCaptureFixture) -> None:
    """As a server does in the background; pages and log say so."""
    caplog.set_level(logging.INFO, "service.operations.renewing")
    before, client = digests(path), make_client(store)
    assert "0 of 5 parts and trees are derived anew" in client.get("/trees").text
    assert not any(each["derived_here"] for kind in ("substructures", "trees") for each in _items(client, kind))
    assert Renewal(store).all() == 0
    assert "5 parts and trees are derived anew" in caplog.text
    assert "derived anew" not in client.get("/trees").text
    assert all(each["derived_here"] for kind in ("substructures", "trees") for each in _items(client, kind))
    assert digests(path) == before
    _is_right(client)
    caplog.clear()
    assert Renewal(store).all() == 0
    assert caplog.text == ""


@pytest.mark.parametrize("path", ["0016"], indirect=True)
def test_what_was_withdrawn_stays_so(path: Path) -> None:
    """Up to schema 0016 the columns had other names."""
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("UPDATE versions SET yanked = '2026-11-27T00:00:00Z', yank_reason = 'light'")
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as opened:
        told = make_client(opened).get("/v1/substructures/pendulum@1").json()
    assert [told[name] for name in ("is_withdrawn", "withdrawn_at", "withdrawal_reason")] == [
        True, "2026-11-27T00:00:00Z", "light",
    ]  # fmt: skip


def _items(client: TestClient, kind: str) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = client.get(f"/v1/{kind}").json()["items"]
    return found


def test_what_is_stopped_goes_on(tmp_path: Path) -> None:
    """What was done stays; the next start does the rest."""
    settings = Settings(database=f"sqlite:///{unpacked(OLD[0], tmp_path)}", catalogue=False)
    with open_store(settings) as store:
        Renewal(store).all(lambda _: True)
        with store.database.read() as connection:
            assert renewals.progress(connection) == (1, 5)
    with open_store(settings) as store:
        assert Renewal(store).all() == 0
        with store.database.read() as connection:
            assert renewals.progress(connection) is None


def test_it_is_work_of_processes_that_can_be_killed(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    works, compute = list[Work](), store.workers.compute

    def noted(share: str, work: Work, seconds: float) -> AttemptReport:
        works.append(work)
        return compute(share, work, seconds)

    monkeypatch.setattr(store.workers, "compute", noted)
    assert Renewal(store).all() == 0
    assert {work.kind for work in works} == {"renew-part", "renew-tree"}
    limits = store.settings.limits
    assert {work.budget.memory_bytes for work in works} == {limits.job_memory_bytes}
    assert all(0 < work.budget.cpu_seconds <= limits.job_cpu_seconds for work in works)


def test_what_takes_too_long_is_left(
    store: Store, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Its process was killed; the others have their turn."""
    compute = store.workers.compute

    def killed(share: str, work: Work, seconds: float) -> AttemptReport:
        if work.kind == "renew-part" and b"andrews" in b"".join(work.blobs.values()):
            raise TimeoutError("took more than 0.1 s")
        return compute(share, work, seconds)

    monkeypatch.setattr(store.workers, "compute", killed)
    assert Renewal(store).all() == 2, "the part, and the tree that has it"
    assert "cannot be derived anew: TimeoutError: took more than 0.1 s" in caplog.text
    _is_right(make_client(store))
    monkeypatch.undo()
    assert make_client(store).get("/v1/trees/machines").status_code == 200, "tried again when it is asked for"


def test_a_server_does_it_by_itself(tmp_path: Path) -> None:
    settings = Settings(database=f"sqlite:///{unpacked(OLD[0], tmp_path)}", catalogue=False, engine="none")
    with background(settings) as address, Client(address) as client:
        _is_right(client)
        for _ in range(600):
            if "derived anew" not in client.request("GET", "/trees").text:
                break
            sleep(0.1)
        items = client.request("GET", "/v1/trees").json()["items"]
        assert all(each["derived_here"] for each in items)
    with open_store(settings) as store:
        assert [finding for finding in verify_all(store.database) if finding.fault] == []


def test_what_cannot_be_derived_is_told(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """And is not served; all else is."""
    path = unpacked(OLD[0], tmp_path)
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("UPDATE parts SET definition = replace(definition, '/10', '/11') WHERE title = ''")
        connection.execute("UPDATE parts SET definition = replace(definition, 'm*l^2/10', 'm*l^2/11')")
        connection.commit()
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store:
        client = make_client(store)
        assert Renewal(store).all() >= 1
        assert "cannot be derived anew" in caplog.text
        answer = client.get("/v1/substructures/pendulum")
        assert (answer.status_code, answer.json()["code"]) == (500, "damaged-content")
        assert client.get("/v1/substructures/andrews-squeezer").status_code == 200
