"""Threads that share their time fairly among those who ask, and the CPU time of one."""

from __future__ import annotations

import time
from collections import OrderedDict, deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from threading import Lock, get_ident
from typing import Any

Waiting = tuple[Future[Any], Callable[[], Any]]


class ThreadCpuTime:
    """The CPU time of a thread since it began, for others to look at; 0 where the system does not tell."""

    def __init__(self) -> None:
        self._clock: int | None = None
        self._begun = 0.0

    def begin(self) -> None:
        """In the thread."""
        if hasattr(time, "pthread_getcpuclockid"):
            self._begun, self._clock = time.thread_time(), time.pthread_getcpuclockid(get_ident())

    def seconds(self) -> float:
        """So much until now."""
        return 0.0 if self._clock is None else time.clock_gettime(self._clock) - self._begun


class SharedThreads:
    """So many threads; while all are busy, whoever waits gets one in turn, however much others have asked for."""

    def __init__(self, count: int, name: str) -> None:
        self._threads = ThreadPoolExecutor(count, thread_name_prefix=name)
        self._waiting: OrderedDict[str, deque[Waiting]] = OrderedDict()
        self._lock = Lock()

    def submit(self, share: str, work: Callable[[], Any]) -> Future[Any]:
        """Have a work done; ``share``: on whose behalf. Raises RuntimeError after :meth:`close`."""
        future: Future[Any] = Future()
        with self._lock:
            self._waiting.setdefault(share, deque()).append((future, work))
            self._threads.submit(self._next)
        return future

    def _next(self) -> None:
        """Do the first work of the share whose turn it is."""
        with self._lock:
            if not self._waiting:  # closed
                return
            share, waiting = self._waiting.popitem(last=False)
            future, work = waiting.popleft()
            if waiting:
                self._waiting[share] = waiting
        if not future.set_running_or_notify_cancel():
            return
        try:
            result = work()
        except BaseException as error:
            future.set_exception(error)
        else:
            future.set_result(result)

    def close(self) -> None:
        """Wait for what is being done, and drop what is not begun."""
        self._threads.shutdown(wait=False, cancel_futures=True)
        with self._lock:
            dropped = [future for waiting in self._waiting.values() for future, _ in waiting]
            self._waiting.clear()
        for future in dropped:
            future.cancel()
        self._threads.shutdown(wait=True)
