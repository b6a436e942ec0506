"""The running process: threads that answer requests, and events between the server, its routes and the supervisor."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Event

from service.keys import Authorisations

THREADS = 16


class Runtime:
    """``threads``: for requests that may be given up; ``wake``: set when there is something new for the supervisor of
    this process; ``stopping``: set when the server stops, so that answers without an end are ended.
    """

    def __init__(self, key_seconds: float) -> None:
        self.authorisations = Authorisations(key_seconds)
        self.threads = ThreadPoolExecutor(THREADS, thread_name_prefix="request")
        self.wake = Event()
        self.stopping = Event()

    def close(self) -> None:
        """Wait for the requests that are being answered, and drop those that are not begun."""
        self.threads.shutdown(wait=True, cancel_futures=True)
