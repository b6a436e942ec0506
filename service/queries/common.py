"""What the query modules share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime, timedelta
from functools import cache
from typing import Any

from sqlalchemy import Connection, Table
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import OperationalError

_INSERT: dict[str, Any] = {"sqlite": sqlite.insert, "postgresql": postgresql.insert}


def now(shift: timedelta = timedelta()) -> str:
    """The time in UTC, shifted, in the one format of the store; sorts as text."""
    return (datetime.now(UTC) + shift).strftime("%Y-%m-%dT%H:%M:%S.%fZ")


def insert_missing(connection: Connection, table: Table, rows: Sequence[Mapping[str, Any]]) -> int:
    """Insert the rows whose key is not there yet; return how many were new."""
    if not rows:
        return 0
    statement = _insert(connection.dialect.name, table)
    counted = {"preserve_rowcount": True}  # otherwise PostgreSQL's driver does not say
    return sum(connection.execute(statement, row, execution_options=counted).rowcount for row in rows)


def put_all(connection: Connection, table: Table, rows: Sequence[Mapping[str, Any]]) -> None:
    """Insert the rows whose key is not there yet, many at a time."""
    if rows:
        connection.execute(_insert(connection.dialect.name, table), list(rows))


@cache
def _insert(dialect: str, table: Table) -> Any:
    """Built once: to build a statement takes longer than to execute it."""
    return _INSERT[dialect](table).on_conflict_do_nothing()


def is_outage(error: Exception) -> bool:
    """Whether it is the database that failed (locked, full, gone), so that the same may work later."""
    return isinstance(error, OperationalError)
