"""Servers that are killed in mid-batch, and servers that share a queue: nothing lost, nothing doubled."""

from __future__ import annotations

import os
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

from service import server
from service.app import open_store
from service.cli.main import main
from service.jobs.engines.engine import Outcome, Work
from service.queue.supervisor import Supervisor
from service.settings import Settings
from substructures.client import Client

from .conftest import HAND, PENDULUM, TREE, make_client
from .databases import fresh
from .fake_engine import FakeEngine, export, finished, running, submitted
from .farm import Server
from .farm import running as running_servers


def cells(count: int, name: str = "c") -> dict[str, Any]:
    """A job that assembles so many trees."""
    template = {"name": name, "instances": [{"name": "a", "substructure": "pendulum"}]}
    return {"kind": "assemble", "template": template, "choices": {"a.l": list(range(1, count + 1))}}


def exports(count: int) -> dict[str, Any]:
    items = [{**export("cell", "metric")["items"][0], "bind": f"arm.l:{k}"} for k in range(1, count + 1)]
    return {"kind": "export", "items": items}


class Slow(FakeEngine):
    """Takes long enough for another to have its turn."""

    def compute(self, work: Work) -> Outcome:
        time.sleep(0.04)
        return super().compute(work)


@contextmanager
def serving(database: str, folder: Path, *options: str) -> Iterator[tuple[Server, Client]]:
    """A server with one worker, and its client."""
    one = Server(database, folder / "log", ("--workers", "1", *options))
    one.environment["SUBSTRUCTURES_LIMIT_LEASE_SECONDS"] = "2"
    with running_servers([one]), Client(one.address) as client:
        yield one, client


@contextmanager
def working(database: str) -> Iterator[None]:
    """A worker that is killed in the end."""
    command = [sys.executable, "-m", "service.cli.main", "worker", "--database", database, "--workers", "1"]
    process = subprocess.Popen(command, env={**os.environ, "SUBSTRUCTURES_LIMIT_LEASE_SECONDS": "2"})
    try:
        yield
    finally:
        process.kill()
        process.wait(30)


def until(condition: Callable[[], bool], seconds: float = 120) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def test_a_killed_server_loses_and_doubles_nothing(tmp_path: Path) -> None:
    """Neither of what was acknowledged, nor of a job. The two starts take 7 s of CPU."""
    with serving(f"sqlite:///{tmp_path / 'x.db'}", tmp_path) as (one, client):
        version, is_new = client.submit(PENDULUM)
        assert is_new
        client.create_tree(TREE)
        tree = client.couple("cell", HAND)
        job = client.submit_job(cells(40))["id"]
        until(lambda: client.job(job)["progress"]["done"] >= 10)
        one.kill()
        one.start()
        assert client.substructure("pendulum@1") == version
        assert client.request("GET", "/v1/trees/cell").json() == tree
        assert client.evaluate("cell", quantities=["metric"], q=[0, 0])["count"] == 1
        assert client.submit(PENDULUM) == (version, False)
        view = client.wait(job)
        assert (view["state"], view["progress"]["failed"]) == ("succeeded", 0)
        names = [item["result"]["name"] for item in client.job_items(job)]
        assert one.stop() == 0
    with closing(sqlite3.connect(tmp_path / "x.db")) as connection:
        trees = connection.execute("SELECT name, count(*) FROM trees GROUP BY name").fetchall()
        assert sorted(trees) == sorted([("cell", 2), *((name, 1) for name in names)])
        assert len(names) == 40
        assert connection.execute("PRAGMA integrity_check").fetchall() == [("ok",)]


def test_a_stopped_supervisor_hands_its_items_back(settings: Settings) -> None:
    with open_store(settings) as store:
        client = make_client(store)
        client.post("/v1/substructures", json=PENDULUM)
        client.post("/v1/trees", json=TREE)
        engine = FakeEngine(slots=2, is_open=False)
        supervisor = Supervisor(store, lambda: engine)
        supervisor.start()
        job = submitted(client, export("cell", "metric", "gravity", "forces"))
        until(lambda: len(engine.started) == 2)
        supervisor.close()
        assert engine.is_closed
        states = [item["state"] for item in client.get(f"/v1/jobs/{job}/items").json()["items"]]
        assert states == ["queued"] * 3
        with running(store, FakeEngine()):
            view = finished(client, job)
        assert (view["state"], view["attempts"]) == ("succeeded", 3)  # what was handed back does not count


def test_supervisors_share_a_queue_on_postgresql(tmp_path: Path) -> None:
    with fresh("postgresql", tmp_path) as address:
        settings = Settings(database=address, catalogue=False)
        with open_store(settings) as one, open_store(settings) as two:
            client = make_client(one)
            client.post("/v1/substructures", json=PENDULUM)
            client.post("/v1/trees", json=TREE)
            engines = Slow(), Slow()
            with running(one, engines[0]), running(two, engines[1]):
                jobs = [submitted(client, exports(60)), submitted(make_client(two), exports(80))]
                assert {finished(client, job, 30)["state"] for job in jobs} == {"succeeded"}
        works = [work.item["bind"] for engine in engines for work in engine.started]
        assert len(works) == len(set(works)) == 80  # equal items of both jobs were computed once
        assert all(engine.started for engine in engines)


@pytest.mark.deep
def test_a_killed_worker_on_postgresql_is_replaced(tmp_path: Path) -> None:
    with fresh("postgresql", tmp_path) as address, serving(address, tmp_path, "--engine", "none") as (_, client):
        client.submit(PENDULUM)
        job = client.submit_job(cells(40))["id"]
        with working(address):
            until(lambda: client.job(job)["progress"]["done"] >= 5)
        with working(address):
            view = client.wait(job)
        assert (view["state"], view["progress"]["failed"]) == ("succeeded", 0)
        assert len({item["result"]["tree"] for item in client.job_items(job)}) == 40


@pytest.mark.deep
def test_a_worker_ends_when_all_jobs_have_ended(tmp_path: Path) -> None:
    """With exit status 0; what came while it worked is done, too."""
    with fresh("postgresql", tmp_path) as address, serving(address, tmp_path, "--engine", "none") as (_, client):
        client.submit(PENDULUM)
        first = client.submit_job(cells(20))["id"]
        command = [sys.executable, "-m", "service.cli.main", "worker", "--database", address, "--workers", "1"]
        process = subprocess.Popen([*command, "--exit-when-idle"])
        try:
            until(lambda: client.job(first)["progress"]["done"] >= 1)
            second = client.submit_job(cells(20, "d"))["id"]
            assert process.wait(60) == 0
        finally:
            process.kill()
        assert {client.job(job)["state"] for job in (first, second)} == {"succeeded"}


def test_a_worker_waits_for_jobs_that_others_have(settings: Settings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "IDLE", 0.2)
    monkeypatch.setattr(server, "LOOK", 0.02)
    with open_store(settings) as store:
        client = make_client(store)
        client.post("/v1/substructures", json=PENDULUM)
        client.post("/v1/trees", json=TREE)
        job = submitted(client, export("cell", "metric"))
        waiting = threading.Thread(target=server.wait_for_end, args=(store,))
        waiting.start()
        waiting.join(1.0)
        assert waiting.is_alive()
        with running(store, FakeEngine()):
            finished(client, job)
        waiting.join(10)
        assert not waiting.is_alive()


def test_a_worker_needs_a_shared_database(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["worker", "--database", f"sqlite:///{tmp_path / 'x.db'}"]) == 1
    assert "PostgreSQL" in capsys.readouterr().err
    assert main(["serve", "--engine", "dask", "--database", f"sqlite:///{tmp_path / 'x.db'}"]) == 1
    assert "--engine-address" in capsys.readouterr().err
