"""One look at the database for all who wait for events of jobs, however many they are."""

from __future__ import annotations

import asyncio
import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from service.database.connections import Database
from service.messages.refusals import Refused
from service.queries.jobs.job_events import latest

POLL = 0.25  # seconds
_log = logging.getLogger(__name__)


class Watcher:
    """Somebody who has read the events of a job up to the number ``seq``; belongs to an event loop."""

    def __init__(self, job: str, seq: int) -> None:
        self.job, self.seq = job, seq
        self._loop, self._news = asyncio.get_running_loop(), asyncio.Event()

    def wake(self) -> None:
        """There may be something to read. May be called by any thread."""
        try:
            self._loop.call_soon_threadsafe(self._news.set)
        except RuntimeError:  # its loop was closed, and nobody waits there any more
            return

    async def wait(self, seconds: float) -> None:
        """Until there may be something to read, or the time is over."""
        try:
            await asyncio.wait_for(self._news.wait(), seconds)
        except TimeoutError:
            return
        self._news.clear()


class Feed:
    """Wakes watchers of jobs. Its thread runs only while there are some."""

    def __init__(self, database: Database, stopping: threading.Event) -> None:
        self._database, self._stopping = database, stopping
        self._lock = threading.Lock()
        self._watchers: set[Watcher] = set()
        self._thread: threading.Thread | None = None
        self._places: dict[str, int] = {}  # streams of each principal

    def enter(self, principal: str, per_principal: int, most: int) -> None:
        """Take a place for a stream, to be given back by :meth:`leave`. Raises Refused 503."""
        with self._lock:
            taken = self._places.get(principal, 0)
            if taken >= per_principal or sum(self._places.values()) >= most:
                limit = per_principal if taken >= per_principal else most
                detail = f"{limit} streams of events are open, the most there may be; close one, or ask for the job"
                raise Refused(503, "too-many-streams", detail, headers={"Retry-After": "5"}, limit=limit)
            self._places[principal] = taken + 1

    def leave(self, principal: str) -> None:
        """Give a place back."""
        with self._lock:
            self._places[principal] -= 1
            if not self._places[principal]:
                del self._places[principal]

    @contextmanager
    def watching(self, job: str, seq: int) -> Iterator[Watcher]:
        """A watcher that is woken when there are events behind its ``seq``, and when the job or the server ends."""
        watcher = Watcher(job, seq)
        with self._lock:
            self._watchers.add(watcher)
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="feed", daemon=True)
                self._thread.start()
        try:
            yield watcher
        finally:
            with self._lock:
                self._watchers.discard(watcher)

    def close(self) -> None:
        """Wait for the end of the thread; the server is stopping."""
        thread = self._thread
        if thread is not None:
            thread.join(10)

    def _run(self) -> None:
        while True:
            is_last = self._stopping.wait(POLL)
            with self._lock:
                watchers = list(self._watchers)
                if not watchers or is_last:
                    self._thread = None
                    break
            try:
                self._look(watchers)
            except Exception as error:
                _log.error("events of jobs cannot be read: %s", str(error).partition("\n")[0])
        for watcher in watchers:
            watcher.wake()

    def _look(self, watchers: list[Watcher]) -> None:
        with self._database.read() as connection:
            found = latest(connection, {watcher.job for watcher in watchers})
        for watcher in watchers:
            seq, is_final = found.get(watcher.job, (0, True))
            if seq > watcher.seq or is_final:
                watcher.wake()
