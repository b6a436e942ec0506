"""The clock of the host jumps while jobs run: by hours, by a year, forth and back."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, tzinfo
from pathlib import Path
from time import sleep
from typing import Any

import pytest

from service.app import open_store
from service.database import clock, connections
from service.server import background
from service.settings import Limits, Settings
from substructures.client import Client

from .conftest import PENDULUM, TREE, make_client
from .databases import fresh
from .fake_engine import FakeEngine, export, running, submitted

#: hours; beyond a day keys of requests are forgotten, beyond a month results of jobs, as if the time had passed
JUMPS = (20, -20, 0, 9000, -9000)
ITEMS = 60
KEPT = 24


class Jumping(datetime):
    """The clock of a host that somebody sets while it runs."""

    ahead = timedelta()

    @classmethod
    def now(cls, tz: tzinfo | None = None) -> datetime:  # type: ignore[override]
        return datetime.now(tz) + cls.ahead


def job(number: int) -> dict[str, Any]:
    items = [
        {
            "name": f"t{number}-{k}",
            "instances": [{"name": "a", "substructure": "simple-pendulum", "parameters": {"l": 1 + k}}],
        }
        for k in range(ITEMS)
    ]
    return {"kind": "assemble", "items": items}


def _jumping(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (clock, connections):
        monkeypatch.setattr(module, "datetime", Jumping)


@pytest.mark.deep
@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_jobs_end_and_nothing_is_doubled(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _jumping(monkeypatch)
    with fresh(kind, tmp_path) as database:
        settings = Settings(database=database, port=0, workers=1, limits=Limits(lease_seconds=1))
        with background(settings) as address, Client(address, timeout=60) as client:
            for number, hours in enumerate(JUMPS):
                key = {"Idempotency-Key": f"job-{number}"}
                begun = client.request("POST", "/v1/jobs", job(number), headers=key).json()["id"]
                monkeypatch.setattr(Jumping, "ahead", timedelta(hours=hours))
                if abs(hours) < KEPT:
                    assert client.request("POST", "/v1/jobs", job(number), headers=key).json()["id"] == begun
                assert client.wait(begun)["state"] == "succeeded"
                assert all(each["state"] == "succeeded" for each in client.job_items(begun))
            trees = client.request("GET", "/v1/trees?page_size=500").json()["items"]
            assert [each["revision"] for each in trees] == [1] * len(JUMPS) * ITEMS


def test_hosts_of_one_database_keep_its_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A host whose clock is set ahead would hold its items until then, if it died."""
    _jumping(monkeypatch)
    with fresh("postgresql", tmp_path) as address:
        settings = Settings(database=address, catalogue=False, limits=Limits(lease_seconds=1))
        with open_store(settings) as store, running(store, FakeEngine(is_open=False)):
            client = make_client(store)
            client.post("/v1/substructures", json=PENDULUM)
            client.post("/v1/trees", json=TREE)
            submitted(client, export("cell", "metric"))
            monkeypatch.setattr(Jumping, "ahead", timedelta(hours=20))
            assert clock.time_now() - datetime.now(UTC) > timedelta(hours=19)
            for _ in range(100):
                if abs(clock.time_now() - datetime.now(UTC)) < timedelta(seconds=1):
                    return
                sleep(0.1)
    raise AssertionError("the clock of the host was kept")
