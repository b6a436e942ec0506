"""Which workers of a Dask cluster compute with our version, and what the log says about a cluster.

People start workers by hand and upgrade them one by one. A worker of another version answers every work at once with an
error and so would take most of them: every worker is asked for its protocol before it gets the first one.
"""

from __future__ import annotations

import asyncio
import logging

from distributed import Client

from service.jobs.engines.dask_task import protocol
from service.jobs.engines.wire import PROTOCOL

CONNECT = 10.0  # seconds for an answer of the scheduler or of a worker
AGAIN = 10.0  # seconds until a worker that does not fit is asked again: another may have its address by then
_log = logging.getLogger(__name__)


class Workers:
    """The workers of a connected cluster."""

    def __init__(self, client: Client) -> None:
        self.client = client
        self.fitting: set[str] = set()  # addresses of those that compute with our version
        self._asking: dict[str, asyncio.Task[None]] = {}
        self._told: dict[str, str] = {}
        self._is_doubted = False

    async def look(self) -> int:
        """The threads of the fitting workers. New workers are asked; their answers count at the next look."""
        async with asyncio.timeout(CONNECT):
            threads = await self.client.nthreads()
        self._drop(set(self._asking) if self._is_doubted else self._asking.keys() - threads.keys())
        self._is_doubted = False
        self.fitting &= threads.keys()
        for address in threads.keys() - self._asking.keys():
            self._asking[address] = asyncio.create_task(self._ask(address))
        return sum(threads[address] for address in self.fitting)

    def doubt(self) -> None:
        """Have all workers asked again: one that was replaced by another at the same address did not fit."""
        self._is_doubted = True

    def close(self) -> None:
        """Ask no more."""
        self._drop(set(self._asking))

    def _drop(self, addresses: set[str]) -> None:
        for address in addresses:
            self._asking.pop(address).cancel()

    async def _ask(self, address: str) -> None:
        """Ask a worker until it fits; say once why it does not."""
        while reason := await self._misfit(address):
            self.fitting.discard(address)
            if self._told.get(address) != reason:
                _log.warning("the Dask worker %s gets no works: %s", address, reason)
                self._told[address] = reason
            await asyncio.sleep(AGAIN)
        self.fitting.add(address)
        if self._told.pop(address, None) is not None:
            _log.info("the Dask worker %s gets works now", address)

    async def _misfit(self, address: str) -> str:
        """Why a worker does not fit; nothing when it does."""
        try:
            async with asyncio.timeout(CONNECT):
                answers = await self.client.run(protocol, workers=[address], on_error="return")
        except Exception as error:  # whatever it takes to load what such a worker answers
            answers = {address: error}
        answer = answers.get(address)
        if isinstance(answer, OSError):
            return f"it does not answer ({described(answer)})"
        if isinstance(answer, Exception):
            return f"it has no package of this version ({described(answer)})"
        return "" if answer == PROTOCOL else f"it speaks protocol {answer}, this server {PROTOCOL}"


class Notices:
    """What the log says about a cluster: every change once, however often it is tried."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._said: set[str] = set()  # since the scheduler was last connected
        self._has_workers = True
        self._was_lost = False
        _silence_library()

    def connected(self) -> None:
        """The scheduler answers."""
        what = "is there again" if self._was_lost or self._said else "is connected"
        _log.info("the scheduler at %s %s", self._address, what)
        self._said.clear()
        self._was_lost, self._has_workers = False, True

    def lost(self, why: str) -> None:
        """The connection is gone."""
        _log.warning("lost the scheduler at %s (%s): works wait for the scheduler", self._address, why)
        self._was_lost = True

    def unreachable(self, why: str) -> None:
        """It was tried to connect."""
        if why not in self._said:
            _log.warning("no scheduler at %s (%s): works wait for it, it is tried again", self._address, why)
        self._said.add(why)

    def workers(self, has_workers: bool) -> None:
        """Whether any worker computes."""
        if has_workers != self._has_workers:
            what = "has workers again" if has_workers else "has no workers of this version: works wait for one"
            _log.warning("the cluster at %s %s", self._address, what)
        self._has_workers = has_workers


def described(error: BaseException) -> str:
    """An error in one line."""
    return " ".join(f"{type(error).__name__}: {error}".split())[:300].rstrip(": ")


def _silence_library() -> None:
    """It traces every lost connection, which we say in one line. Some of its loggers have levels of their own."""
    for name in list(logging.root.manager.loggerDict):
        if name.startswith("distributed."):
            logging.getLogger(name).setLevel(logging.NOTSET)
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
