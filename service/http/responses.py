"""Answers of operations as HTTP responses."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Iterator

from anyio import CancelScope
from fastapi import Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from service.messages.answers import FOR_EVER, REVALIDATE, Answer, Stream, names, some_of
from service.store.store import Store

AT_ONCE = 2**22  # bytes that are handed to the connection at a time


def response_of(answer: Answer | Stream) -> Response:
    """The HTTP response. The next piece of a stream is made while one is sent; when making one fails, the body is cut
    off.
    """
    if isinstance(answer, Stream):
        return StreamingResponse(_ahead(answer.pieces), answer.status, dict(answer.headers))
    return Response(answer.body, answer.status, dict(answer.headers))


async def _ahead(pieces: Iterator[bytes | memoryview]) -> AsyncIterator[bytes | memoryview]:
    following = asyncio.ensure_future(run_in_threadpool(some_of, pieces))
    try:
        while some := await following:
            following = asyncio.ensure_future(run_in_threadpool(some_of, pieces))
            for piece in some:
                view = memoryview(piece)
                for start in range(0, len(view), AT_ONCE):
                    yield view[start : start + AT_ONCE]
    finally:
        with CancelScope(shield=True):  # when the client has gone, a thread may still be reading the request
            await asyncio.gather(following, return_exceptions=True)


def conditional(request: Request, tag: str, immutable: bool, make: Callable[[], Answer]) -> Response:
    """304 when the client has the representation already, otherwise make it."""
    headers = {"ETag": tag, "Cache-Control": FOR_EVER if immutable else REVALIDATE, "Vary": "Accept"}
    if names(request.headers.get("if-none-match", ""), tag):
        return Response(status_code=304, headers=headers)
    answer = make()
    return Response(answer.body, answer.status, {**answer.headers, **headers})


def remembered(store: Store, request: Request, tag: str, immutable: bool, make: Callable[[], Answer]) -> Response:
    """:func:`conditional` for what takes long to make: the answer of this tag is kept."""
    return conditional(request, tag, immutable, lambda: store.caches.printed.once(tag, make))


def next_link(request: Request, token: str | None) -> str | None:
    """The address of the next page."""
    if token is None:
        return None
    url = request.url.include_query_params(page_token=token)
    return f"{url.path}?{url.query}"


def link_header(link: str | None) -> dict[str, str]:
    """The Link header of a page."""
    return {} if link is None else {"Link": f'<{link}>; rel="next"'}
