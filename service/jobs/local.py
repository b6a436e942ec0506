"""The engine of one machine: a pool of warm runners, which is never without work to give and never waits for one."""

from __future__ import annotations

import contextlib
import logging
import selectors
import socket
from collections import deque
from time import monotonic

from service.jobs.engine import AttemptReport, Work
from service.jobs.process import CHUNK, NICE, Process
from service.jobs.wire import WireError

LONGEST_PAUSE = 30.0
#: seconds for a runner to import what it needs; one that takes longer is killed
START = 120.0
WATCH = 0.1  # seconds between looks at the memory of runners
_log = logging.getLogger(__name__)


class LocalEngine:
    """Computes works in ``workers`` processes of this machine. To be used by one thread, which has to outlive it:
    on Linux a runner ends with the thread that started it."""

    def __init__(self, workers: int, user: str = "", niceness: int = NICE) -> None:
        """``user``: whose rights the runners have, in place of ours."""
        self.workers, self._user, self._niceness = workers, user, niceness
        self._selector = selectors.DefaultSelector()
        self._told, self._tell = socket.socketpair()
        for each in (self._told, self._tell):
            each.setblocking(False)
        self._selector.register(self._told, selectors.EVENT_READ)
        self._is_interrupted = False
        self._processes: set[Process] = set()
        self._running: dict[str, Process] = {}
        self._news: deque[AttemptReport] = deque()
        self._failures, self._not_before = 0, 0.0
        self._fill()

    @property
    def free(self) -> int:
        """Works that can be started now: runners that are ready and idle."""
        return sum(1 for process in self._processes if process.is_ready and process.current is None)

    @property
    def processes(self) -> list[int]:
        """The ids of the runners' processes."""
        return [process.pid for process in self._processes]

    def start(self, work: Work) -> None:
        """Start to compute; raises RuntimeError when nothing is free."""
        idle = [process for process in self._processes if process.is_ready and process.current is None]
        if not idle:
            raise RuntimeError("no runner is free")
        process = idle[0]
        self._running[work.id] = process
        process.start(work)
        self._watch(process)

    def stop(self, attempt: str) -> None:
        """Kill what computes the attempt; no report follows."""
        process = self._running.pop(attempt, None)
        if process is not None:
            self._remove(process)
            self._fill()
        self._news = deque(report for report in self._news if report.id != attempt)

    def interrupt(self) -> None:
        """Let :meth:`reports` return, or not wait at all the next time. From any thread."""
        with contextlib.suppress(BlockingIOError):  # it has been told often enough
            self._tell.send(b"!")

    def reports(self, seconds: float) -> list[AttemptReport]:
        """News, waiting at most so long for the first; none also when another runner has become free."""
        end = monotonic() + seconds
        free, self._is_interrupted = self.free, False
        while True:
            self._fill()
            pause = 0.0 if self._news else max(0.0, self._wake(end) - monotonic())
            for key, _ in self._selector.select(pause):
                if key.data is None:
                    self._is_interrupted = bool(self._told.recv(CHUNK))
                else:
                    self._handle(key.data, key.fd)
            self._check_limits()
            if self._news or self._is_interrupted or self.free > free or monotonic() >= end:
                news, self._news = list(self._news), deque()
                return news

    def _wake(self, end: float) -> float:
        """When to look again although nothing was heard."""
        times = [end, *(process.deadline for process in self._processes)]
        if self._running:
            times.append(monotonic() + WATCH)
        return min(times if len(self._processes) >= self.workers else [*times, self._not_before])

    def _fill(self) -> None:
        """Start runners that are missing; after failures only now and then."""
        while len(self._processes) < self.workers and monotonic() >= self._not_before:
            process = Process(self._user, self._niceness)
            process.deadline = monotonic() + START
            self._processes.add(process)
            self._selector.register(process.reports, selectors.EVENT_READ, process)
            self._selector.register(process.output, selectors.EVENT_READ, process)

    def _watch(self, process: Process) -> None:
        """Listen for room in the pipe of the work as long as something waits for it."""
        is_watched = process.work in self._selector.get_map()
        if process.is_sending and not is_watched:
            self._selector.register(process.work, selectors.EVENT_WRITE, process)
        elif is_watched and not process.is_sending:
            self._selector.unregister(process.work)

    def _handle(self, process: Process, descriptor: int) -> None:
        if process not in self._processes:  # removed meanwhile
            return
        if descriptor == process.work:
            process.flush()
            self._watch(process)
        elif descriptor == process.output:
            if not process.listen():
                self._selector.unregister(descriptor)
        else:
            self._receive(process)

    def _receive(self, process: Process) -> None:
        was_ready = process.is_ready
        try:
            reports = process.receive()
        except WireError as error:
            _log.error("a runner is out of order: %s", error)
            reports = None
        if reports is None:
            self._lost(process)
            return
        if process.is_ready and not was_ready:
            self._failures, process.deadline = 0, float("inf")
        for report in reports:
            self._news.append(report)
            if report.is_final:
                del self._running[report.id]
                process.listen()
                if process.printed:
                    _log.warning("printed by the runner of %s: %s", report.id, process.printed)
        if process.is_worn and process.current is None:
            self._remove(process)

    def _lost(self, process: Process) -> None:
        """A runner has ended: report what was seen."""
        if process.current is not None:
            del self._running[process.current.id]
            self._news.append(process.seen(process.current))
        if not process.is_ready:
            self._failures += 1
            pause = min(LONGEST_PAUSE, 0.1 * 2.0**self._failures)
            self._not_before = monotonic() + pause
            _log.error("a runner did not start; the next in %.1f s. It printed: %s", pause, process.printed)
        self._remove(process)

    def _check_limits(self) -> None:
        """Kill what takes too much or too long, also to start."""
        for process in list(self._processes):
            report = process.excess()
            if report is not None:
                del self._running[report.id]
                self._news.append(report)
            if report is not None or (not process.is_ready and monotonic() >= process.deadline):
                self._remove(process)

    def _remove(self, process: Process) -> None:
        self._processes.discard(process)
        for descriptor in (process.reports, process.work, process.output):
            if descriptor in self._selector.get_map():
                self._selector.unregister(descriptor)
        process.close()

    def close(self) -> None:
        """Kill all runners, and wait for their end."""
        for process in list(self._processes):
            self._remove(process)
        self._running.clear()
        self._selector.close()
        self._told.close()
        self._tell.close()
