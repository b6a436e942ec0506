"""Sessions of pages. What stands in the cookie is never stored."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, delete, insert, select

from service.database.tables import sessions
from service.queries.common import now


@dataclass(frozen=True, slots=True)
class Session:
    """A session as stored."""

    id: str
    key: str
    created: str
    expires: str


def add_session(connection: Connection, identifier: str, key: str, expires: str) -> None:
    """Store a new session; those that have expired go."""
    connection.execute(delete(sessions).where(sessions.c.expires <= now()))
    connection.execute(insert(sessions).values(id=identifier, key=key, created=now(), expires=expires))


def find(connection: Connection, identifier: str) -> Session | None:
    """One session."""
    columns = select(*(sessions.c[name] for name in Session.__slots__))
    row = connection.execute(columns.where(sessions.c.id == identifier)).first()
    return None if row is None else Session(*row)


def end(connection: Connection, identifier: str) -> None:
    """Remove a session."""
    connection.execute(delete(sessions).where(sessions.c.id == identifier))


def end_all(connection: Connection, key: str) -> None:
    """Remove the sessions of a key."""
    connection.execute(delete(sessions).where(sessions.c.key == key))
