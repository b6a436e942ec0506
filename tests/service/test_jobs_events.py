"""Server-sent events: complete, in order, resumed where a reader left off, and ended with the job."""

from __future__ import annotations

import json
import threading
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import httpx2
import pytest
from fastapi.testclient import TestClient

from service.routes.jobs import job_streams
from service.server import background
from service.settings import Limits, Settings
from service.store import job_events as feed
from service.store.store import Store
from substructures.client import Client

from .conftest import PENDULUM, TREE
from .fake_engine import FakeEngine, eventually, export, finished, running, submitted

Event = tuple[int, str, dict[str, Any]]


def parsed(text: str) -> list[Event]:
    blocks = [block for block in text.split("\n\n") if block and not block.startswith(":")]
    fields = [dict(line.split(": ", 1) for line in block.split("\n")) for block in blocks]
    return [(int(f["id"]), f["event"], json.loads(f["data"])) for f in fields]


def read(client: TestClient, job: str, after: int | None = None) -> list[Event]:
    headers = {} if after is None else {"Last-Event-ID": str(after)}
    answer = client.get(f"/v1/jobs/{job}/events", headers=headers)
    assert answer.status_code == 200
    assert answer.headers["content-type"].startswith("text/event-stream")
    return parsed(answer.text)


def test_events_resume(filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    with running(store, FakeEngine()):
        job = submitted(filled, export("cell", "metric", "gravity", "forces"))
        finished(filled, job)
    events = read(filled, job)
    assert [event[0] for event in events] == list(range(1, len(events) + 1))
    assert events[0][2]["state"] == "queued"
    assert (events[-1][1], events[-1][2]["state"]) == ("state", "succeeded")
    succeeded = [position for _, _, data in events for position in data.get("succeeded", ())]
    assert sorted(succeeded) == [0, 1, 2]
    for after in (0, 1, len(events) - 1, len(events), 10**15):
        assert read(filled, job, after) == events[after:]
    assert filled.get(f"/v1/jobs/{job}/events", headers={"Last-Event-ID": "odd"}).text.startswith("id: 1\n")
    monkeypatch.setattr(job_streams, "EVENTS", 2)
    assert read(filled, job) == events
    assert filled.get("/v1/jobs/none/events").status_code == 404


def test_events_add_up(filled: TestClient, store: Store) -> None:
    """Also of items that are known at submission, and of those that are cancelled before they start."""

    def changed(job: str, state: str) -> list[int]:
        return sorted(position for _, _, data in read(filled, job) for position in data.get(state, ()))

    with running(store, FakeEngine()):
        finished(filled, submitted(filled, export("cell", "metric", "gravity")))
    known = submitted(filled, export("cell", "gravity", "forces", "metric"))
    filled.post(f"/v1/jobs/{known}/cancel")
    assert (changed(known, "succeeded"), changed(known, "cancelled")) == ([0, 2], [1])
    with running(store, FakeEngine(slots=1, is_open=False)):
        job = submitted(filled, export("cell", "forces", "bias", "coriolis"))
        eventually(filled, job, lambda view: view["state"] == "running")
        filled.post(f"/v1/jobs/{job}/cancel")
        finished(filled, job)
    assert changed(job, "cancelled") == [0, 1, 2]


def test_events_as_they_happen(filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(job_streams, "HEARTBEAT", 0.05)
    monkeypatch.setattr(feed, "POLL", 0.01)
    with running(store, FakeEngine(slots=1, is_open=False)) as engine:
        job = submitted(filled, export("cell", "metric", "gravity"))
        texts: list[str] = []
        reader = threading.Thread(target=lambda: texts.append(filled.get(f"/v1/jobs/{job}/events").text))
        reader.start()
        eventually(filled, job, lambda view: view["state"] == "running")
        reader.join(0.2)
        assert reader.is_alive()
        engine.open()
        reader.join(10)
    assert ": still here" in texts[0]
    assert parsed(texts[0])[-1][2]["state"] == "succeeded"


def test_events_end_with_the_server(filled: TestClient, store: Store) -> None:
    job = submitted(filled, export("cell", "metric"))
    texts: list[str] = []
    reader = threading.Thread(target=lambda: texts.append(filled.get(f"/v1/jobs/{job}/events").text))
    reader.start()
    reader.join(0.3)
    assert reader.is_alive()
    store.runtime.stopping.set()
    reader.join(5)
    assert [event[2]["state"] for event in parsed(texts[0])] == ["queued"]


def test_streams_are_limited_and_share_one_look(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three streams read their own events once each; then one look serves all, and the fourth has no place."""
    reads, looks = list[str](), list[set[str]]()
    read_own, look = job_streams._read, feed.latest
    monkeypatch.setattr(job_streams, "_read", lambda store, job, seq: (reads.append(job), read_own(store, job, seq))[1])
    monkeypatch.setattr(feed, "latest", lambda connection, known: (looks.append(known), look(connection, known))[1])
    monkeypatch.setattr(feed, "POLL", 0.05)
    limits = Limits(event_streams_per_key=3)
    settings = Settings(database=f"sqlite:///{tmp_path}/x.db", catalogue=False, engine="none", limits=limits)
    with background(settings) as address, Client(address) as client, ExitStack() as opened:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        job = client.request("POST", "/v1/jobs", json=export("cell", "metric")).json()["id"]
        url = f"{address}/v1/jobs/{job}/events"
        streams = [opened.enter_context(httpx2.stream("GET", url)) for _ in range(3)]
        texts = [stream.iter_text() for stream in streams]
        assert all("queued" in next(text) for text in texts)
        refused = httpx2.get(url)
        assert (refused.status_code, refused.json()["code"]) == (503, "too-many-streams")
        time.sleep(0.5)
        assert len(reads) <= 6  # what there was, and that there is no more
        assert len(looks) >= 3
        client.request("POST", f"/v1/jobs/{job}/cancel", json={})
        assert all("cancelled" in "".join(text) for text in texts)
    with background(settings) as address:  # places were given back with the streams
        assert httpx2.get(f"{address}/v1/jobs/{job}/events").status_code == 200
