"""Claims on idempotency keys and the answers kept under them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from sqlalchemy import Connection, RowMapping, bindparam, delete, select, update

from service.content.integrity import digest_of
from service.database.tables import idempotency
from service.queries.common import insert_missing, now
from service.queries.seals import seal_of_answer


@dataclass(frozen=True, slots=True)
class Claim:
    """Somebody's claim on a key of a principal."""

    principal: str
    key: str
    owner: str


@dataclass(frozen=True, slots=True)
class Entry:
    """A key as stored; ``status`` None: in flight; ``body`` None with a status: compute again (older versions);
    ``is_ours``: whether the answer has the seal of this server.
    """

    fingerprint: str
    owner: str
    created: str
    status: int | None
    headers: str | None
    body: bytes | None
    is_ours: bool


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
    row = connection.execute(_FIND, {"of_principal": principal, "of_key": key}).mappings().first()
    if row is None:
        return None
    is_ours = row["seal"] == _seal(connection, row)
    values: list[Any] = [*(row[name] for name in Entry.__slots__[:-1]), is_ours]
    return Entry(*values)


def finish(connection: Connection, held: Claim, fingerprint: str, answer: tuple[int, str, bytes | None]) -> bool:
    """Keep the answer (status, headers, body) of a request; False when the claim is no longer ours."""
    status, headers, body = answer
    kept: dict[str, Any] = {"status": status, "headers": headers, "body": body}
    request = {"principal": held.principal, "key": held.key, "fingerprint": fingerprint}
    kept |= {"size": len(body or b""), "seal": _seal(connection, request | kept)}
    return bool(connection.execute(_FINISH, _held(held) | {f"its_{name}": x for name, x in kept.items()}).rowcount)


def wrong_answers(connection: Connection) -> Iterator[tuple[str, str, str]]:
    """Principals, keys and fingerprints of answers that have another seal than that of this server."""
    for row in connection.execute(_SEALED).mappings():
        if row["seal"] != _seal(connection, row):
            yield row["principal"], row["key"], row["fingerprint"]


def _seal(connection: Connection, row: Mapping[str, Any] | RowMapping) -> str:
    body = row["body"] or b""
    digest = digest_of(body if isinstance(body, bytes) else repr(body).encode())  # SQLite keeps any type anywhere
    return seal_of_answer(connection, row, digest)


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
_FIND = select(idempotency).where(_IS)
_SEALED = select(idempotency).where(~_IS_CLAIM, idempotency.c.seal != "").execution_options(yield_per=100)
_RENEW = update(idempotency).where(_IN_FLIGHT).values(created=bindparam("its_created"))
_FINISH = (
    update(idempotency)
    .where(_IN_FLIGHT)
    .values({name: bindparam(f"its_{name}") for name in ("status", "headers", "body", "size", "seal")})
)
_RELEASE = delete(idempotency).where(_IN_FLIGHT)
_OLD_ANSWERS, _OLD_CLAIMS = (delete(idempotency).where(_IS_OLD, which) for which in (~_IS_CLAIM, _IS_CLAIM))
