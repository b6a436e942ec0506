"""Databases for the tests: SQLite files, and databases on a PostgreSQL server that are dropped afterwards.

The server is that at TEST_POSTGRES_URL, or one on 127.0.0.1:5432 that trusts us; without one the test is skipped.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest
import sqlalchemy as sa
from sqlalchemy.engine import make_url

from service.database.migrate import upgrade

CANDIDATES = [os.environ.get("TEST_POSTGRES_URL"), "postgresql://postgres@127.0.0.1:5432/postgres"]


class Server:
    """A server of PostgreSQL. To drop a database waits for the disk: that is done in a thread."""

    def __init__(self, engine: sa.Engine) -> None:
        self.engine = engine
        self._migrated = ""
        self._dropping, self._drops = ThreadPoolExecutor(1), list[Future[None]]()

    def address(self, name: str) -> str:
        return self.engine.url.set(database=name).render_as_string(hide_password=False)

    def create(self, template: str, encoding: str = "") -> str:
        """The name of a new database; ``encoding``: another than that of the template."""
        name = f"substructures_test_{secrets.token_hex(6)}"
        with self.engine.connect() as connection:
            how = f"ENCODING '{encoding}' LOCALE 'C'" if encoding else ""
            connection.exec_driver_sql(f'CREATE DATABASE "{name}" TEMPLATE "{template}" {how}')
        return name

    def migrated(self) -> str:
        """The name of a database with all tables, which others begin as copies of: migrations are run once."""
        if not self._migrated:
            self._migrated = self.create("template1")
            engine = sa.create_engine(self.address(self._migrated))
            upgrade(engine)
            engine.dispose()
        return self._migrated

    def drop(self, name: str) -> None:
        self._drops.append(self._dropping.submit(self._drop, name))

    def _drop(self, name: str) -> None:
        with self.engine.connect() as connection:
            connection.exec_driver_sql(f'DROP DATABASE "{name}" WITH (FORCE)')

    def close(self) -> None:
        """Wait until everything is dropped."""
        if self._migrated:
            self.drop(self._migrated)
        for each in self._drops:
            each.result()
        self.engine.dispose()


@cache
def server() -> Server | None:
    """The first server that answers; whoever asks for it closes it with :func:`close`."""
    for address in filter(None, CANDIDATES):
        url = make_url(address).set(drivername="postgresql+psycopg").update_query_dict({"connect_timeout": "2"})
        engine = sa.create_engine(url, isolation_level="AUTOCOMMIT")
        try:
            with engine.connect():
                return Server(engine)
        except sa.exc.OperationalError:
            engine.dispose()
    return None


def close() -> None:
    """At the end of a session."""
    if server.cache_info().currsize and (opened := server()):
        opened.close()


@contextmanager
def fresh(kind: str, folder: Path, *, is_migrated: bool = True, encoding: str = "") -> Iterator[str]:
    """The address of a database; ``kind``: sqlite, a file in the folder that is not there yet, or postgresql, without
    tables unless ``is_migrated``, or empty in another encoding than the server's.
    """
    if kind == "sqlite":
        yield f"sqlite:///{folder / 'store.db'}"
        return
    opened = server()
    if opened is None:
        pytest.skip("no PostgreSQL server answers at TEST_POSTGRES_URL or 127.0.0.1:5432")
    template = "template0" if encoding else opened.migrated() if is_migrated else "template1"
    name = opened.create(template, encoding)
    try:
        yield opened.address(name)
    finally:
        opened.drop(name)
