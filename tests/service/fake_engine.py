"""An engine without processes: computes at once, or when the test lets it, or dies as the test wants."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from fastapi.testclient import TestClient

from service.jobs.engines.engine import AttemptReport, Outcome, Work
from service.jobs.kinds import run
from service.queue.supervisor import Supervisor
from service.store.store import Store


class FakeEngine:
    """``slots`` works at a time; ``allowed``: how many may end; ``death`` says what is seen of a work."""

    def __init__(self, slots: int = 2, death: Callable[[Work], str] = lambda _: "", is_open: bool = True) -> None:
        self.slots, self.death = slots, death
        self.allowed = math.inf if is_open else 0
        self.works: dict[str, Work] = {}
        self.started: list[Work] = []
        self.stopped: list[str] = []
        self.is_closed = False

    @property
    def free(self) -> int:
        return self.slots - len(self.works)

    def open(self) -> None:
        """Let everything end."""
        self.allowed = math.inf

    def start(self, work: Work) -> None:
        self.works[work.id] = work
        self.started.append(work)

    def stop(self, attempt: str) -> None:
        self.works.pop(attempt, None)
        self.stopped.append(attempt)

    def reports(self, seconds: float) -> list[AttemptReport]:
        if not self.works or self.allowed < 1:
            time.sleep(min(seconds, 0.01))
            return [AttemptReport(identifier, fraction=0.5) for identifier in self.works]
        ready = list(self.works)[: int(min(self.allowed, self.slots))]
        self.allowed -= len(ready)
        return [self._report(self.works.pop(identifier)) for identifier in ready]

    def _report(self, work: Work) -> AttemptReport:
        death = self.death(work)
        return AttemptReport(work.id, death=death) if death else AttemptReport(work.id, outcome=self.compute(work))

    def compute(self, work: Work) -> Outcome:
        return run(work.kind, dict(work.item), work.blobs, lambda _: None)

    def close(self) -> None:
        self.is_closed = True


@contextmanager
def running(store: Store, engine: FakeEngine) -> Iterator[FakeEngine]:
    """A supervisor with this engine while the block lasts."""
    supervisor = Supervisor(store, lambda: engine)
    supervisor.start()
    try:
        yield engine
    finally:
        engine.open()
        supervisor.close()


def export(tree: str, *quantities: str) -> dict[str, Any]:
    """A submission that exports quantities of a tree."""
    items = [{"tree": tree, "quantity": quantity, "format": "text"} for quantity in quantities]
    return {"kind": "export", "items": items}


def submitted(client: TestClient, body: dict[str, Any], **headers: str) -> str:
    """The id of a job."""
    answer = client.post("/v1/jobs", json=body, headers=headers)
    assert answer.status_code == 202, answer.text
    assert answer.headers["location"] == f"/v1/jobs/{answer.json()['id']}"
    return str(answer.json()["id"])


def finished(client: TestClient, job: str, seconds: float = 10) -> dict[str, Any]:
    """The job when it has ended."""
    return eventually(client, job, lambda view: view["state"] in ("succeeded", "failed", "cancelled"), seconds)


def eventually(
    client: TestClient, job: str, is_so: Callable[[dict[str, Any]], bool], seconds: float = 10
) -> dict[str, Any]:
    """The job as soon as it is so."""
    end = time.monotonic() + seconds
    while True:
        view: dict[str, Any] = client.get(f"/v1/jobs/{job}").json()
        if is_so(view):
            return view
        assert time.monotonic() < end, view
        time.sleep(0.01)


def items(client: TestClient, job: str) -> list[dict[str, Any]]:
    """The items of a job with what came of them."""
    return list(client.get(f"/v1/jobs/{job}/result?page_size=1000").json()["items"])
