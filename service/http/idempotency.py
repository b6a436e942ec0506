"""``Idempotency-Key``: a POST that is sent twice acts once; the answer is kept in the transaction that acts.

::

    claim (own transaction) -> prepare (computes, stores nothing) -> commit + answer kept (one transaction)
        |                          '-- fails: the claim is given up, the request may be sent again
        |-- answered already: the same answer again; 500 where it has not the seal of this server
        |-- other request under this key: 422
        '-- in flight: 409

A computation stores nothing, so it claims nothing: the same request computes the same answer again. What its key
belongs to is remembered by the process; it is claimed only when the computation becomes a job.
"""

from __future__ import annotations

import hashlib
import secrets
from collections.abc import Callable, Iterable
from datetime import timedelta
from functools import cached_property

import orjson
from fastapi import Request

from service.content.integrity import NOT_SEALED, damaged
from service.database.connections import Connection
from service.messages.answers import Answer
from service.messages.refusals import Refused
from service.queries import idempotency
from service.store.idempotency import LEASE
from service.store.runtime import Computed
from service.store.store import Store

REMEDY = (
    "the request was served, and is not served again: look at what it has made (GET /v1/audit says who did what), and "
    "send what is still to be done under another key"
)


class IdempotencyClaim:
    """The claim of a request on its key; without a key there is nothing to claim or to keep."""

    def __init__(
        self,
        request: Request,
        body: Callable[[], Iterable[bytes]],
        store: Store,
        key: str | None,
    ) -> None:
        """``body``: gives the pieces of the request body."""
        self.key = key or ""
        self._request, self._body, self._store, self._database = request, body, store, store.database
        self._principal: str = request.state.principal
        self._wanted = idempotency.Claim(self._principal, self.key, secrets.token_hex(8))
        self._is_claimed = False

    @cached_property
    def _fingerprint(self) -> str:
        request = self._request
        seen = [request.method, request.url.path, request.url.query]
        seen += [request.headers.get(name, "") for name in ("content-type", "accept")]
        found = hashlib.sha256("\n".join(seen).encode() + b"\n")
        for piece in self._body():
            found.update(piece)
        return found.hexdigest()

    def claim(self) -> idempotency.Entry | None:
        """Claim the key, once, or what was answered under it already. Raises Refused 409, 422 or 500."""
        if not self.key or self._is_claimed:
            return None
        lifetime = timedelta(hours=self._store.settings.limits.idempotency_hours)
        with self._database.write(durable=False) as connection:  # a claim need not outlive the request
            self._store.usage.take(connection, "answer", self._principal, 0)
            if self._store.claims.is_time_to_forget():
                idempotency.forget(connection, lifetime, LEASE)
            entry = idempotency.claim(connection, self._wanted, self._fingerprint)
            if entry is not None:  # maybe too old to count
                # who takes a claim over too early is fenced off: the first to finish is the only one
                idempotency.forget(connection, lifetime, LEASE)
                entry = idempotency.claim(connection, self._wanted, self._fingerprint)
        self._is_claimed = entry is None
        if self._is_claimed:
            self._store.claims.hold(self._wanted)
        return self._answered(entry)

    def known(self, computed: Computed) -> idempotency.Entry | None:
        """What was answered under the key, which is not claimed. Raises Refused 409, 422 or 500."""
        if not self.key:
            return None
        with self._database.read() as connection:
            entry = idempotency.find(connection, self._principal, self.key)
        if entry is None and computed.first(self._principal, self.key, self._fingerprint) != self._fingerprint:
            raise _reused()
        return self._answered(entry)

    def _answered(self, entry: idempotency.Entry | None) -> idempotency.Entry | None:
        """What is there, if it is of this request and has been answered. Raises Refused 409, 422, and 500 for an answer
        that this server has not given.
        """
        if entry is None:
            return None
        if entry.fingerprint != self._fingerprint:
            raise _reused()
        if entry.status is None:
            detail = "the first request with this Idempotency-Key is still being served"
            raise Refused(409, "idempotency-in-flight", detail, headers={"Retry-After": "1"})
        if not entry.is_ours:  # neither is it told as true, nor is what was done done again
            raise damaged("the answer to the request", f"sha256:{entry.fingerprint}", NOT_SEALED, REMEDY)
        return entry

    def keep(self, connection: Connection, answer: Answer) -> None:
        """Keep an answer under the key, if it was claimed. Raises Refused 409."""
        if not self._is_claimed:
            return
        kept = (answer.status, orjson.dumps(dict(answer.headers)).decode(), answer.body)
        if not idempotency.finish(connection, self._wanted, self._fingerprint, kept):
            raise Refused(409, "idempotency-lost", "another request with this Idempotency-Key took over")
        self._store.usage.add("answer", self._principal, len(answer.body))

    def settle(self) -> None:
        """The answer that was kept is on the disk."""
        if self._is_claimed:
            self._store.claims.drop(self._wanted)

    def release(self) -> None:
        """Give the claim up: the request may be sent again."""
        if self._is_claimed:
            self._store.claims.drop(self._wanted)
            with self._database.write(durable=False) as connection:
                idempotency.release(connection, self._wanted)


def _reused() -> Refused:
    return Refused(422, "idempotency-key-reused", "this Idempotency-Key belongs to another request")


def replayed(entry: idempotency.Entry) -> Answer:
    """The answer that was kept."""
    headers = {**orjson.loads(entry.headers or "{}"), "Idempotency-Replayed": "true"}
    return Answer(entry.status or 200, entry.body or b"", headers)
