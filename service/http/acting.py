"""Endpoints that act: work at most once per idempotency key, within its time, and committed in one transaction.

Work that takes longer than its limit (``sync_seconds`` of CPU time, or less by ``Prefer: wait=N``) becomes a job, as
does work that is asked for with ``Prefer: respond-async``: the answer is 202. What takes long is done by a worker
(:mod:`service.jobs.worker`), which is killed at its deadline. What was begun here goes on to its end; its result is
dropped, and nothing is stored twice.
"""

from __future__ import annotations

import re
from collections.abc import AsyncIterator, Awaitable, Callable, Iterable
from contextlib import suppress
from dataclasses import replace
from functools import partial, wraps
from typing import Annotated, Any, TypeVar

from fastapi import Depends, Header, Request, Response

from service.database.connections import Connection
from service.http.deadline import Deadline, GivenUp
from service.http.idempotency import IdempotencyClaim, replayed
from service.http.requests import RawBody, spooled_body, store_of
from service.http.responses import response_of
from service.jobs.worker import Worker
from service.messages.answers import Answer, Stream
from service.messages.refusals import Refused, StaleError
from service.messages.spool import Spool
from service.messages.viewer import Viewer
from service.queries.common import is_conflict
from service.store.runtime import Task
from service.store.store import Store

#: writes what was prepared, in the transaction of the request, and answers
Commit = Callable[[Connection], Answer]
Result = TypeVar("Result")
IdempotencyKey = Annotated[str | None, Header(min_length=1, max_length=255)]
ATTEMPTS = 8
#: what workers do may take so many times its CPU time by the clock: a machine that is busy makes no request a job
SLOWNESS = 6.0


class Act:
    """The act of one POST request."""

    def __init__(self, request: Request, body: Callable[[], Iterable[bytes]], store: Store, key: str | None) -> None:
        """``body``: gives the pieces of the request body."""
        self.store, self._request, self._body = store, request, body
        self.viewer: Viewer = request.state.viewer
        self.principal = self.viewer.key
        limits = store.settings.limits
        wait = self._prefers("wait=([0-9]{1,6})")
        self._waits = wait[0] if wait and float(wait[1]) <= limits.sync_seconds else ""
        self._deadline = deadline_of(store, float(wait[1]) if self._waits and wait else None)
        self.worker = worker_of(store, self.viewer, self._deadline)
        self._claimed = IdempotencyClaim(request, body, store, key)

    def run(self, prepare: Callable[[], Commit], deferred: Callable[[], Commit] | None = None) -> Response:
        """Prepare without writing, then commit in one transaction. The endpoint has to be ``timed``.

        ``deferred`` prepares the job that does the same. Raises Refused 409, 422 or, without one, 503 (took too long).
        """
        kept = self._claimed.claim()
        return response_of(replayed(kept)) if kept is not None else self._in_time(prepare, deferred)

    def submit(self, prepare: Callable[[], Commit]) -> Response:
        """As :meth:`run`, without a limit of time."""
        kept = self._claimed.claim()
        return response_of(replayed(kept)) if kept is not None else self._finish(prepare)

    def compute(self, work: Callable[[], Answer | Stream], deferred: Callable[[], Commit] | None = None) -> Response:
        """Work that stores nothing: the same request under the same key computes the same answer again.

        The endpoint has to be ``timed``; the time limit of a stream is that of its beginning.
        """
        known = self._claimed.known(self.store.runtime.computed)
        if known is not None and known.body is not None:  # it became a job
            return response_of(replayed(known))

        return self._in_time(work, None if deferred is None else partial(self._claiming, deferred))

    async def within_time(self, task: Task, endpoint: Callable[[], Response]) -> Response:
        """The answer of an endpoint, or, where its work takes too long, of what is to be done instead."""
        threads = self.store.runtime.threads[task]
        return await self._deadline.within(partial(threads.submit, self.principal), endpoint)

    def first(self, work: Callable[[], Result]) -> Result:
        """What has to be known before anything else is done. Raises Refused 503 when it takes too long."""
        try:
            return work()
        except TimeoutError:
            raise took_too_long(self._deadline.limit, "nothing was stored") from None

    def afterwards(self, work: Callable[[Worker], object]) -> None:
        """Do what a page here will ask for next, if one has asked; nobody waits for it."""
        if self._request.headers.get("sec-fetch-site") != "same-origin":
            return
        worker = worker_of(self.store, self.viewer, deadline_of(self.store))
        with suppress(RuntimeError):  # the server stops
            self.store.runtime.threads["print"].submit(self.principal, partial(work, worker))

    def require(self, scope: str) -> None:
        """Raise Refused 403 unless whoever asks has this scope too."""
        self.viewer.require(scope)

    def require_time(self) -> None:
        """Raise TimeoutError where none is left: for work in steps, between them."""
        if self._deadline.is_over:
            raise TimeoutError

    @property
    def prefers_async(self) -> bool:
        """Whether a job is asked for."""
        return self._prefers("respond-async") is not None

    def _claiming(self, deferred: Callable[[], Commit]) -> Commit | Answer:
        """The job that a computation becomes, or what it became under the same key."""
        kept = self._claimed.claim()
        return deferred() if kept is None or kept.body is None else replayed(kept)

    def _in_time(
        self, work: Callable[[], Commit | Answer | Stream], deferred: Callable[[], Commit | Answer] | None
    ) -> Response:
        deadline = self._deadline

        def late() -> Commit | Answer | Stream:
            """What is done when there is no time left: the job, if there is one."""
            if deferred is not None:
                return deferred()
            raise took_too_long(deadline.limit, "nothing was stored")

        def watched() -> Commit | Answer | Stream:
            """The work under its deadline."""
            if deadline.is_over or (deferred is not None and self.prefers_async):
                return late()
            return deadline.watched(work, late, instead=lambda: self._finish(late))

        return self._finish(watched)

    def _finish(self, prepare: Callable[[], Commit | Answer | Stream]) -> Response:
        """Commit what was prepared, and keep the answer under the key in the same transaction."""
        try:
            for _ in range(ATTEMPTS):
                found = prepare()
                try:
                    return response_of(self._told(self._stored(found)))
                except Exception as error:
                    if not isinstance(error, StaleError) and not is_conflict(error):
                        raise
            detail = "others keep changing this resource; try again"
            raise Refused(409, "conflict", detail, headers={"Retry-After": "1"})
        except GivenUp:  # somebody else has answered
            raise
        except BaseException:
            self._claimed.release()
            raise

    def _stored(self, found: Commit | Answer | Stream) -> Answer | Stream:
        if isinstance(found, Answer | Stream):
            return found
        with self.store.database.write() as connection:
            answer = found(connection)
            self._claimed.keep(connection, answer)
        self._claimed.settle()
        if answer.status == 202:  # a job does not wait until somebody looks for one
            self.store.runtime.wake.set()
        return answer

    def _told(self, answer: Answer | Stream) -> Answer | Stream:
        """The answer with the preferences that it follows (RFC 7240, section 3)."""
        is_late = answer.status == 202 and self.prefers_async
        applied = ", ".join(filter(None, ("respond-async" if is_late else "", self._waits)))
        return replace(answer, headers={**answer.headers, "Preference-Applied": applied}) if applied else answer

    def _prefers(self, preference: str) -> re.Match[str] | None:
        """The preference (RFC 7240) if it is asked for; none has parameters, and those that are given are ignored."""
        given = ",".join(self._request.headers.getlist("prefer")).split(",")
        names = (each.partition(";")[0].strip().lower() for each in given)
        return next(filter(None, (re.fullmatch(preference, each) for each in names)), None)


class SpooledAct(Act):
    """The act of a request with a body of any size, which is in ``spool``."""

    def __init__(self, request: Request, spool: Spool, store: Store, key: str | None) -> None:
        super().__init__(request, spool.pieces, store, key)
        self.spool = spool


async def act(request: Request, raw: RawBody, idempotency_key: IdempotencyKey = None) -> Act:
    """The Act of a request, as a dependency."""
    return Act(request, lambda: (raw,), store_of(request), idempotency_key)


async def spooled_act(request: Request, idempotency_key: IdempotencyKey = None) -> AsyncIterator[SpooledAct]:
    """The SpooledAct of a request, as a dependency."""
    async with spooled_body(request) as spool:
        yield SpooledAct(request, spool, store_of(request), idempotency_key)


ActOf = Annotated[Act, Depends(act)]
SpooledActOf = Annotated[SpooledAct, Depends(spooled_act)]


def deadline_of(store: Store, wait: float | None = None) -> Deadline:
    """The time of a request; ``wait``: what whoever asks would wait."""
    limit = store.settings.limits.sync_seconds
    return Deadline(SLOWNESS * limit, limit) if wait is None else Deadline(wait)


def worker_of(store: Store, viewer: Viewer, deadline: Deadline) -> Worker:
    """What computes for a request, within its time."""
    limits = store.settings.limits
    return Worker(store.workers, viewer.owner, deadline.limit, deadline.due, limits.job_memory_bytes)


def took_too_long(seconds: float, advice: str) -> Refused:
    """503: no time is left, and there is no job that would do the same."""
    detail = f"this takes longer than {seconds:g} s, the limit of a request; {advice}"
    return Refused(503, "took-too-long", detail, limit=seconds)


async def in_time(
    request: Request, endpoint: Callable[[Worker], Response], advice: str, job: Callable[[Act], Commit] | None = None
) -> Response:
    """The answer of an endpoint that lets a worker print formulas. Raises Refused 503 when it takes too long.

    ``advice``: what to do then. ``job``: prepares the job that does the same, for those who may submit jobs.
    """
    store, deadline = store_of(request), deadline_of(store_of(request))
    act = None if job is None else Act(request, tuple, store, None)
    worker = worker_of(store, request.state.viewer, deadline)

    def late() -> Response:
        """What is said when there is no time left."""
        if job is not None and act is not None and act.viewer.has("jobs"):
            return act.submit(partial(job, act))
        raise took_too_long(deadline.limit, advice)

    def watched() -> Response:
        """The endpoint under its deadline."""
        is_late = deadline.is_over or (act is not None and act.prefers_async)
        return late() if is_late else deadline.watched(partial(endpoint, worker), late, instead=late)

    threads = store.runtime.threads["print"]
    return await deadline.within(partial(threads.submit, request.state.principal), watched)


def timed(task: Task) -> Callable[[Callable[..., Response]], Callable[..., Awaitable[Response]]]:
    """An endpoint whose work, done by its parameter ``act``, is given up when it takes too long."""

    def decorated(endpoint: Callable[..., Response]) -> Callable[..., Awaitable[Response]]:
        """The endpoint in a thread of its task."""

        @wraps(endpoint)
        async def watched(*, act: Act, **arguments: Any) -> Response:
            """The endpoint under the deadline of its act."""
            return await act.within_time(task, lambda: endpoint(act=act, **arguments))

        return watched

    return decorated
