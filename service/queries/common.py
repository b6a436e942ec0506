"""What the query modules share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import timedelta
from functools import cache
from importlib import import_module
from typing import Any

from sqlalchemy import Connection, Table
from sqlalchemy.exc import DBAPIError, OperationalError

from service.database.clock import time_now

_READ_ONLY = ("25006", "0A000")  # of PostgreSQL


def now(shift: timedelta = timedelta()) -> str:
    """The time in UTC, shifted, in the one format of the store; sorts as text."""
    return (time_now() + shift).strftime("%Y-%m-%dT%H:%M:%S.%fZ")


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
    """Built once: to build a statement takes longer than to execute it. Of two dialects one is never imported."""
    return import_module(f"sqlalchemy.dialects.{dialect}").insert(table).on_conflict_do_nothing()


def is_outage(error: Exception) -> bool:
    """Whether it is the database that failed (locked, full, gone, read-only), so that the same may work later."""
    if isinstance(error, OperationalError) or is_read_only(error):
        return True
    return isinstance(error, DBAPIError) and error.connection_invalidated


def is_read_only(error: Exception) -> bool:
    """Whether the database takes no changes: it was set so, or is a standby, which refuses to begin a transaction that
    writes as a feature that it does not support."""
    seen = getattr(error, "orig", None)
    return getattr(seen, "sqlite_errorname", "") == "SQLITE_READONLY" or getattr(seen, "sqlstate", "") in _READ_ONLY


def is_conflict(error: Exception) -> bool:
    """Whether a transaction was given up for the sake of another, so that it should be tried again: a deadlock, or
    an item that another host has claimed since it was seen queued."""
    if not isinstance(error, DBAPIError):
        return False
    return getattr(error.orig, "sqlstate", "") in ("40P01", "40001") or "uq_job_items_running" in str(error.orig)


def is_full(error: Exception) -> bool:
    """Whether the disk of the database has no room."""
    seen = getattr(error, "orig", None)
    return getattr(seen, "sqlite_errorname", "") == "SQLITE_FULL" or getattr(seen, "sqlstate", "") == "53100"
