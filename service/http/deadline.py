"""The time that the work of a request may take, and what is answered in its place when it takes longer.

A thread cannot be stopped: what was begun in time goes on to its end, which the limits on sizes bound. So the event
loop watches the thread that works, and when the time is over it lets another one answer; whoever comes first, the work
or the clock, takes the right to answer, and the other one finds it gone.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import Future
from contextvars import copy_context
from functools import partial
from threading import Lock
from time import monotonic
from typing import TypeVar

from fastapi import Response
from fastapi.concurrency import run_in_threadpool

from service.processes.threads import ThreadCpuTime

T = TypeVar("T")
Submit = Callable[[Callable[[], Response]], Future[Response]]
LOOK = 0.001  # seconds between looks at the time of a thread
_log = logging.getLogger(__name__)


class GivenUp(Exception):
    """The work took too long, and another thread has answered; the cause is the error in which it ended, if any."""


class Deadline:
    """``seconds`` from now, at ``due``; ``limit``: the CPU time of the thread that works, where that is less."""

    def __init__(self, seconds: float, limit: float | None = None) -> None:
        self.limit = seconds if limit is None else limit
        self.due = monotonic() + seconds
        self._cpu_time = ThreadCpuTime()
        self._lock = Lock()
        self._instead: Callable[[], Response] | None = None  # while there is work that can be given up

    @property
    def is_over(self) -> bool:
        """Whether the time is over."""
        return self._left() <= 0

    def _left(self) -> float:
        """Seconds in which the time is not over."""
        return min(self.due - monotonic(), self.limit - self._cpu_time.seconds())

    def watched(self, work: Callable[[], T], late: Callable[[], T], instead: Callable[[], Response]) -> T:
        """What ``work`` gives, or ``late`` when it looks at the clock itself and raises TimeoutError.

        ``instead`` answers if the time is over before the work is done; then GivenUp is raised here, whatever the work
        ends with.
        """
        with self._lock:
            self._instead = instead
        try:
            found = work()
        except TimeoutError as error:
            self._finish(error)
            return late()
        except BaseException as error:
            self._finish(error)
            raise
        self._finish(None)
        return found

    def _finish(self, error: BaseException | None) -> None:
        """The work has ended. Raises GivenUp when it was too late."""
        if self._take() is None:
            raise GivenUp from error

    def _take(self) -> Callable[[], Response] | None:
        """Take the right to answer: what is to be done instead of the work in progress; None without any."""
        with self._lock:
            instead, self._instead = self._instead, None
        return instead

    async def within(self, submit: Submit, endpoint: Callable[[], Response]) -> Response:
        """The answer of an endpoint, or, where its work takes too long, of what is to be done instead.

        ``submit``: gives the work to a thread.
        """
        future = submit(partial(copy_context().run, self._timed, endpoint))
        answer = asyncio.wrap_future(future)
        while not answer.done() and (left := self._left()) > 0:
            await asyncio.wait({answer}, timeout=max(LOOK, left))
        if answer.done():
            return answer.result()
        if future.cancel():  # all threads have other work: too late for this one
            return await run_in_threadpool(endpoint)
        instead = self._take()
        if instead is None:  # the work is done or not begun, and the rest is short
            return await answer
        answer.add_done_callback(_tell)
        return await run_in_threadpool(instead)

    def _timed(self, endpoint: Callable[[], Response]) -> Response:
        self._cpu_time.begin()
        return endpoint()


def _tell(abandoned: asyncio.Future[Response]) -> None:
    """Nobody waits for abandoned work any more, so the log has the error in which it ended."""
    error = abandoned.exception()
    if error is not None and error.__cause__ is not None and not isinstance(error.__cause__, TimeoutError):
        _log.warning("work that was given up ended in an error: %r", error.__cause__)
