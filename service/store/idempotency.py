"""Claims on idempotency keys, renewed while their requests are served, so that those of a dead server end soon."""

from __future__ import annotations

import logging
import threading
from datetime import timedelta
from time import monotonic

from service.database.connections import Database
from service.queries.idempotency import Claim, renew

LEASE = timedelta(seconds=5)  # after which a claim that is not renewed belongs to whoever asks
RENEWAL = 1.25  # seconds
FORGET = 1.0  # seconds between looks for what is too old
_log = logging.getLogger(__name__)


class Claims:
    """The claims of a process. Its thread runs only while there are some; what was answered drops out by itself."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._lock = threading.Lock()
        self._held: set[Claim] = set()
        self._closed = threading.Event()
        self._thread: threading.Thread | None = None
        self._forgotten = -FORGET

    def is_time_to_forget(self) -> bool:
        """Whether what is too old is to be forgotten now: now and then, and not with each request."""
        with self._lock:
            is_due = monotonic() - self._forgotten >= FORGET
            self._forgotten = monotonic() if is_due else self._forgotten
        return is_due

    def hold(self, claim: Claim) -> None:
        """Renew a claim until it is answered or given up."""
        with self._lock:
            self._held.add(claim)
            if self._thread is None and not self._closed.is_set():
                self._thread = threading.Thread(target=self._run, name="claims", daemon=True)
                self._thread.start()

    def drop(self, claim: Claim) -> None:
        """It was answered or given up."""
        with self._lock:
            self._held.discard(claim)

    @property
    def count(self) -> int:
        """How many there are."""
        return len(self._held)

    def close(self) -> None:
        """Renew no more, and wait for the thread."""
        self._closed.set()
        thread = self._thread
        if thread is not None:
            thread.join(10)

    def _run(self) -> None:
        while True:
            self._closed.wait(RENEWAL)
            with self._lock:
                held = set(self._held)
                if not held or self._closed.is_set():
                    self._thread = None
                    return
            try:
                with self._database.write(durable=False) as connection:
                    gone = {claim for claim in held if not renew(connection, claim)}
            except Exception as error:
                _log.error("claims on idempotency keys cannot be renewed: %s", str(error).partition("\n")[0])
                continue
            with self._lock:
                self._held -= gone
