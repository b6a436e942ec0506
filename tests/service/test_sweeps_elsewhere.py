"""Sweeps on workers of PostgreSQL and of Dask: a killed one costs a range of rows, and the table is the same."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from service.jobs.engines.dask import DaskEngine
from service.jobs.kinds import run
from service.jobs.kinds import sweep as kind
from substructures.client import Client

from .conftest import PENDULUM, SLIDER
from .databases import fresh
from .jobs_library import MemoryLibrary, compute
from .test_jobs_dask import Cluster, cluster, engine
from .test_jobs_servers import serving, until, working
from .test_sweeps import SWEEP

ROWS = 60 * kind.AT_ONCE
LARGE: dict[str, Any] = {
    "template": SWEEP["template"],
    "samples": {"method": "latin-hypercube", "count": ROWS, "seed": 4, "of": {"arm.m": {"uniform": [1, 3]}}},
    "columns": {**SWEEP["columns"], "reach": {"analysis": "reach", "of": "hand.tip"}},
    "where": "torque < 90",
}
__all__ = ["cluster", "engine"]  # fixtures
pytestmark = pytest.mark.deep


def expected() -> dict[str, Any]:
    """The rows as one process computes them."""
    library = MemoryLibrary([PENDULUM, SLIDER])
    found = [run("sweep", item, library.blobs, lambda _: None) for item in library.items("sweep", LARGE)]
    parts = [kind.rows_of(each.files["rows"]) for each in found]
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def table(client: Client, job: str) -> dict[str, Any]:
    found = client.request("GET", f"/v1/jobs/{job}/table", headers={"Accept": "application/x-npz"})
    return kind.rows_of(found.content)


def test_killed_workers_on_postgresql_cost_ranges(tmp_path: Path) -> None:
    with fresh("postgresql", tmp_path) as address, serving(address, tmp_path, "--engine", "none") as (_, client):
        for part in (PENDULUM, SLIDER):
            client.submit(part)
        job = client.submit_job({"kind": "sweep", **LARGE})["id"]
        for rounds in (1, 2):
            with working(address):
                until(lambda: client.job(job)["progress"]["done"] >= rounds)  # noqa: B023 -- called here
        with working(address), working(address):
            view = client.wait(job)
        assert (view["state"], view["progress"]["failed"]) == ("succeeded", 0)
        told = client.request("GET", f"/v1/jobs/{job}/table").json()
        assert (told["done"], told["rows"]) == (ROWS, ROWS)
        found, right = table(client, job), expected()
        for name, x in right.items():
            assert np.array_equal(found[name], x), name


@pytest.mark.parametrize("cluster", [2], indirect=True)
def test_a_killed_worker_of_dask_costs_ranges(cluster: Cluster, engine: DaskEngine) -> None:
    library = MemoryLibrary([PENDULUM, SLIDER])
    works = library.works("sweep", LARGE)
    killed: list[int] = []

    def disturb(done: int) -> None:
        if done >= 3 and not killed:
            cluster.workers[0].kill()
            killed.append(done)

    final = compute(engine, works, 150, disturb)
    assert killed
    right, at = expected(), 0
    for work in works:
        outcome = final[work.id].outcome
        assert outcome is not None
        rows = kind.rows_of(outcome.files["rows"])
        for name, x in rows.items():
            assert np.array_equal(x, right[name][at : at + len(x)]), name
        at += len(rows["row"])
    assert at == len(right["row"])
