"""A batch over HTTP on a Dask cluster that loses a worker and its scheduler: the results are those of one machine."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from substructures.client import Client

from .conftest import PENDULUM, SLIDER
from .farm import Server, finished, running, submit
from .test_jobs_dask import Cluster

BATCH, WORKERS = 300, 4
JOB: dict[str, Any] = {
    "kind": "assemble",
    "template": {"name": "cell", "instances": [{"name": "arm", "substructure": "pendulum"}]},
    "choices": {"arm.l": list(range(1, BATCH + 1))},
}


def results(client: Client, job: str) -> dict[int, Any]:
    """What came of every item, by position."""
    listed = list(client.job_items(job))
    found = {item["position"]: (item["state"], item["result"]) for item in listed}
    assert len(found) == len(listed) == BATCH
    return found


def computed(server: Server) -> dict[int, Any]:
    """The results of an undisturbed run."""
    with running([server]), Client(server.address) as client:
        prepare(client)
        job = submit([server], JOB, "batch")
        assert finished(client, job, 300)["state"] == "succeeded"
        return results(client, job)


def prepare(client: Client) -> None:
    for definition in (PENDULUM, SLIDER):
        client.submit(definition)


def wait_for(client: Client, job: str, done: int) -> None:
    """Until so many items are done, and not all."""
    end = time.monotonic() + 120
    while (progress := client.job(job)["progress"])["done"] < done:
        assert time.monotonic() < end, progress
        time.sleep(0.02)
    assert progress["done"] < BATCH, "the batch ended too early"


@pytest.fixture
def cluster() -> Iterator[Cluster]:
    opened = Cluster(WORKERS)
    yield opened
    opened.close()


@pytest.mark.deep
def test_a_batch_on_a_cluster_that_loses_a_worker_and_its_scheduler(cluster: Cluster, tmp_path: Path) -> None:
    expected = computed(Server(f"sqlite:///{tmp_path}/local.db", tmp_path / "local.log"))
    settings = ("--engine", "dask", "--engine-address", cluster.address)
    server = Server(f"sqlite:///{tmp_path}/dask.db", tmp_path / "dask.log", settings)
    with running([server]), Client(server.address) as client:
        prepare(client)
        job = submit([server], JOB, "batch")
        wait_for(client, job, 20)
        cluster.workers[0].kill()
        wait_for(client, job, 60)
        cluster.restart_scheduler()
        cluster.add_workers(WORKERS - 1)
        end = finished(client, job, 300)
        assert (end["state"], end["progress"]["done"], end["progress"]["failed"]) == ("succeeded", BATCH, 0)
        assert results(client, job) == expected
        listed = client.request("GET", "/v1/jobs?page_size=100").json()["items"]
        assert [each["id"] for each in listed] == [job]
        for name in {result["tree"].partition("@")[0] for _, result in expected.values()}:
            assert client.request("GET", f"/v1/trees/{name}").json()["revision"] == 1
