"""Endpoints that act: the dependency ``once``, and the time that their work may take."""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable
from functools import wraps
from typing import Annotated, Any

from fastapi import Depends, Header, Request, Response

from service.http.once import Once
from service.http.requests import RawBody, spooled_body, store_of
from service.spool import Spool
from service.store import Store

IdempotencyKey = Annotated[str | None, Header(min_length=1, max_length=255)]


async def once(request: Request, raw: RawBody, idempotency_key: IdempotencyKey = None) -> Once:
    """The Once of a request."""
    return Once(request, lambda: (raw,), store_of(request), idempotency_key)


class OnceSpooled(Once):
    """The same for a body of any size, which is in ``spool``."""

    def __init__(self, request: Request, spool: Spool, store: Store, key: str | None) -> None:
        super().__init__(request, spool.pieces, store, key)
        self.spool = spool


async def once_spooled(request: Request, idempotency_key: IdempotencyKey = None) -> AsyncIterator[OnceSpooled]:
    """The OnceSpooled of a request."""
    async with spooled_body(request) as spool:
        yield OnceSpooled(request, spool, store_of(request), idempotency_key)


OnceOf = Annotated[Once, Depends(once)]
OnceSpooledOf = Annotated[OnceSpooled, Depends(once_spooled)]


def timed(endpoint: Callable[..., Response]) -> Callable[..., Awaitable[Response]]:
    """An endpoint whose work, done by its parameter ``once``, is given up when it takes too long."""

    @wraps(endpoint)
    async def watched(*, once: Once, **arguments: Any) -> Response:
        return await once.within_time(lambda: endpoint(once=once, **arguments))

    return watched
