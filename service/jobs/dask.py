"""The engine of a Dask cluster: every task of Dask runs the same killable runner on the machine of its worker.

Dask cannot stop a task that runs, and its scheduler forgets everything when it restarts. So a task looks after itself:
it kills its runner as soon as the worker no longer wants its result (cancelled, client or scheduler gone). What is lost
with a scheduler is submitted again to the next one; only when none can be reached for ``SILENCE`` are attempts reported
dead. Works and reports travel as frames (:mod:`service.jobs.wire`); of this package Dask pickles one function's name.

A cluster runs whatever it is sent: its ports have to be reachable by trusted machines only, or be guarded by TLS.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import secrets
import threading
from collections.abc import Iterator, Mapping
from concurrent.futures import CancelledError
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from distributed import Client, KilledWorker, Status, get_worker

from service.jobs.engine import Report, Work
from service.jobs.local import LocalEngine
from service.jobs.wire import Reader, WireError, read_report, read_work, report_frame, work_frame

TOPIC = "substructures-progress"
POLL = 0.1  # seconds between looks of a task at whether it is still wanted
WATCH = 0.5  # seconds between looks at the cluster
SILENCE = 60.0  # seconds without a scheduler or workers after which attempts are given up
CONNECT = 10.0
AHEAD = 2  # works for every thread of the cluster, so that none waits for us
_log = logging.getLogger(__name__)
_local = threading.local()


def compute(frame: bytes) -> bytes:
    """The task: compute a work on the worker, and answer with the frame of its last report (nothing when unwanted)."""
    worker = get_worker()
    key = worker.get_current_task()
    (first,) = Reader().feed(frame)
    work = read_work(first, {})
    engine = _engine()
    while not engine.free:
        engine.reports(POLL)
        if not _is_wanted(worker, key):
            return b""
    engine.start(work)
    while True:
        for report in engine.reports(POLL):
            if report.is_final:
                return report_frame(report).to_bytes()
            worker.log_event(TOPIC, {"id": work.id, "fraction": report.fraction})
        if not _is_wanted(worker, key):
            engine.stop(work.id)
            return b""


def _engine() -> LocalEngine:
    """The runner of this thread of the worker; it ends with the thread."""
    if not hasattr(_local, "engine"):
        _local.engine = LocalEngine(1)
    engine: LocalEngine = _local.engine
    return engine


def _is_wanted(worker: Any, key: Any) -> bool:
    task = worker.state.tasks.get(key)
    return worker.status in (Status.running, Status.paused) and task is not None and task.state == "executing"


class DaskEngine:
    """Computes works on the cluster whose scheduler listens at ``address``, such as ``tcp://host:8786``."""

    def __init__(self, address: str) -> None:
        self.address = address
        logging.getLogger("distributed").setLevel(logging.CRITICAL)  # traces of every lost connection; we say it once
        self._open: set[str] = set()  # used by the caller's thread only
        self._wanted: dict[str, Work] = {}
        self._news: SimpleQueue[Report | None] = SimpleQueue()
        self._slots = 0
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._client: Client | None = None
        self._heard = monotonic()
        self._loop = asyncio.new_event_loop()
        self._closing = asyncio.Event()
        self._thread = threading.Thread(target=self._run, name="dask", daemon=True)
        self._thread.start()

    @property
    def free(self) -> int:
        """Works that can be started now; none while the scheduler is not connected or has no workers."""
        return max(0, AHEAD * self._slots - len(self._open))

    def start(self, work: Work) -> None:
        """Start to compute; reports follow."""
        self._open.add(work.id)
        self._wanted[work.id] = work
        self._loop.call_soon_threadsafe(self._reconcile)

    def stop(self, attempt: str) -> None:
        """Cancel the task, whose worker then kills the runner; no report follows."""
        self._open.discard(attempt)
        if self._wanted.pop(attempt, None) is not None:
            self._loop.call_soon_threadsafe(self._reconcile)

    def reports(self, seconds: float) -> list[Report]:
        """News, waiting at most so long for the first; none also when there are more or fewer workers."""
        news: list[Report | None] = []
        with contextlib.suppress(Empty):
            news.append(self._news.get(timeout=max(seconds, 1e-3)))
            while True:
                news.append(self._news.get_nowait())
        return [report for report in news if report is not None and self._is_news(report)]

    def _is_news(self, report: Report) -> bool:
        is_open = report.id in self._open
        if report.is_final:
            self._open.discard(report.id)
        return is_open

    def close(self) -> None:
        """Cancel all tasks and disconnect."""
        self._wanted.clear()
        self._open.clear()
        self._loop.call_soon_threadsafe(self._closing.set)
        self._thread.join()

    def _run(self) -> None:
        with contextlib.closing(self._loop):
            self._loop.run_until_complete(self._serve())

    async def _serve(self) -> None:
        """Keep a connection to the scheduler until closed."""
        while not self._closing.is_set():
            try:
                async with asyncio.timeout(2 * CONNECT):
                    client = await Client(self.address, asynchronous=True, timeout=CONNECT, set_as_default=False)
            except (OSError, TimeoutError) as error:
                _log.warning("no scheduler at %s: %s", self.address, error)
                self._give_up("the scheduler cannot be reached")
                await self._pause()
                continue
            try:
                await self._use(client)
            finally:
                await self._leave(client)

    async def _pause(self) -> None:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._closing.wait(), WATCH)

    async def _use(self, client: Client) -> None:
        """Follow the wanted works until the connection is lost."""
        client.subscribe_topic(TOPIC, self._progress)
        self._client = client
        self._reconcile()
        while client.status == "running" and not self._closing.is_set():
            try:
                async with asyncio.timeout(CONNECT):
                    slots = sum((await client.nthreads()).values())
            except (OSError, TimeoutError):
                return
            if slots != self._slots:
                self._slots = slots
                self._news.put(None)
            if slots:
                self._heard = monotonic()
            self._give_up("the cluster has no workers")
            await self._pause()

    async def _leave(self, client: Client) -> None:
        self._client, self._slots = None, 0
        tasks = list(self._tasks.values())
        self._tasks.clear()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        with contextlib.suppress(OSError, TimeoutError):
            async with asyncio.timeout(CONNECT):
                await client.close()

    def _progress(self, event: tuple[float, Mapping[str, Any]]) -> None:
        _, message = event
        if message.get("id") in self._wanted:
            self._news.put(Report(message["id"], float(message["fraction"])))

    def _give_up(self, what: str) -> None:
        """Report everything dead when nothing was heard for too long."""
        if monotonic() - self._heard < SILENCE:
            return
        self._heard = monotonic()
        for attempt in list(self._wanted):
            self._end(Report(attempt, death=f"{what} (for {SILENCE:g} s)"))
        self._reconcile()

    def _end(self, report: Report) -> None:
        if self._wanted.pop(report.id, None) is not None:
            self._news.put(report)

    def _reconcile(self) -> None:
        """A task of ours for every wanted work, and for no other."""
        if self._client is None:
            return
        wanted = dict(self._wanted)
        for attempt in self._tasks.keys() - wanted.keys():
            self._tasks.pop(attempt).cancel()
        for attempt in wanted.keys() - self._tasks.keys():
            self._tasks[attempt] = self._loop.create_task(self._follow(self._client, wanted[attempt]))

    async def _follow(self, client: Client, work: Work) -> None:
        """Submit a work and wait for its report; without a connection it is left to the next one."""
        frame = work_frame(work).to_bytes()
        future = client.submit(compute, frame, key=f"substructures-{work.id}-{secrets.token_hex(8)}", pure=False)
        try:
            self._end(_report(work.id, await future))
        except (CancelledError, OSError) as error:
            if client.status == "running":
                self._end(Report(work.id, death=f"the cluster gave the task up: {error}"))
        except (KilledWorker, WireError, ImportError) as error:
            self._end(Report(work.id, death=f"the task failed: {error}"))
        finally:
            future.release()
            if self._tasks.get(work.id) is asyncio.current_task():
                del self._tasks[work.id]


def _report(attempt: str, data: bytes) -> Report:
    frames: Iterator[Any] = Reader().feed(data)
    frame = next(frames, None)
    return Report(attempt, death="the worker gave the task up") if frame is None else read_report(frame)
