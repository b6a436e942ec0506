"""The Dask engine on a cluster of loopback: what is computed, cancelling, lost workers, a scheduler that restarts."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from service.jobs.engines import dask
from service.jobs.engines.dask import DaskEngine
from service.jobs.engines.engine import AttemptReport, Budget, Work
from service.jobs.kinds import run

from .conftest import PENDULUM, SLIDER, TREE
from .jobs_library import BUDGET, MemoryLibrary, chain, compute

ROOT = Path(__file__).parents[2]
QUIET = ("--no-dashboard", "--host", "127.0.0.1")


class Cluster:
    """A scheduler on a free port, and workers of one thread, all processes of their own."""

    def __init__(self, workers: int) -> None:
        with socket.create_server(("127.0.0.1", 0)) as free:
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.workers: list[subprocess.Popen[bytes]] = []
        self.start_scheduler()
        self.add_workers(workers)

    def start_scheduler(self) -> None:
        self.scheduler = self._start("dask_scheduler", "--port", str(self.port), "--no-show")

    def add_workers(self, count: int, *more: str) -> None:
        options = ("--nthreads", "1", "--no-nanny", "--memory-limit", "0", "--death-timeout", "60", *more)
        self.workers += [self._start("dask_worker", self.address, *options) for _ in range(count)]

    def _start(self, command: str, *arguments: str) -> subprocess.Popen[bytes]:
        line = [sys.executable, "-m", f"distributed.cli.{command}", *arguments, *QUIET]
        environment = {**os.environ, "PYTHONWARNINGS": "default"}
        return subprocess.Popen(line, cwd=ROOT, env=environment, stderr=subprocess.DEVNULL)

    def restart_scheduler(self) -> None:
        """As after a crash: nothing is remembered, and its workers go."""
        self.scheduler.kill()
        self.scheduler.wait()
        for worker in self.workers:
            worker.wait(30)
        self.start_scheduler()

    def close(self) -> None:
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return MemoryLibrary([PENDULUM, SLIDER], [TREE])


@pytest.fixture
def cluster(request: pytest.FixtureRequest) -> Iterator[Cluster]:
    """As many workers as the test asks for."""
    opened = Cluster(getattr(request, "param", 1))
    yield opened
    opened.close()


@pytest.fixture
def engine(cluster: Cluster) -> Iterator[DaskEngine]:
    opened = DaskEngine(cluster.address)
    connected(opened)
    yield opened
    opened.close()


def connected(engine: DaskEngine) -> None:
    for _ in range(300):
        if engine.free:
            return
        engine.reports(0.1)
    raise AssertionError("no cluster was found")


def runners(worker: subprocess.Popen[bytes]) -> list[int]:
    """The runners that a worker has started."""
    tasks = Path(f"/proc/{worker.pid}/task")
    return [int(pid) for task in tasks.iterdir() for pid in (task / "children").read_text().split()]


def cells(library: MemoryLibrary, count: int) -> list[Work]:
    return library.works("assemble", {"items": [{**TREE, "name": f"cell-{k}"} for k in range(count)]})


def check(works: list[Work], reports: dict[str, AttemptReport]) -> None:
    """Every work has the result that it has in place."""
    for work in works:
        outcome = reports[work.id].outcome
        expected = run(work.kind, dict(work.item), work.blobs, lambda _: None)
        assert outcome is not None, reports[work.id].death
        assert outcome.problem is None
        assert outcome.files["program"] == expected.files["program"]


def check_limits(worker: subprocess.Popen[bytes], engine: DaskEngine, library: MemoryLibrary) -> None:
    """The only worker of an engine computes within limits until it is stopped; one runner more is killed."""
    works = cells(library, 5)
    check(works, compute(engine, works))
    (long,) = library.works("derive", {"items": [chain(60)]}, Budget(0.2, 2**31))
    outcome = compute(engine, [long])[long.id].outcome
    assert outcome is not None
    assert outcome.problem is not None
    assert outcome.problem["code"] == "cpu-limit"
    free = engine.free
    (endless,) = library.works("derive", {"items": [chain(60)]}, BUDGET)
    check(works, compute(engine, works))  # from here on the runner is warm
    engine.start(endless)
    assert engine.free == free - 1
    time.sleep(0.5)
    (before,) = runners(worker)
    start = time.monotonic()
    engine.stop(endless.id)
    while before in runners(worker):
        assert time.monotonic() - start < 20  # the work takes minutes
        time.sleep(0.02)
    assert engine.reports(0.2) == []
    check(works, compute(engine, works))
    engine.start(endless)
    time.sleep(0.5)
    (victim,) = runners(worker)
    os.kill(victim, signal.SIGKILL)
    reports = [report for _ in range(20) for report in engine.reports(0.1) if report.is_final]
    assert [(report.id, "signal 9" in report.death) for report in reports] == [(endless.id, True)]
    check(works, compute(engine, works))


@pytest.mark.deep
@pytest.mark.parametrize("cluster", [4], indirect=True)
def test_killed_worker_and_restarted_scheduler_lose_nothing(
    cluster: Cluster, engine: DaskEngine, library: MemoryLibrary
) -> None:
    works = cells(library, 300)

    def restart() -> None:
        cluster.restart_scheduler()
        cluster.add_workers(3)

    disturbances: list[tuple[int, Callable[[], object]]] = [(60, cluster.workers[0].kill), (150, restart)]

    def disturb(done: int) -> None:
        while disturbances and done > disturbances[0][0]:
            disturbances.pop(0)[1]()

    final = compute(engine, works, 150, disturb)
    assert not disturbances
    check(works, final)


@pytest.mark.deep
def test_attempts_are_given_up_when_the_cluster_stays_away(
    cluster: Cluster, library: MemoryLibrary, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask, "SILENCE", 2.0)
    engine = DaskEngine(cluster.address)
    try:
        connected(engine)
        (work,) = library.works("derive", {"items": [chain(60)]}, BUDGET)
        engine.start(work)
        cluster.close()
        reports = [report for _ in range(150) for report in engine.reports(0.1) if report.is_final]
        assert [report.id for report in reports] == [work.id]
        assert "scheduler" in reports[0].death
        assert engine.free == 0
    finally:
        engine.close()
