"""The runners of requests: turns of owners, one runner that is free for others, ends of time, deaths."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest

from service.jobs.engines.engine import AttemptReport, Budget, Outcome, Work
from service.jobs.engines.local import LocalEngine
from service.jobs.engines.pool import InProcess, WorkerPool
from service.jobs.worker import Worker, Workers
from service.messages.refusals import Refused
from substructures import Definition
from substructures.documents import read_json
from substructures.errors import InvalidDocument, TooLarge

from .conftest import PENDULUM
from .jobs_library import BUDGET, chain

MEMORY = 2**31
SECONDS = 60.0


def until(condition: Callable[[], Any], seconds: float = SECONDS) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


class Gated:
    """An engine whose works end when the test says so; ``begun``: their ids in order."""

    def __init__(self) -> None:
        self.workers, self.running, self.begun = 1, dict[str, Work](), list[str]()
        self.stopped, self.ended, self._news = list[str](), 0, threading.Event()
        self._reports: list[AttemptReport] = []
        self.is_closed = False

    @property
    def free(self) -> int:
        return self.workers - len(self.running)

    def start(self, work: Work) -> None:
        self.begun.append(work.id)
        self.running[work.id] = work

    def stop(self, attempt: str) -> None:
        self.running.pop(attempt, None)
        self.stopped.append(attempt)

    def end(self, attempt: str, **told: Any) -> None:
        del self.running[attempt]
        self._reports.append(AttemptReport(attempt, **({"outcome": Outcome({"done": attempt})} | told)))
        self._news.set()

    def interrupt(self) -> None:
        self._news.set()

    def reports(self, seconds: float) -> list[AttemptReport]:
        self._news.wait(seconds)
        self._news.clear()
        found, self._reports = self._reports, []
        return found

    def close(self) -> None:
        self.is_closed = True


@pytest.fixture
def gated() -> Iterator[tuple[Gated, Workers, Callable[..., Future[AttemptReport]]]]:
    engine = Gated()
    pool = WorkerPool(3, lambda: engine)  # type: ignore[arg-type,return-value]
    threads = ThreadPoolExecutor(32)

    def ask(name: str, share: str, seconds: float = SECONDS) -> Future[AttemptReport]:
        return threads.submit(pool.compute, share, Work(name, "derive", {}, {}, BUDGET), seconds)

    yield engine, pool, ask
    pool.close()
    threads.shutdown()


def test_one_runner_is_free_for_others(gated: Any) -> None:
    """However much one owner asks for, another one's work begins at once; then all have turns."""
    engine, _, ask = gated
    many = [ask(f"many{k}", "many") for k in range(6)]
    until(lambda: len(engine.begun) == 2)
    one = [ask("one0", "one")]
    until(lambda: "one0" in engine.begun)
    one += [ask(f"one{k}", "one") for k in (1, 2)]
    until(lambda: engine.workers == 3)
    for _ in range(9):
        until(lambda: engine.running)
        count = len(engine.begun)
        engine.end(next(iter(engine.running)))
        until(lambda count=count: len(engine.begun) > count or len(engine.begun) == 9)
    assert all(each.result(SECONDS).outcome is not None for each in (*many, *one))
    assert engine.begun.index("one1") < 6
    assert engine.begun.index("one2") < 8


def test_runners_are_started_when_they_are_needed(gated: Any) -> None:
    engine, _, ask = gated
    first = ask("first", "a")
    until(lambda: engine.begun)
    assert engine.workers == 1
    second = ask("second", "b")
    until(lambda: len(engine.begun) == 2)
    for name in ("first", "second"):
        engine.end(name)
    assert {each.result(SECONDS).id for each in (first, second)} == {"first", "second"}


def test_who_waits_no_longer_is_stopped_or_not_begun(gated: Any) -> None:
    engine, _, ask = gated
    begun = ask("begun", "a", 2.0)
    until(lambda: engine.begun)
    other = ask("other", "a")
    until(lambda: len(engine.begun) == 2)
    late = ask("late", "a", 0.1)
    for each in (begun, late):
        with pytest.raises(TimeoutError):
            each.result(SECONDS)
    until(lambda: "begun" in engine.stopped)
    engine.end("other")
    assert other.result(SECONDS).outcome == Outcome({"done": "other"})
    again = ask("again", "a")
    until(lambda: "again" in engine.begun)
    assert "late" not in engine.begun
    engine.end("again")
    assert again.result(SECONDS).id == "again"


def test_a_pool_may_start_when_it_is_needed() -> None:
    engines: list[Gated] = []

    def start() -> Any:
        engines.append(Gated())
        return engines[0]

    pool = WorkerPool(2, start, warm=False)
    pool.close()
    assert engines == []
    pool = WorkerPool(2, start, warm=False)
    with ThreadPoolExecutor(1) as threads:
        asked = threads.submit(pool.compute, "a", Work("one", "derive", {}, {}, BUDGET), SECONDS)
        until(lambda: engines and engines[0].begun)
        engines[0].end("one")
        assert asked.result(SECONDS).outcome == Outcome({"done": "one"})
    pool.close()


def test_at_the_end_all_are_told(gated: Any) -> None:
    engine, pool, ask = gated
    asked = [ask(f"work{k}", "a") for k in range(4)]
    until(lambda: len(engine.begun) == 2)
    pool.close()
    assert {each.result(SECONDS).death for each in asked} == {"the server stops"}
    assert engine.is_closed
    assert ask("late", "a").result(SECONDS).death == "the server stops"


@pytest.fixture(scope="module")
def pool() -> Iterator[WorkerPool]:
    found = WorkerPool(2, lambda: LocalEngine(1))
    yield found
    found.close()


def worker(workers: Workers, cpu_seconds: float = SECONDS, seconds: float = SECONDS) -> Worker:
    return Worker(workers, "me", cpu_seconds, time.monotonic() + seconds, MEMORY)


def item(document: dict[str, Any], nodes: int = 100_000, **more: Any) -> dict[str, Any]:
    return {"definition": read_json(Definition.read(document).canonical()), "nodes": nodes, **more}


BUSY = item(chain(40))


def test_what_a_runner_makes(pool: WorkerPool) -> None:
    """The same as this process does, and the time that it took."""
    here, there = worker(InProcess()), worker(pool)
    ours, theirs = (ask("derive", item(PENDULUM)) for ask in (here, there))
    assert (theirs.summary, theirs.files["program"]) == (ours.summary, ours.files["program"])
    assert 0 < SECONDS - there.cpu_seconds < SECONDS / 2


def test_refusals_are_those_of_the_work(pool: WorkerPool) -> None:
    wrong = {**PENDULUM, "bodies": [{**PENDULUM["bodies"][0], "mass": "no_name"}]}
    for workers in (pool, InProcess()):
        ask = worker(workers)
        with pytest.raises(InvalidDocument, match="no_name") as invalid:
            ask("derive", item(wrong))
        assert [fault.pointer for fault in invalid.value.faults] == ["/bodies/0/mass"]
        with pytest.raises(TooLarge) as large:
            ask("derive", item(PENDULUM, 3))
        assert large.value.limit == 3
        with pytest.raises(TimeoutError, match="operations"):  # it is not begun
            ask("derive", item(chain(12), admit=100))
        with pytest.raises(Refused) as refused:
            ask("print-part", {"digest": "sha256:no", "program": "sha256:no", "selected": "sha256:no"})
        assert refused.value.status == 500


def test_cpu_time_and_the_clock_end_a_work(pool: WorkerPool) -> None:
    start = time.monotonic()
    with pytest.raises(TimeoutError):
        worker(pool, cpu_seconds=0.3)("derive", BUSY)
    with pytest.raises(TimeoutError):
        worker(pool, seconds=0.3)("derive", BUSY)
    ask = worker(pool)
    ask.cpu_seconds = 0
    with pytest.raises(TimeoutError, match="no time left"):
        ask("derive", BUSY)
    assert time.monotonic() - start < SECONDS / 2
    assert worker(pool)("derive", item(PENDULUM)).files  # there is another runner


def test_work_that_is_given_up_ends_where_it_tells_how_far_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also in a process that cannot be ended: closing it waits for what was begun."""
    told = 0

    def endless(_kind: str, _item: Any, _blobs: Any, progress: Callable[[float], None]) -> Outcome:
        nonlocal told
        while True:
            told += 1
            progress(0.5)
            time.sleep(0.001)

    monkeypatch.setattr("service.jobs.engines.pool.run", endless)
    workers = InProcess()
    with pytest.raises(TimeoutError):
        worker(workers, seconds=0.2)("derive", item(PENDULUM))
    workers.close()
    assert told > 1


def test_memory_ends_a_work(pool: WorkerPool) -> None:
    ask = worker(pool)
    ask.memory_bytes = 150 * 2**20
    with pytest.raises(Refused, match="memory") as refused:
        ask("derive", BUSY)
    assert (refused.value.status, refused.value.code) == (422, "memory-limit")


def test_a_work_whose_runner_is_killed_is_computed_again(pool: WorkerPool) -> None:
    found: list[Any] = []

    def ask() -> None:
        try:
            found.append(worker(pool)("derive", item(chain(12))))
        except Refused as error:
            found.append(error)

    thread = threading.Thread(target=ask)
    thread.start()
    until(lambda: pool._engine and pool._engine._running)
    (process,) = pool._engine._running.values()
    os.kill(process.pid, signal.SIGKILL)
    thread.join(SECONDS)
    assert found[0].summary["dof"] == 12


def test_killed_again_and_again_it_says_so() -> None:
    class Deadly:
        def compute(self, _share: str, work: Work, _seconds: float) -> AttemptReport:
            return AttemptReport(work.id, death="killed by signal 9")

        def close(self) -> None:
            """Nothing."""

    with pytest.raises(Refused, match="killed, and so was the next one") as refused:
        worker(Deadly())("derive", {})
    assert (refused.value.status, refused.value.code, refused.value.headers) == (
        503,
        "restarting",
        {"Retry-After": "1"},
    )


def test_budgets_are_what_is_left() -> None:
    seen: list[Budget] = []

    class Noting:
        def compute(self, _share: str, work: Work, _seconds: float) -> AttemptReport:
            seen.append(work.budget)
            return AttemptReport(work.id, 1.0, Outcome({}, {"f": b""}), cpu_seconds=4.0)

        def close(self) -> None:
            """Nothing."""

    ask = worker(Noting(), cpu_seconds=10.0)
    for _ in range(3):
        ask("derive", {})
    assert [each.cpu_seconds for each in seen] == [10.0, 6.0, 2.0]
    with pytest.raises(TimeoutError):
        ask("derive", {})
