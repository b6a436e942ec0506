"""What an operation answers, before it becomes an HTTP response; kept under idempotency keys as it is."""

from __future__ import annotations

import asyncio
import hashlib
from collections.abc import AsyncIterator, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import chain

from anyio import CancelScope
from fastapi import Response
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import StreamingResponse

from service import __version__

JSON = "application/json"
FOR_EVER = "max-age=31536000, immutable"
REVALIDATE = "no-cache"
AT_ONCE = 2**20  # bytes that are handed to the connection at a time; a smaller body is sent as a whole


@dataclass(frozen=True, slots=True)
class Answer:
    """Status, body and headers (with the content type) of a success."""

    status: int
    body: bytes
    headers: Mapping[str, str] = field(default_factory=dict)

    def response(self) -> Response:
        """The HTTP response."""
        return Response(self.body, self.status, dict(self.headers))


@dataclass(frozen=True, slots=True)
class Stream:
    """Status, headers and body, piece by piece, of a success that may be larger than memory."""

    pieces: Iterator[bytes | memoryview]
    headers: Mapping[str, str]
    status: int = 200

    def response(self) -> Response:
        """The HTTP response. The next piece is made while one is sent; when making one fails, the body is cut off."""
        return StreamingResponse(_ahead(self.pieces), self.status, dict(self.headers))


async def _ahead(pieces: Iterator[bytes | memoryview]) -> AsyncIterator[bytes | memoryview]:
    following = asyncio.ensure_future(run_in_threadpool(_some, pieces))
    try:
        while some := await following:
            following = asyncio.ensure_future(run_in_threadpool(_some, pieces))
            for piece in some:
                view = memoryview(piece)
                for start in range(0, len(view), AT_ONCE):
                    yield view[start : start + AT_ONCE]
    finally:
        with CancelScope(shield=True):  # when the client has gone, a thread may still be reading the request
            await asyncio.gather(following, return_exceptions=True)


def _some(pieces: Iterator[bytes | memoryview]) -> list[bytes | memoryview]:
    """Some pieces that are worth a change of threads, none at the end."""
    some, size = [], 0
    for piece in pieces:
        some.append(piece)
        size += len(piece)
        if size > AT_ONCE:
            break
    return some


def streamed(pieces: Iterator[bytes | memoryview], content_type: str) -> Answer | Stream:
    """An answer as a whole if it is small, so that its length is told, otherwise as a stream."""
    begun, headers = _some(pieces), {"Content-Type": content_type}
    if sum(map(len, begun)) > AT_ONCE:
        return Stream(chain(begun, pieces), headers)
    return Answer(200, b"".join(begun), headers)


def json_answer(body: bytes, status: int = 200, headers: Mapping[str, str] | None = None) -> Answer:
    """An answer with a JSON body."""
    return Answer(status, body, {"Content-Type": JSON, **(headers or {})})


def etag(*identity: str) -> str:
    """A strong ETag of a representation that is a function of its identity and of the software."""
    text = "\n".join((__version__, *identity))
    return f'"{hashlib.sha256(text.encode()).hexdigest()[:32]}"'
