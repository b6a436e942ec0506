"""``Idempotency-Key``: a POST that is sent twice acts once; the answer is kept in the transaction that acts.

::

    claim (own transaction) -> prepare (computes, stores nothing) -> commit + answer kept (one transaction)
        |                          '-- fails: the claim is given up, the request may be sent again
        |-- answered already: the same answer again
        |-- other request under this key: 422
        '-- in flight: 409

Work that takes longer than its limit (``sync_seconds``, or less by ``Prefer: wait=N``) becomes a job, as does work that
is asked for with ``Prefer: respond-async``: the answer is 202. A thread cannot be stopped, so what was begun in time
goes on to its end, which the limits on sizes bound; its result is dropped, and nothing is stored twice. For this the
endpoint is ``timed`` (:mod:`service.http.acting`): the event loop watches the thread that works, and lets another one
answer in its place.
"""

from __future__ import annotations

import asyncio
import hashlib
import re
import secrets
from collections.abc import Callable, Iterable
from contextvars import copy_context
from datetime import timedelta
from functools import cached_property
from threading import Lock
from time import perf_counter

import orjson
from fastapi import Request, Response
from fastapi.concurrency import run_in_threadpool

from service import keys
from service.answers import Answer, Stream
from service.database.connections import Connection
from service.operations.trees import StaleError
from service.queries import idempotency
from service.queries.common import is_conflict
from service.refusals import Refused
from service.store import Store

Commit = Callable[[Connection], Answer]
ATTEMPTS = 8


class _GivenUp(Exception):
    """The work took too long, and another thread has answered."""


class Once:
    """Runs the work of one POST request at most once per idempotency key."""

    def __init__(self, request: Request, body: Callable[[], Iterable[bytes]], store: Store, key: str | None) -> None:
        """``body``: gives the pieces of the request body."""
        self.store, self.key, self._request, self._body = store, key, request, body
        self.principal: str = request.state.principal
        self._owner = secrets.token_hex(8)
        wait = self._prefers("wait=([0-9]{1,6})")
        limit = store.settings.limits.sync_seconds
        self._seconds = min(limit, float(wait[1])) if wait else limit
        self._due = perf_counter() + self._seconds
        self._watch = Lock()
        self._instead: Callable[[], Response] | None = None  # while there is work that can be given up

    @cached_property
    def _fingerprint(self) -> str:
        request = self._request
        seen = [request.method, request.url.path, request.url.query]
        seen += [request.headers.get(name, "") for name in ("content-type", "accept")]
        found = hashlib.sha256("\n".join(seen).encode() + b"\n")
        for piece in self._body():
            found.update(piece)
        return found.hexdigest()

    @property
    def is_plain(self) -> bool:
        """Whether the request asks for nothing of all this: neither for an answer that is kept nor for a job."""
        return not self.key and "prefer" not in self._request.headers

    def run(self, prepare: Callable[[], Commit], deferred: Callable[[], Commit] | None = None) -> Response:
        """Prepare without writing, then commit in one transaction. The endpoint has to be ``timed``.

        ``deferred`` prepares the job that does the same. Raises Refused 409, 422 or, without one, 503 (took too long).
        """
        kept = self._claim() if self.key else None
        return _replayed(kept) if kept is not None else self._do(prepare, deferred, keeps=True)

    def submit(self, prepare: Callable[[], Commit]) -> Response:
        """As :meth:`run`, without a limit of time."""
        kept = self._claim() if self.key else None
        return _replayed(kept) if kept is not None else self._finish(prepare, keeps=True)

    def compute(self, work: Callable[[], Answer | Stream], deferred: Callable[[], Commit] | None = None) -> Response:
        """Work that stores nothing: the same request under the same key computes the same answer again.

        The endpoint has to be ``timed``; the time limit of a stream is that of its beginning.
        """
        known = self._claim() if self.key else None
        if known is not None and known.body is not None:  # it became a job
            return _replayed(known)
        return self._do(work, deferred, keeps=known is None)

    async def within_time(self, endpoint: Callable[[], Response]) -> Response:
        """The answer of an endpoint, or, where its work takes too long, of what is to be done instead."""
        future = self.store.runtime.threads.submit(copy_context().run, endpoint)
        answer = asyncio.wrap_future(future)
        await asyncio.wait({answer}, timeout=max(0, self._due - perf_counter()))
        if answer.done():
            return answer.result()
        if future.cancel():  # all threads have other work: too late for this one
            return await run_in_threadpool(endpoint)
        instead = self._give_up()
        if instead is None:  # the work is done or not begun, and the rest is short
            return await answer
        answer.add_done_callback(lambda abandoned: abandoned.exception())
        return await run_in_threadpool(instead)

    def _do(
        self, work: Callable[[], Commit | Answer | Stream], deferred: Callable[[], Commit] | None, keeps: bool
    ) -> Response:
        def late() -> Commit:
            if deferred is not None:
                return deferred()
            detail = f"this takes longer than {self._seconds:g} s, the limit of a request; nothing was stored"
            raise Refused(503, "took-too-long", detail, limit=self._seconds)

        def watched() -> Commit | Answer | Stream:
            if perf_counter() >= self._due or (deferred is not None and self._prefers("respond-async")):
                return late()
            with self._watch:
                self._instead = lambda: self._finish(late, keeps)
            try:
                return work()
            except TimeoutError:  # it has looked at the clock itself
                pass
            finally:
                if self._give_up() is None:
                    raise _GivenUp
            return late()

        return self._finish(watched, keeps)

    def _give_up(self) -> Callable[[], Response] | None:
        """End the work in progress, or drop what it will give: what is to be done in its place; None without any."""
        with self._watch:
            instead, self._instead = self._instead, None
        return instead

    def _finish(self, prepare: Callable[[], Commit | Answer | Stream], keeps: bool) -> Response:
        """Commit what was prepared, and keep the answer under the key in the same transaction."""
        try:
            for _ in range(ATTEMPTS):
                found = prepare()
                try:
                    return self._stored(found, keeps).response()
                except Exception as error:
                    if not isinstance(error, StaleError) and not is_conflict(error):
                        raise
            detail = "others keep changing this resource; try again"
            raise Refused(409, "conflict", detail, headers={"Retry-After": "1"})
        except _GivenUp:  # somebody else has answered
            raise
        except BaseException:
            self._release()
            raise

    def _stored(self, found: Commit | Answer | Stream, keeps: bool) -> Answer | Stream:
        if isinstance(found, Answer | Stream):
            if keeps and self.key:
                with self.store.database.write() as connection:
                    self._keep(connection, found, None)
            return found
        with self.store.database.write() as connection:
            answer = found(connection)
            if keeps:
                self._keep(connection, answer, answer.body)
        if answer.status == 202:  # a job does not wait until somebody looks for one
            self.store.runtime.wake.set()
        return answer

    def _prefers(self, preference: str) -> re.Match[str] | None:
        """The preference (RFC 7240) if it is asked for."""
        given = ",".join(self._request.headers.getlist("prefer")).split(",")
        return next(filter(None, (re.fullmatch(preference, each.strip().lower()) for each in given)), None)

    def require(self, scope: str) -> None:
        """Raise Refused 403 unless whoever asks has this scope too."""
        with self.store.database.read() as connection:
            keys.authorise(connection, self._request.headers.get("authorization"), scope)

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
