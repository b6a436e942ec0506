"""The running process: threads that answer requests, and events between the server, its routes and the supervisor."""

from __future__ import annotations

from threading import Event, Lock
from typing import Literal

from service.processes.threads import SharedThreads
from service.store.authorisations import Authorisations, WrongKeys

#: what has threads of its own, and how many; those of other tasks than to evaluate do nothing but wait for workers, and
#: are so many that nobody's works wait for a thread behind those of others
Task = Literal["evaluate", "analyse", "derive", "print"]
THREADS: dict[Task, int] = {"evaluate": 16, "analyse": 256, "derive": 256, "print": 256}
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
    """``computed``: keys of computations; ``threads``: for requests that may be given up, by task; ``wrong_keys``: at
    sign-in; ``renewing``: held while something stored is derived anew; ``wake``: set when there is something new for
    the supervisor of this process; ``stopping``: set when the server stops, so that answers without an end are ended.
    """

    def __init__(self, key_seconds: float) -> None:
        self.authorisations = Authorisations(key_seconds)
        self.wrong_keys = WrongKeys()
        self.computed = Computed()
        self.threads = {task: SharedThreads(count, task) for task, count in THREADS.items()}
        self.renewing = Lock()
        self.wake = Event()
        self.stopping = Event()

    def close(self) -> None:
        """End what has no end, wait for the requests that are being answered, and drop those that are not begun."""
        self.stopping.set()
        for threads in self.threads.values():
            threads.close()
