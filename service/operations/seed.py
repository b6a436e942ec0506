"""Import of the shipped catalogue; content that is stored already is not derived again."""

from __future__ import annotations

import logging
from time import perf_counter

from service.operations import catalogue as operations
from service.store import Store
from substructures import catalogue
from substructures.part.definition import Definition

_log = logging.getLogger(__name__)


def import_catalogue(store: Store) -> int:
    """Store every shipped definition that is missing, each in a transaction; return how many were new."""
    start, added = perf_counter(), 0
    for name in catalogue.names():
        submission = operations.prepare(store, Definition.read(catalogue.load(name)))
        with store.database.write() as connection:
            added += operations.submit(connection, submission)[1]
    if added:
        _log.info("imported %d catalogue entries in %.1f s", added, perf_counter() - start)
    return added
