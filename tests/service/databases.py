"""Empty databases for the tests: SQLite files, and databases on a PostgreSQL server that are dropped afterwards.

The server is that at TEST_POSTGRES_URL, or one on 127.0.0.1:5432 that trusts us; without one the test is skipped.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import sqlalchemy as sa
from sqlalchemy.engine import make_url

CANDIDATES = [os.environ.get("TEST_POSTGRES_URL"), "postgresql://postgres@127.0.0.1:5432/postgres"]


def server() -> str | None:
    """The address of the first server that answers."""
    for address in filter(None, CANDIDATES):
        url = make_url(address).set(drivername="postgresql+psycopg").update_query_dict({"connect_timeout": "2"})
        engine = sa.create_engine(url)
        try:
            with engine.connect():
                return url.render_as_string(hide_password=False)
        except sa.exc.OperationalError:
            continue
        finally:
            engine.dispose()
    return None


@contextmanager
def fresh(kind: str, folder: Path) -> Iterator[str]:
    """The address of an empty database; ``kind``: sqlite, a file in the folder, or postgresql."""
    if kind == "sqlite":
        yield f"sqlite:///{folder / 'store.db'}"
        return
    base = server()
    if base is None:
        pytest.skip("no PostgreSQL server answers at TEST_POSTGRES_URL or 127.0.0.1:5432")
    name = f"substructures_test_{secrets.token_hex(6)}"
    engine = sa.create_engine(base, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        connection.exec_driver_sql(f'CREATE DATABASE "{name}"')
    try:
        yield make_url(base).set(database=name).render_as_string(hide_password=False)
    finally:
        with engine.connect() as connection:
            connection.exec_driver_sql(f'DROP DATABASE "{name}" WITH (FORCE)')
        engine.dispose()
