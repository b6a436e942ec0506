"""The folder of a server is looked at again and again, in a thread of its first process."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Event, Thread

from service.operations.sharing.folder import Folder
from service.queries.common import is_outage
from service.store.store import Store

POLL, SHARE = 1.0, 20.0  # seconds between looks at the folder, at least so many times as long as to list it
FIRST = 30.0  # seconds for which a server that starts waits until all is read
PATIENCE = 2.0  # seconds for the file at hand when the server stops
_log = logging.getLogger(__name__)


@contextmanager
def followed(store: Store) -> Iterator[None]:
    """Read the folder of a store while the block lasts, which begins when all files were read, or after some time."""
    if not store.settings.folder:
        yield
        return
    stopping, first = store.runtime.stopping, Event()
    thread = Thread(target=lambda: _follow(store, first.set), name="folder", daemon=True)
    thread.start()
    try:
        first.wait(FIRST)
        yield
    finally:
        stopping.set()
        thread.join(PATIENCE)


def _follow(store: Store, looked: Callable[[], None]) -> None:
    """Look again and again; a look that fails is told once, and the next one does what it has left."""
    folder, complaint, pause = None, "", 0.0
    while not store.runtime.stopping.wait(pause):
        try:
            folder = folder or Folder(store)
            folder.look()
            complaint = ""
        except Exception as error:
            if not store.runtime.stopping.is_set() and complaint != (complaint := str(error)):
                _log.error("the folder is not read: %s", error, exc_info=None if is_outage(error) else error)
        looked()
        pause = POLL if folder is None else max(POLL, SHARE * folder.took)
