"""An engine beside another one for what needs the store itself: mirrors, each in a thread of this process.

Most of a mirror is to wait for the other instance and for the disk. What is stored is stored for whoever submitted the
job, part by part; so nothing is lost with a thread that does not come to its end.
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from importlib import import_module
from time import monotonic
from typing import Any

from service.jobs.engines.engine import AttemptReport, Engine, Outcome, Work
from service.jobs.kinds import failed
from service.jobs.kinds.mirror import MIRROR_KIND
from service.messages.refusals import Refused, known_refusal
from service.queries.attempts import job_of
from service.queries.jobs.jobs import submitters
from service.sources import SETTING, source_of
from service.store.store import Store

PATIENCE = 10.0  # seconds for threads to end, which wait for other instances
_log = logging.getLogger(__name__)


class Stopped(Exception):
    """Nobody wants the mirror any more."""


class WithMirrors:
    """An engine that makes mirrors here, in the places of another one, which does the rest."""

    def __init__(self, engine: Engine, store: Store) -> None:
        self._engine, self._store = engine, store
        self._threads: dict[str, tuple[threading.Thread, threading.Event]] = {}
        self._news: deque[AttemptReport] = deque()

    @property
    def free(self) -> int:
        """Works that can be started now."""
        return max(0, self._engine.free - len(self._threads))

    def start(self, work: Work) -> None:
        """Start to compute; reports follow."""
        if work.kind != MIRROR_KIND:
            self._engine.start(work)
            return
        stop = threading.Event()
        thread = threading.Thread(target=self._run, args=(work, stop), name=f"mirror {work.id}", daemon=True)
        self._threads[work.id] = thread, stop
        thread.start()

    def stop(self, attempt: str) -> None:
        """End what computes the attempt, a mirror after the part at hand; no report follows."""
        if attempt not in self._threads:
            self._engine.stop(attempt)
            return
        self._threads.pop(attempt)[1].set()

    def reports(self, seconds: float) -> list[AttemptReport]:
        """News, waiting at most so long for the first."""
        found = self._engine.reports(0.0 if self._news else seconds)
        while self._news:
            report = self._news.popleft()
            if report.id in self._threads:
                found.append(report)
                if report.is_final:
                    del self._threads[report.id]
        return found

    def close(self) -> None:
        """Stop all."""
        threads = list(self._threads.values())
        for _, stop in threads:
            stop.set()
        self._engine.close()
        end = monotonic() + PATIENCE
        for thread, _ in threads:
            thread.join(max(0.0, end - monotonic()))

    def _run(self, work: Work, stop: threading.Event) -> None:
        def told(share: float) -> None:
            """Note how far it is. Raises Stopped."""
            if stop.is_set():
                raise Stopped
            self._news.append(AttemptReport(work.id, share))

        try:
            outcome = Outcome(_mirrored(self._store, work, told))
        except Stopped:
            return
        except Exception as error:
            known = known_refusal(error)
            if known is None and not stop.is_set():
                _log.error("a mirror failed: %s", type(error).__name__, exc_info=error)
            outcome = failed(
                known or Refused(500, "internal-error", f"an error in the service: {type(error).__name__}")
            )
        if not stop.is_set():
            self._news.append(AttemptReport(work.id, 1.0, outcome))


def _mirrored(store: Store, work: Work, told: Callable[[float], None]) -> dict[str, Any]:
    """The summary of a mirror. Raises as :meth:`service.operations.sharing.mirrors.Mirror.run`."""
    address = work.item["source"]
    source = source_of(address, store.settings.mirror_sources)
    if source is None:
        detail = f"'{address}' is no longer one of the instances that the operator lists in {SETTING}"
        raise Refused(422, "source-not-allowed", detail)
    job = job_of(work.id)
    with store.database.read() as connection:
        viewer = submitters(connection, {job})[job]
    mirrors = import_module("service.operations.sharing.mirrors")  # with a client, which no other server needs
    found: dict[str, Any] = mirrors.Mirror(store, viewer, source, work.item["nodes"], told).run()
    return found
