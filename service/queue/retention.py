"""Remove what has been kept long enough: finished jobs with their results, and uploads that no job refers to."""

from __future__ import annotations

from datetime import timedelta
from threading import Event

from service.queries.common import now
from service.queries.jobs.uploads import remove_unused
from service.queries.removal import remove_finished
from service.store.store import Store

CHUNKS = 10  # uploads that are removed together


def sweep(store: Store, stop: Event) -> None:
    """Remove what is old, little in a transaction, so that nobody waits for long."""
    limits = store.settings.limits
    old, unused = now(-timedelta(days=limits.job_days)), now(-timedelta(hours=limits.upload_hours))
    for remove, before, most in ((remove_finished, old, 1), (remove_unused, unused, CHUNKS)):
        removed = most
        while removed and not stop.is_set():
            with store.database.write() as connection:
                removed = remove(connection, before, most)
