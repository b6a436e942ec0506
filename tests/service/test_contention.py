"""Many clients at a time: nobody is told that the database is locked, and nothing written is missing."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from substructures.client import Client

from .conftest import PENDULUM
from .farm import Server, finished, running

WRITERS, READERS, SECONDS = 8, 32, 20.0


def tree(writer: int, i: int) -> dict[str, Any]:
    instance = {"name": "arm", "substructure": "pendulum", "parameters": {"m": f"{writer + 1}/{i + 1}"}}
    return {"name": f"tree-{writer}-{i}", "instances": [instance]}


@pytest.mark.deep
def test_eight_writers_and_thirty_two_readers(tmp_path: Path) -> None:
    one = Server(f"sqlite:///{tmp_path}/store.db", tmp_path / "log")
    over = threading.Event()

    def write(writer: int) -> list[str]:
        names, jobs = [], []
        with Client(one.address) as client:
            while not over.is_set():
                made = client.create_tree(tree(writer, len(names)))
                names.append(str(made["name"]))
                evaluation = {"tree": names[-1], "request": {"quantities": ["metric"], "q": [[0.1]]}}
                job = client.request("POST", "/v1/jobs", {"kind": "evaluate", "items": [evaluation]})
                jobs.append(str(job.json()["id"]))
            for job in jobs:
                assert finished(client, job, 120)["state"] == "succeeded"
        return names

    def read(_: int) -> int:
        count = 0
        with Client(one.address) as client:
            while not over.is_set():
                client.substructure("pendulum")
                client.request("GET", "/v1/jobs?page_size=5")
                client.evaluate("probe", quantities=["metric"], q=[0.1])
                count += 3
        return count

    with running([one]), ThreadPoolExecutor(WRITERS + READERS) as pool:
        with Client(one.address) as client:
            client.submit(PENDULUM)
            client.create_tree({**tree(99, 0), "name": "probe"})
        writers = [pool.submit(write, k) for k in range(WRITERS)]
        readers = [pool.submit(read, k) for k in range(READERS)]
        time.sleep(SECONDS)
        over.set()
        names = [name for each in writers for name in each.result()]
        reads = sum(each.result() for each in readers)
        with Client(one.address) as client:
            for name in names[::7]:
                assert client.request("GET", f"/v1/trees/{name}").json()["revision"] == 1
    assert len(names) == len(set(names)) > WRITERS
    assert reads > READERS
    assert "locked" not in one.log.read_text()
    print(f"{len(names)} trees and jobs written, {reads} requests answered")
