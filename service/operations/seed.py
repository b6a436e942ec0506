"""Import of the shipped catalogue; content that is stored already is not derived again."""

from __future__ import annotations

import logging
from collections.abc import Callable
from time import perf_counter

from service.database.connections import Connection
from service.messages.refusals import Refused
from service.messages.viewer import CATALOGUE, SHIPPED
from service.operations import catalogue as operations
from service.operations.owners import ship
from service.operations.sharing.provenance import Origin
from service.queries import content
from service.queries.owners import is_version, ownership
from service.schemas.entries import PLAIN
from service.store.store import Store
from substructures import catalogue
from substructures.part.definition import Definition

_log = logging.getLogger(__name__)


#: is told how many of the shipped definitions are done, and of how many
Told = Callable[[int, int], None]


def import_catalogue(store: Store, told: Told = lambda _done, _all: None) -> int:
    """Store every shipped definition that is missing, each in a transaction; return how many were new.

    A name that somebody else has stays theirs. ``told`` hears of each that is new.
    """
    start, added, known = perf_counter(), 0, catalogue.digests()
    with store.database.read() as connection:
        names = [name for name in catalogue.names() if not _is_stored(connection, name, known.get(name, ""))]
    for done, name in enumerate(names, 1):
        definition = Definition.read(catalogue.load(name))
        if not _is_ours(store, definition):
            _log.warning("'%s' of the shipped catalogue is left out: the name belongs to somebody else", name)
            continue
        submission = operations.prepare(store, SHIPPED, definition, PLAIN, Origin("catalogue"))
        with store.database.write() as connection:
            is_new = operations.submit(connection, SHIPPED, submission)[1]
        added += is_new
        if is_new:
            told(done, len(names))
    if added:
        told(len(names), len(names))
        _log.info("imported %d catalogue entries in %.1f s", added, perf_counter() - start)
    return added


def _is_stored(connection: Connection, name: str, digest: str) -> bool:
    """Whether the catalogue has a version of this content, which is sound and was derived here."""
    found = ownership(connection, "substructure", name)
    if found is None or found.owner != CATALOGUE or not is_version(connection, name, digest):
        return False
    try:
        part = content.get_part(connection, digest)
    except Refused:  # damaged
        return False
    return part is not None and part.is_derived


def _is_ours(store: Store, definition: Definition) -> bool:
    """Whether the name belongs to the catalogue, or is free."""
    with store.database.read() as connection:
        found = ownership(connection, "substructure", definition.name)
    if found is None or found.owner == CATALOGUE:
        return True
    with store.database.write() as connection:
        return ship(connection, definition.name, definition.digest)
