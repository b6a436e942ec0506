"""The engine of a Dask cluster: every task of Dask runs the same killable runner on the machine of its worker.

The scheduler forgets everything when it restarts. What is lost with it is submitted again to the next one; only when
none can be reached for ``SILENCE`` are attempts reported dead. Works and reports travel as frames, see
:mod:`service.jobs.engines.wire`.

Works are pinned to the workers that were found to have our version. Dask keeps a task whose workers have all gone for
ever; such works are submitted again to those that are there.

A cluster runs whatever it is sent: its ports have to be reachable by trusted machines only, or be guarded by TLS.
"""

from __future__ import annotations

import asyncio
import contextlib
import secrets
import threading
from collections.abc import Collection, Iterator, Mapping
from concurrent.futures import CancelledError
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any, NamedTuple

from distributed import Client
from distributed.comm.core import CommClosedError

from service.jobs.engines.dask_cluster import CONNECT, Notices, Workers, described
from service.jobs.engines.dask_task import TOPIC, compute
from service.jobs.engines.engine import AttemptReport, Work
from service.jobs.engines.wire import MessageReader, WireError, read_report, work_frame

WATCH = 0.5  # seconds between looks at the cluster
SILENCE = 60.0  # seconds without a scheduler or workers after which attempts are given up
LONGEST_PAUSE = 30.0  # seconds between attempts to connect
FINDING = 3.0  # seconds in which the workers of a cluster are found before they are missed
AHEAD = 2  # works for every thread of the cluster, so that none waits for us


class _Task(NamedTuple):
    """What follows a work, and the workers that may compute it."""

    follower: asyncio.Task[None]
    workers: frozenset[str]


class DaskEngine:
    """Computes works on the cluster whose scheduler listens at ``address``, such as ``tcp://host:8786``."""

    def __init__(self, address: str) -> None:
        self.address = address
        self._open: set[str] = set()  # used by the caller's thread only
        self._wanted: dict[str, Work] = {}
        self._news: SimpleQueue[AttemptReport | None] = SimpleQueue()
        self._slots = 0
        self._tasks: dict[str, _Task] = {}
        self._workers: Workers | None = None
        self._notices = Notices(address)
        self._heard = monotonic()
        self._loop = asyncio.new_event_loop()
        self._closing = threading.Event()
        self._serving: asyncio.Task[None] | None = None
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

    def reports(self, seconds: float) -> list[AttemptReport]:
        """News, waiting at most so long for the first; none also when there are more or fewer workers."""
        news: list[AttemptReport | None] = []
        with contextlib.suppress(Empty):
            news.append(self._news.get(timeout=max(seconds, 1e-3)))
            while True:
                news.append(self._news.get_nowait())
        return [report for report in news if report is not None and self._is_news(report)]

    def _is_news(self, report: AttemptReport) -> bool:
        is_open = report.id in self._open
        if report.is_final:
            self._open.discard(report.id)
        return is_open

    def close(self) -> None:
        """Cancel all tasks and disconnect."""
        self._wanted.clear()
        self._open.clear()
        self._closing.set()
        with contextlib.suppress(RuntimeError):  # closed before
            self._loop.call_soon_threadsafe(self._interrupt)
        self._thread.join()

    def _interrupt(self) -> None:
        if self._serving is not None:
            self._serving.cancel()

    def _run(self) -> None:
        with contextlib.closing(self._loop):
            self._serving = self._loop.create_task(self._serve())
            self._loop.run_until_complete(self._serving)
            self._loop.run_until_complete(_end_all(asyncio.all_tasks(self._loop)))

    async def _serve(self) -> None:
        """Keep a connection to the scheduler until closed, whatever its address answers."""
        pause = WATCH
        while not self._closing.is_set():
            began = monotonic()
            with contextlib.suppress(asyncio.CancelledError):  # by us, when closing
                await self._connect()
                self._give_up("the scheduler cannot be reached")
                lasted = monotonic() - began > LONGEST_PAUSE
                pause = WATCH if lasted else min(2 * pause, LONGEST_PAUSE)
                await asyncio.sleep(0 if self._closing.is_set() else pause)

    async def _connect(self) -> None:
        """Compute while there is a connection; say why there is none."""
        client = None
        try:
            client = Client(self.address, asynchronous=True, timeout=CONNECT, set_as_default=False)
            async with asyncio.timeout(2 * CONNECT):
                await client
            self._notices.connected()
            await self._use(client)
        except (Exception, asyncio.CancelledError) as error:  # anything when no scheduler listens there
            if not self._closing.is_set():
                (self._notices.lost if self._workers else self._notices.unreachable)(described(error))
        finally:
            await self._leave(client)

    async def _use(self, client: Client) -> None:
        """Follow the wanted works until the connection is lost. The library makes another one, without our tasks."""
        client.subscribe_topic(TOPIC, self._progress)
        connection, began = client.scheduler_comm, monotonic()
        self._workers = Workers(client)
        while client.status == "running" and client.scheduler_comm is connection:
            self._set_slots(await self._workers.look())
            if self._slots or monotonic() - max(self._heard, began) > FINDING:
                self._notices.workers(self._slots > 0)
            self._give_up("the cluster has no workers of this version")
            self._reconcile()
            await asyncio.sleep(WATCH)
        raise ConnectionError("the connection was closed")

    def _set_slots(self, slots: int) -> None:
        if slots != self._slots:
            self._slots = slots
            self._news.put(None)
        if slots:
            self._heard = monotonic()

    async def _leave(self, client: Client | None) -> None:
        if self._workers is not None:
            self._workers.close()
        self._workers, self._slots = None, 0
        followers = [task.follower for task in self._tasks.values()]
        self._tasks.clear()
        await _end_all(followers)
        if client is not None:
            with contextlib.suppress(Exception):
                async with asyncio.timeout(CONNECT):
                    await client.close()

    def _progress(self, event: tuple[float, Mapping[str, Any]]) -> None:
        _, message = event
        if message.get("id") in self._wanted:
            self._news.put(AttemptReport(message["id"], float(message["fraction"])))

    def _give_up(self, what: str) -> None:
        """Report everything dead when nothing was heard for too long."""
        if monotonic() - self._heard < SILENCE:
            return
        self._heard = monotonic()
        for attempt in list(self._wanted):
            self._end(AttemptReport(attempt, death=f"{what} (for {SILENCE:g} s)"))
        self._reconcile()

    def _end(self, report: AttemptReport) -> None:
        if self._wanted.pop(report.id, None) is not None:
            self._news.put(report)

    def _reconcile(self) -> None:
        """A task of ours for every wanted work, and for no other; none whose workers have all gone."""
        if self._workers is None:
            return
        wanted, fitting = dict(self._wanted), frozenset(self._workers.fitting)
        for attempt, task in list(self._tasks.items()):
            if attempt not in wanted or task.workers.isdisjoint(fitting):
                self._tasks.pop(attempt).follower.cancel()
        if not fitting:
            return
        for attempt in wanted.keys() - self._tasks.keys():
            follower = self._loop.create_task(self._follow(self._workers, wanted[attempt], fitting))
            self._tasks[attempt] = _Task(follower, fitting)

    async def _follow(self, workers: Workers, work: Work, fitting: frozenset[str]) -> None:
        """Submit a work and wait for its report; without a connection it is left to the next one."""
        client, key = workers.client, f"substructures-{work.id}-{secrets.token_hex(8)}"
        frame = work_frame(work).to_bytes()
        future = client.submit(compute, frame, key=key, pure=False, workers=sorted(fitting), allow_other_workers=False)
        try:
            data = await future
        except CommClosedError:
            pass  # the connection broke, which the client may notice later: the next look submits the work again
        except (CancelledError, OSError) as error:
            if client.status == "running":
                self._end(AttemptReport(work.id, death=f"the cluster gave the task up: {error}"))
        except (WireError, ImportError):
            workers.doubt()  # a worker of another version: the next look submits the work again
        except Exception as error:
            self._end(AttemptReport(work.id, death=f"the task failed: {described(error)}"))
        else:
            self._end(_report(work.id, data))
        finally:
            future.release()
            task = self._tasks.get(work.id)
            if task is not None and task.follower is asyncio.current_task():
                del self._tasks[work.id]


def _report(attempt: str, data: bytes) -> AttemptReport:
    try:
        frames: Iterator[Any] = MessageReader().feed(data)
        frame = next(frames, None)
        return AttemptReport(attempt, death="the worker gave the task up") if frame is None else read_report(frame)
    except WireError as error:
        return AttemptReport(attempt, death=f"the worker's answer cannot be read: {error}")


async def _end_all(tasks: Collection[asyncio.Task[Any]]) -> None:
    """Cancel tasks, and wait for their ends; not for ever."""
    for task in tasks:
        task.cancel()
    if tasks:
        await asyncio.wait(tasks, timeout=CONNECT)
