"""``Idempotency-Key``: a POST that is sent twice acts once; the answer is kept in the transaction that acts.

::

    claim (own transaction) -> prepare (computes, stores nothing) -> commit + answer kept (one transaction)
        |                          '-- fails: the claim is given up, the request may be sent again
        |-- answered already: the same answer again
        |-- other request under this key: 422
        '-- in flight: 409

Work that takes longer than its limit (``sync_seconds``, or less by ``Prefer: wait=N``) becomes a job, as does work that
is asked for with ``Prefer: respond-async``: the answer is 202. A thread cannot be stopped, so what was begun in time
goes on to its end, which the limits on sizes bound; its result is dropped, and nothing is stored twice.
"""

from __future__ import annotations

import hashlib
import re
import secrets
from collections.abc import Callable, Iterable
from contextvars import copy_context
from datetime import timedelta
from functools import cached_property
from time import perf_counter
from typing import Annotated, TypeVar

import orjson
from fastapi import Depends, Header, Request, Response

from service import keys
from service.answers import Answer, Stream
from service.database import Connection
from service.operations.trees import StaleError
from service.problems import Refused
from service.queries import idempotency
from service.requests import RawBody, SpooledBody, store_of
from service.store import Store

Commit = Callable[[Connection], Answer]
S = TypeVar("S")
T = TypeVar("T")
ATTEMPTS = 8


class Once:
    """Runs the work of one POST request at most once per idempotency key."""

    def __init__(self, request: Request, body: Callable[[], Iterable[bytes]], store: Store, key: str | None) -> None:
        """``body``: gives the pieces of the request body."""
        self.store, self.key, self._request, self._body = store, key, request, body
        self.principal: str = request.state.principal
        self._owner = secrets.token_hex(8)
        self._started = perf_counter()

    @cached_property
    def _fingerprint(self) -> str:
        request = self._request
        seen = [request.method, request.url.path, request.url.query]
        seen += [request.headers.get(name, "") for name in ("content-type", "accept")]
        found = hashlib.sha256("\n".join(seen).encode() + b"\n")
        for piece in self._body():
            found.update(piece)
        return found.hexdigest()

    def run(self, prepare: Callable[[], Commit], deferred: Callable[[], Commit] | None = None) -> Response:
        """Prepare without writing, then commit in one transaction.

        ``deferred`` prepares the job that does the same. Raises Refused 409, 422 or, without one, 503 (took too long).
        """
        return self.submit(lambda: self._in_time(prepare, deferred))

    def submit(self, prepare: Callable[[], Commit]) -> Response:
        """As :meth:`run`, without a limit of time."""
        kept = self._claim() if self.key else None
        if kept is not None:
            return _replayed(kept)
        try:
            return self._act(prepare).response()
        except BaseException:
            self._release()
            raise

    def _act(self, prepare: Callable[[], Commit]) -> Answer:
        for _ in range(ATTEMPTS):
            commit = prepare()
            try:
                with self.store.database.write() as connection:
                    answer = commit(connection)
                    self._keep(connection, answer, answer.body)
                return self._told(answer)
            except StaleError:
                continue
        raise Refused(409, "conflict", "others keep changing this resource; try again", headers={"Retry-After": "1"})

    def _in_time(self, work: Callable[[], S], deferred: Callable[[], T] | None) -> S | T:
        """What the work gives, or what ``deferred`` gives where the work has no time (left)."""
        seconds = self.store.settings.limits.sync_seconds
        if deferred is not None:
            if self._prefers("respond-async"):
                return deferred()
            wait = self._prefers("wait=([0-9]{1,6})")
            seconds = min(seconds, float(wait[1])) if wait else seconds
        future = self.store.threads.submit(copy_context().run, work)
        try:
            return future.result(self._started + seconds - perf_counter())
        except TimeoutError:
            future.cancel()
        if deferred is not None:
            return deferred()
        detail = f"this takes longer than {seconds:g} s, the limit of a request; nothing was stored"
        raise Refused(503, "took-too-long", detail, limit=seconds)

    def _prefers(self, preference: str) -> re.Match[str] | None:
        """The preference (RFC 7240) if it is asked for."""
        given = ",".join(self._request.headers.getlist("prefer")).split(",")
        return next(filter(None, (re.fullmatch(preference, each.strip().lower()) for each in given)), None)

    def compute(self, work: Callable[[], Answer | Stream], deferred: Callable[[], Commit] | None = None) -> Response:
        """Work that stores nothing: the same request under the same key computes the same answer again.

        The time limit of a stream is that of its beginning.
        """
        known = self._claim() if self.key else None
        if known is not None and known.body is not None:  # it became a job
            return _replayed(known)
        try:
            found = self._in_time(work, deferred)
            if isinstance(found, Answer | Stream):
                if known is None and self.key:
                    with self.store.database.write() as connection:
                        self._keep(connection, found, None)
                return found.response()
            with self.store.database.write() as connection:
                answer = found(connection)
                if known is None:
                    self._keep(connection, answer, answer.body)
        except BaseException:
            self._release()
            raise
        return self._told(answer).response()

    def require(self, scope: str) -> None:
        """Raise Refused 403 unless whoever asks has this scope too."""
        with self.store.database.read() as connection:
            keys.authorise(connection, self._request.headers.get("authorization"), scope)

    def _told(self, answer: Answer) -> Answer:
        """The answer; a job does not wait until somebody looks for one."""
        if answer.status == 202:
            self.store.wake.set()
        return answer

    def _claim(self) -> idempotency.Entry | None:
        limits = self.store.settings.limits
        lifetime = timedelta(hours=limits.idempotency_hours)
        # who takes a claim over too early is fenced off: the first to finish is the only one
        lease = timedelta(seconds=15 + 2 * limits.sync_seconds)
        with self.store.database.write() as connection:
            idempotency.forget(connection, lifetime, lease)
            entry = idempotency.claim(connection, self.principal, self.key or "", self._fingerprint, self._owner)
        if entry is None:
            return None
        if entry.fingerprint != self._fingerprint:
            raise Refused(422, "idempotency-key-reused", "this Idempotency-Key belongs to another request")
        if entry.status is None:
            detail = "the first request with this Idempotency-Key is still being served"
            raise Refused(409, "idempotency-in-flight", detail, headers={"Retry-After": "1"})
        return entry

    def _keep(self, connection: Connection, answer: Answer | Stream, body: bytes | None) -> None:
        if not self.key:
            return
        kept = (answer.status, orjson.dumps(dict(answer.headers)).decode(), body)
        if not idempotency.finish(connection, self.principal, self.key, self._owner, kept):
            raise Refused(409, "idempotency-lost", "another request with this Idempotency-Key took over")

    def _release(self) -> None:
        if self.key:
            with self.store.database.write() as connection:
                idempotency.release(connection, self.principal, self.key, self._owner)


def _replayed(entry: idempotency.Entry) -> Response:
    headers = {**orjson.loads(entry.headers or "{}"), "Idempotency-Replayed": "true"}
    return Response(entry.body, entry.status or 200, headers)


IdempotencyKey = Annotated[str | None, Header(min_length=1, max_length=255)]


async def once(request: Request, raw: RawBody, idempotency_key: IdempotencyKey = None) -> Once:
    """The Once of a request."""
    return Once(request, lambda: (raw,), store_of(request), idempotency_key)


async def once_spooled(request: Request, body: SpooledBody, idempotency_key: IdempotencyKey = None) -> Once:
    """The Once of a request with a body of any size."""
    return Once(request, body.pieces, store_of(request), idempotency_key)


OnceOf = Annotated[Once, Depends(once)]
OnceSpooled = Annotated[Once, Depends(once_spooled)]
