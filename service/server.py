"""Run the service on a socket: in the foreground, or in a thread for the demo."""

from __future__ import annotations

import asyncio
import ctypes
import errno
import gc
import logging
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from functools import partial
from pathlib import Path
from typing import cast

import uvicorn

from service.app import create_app, open_store
from service.following import followed
from service.http.connections import Complaints, Connection, Connections
from service.jobs.engines.engine import Engine
from service.operations.renewing import renewed
from service.operations.seed import Told
from service.processes.parent import bound, kept, listeners
from service.queries.jobs.jobs import waiting
from service.queries.keys import any_key
from service.queue.engines import engine_of, worker_pool
from service.queue.supervisor import Supervisor
from service.settings import Settings, SettingsError
from service.store.store import Store

logger = logging.getLogger(__name__)

MAPPED, KEPT = 32 * 2**20, 64 * 2**20  # bytes: memory that is got from the system each time, and kept when free
TURN = 0.001  # seconds that a thread computes while others wait
M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3  # malloc.h
TICKS = 10  # of uvicorn in a second
IDLE, LOOK = 5.0, 0.5  # seconds without a job after which a worker may end, and between looks
GRACE = 4  # seconds for answers that were begun, when the server is told to end
AT_A_STRETCH, WAITING = 32, 1024  # connections that are accepted, and that wait to be


def serve(settings: Settings, told: Told = lambda _done, _all: None) -> None:
    """Serve until interrupted; ``told``: as of ``import_catalogue``. Raises SettingsError rather than to listen beyond
    loopback without API keys.
    """
    if kept.is_start:
        _require_free(settings)
        _require_folder(settings)
    with open_store(settings, kept, _require, told) as store:
        signal.signal(signal.SIGTERM, _stop)  # raised again by uvicorn after its shutdown
        _prepare_to_answer()
        store.workers = worker_pool(settings)
        # one supervisor for all processes, in the first: the others' jobs wait until it looks for some
        is_first = kept.number == 0
        with (
            renewed(store) if is_first else nullcontext(),
            supervised(store, engine_of(settings) if is_first else None),
            followed(store) if is_first else nullcontext(),
        ):
            _run(store)


def _require_free(settings: Settings) -> None:
    """Raise SettingsError for an address that cannot be listened on, before there is a store."""
    try:
        for each in bound(settings.host, settings.port):
            each.close()
    except OSError as error:
        raise _cannot_listen(settings, error) from None


def _require_folder(settings: Settings) -> None:
    """Raise SettingsError for a folder of parts that is none."""
    if settings.folder and not Path(settings.folder).is_dir():
        raise SettingsError(f"--folder: there is no folder '{settings.folder}'; it is that of definitions to be read")


def _cannot_listen(settings: Settings, error: OSError) -> SettingsError:
    where = f"{settings.host}:{settings.port}"
    another = "; is another server running? --port takes another one" if error.errno == errno.EADDRINUSE else ""
    return SettingsError(f"cannot listen on {where}: {error.strerror or error}{another}")


def _require(store: Store) -> None:
    """Raise SettingsError for a store that cannot be served as it is wanted."""
    _check_processes(store)
    check_exposure(store)


def _check_processes(store: Store) -> None:
    """Raise SettingsError where several processes are asked for and cannot be."""
    if store.settings.processes == 1:
        return
    if kept.channel is None:
        raise SettingsError("several processes are started by the command 'substructures serve' alone")
    if store.database.is_sqlite and store.database.claim is None:
        raise SettingsError("several processes share an SQLite file on Linux only; use PostgreSQL")


def _run(store: Store) -> None:
    """Answer until the end. Raises SettingsError for an address that cannot be listened on."""
    settings = store.settings
    try:
        found = listeners(settings.host, settings.port, store.database.claim, settings.processes)
    except OSError as error:
        raise _cannot_listen(settings, error) from None
    if kept.number == 0:
        name = found[0].getsockname()
        logger.info("pages and requests: http://%s:%s/; Ctrl+C stops", settings.host, name[1])
        logger.info("stored in %s", store.database.url)
    logger.info("listening on %s", ", ".join(f"{name[0]}:{name[1]}" for name in (s.getsockname() for s in found)))
    _server(store).run(sockets=found)


def _prepare_to_answer() -> None:
    """Let short requests pass those that compute: threads take turns more often, collections leave out what stays.
    And keep memory for the next large request: pages that the system gives anew cost as much as what is done with them.
    """
    with suppress(AttributeError, OSError):  # of other C libraries than that of GNU; there, what large requests lead to
        library = ctypes.CDLL(None)
        library.mallopt(M_MMAP_THRESHOLD, MAPPED)
        library.mallopt(M_TRIM_THRESHOLD, KEPT)
    sys.setswitchinterval(TURN)
    gc.collect()
    gc.freeze()


def work(settings: Settings, exit_when_idle: bool = False) -> None:
    """Compute jobs of a database that servers share, until interrupted; ``exit_when_idle``: until all jobs have ended.

    Raises SettingsError for SQLite.
    """
    if not settings.database.startswith("postgres"):
        raise SettingsError("a worker of its own needs PostgreSQL; with SQLite the server computes the jobs itself")
    if settings.engine == "none":
        raise SettingsError("a worker needs an engine: local or dask")
    signal.signal(signal.SIGTERM, _stop)
    with open_store(settings) as store:
        store.workers = worker_pool(settings, warm=False)  # of mirrors
        with supervised(store, engine_of(settings)):
            wait_for_end(store) if exit_when_idle else threading.Event().wait()


def wait_for_end(store: Store) -> None:
    """Until nothing waits or runs anywhere, seen for IDLE seconds."""
    end = time.monotonic() + IDLE
    while time.monotonic() < end:
        time.sleep(LOOK)
        try:
            with store.database.read() as connection:
                is_needed = waiting(connection) > 0
        except Exception as error:
            logging.getLogger(__name__).error("the queue cannot be read: %s", error)
            is_needed = True
        if is_needed:
            end = time.monotonic() + IDLE


def _stop(_signal: int, _frame: object) -> None:
    raise SystemExit(0)


def check_exposure(store: Store) -> None:
    """Raise SettingsError when others could reach a server that has no keys."""
    with store.database.read() as connection:
        if store.settings.is_loopback or any_key(connection):
            return
    raise SettingsError(
        f"refusing to listen on {store.settings.host} without API keys; create one with"
        " 'substructures key create --owner TEAM --scope admin' or listen on 127.0.0.1"
    )


@contextmanager
def background(settings: Settings, told: Told = lambda _done, _all: None) -> Iterator[str]:
    """A server in a thread on a free port of loopback; gives its address. ``told``: as of ``import_catalogue``."""
    with (
        open_store(settings, progress=told) as store,
        renewed(store),
        supervised(store, engine_of(settings)),
        socket.create_server(("127.0.0.1", 0)) as listener,
    ):
        server = _server(store)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]}, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{listener.getsockname()[1]}"
        finally:
            server.should_exit = True
            thread.join(timeout=10)


class _Server(uvicorn.Server):
    """Ends event streams when it is told to stop, since it waits for the answers that it has begun."""

    def __init__(self, store: Store, connections: Connections, config: uvicorn.Config) -> None:
        super().__init__(config)
        self._store, self._connections = store, connections

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen; the loop accepts few connections at a stretch, while many may wait."""
        asyncio.get_running_loop().set_exception_handler(Complaints())
        await super().startup(sockets)
        kept.note(0)
        for listener in (one for server in self.servers for one in server.sockets):
            with socket.socket(fileno=os.dup(listener.fileno())) as same:
                same.listen(WAITING)

    async def on_tick(self, counter: int) -> bool:
        """Once a second, look for connections whose clients let us wait."""
        if counter % TICKS == 0:
            self._connections.sweep(1.0)
        return await super().on_tick(counter)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End what would have no end, then wait for the answers that were begun."""
        self._store.runtime.stopping.set()
        await super().shutdown(sockets)


def _server(store: Store) -> uvicorn.Server:
    settings = store.settings
    connections = Connections(settings.limits_of_process, kept.note)
    return _Server(
        store,
        connections,
        uvicorn.Config(
            create_app(store),
            http=cast(type[asyncio.Protocol], partial(Connection, connections)),
            backlog=AT_A_STRETCH if settings.processes == 1 else 1,
            host=settings.host,
            port=settings.port,
            log_config=None,
            access_log=False,  # service.http.middleware writes a line with the request id
            server_header=False,
            loop="asyncio",  # for large answers quicker than uvloop
            lifespan="off",
            ws="none",
            timeout_graceful_shutdown=GRACE,
        ),
    )


@contextmanager
def supervised(store: Store, engine: Callable[[], Engine] | None) -> Iterator[None]:
    """Run the jobs of a store while the block lasts; None leaves them to another process."""
    if engine is None:
        yield
        return
    supervisor = Supervisor(store, engine)
    supervisor.start()
    try:
        yield
    finally:
        supervisor.close()
