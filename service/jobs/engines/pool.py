"""The processes that compute what requests need: a few runners, shared fairly among those who ask.

::

    request --> a thread waits --> the turn of its owner --> a runner, killed at the end of its time --> report

A runner is kept free of each owner's works: however much one asks for, another one's work begins at once. There is one
runner at first; more are started when they are needed.
"""

from __future__ import annotations

import logging
from collections import Counter, OrderedDict, deque
from collections.abc import Callable
from concurrent.futures import Future, wait
from dataclasses import dataclass, field
from functools import partial
from threading import Event, Lock, Thread
from time import monotonic

from service.jobs.engines.engine import AttemptReport, Work
from service.jobs.engines.local import LocalEngine
from service.jobs.engines.wire import read_report, read_work, report_frame, work_frame
from service.jobs.kinds import run
from service.jobs.worker import CLOSED
from service.processes.threads import SharedThreads, ThreadCpuTime

NICE = 5  # those that answer go first, jobs last
THREADS, LOOK = 4, 0.05  # of a process without runners; seconds between looks at the time that one has taken
LEAST = 2  # runners: one is kept free
PAUSE = 1.0  # seconds without news, and after a failure
_log = logging.getLogger(__name__)


class InProcess:
    """Works are computed by threads of this process: nothing can be ended, and nothing has to be started."""

    def __init__(self, count: int = THREADS) -> None:
        self.threads = SharedThreads(count, "work")

    def compute(self, share: str, work: Work, seconds: float) -> AttemptReport:
        """The last report about a work. Raises TimeoutError after so many seconds, or after the CPU time of its budget;
        what was begun goes on then, but for what tells how far it is.
        """
        end, took = monotonic() + seconds, Took()
        future: Future[AttemptReport] = self.threads.submit(share, partial(_computed, work, took))
        while not future.done():
            left = min(LOOK, end - monotonic())
            if left <= 0 or took.seconds() > work.budget.cpu_seconds:
                future.cancel()
                took.is_given_up = True
                raise TimeoutError
            wait((future,), left)
        return future.result()

    def close(self) -> None:
        """Wait for what was begun."""
        self.threads.close()


class Took(ThreadCpuTime):
    """What a work has taken; ``is_given_up``: nobody waits for it any more."""

    def __init__(self) -> None:
        super().__init__()
        self.is_given_up = False

    def go_on(self, _share: float) -> None:
        """A listener of progress. Raises TimeoutError when nobody waits."""
        if self.is_given_up:
            raise TimeoutError("nobody waits for this any more")


def _computed(work: Work, took: Took) -> AttemptReport:
    """As everywhere: what comes and goes is what is sent."""
    took.begin()
    given = read_work(work_frame(work), {})
    outcome = run(given.kind, dict(given.item), given.blobs, took.go_on)
    return read_report(report_frame(AttemptReport(work.id, 1.0, outcome, cpu_seconds=took.seconds())))


@dataclass(eq=False)
class _Asked:
    """A work with who waits for it."""

    share: str
    work: Work
    report: Future[AttemptReport] = field(default_factory=Future)


class WorkerPool:
    """At most so many runners, with a thread that feeds them."""

    def __init__(self, most: int, start: Callable[[], LocalEngine], warm: bool = True) -> None:
        """``start``: makes the engine with its first runner, in the thread that alone uses it: now, or else when there
        is something to do."""
        self._most, self._start = max(LEAST, most), start
        self._waiting: OrderedDict[str, deque[_Asked]] = OrderedDict()
        self._running: dict[str, _Asked] = {}
        self._withdrawn: list[str] = []
        self._lock, self._closing, self._needed = Lock(), Event(), Event()
        if warm:
            self._needed.set()
        self._engine: LocalEngine | None = None
        self._thread = Thread(target=self._run, name="workers", daemon=True)
        self._thread.start()

    def compute(self, share: str, work: Work, seconds: float) -> AttemptReport:
        """The last report about a work. Raises TimeoutError after so many seconds; then it is killed."""
        asked = _Asked(share, work)
        with self._lock:
            if self._closing.is_set():
                return AttemptReport(work.id, death=CLOSED)
            self._waiting.setdefault(share, deque()).append(asked)
        self._needed.set()
        self._wake()
        try:
            return asked.report.result(seconds)
        except TimeoutError:
            with self._lock:
                self._withdrawn.append(work.id)
            asked.report.cancel()  # where it waits still
            self._wake()
            raise

    def close(self) -> None:
        """Kill all runners; whoever waits is told."""
        self._closing.set()
        self._needed.set()
        self._wake()
        self._thread.join()

    def _wake(self) -> None:
        engine = self._engine
        if engine is not None:
            engine.interrupt()

    def _run(self) -> None:
        self._needed.wait()
        while not self._closing.is_set():
            try:
                self._engine = self._engine or self._start()
                self._step(self._engine)
            except Exception:
                _log.exception("the runners of requests are out of order")
                self._closing.wait(PAUSE)
        with self._lock:
            asked = [*self._running.values(), *(each for some in self._waiting.values() for each in some)]
            self._running.clear()
            self._waiting.clear()
        if self._engine is not None:
            self._engine.close()
        for each in asked:
            _tell(each, AttemptReport(each.work.id, death=CLOSED))

    def _step(self, engine: LocalEngine) -> None:
        with self._lock:
            for identifier in self._withdrawn:
                self._running.pop(identifier, None)
                engine.stop(identifier)
            self._withdrawn.clear()
            while engine.free and (asked := self._next()) is not None:
                self._running[asked.work.id] = asked
                engine.start(asked.work)
            waiting = sum(len(self._waiting[share]) for share in self._turns())
            engine.workers = max(engine.workers, min(self._most, len(self._running) + waiting))
        for report in engine.reports(PAUSE):
            if report.is_final and (ended := self._running.pop(report.id, None)) is not None:
                _tell(ended, report)

    def _turns(self) -> list[str]:
        """The shares whose turn may come: those that have not all runners but one already."""
        if not self._waiting:
            return []
        busy = Counter(each.share for each in self._running.values())
        return [share for share in self._waiting if busy[share] < self._most - 1]

    def _next(self) -> _Asked | None:
        """The first work of the share whose turn it is; then it is the turn of others."""
        while turns := self._turns():
            waiting = self._waiting.pop(turns[0])
            asked = waiting.popleft()
            if waiting:
                self._waiting[turns[0]] = waiting
            if asked.report.set_running_or_notify_cancel():
                return asked
        return None


def _tell(asked: _Asked, report: AttemptReport) -> None:
    if not asked.report.done():
        asked.report.set_result(report)
