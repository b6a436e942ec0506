"""Claims on idempotency keys and the answers kept under them."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import timedelta

from sqlalchemy import ColumnElement, Connection, delete, select, update

from service.database.tables import idempotency
from service.queries.common import insert_missing, now


@dataclass(frozen=True, slots=True)
class Claim:
    """Somebody's claim on a key of a principal."""

    principal: str
    key: str
    owner: str


@dataclass(frozen=True, slots=True)
class Entry:
    """A key as stored; ``status`` None: in flight; ``body`` None with a status: compute again (older versions)."""

    fingerprint: str
    owner: str
    created: str
    status: int | None
    headers: str | None
    body: bytes | None


def claim(connection: Connection, wanted: Claim, fingerprint: str) -> Entry | None:
    """Claim a key; None when it is ours now, otherwise what is there."""
    row = {"principal": wanted.principal, "key": wanted.key, "owner": wanted.owner}
    row |= {"fingerprint": fingerprint, "created": now()}
    return None if insert_missing(connection, idempotency, [row]) else find(connection, wanted.principal, wanted.key)


def renew(connection: Connection, held: Claim) -> bool:
    """Let a claim begin anew; False when it is no longer one."""
    return bool(connection.execute(update(idempotency).where(_in_flight(held)).values(created=now())).rowcount)


def find(connection: Connection, principal: str, key: str) -> Entry | None:
    """What is there under a key."""
    columns = select(*(idempotency.c[name] for name in Entry.__slots__))
    found = connection.execute(columns.where(_is(principal, key))).first()
    return None if found is None else Entry(*found)


def finish(connection: Connection, held: Claim, answer: tuple[int, str, bytes | None]) -> bool:
    """Keep the answer (status, headers, body); False when the claim is no longer ours."""
    status, headers, body = answer
    kept = (
        update(idempotency)
        .where(_in_flight(held))
        .values(status=status, headers=headers, body=body, size=len(body or b""))
    )
    return bool(connection.execute(kept).rowcount)


def release(connection: Connection, held: Claim) -> None:
    """Give a claim up, so that the request can be sent again."""
    connection.execute(delete(idempotency).where(_in_flight(held)))


def forget(connection: Connection, answered: timedelta, in_flight: timedelta) -> None:
    """Drop answers older than ``answered`` and claims older than ``in_flight``, whose server must have died."""
    is_claim = idempotency.c.status.is_(None)
    connection.execute(delete(idempotency).where(idempotency.c.created < now(-answered), ~is_claim))
    connection.execute(delete(idempotency).where(idempotency.c.created < now(-in_flight), is_claim))


def _in_flight(held: Claim) -> ColumnElement[bool]:
    return _is(held.principal, held.key) & (idempotency.c.owner == held.owner) & idempotency.c.status.is_(None)


def _is(principal: str, key: str) -> ColumnElement[bool]:
    return (idempotency.c.principal == principal) & (idempotency.c.key == key)
