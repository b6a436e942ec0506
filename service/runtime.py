"""The running process: threads that answer requests, and events between the server, its routes and the supervisor."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Event, Lock

from service.keys import Authorisations

THREADS = 16
#: idempotency keys of computations that a process remembers
COMPUTED = 10_000


class Computed:
    """Which computation a key belongs to: the last ``COMPUTED`` ones of this process."""

    def __init__(self) -> None:
        self._fingerprints: dict[tuple[str, str], str] = {}
        self._lock = Lock()

    def first(self, principal: str, key: str, fingerprint: str) -> str:
        """The fingerprint of the first request under this key: this one where there was none."""
        with self._lock:
            found = self._fingerprints.setdefault((principal, key), fingerprint)
            if len(self._fingerprints) > COMPUTED:
                del self._fingerprints[next(iter(self._fingerprints))]
            return found


class Runtime:
    """``computed``: keys of computations; ``threads``: for requests that may be given up; ``wake``: set when there is
    something new for the supervisor of this process; ``stopping``: set when the server stops, so that answers without
    an end are ended.
    """

    def __init__(self, key_seconds: float) -> None:
        self.authorisations = Authorisations(key_seconds)
        self.computed = Computed()
        self.threads = ThreadPoolExecutor(THREADS, thread_name_prefix="request")
        self.wake = Event()
        self.stopping = Event()

    def close(self) -> None:
        """Wait for the requests that are being answered, and drop those that are not begun."""
        self.threads.shutdown(wait=True, cancel_futures=True)
