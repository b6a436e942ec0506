"""API keys. The secret itself is never stored."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection, Select, bindparam, delete, insert, select, update

from service.database.tables import api_keys
from service.queries.common import now


@dataclass(frozen=True, slots=True)
class ApiKey:
    """A key as stored; ``scopes`` are separated by spaces."""

    id: str
    secret_hash: str
    label: str
    scopes: str
    created: str
    expires: str | None
    revoked: str | None
    owner: str


def any_key(connection: Connection) -> bool:
    """Whether there is a key that was not revoked; expired ones count, so that a server never opens by itself."""
    return connection.execute(_ANY).first() is not None


def get_key(connection: Connection, identifier: str) -> ApiKey | None:
    """One key."""
    row = connection.execute(_ONE, {"id": identifier}).first()
    return None if row is None else ApiKey(*row)


def list_keys(connection: Connection) -> list[ApiKey]:
    """All keys, the oldest first."""
    return [ApiKey(*row) for row in connection.execute(_all().order_by(api_keys.c.created))]


def add_key(connection: Connection, key: ApiKey) -> None:
    """Store a new key."""
    connection.execute(insert(api_keys).values(**{name: getattr(key, name) for name in ApiKey.__slots__}))


def revoke_key(connection: Connection, identifier: str) -> bool:
    """Revoke a key; False when there is none."""
    return bool(connection.execute(update(api_keys).where(api_keys.c.id == identifier).values(revoked=now())).rowcount)


def expire_key(connection: Connection, identifier: str, expires: str) -> None:
    """Let a key expire at a time."""
    connection.execute(update(api_keys).where(api_keys.c.id == identifier).values(expires=expires))


def delete_key(connection: Connection, identifier: str) -> None:
    """Remove a key."""
    connection.execute(delete(api_keys).where(api_keys.c.id == identifier))


def _all() -> Select[Any]:
    return select(*(api_keys.c[name] for name in ApiKey.__slots__))


_ANY = select(api_keys.c.id).where(api_keys.c.revoked.is_(None)).limit(1)
_ONE = _all().where(api_keys.c.id == bindparam("id"))
