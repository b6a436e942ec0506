"""A client of a store: it is served to this process alone while a command lasts."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from service.cli.output import shipped
from service.database.connections import Database
from service.messages.viewer import CONSOLE, SCOPES
from service.queries.keys import any_key
from service.server import background
from service.settings import Settings
from service.store import keys
from substructures.client import Client

DAYS = 1 / 24


@contextmanager
def serving(settings: Settings) -> Iterator[Client]:
    """Of a store with keys by one that is made for this, and removed. Raises DatabaseError, MigrationError."""
    with ExitStack() as opened:
        with shipped() as told:
            address = opened.enter_context(background(settings, told))
        key = opened.enter_context(_key(settings.database))
        yield opened.enter_context(Client(address, key))


@contextmanager
def _key(url: str) -> Iterator[str | None]:
    database = Database(url, exclusive=False)
    try:
        with database.read() as connection:
            is_open = not any_key(connection)
        if is_open:
            yield None
            return
        with database.write() as connection:
            text = keys.create(connection, "a command on the store", SCOPES, DAYS, CONSOLE)
        try:
            yield text
        finally:
            with database.write() as connection:
                identifier = text.split("_")[1]
                keys.revoke(connection, identifier)
                keys.delete(connection, identifier)
    finally:
        database.close()
