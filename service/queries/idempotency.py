"""Claims on idempotency keys and the answers kept under them."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import timedelta

from sqlalchemy import Connection, bindparam, delete, select, update

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
    return bool(connection.execute(_RENEW, {**_held(held), "its_created": now()}).rowcount)


def find(connection: Connection, principal: str, key: str) -> Entry | None:
    """What is there under a key."""
    found = connection.execute(_FIND, {"of_principal": principal, "of_key": key}).first()
    return None if found is None else Entry(*found)


def finish(connection: Connection, held: Claim, answer: tuple[int, str, bytes | None]) -> bool:
    """Keep the answer (status, headers, body); False when the claim is no longer ours."""
    status, headers, body = answer
    kept = {"its_status": status, "its_headers": headers, "its_body": body, "its_size": len(body or b"")}
    return bool(connection.execute(_FINISH, {**_held(held), **kept}).rowcount)


def release(connection: Connection, held: Claim) -> None:
    """Give a claim up, so that the request can be sent again."""
    connection.execute(_RELEASE, _held(held))


def forget(connection: Connection, answered: timedelta, in_flight: timedelta) -> None:
    """Drop answers older than ``answered`` and claims older than ``in_flight``, whose server must have died."""
    connection.execute(_OLD_ANSWERS, {"before": now(-answered)})
    connection.execute(_OLD_CLAIMS, {"before": now(-in_flight)})


def _held(held: Claim) -> dict[str, str]:
    return {"of_principal": held.principal, "of_key": held.key, "of_owner": held.owner}


# Built once: to build a statement takes longer than to execute it.
_IS = (idempotency.c.principal == bindparam("of_principal")) & (idempotency.c.key == bindparam("of_key"))
_IS_CLAIM, _IS_OLD = idempotency.c.status.is_(None), idempotency.c.created < bindparam("before")
_IN_FLIGHT = _IS & (idempotency.c.owner == bindparam("of_owner")) & _IS_CLAIM
_FIND = select(*(idempotency.c[name] for name in Entry.__slots__)).where(_IS)
_RENEW = update(idempotency).where(_IN_FLIGHT).values(created=bindparam("its_created"))
_FINISH = (
    update(idempotency)
    .where(_IN_FLIGHT)
    .values({name: bindparam(f"its_{name}") for name in ("status", "headers", "body", "size")})
)
_RELEASE = delete(idempotency).where(_IN_FLIGHT)
_OLD_ANSWERS, _OLD_CLAIMS = (delete(idempotency).where(_IS_OLD, which) for which in (~_IS_CLAIM, _IS_CLAIM))
