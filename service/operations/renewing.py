"""What a store holds of other software, or from elsewhere, is derived anew: in the background, and first what is asked
for.

A server that starts with other software than the last one looks at all parts and trees once
(:mod:`service.operations.renewal`). Each is written by itself, so that what was done stays when the server is stopped,
and the next start goes on with the rest. What is asked for meanwhile, and was not derived by this server, is derived
before it is answered (:mod:`service.http.not_derived`).
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from threading import Thread
from time import perf_counter

from service.database.connections import DBAPIError
from service.messages.refusals import NotDerived, Refused
from service.operations.renewal import OPERATOR, is_part_newest, is_tree_newest, renew_part, renew_tree
from service.operations.verification import told
from service.queries import content, renewals, trees, versions
from service.store.store import Store

SHARE = 1.0  # of the time of a piece of work that it rests afterwards, for those who wait for answers
PATIENCE = 2.0  # seconds for the piece of work at hand, which is begun again at the next start
_log = logging.getLogger(__name__)


class Renewal:
    """The renewals of one store: one at a time, whoever asks."""

    def __init__(self, store: Store) -> None:
        self._store, self._lock = store, store.runtime.renewing

    def on_request(self, wanted: NotDerived) -> None:
        """Derive anew what is asked for, unless somebody else just has. Raises Refused 500 where that cannot be, and
        NotDerived where something else takes all the time of a request.
        """
        if not self._lock.acquire(timeout=self._store.settings.limits.sync_seconds):
            raise wanted
        try:
            self._renew(wanted, is_served=not wanted.is_newest)
        except (Refused, DBAPIError):
            raise
        except Exception as error:
            detail = f"the {wanted.kind} {wanted.key} is not as this server derived it, and cannot be derived anew"
            raise Refused(500, "damaged-content", f"{detail}: {told(error)}") from error
        finally:
            self._lock.release()

    def _renew(self, wanted: NotDerived, is_served: bool = False) -> None:
        """``is_served``: a tree of other software is good enough, if this server coupled it."""
        database, nodes = self._store.database, self._store.settings.limits.job_nodes
        name, _, number = wanted.key.partition("@")
        with database.read() as connection:
            if wanted.kind == "part":
                is_done = is_part_newest(connection, wanted.key)
            else:
                is_done = is_tree_newest(connection, name, int(number), is_served)
        if is_done:
            return
        worker = self._store.job_worker(OPERATOR.owner)
        if wanted.kind == "part":
            renew_part(database, wanted.key, nodes, compute=worker)
        else:
            renew_tree(database, name, int(number), nodes, compute=worker)

    def all(self, is_stopped: Callable[[float], bool] = lambda _seconds: False) -> int:
        """Derive anew all that needs it; the number of those that could not be. ``is_stopped``: waits for so long, and
        says whether to end.
        """
        database, start = self._store.database, perf_counter()
        with database.read() as connection:
            if renewals.is_done(connection):
                return 0
            stale = [*(NotDerived("part", digest) for digest in content.stale_parts(connection))]
            stale += [NotDerived("tree", f"{name}@{number}") for name, number in trees.stale_revisions(connection)]
        if stale:
            _log.info("%d parts and trees are derived anew by this version, in the background", len(stale))
        failed = 0
        for wanted in stale:
            begun = perf_counter()
            failed += not self._tried(wanted)
            if is_stopped(SHARE * (perf_counter() - begun)):
                return failed
        with database.write() as connection:
            taken = 0 if renewals.is_ours(connection) else versions.seal_numbers(connection)
            renewals.note(connection)
        if taken:
            _log.warning("the numbers of %d versions had no seal of this server; they are taken as they are", taken)
        if stale:
            _log.info("%d derived anew in %.1f s, %d could not be", len(stale), perf_counter() - start, failed)
        return failed

    def _tried(self, wanted: NotDerived) -> bool:
        try:
            with self._lock:
                self._renew(wanted)
        except Exception as error:  # whatever it is, the next one is looked at, too
            _log.warning("the %s %s cannot be derived anew: %s", wanted.kind, wanted.key, told(error))
            return False
        return True


@contextmanager
def renewed(store: Store) -> Iterator[None]:
    """Derive a store anew in the background while the block lasts, where that is needed."""
    stopping = store.runtime.stopping
    thread = Thread(target=lambda: _watched(store), name="renewal", daemon=True)
    thread.start()
    try:
        yield
    finally:
        stopping.set()
        thread.join(PATIENCE)


def _watched(store: Store) -> None:
    try:
        Renewal(store).all(store.runtime.stopping.wait)
    except Exception as error:
        _log.error("the store is not derived anew: %s", told(error), exc_info=error)
