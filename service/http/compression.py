"""What is read is compressed where it is text or WebAssembly; answers to POST and binary numbers are not.

A strong ETag names bytes, and those of another coding are others (RFC 9110, section 8.8.3.3): of what is compressed it
is weak, as proxies make it. Preconditions take it with or without its ``W/`` (:func:`service.messages.answers.names`).
"""

from __future__ import annotations

from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.gzip import DEFAULT_EXCLUDED_CONTENT_TYPES, GZipMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.messages.negotiation import is_refused
from substructures.formats import arrays, arrow

#: bytes below which it is not worth the time
LEAST = 1400
LEVEL = 5
BINARY = (arrays.MEDIA_TYPE, arrow.MEDIA_TYPE, "application/vnd.apache.parquet", "application/octet-stream")


class Compression:
    """Compresses answers to GET for clients that take gzip."""

    def __init__(self, app: ASGIApp) -> None:
        excluded = (*DEFAULT_EXCLUDED_CONTENT_TYPES, *BINARY)
        self._plain = app
        self._packing = GZipMiddleware(app, LEAST, LEVEL, exclude_content_types=excluded)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer."""
        is_read = scope["type"] == "http" and scope["method"] == "GET"
        headers = Headers(scope=scope) if is_read else Headers()
        if not is_read or is_refused(headers.get("accept-encoding", ""), "gzip"):
            await self._plain(scope, receive, send)
        else:
            await self._packing(scope, receive, _weakening(send, headers.get("if-none-match", "")))


def _weakening(send: Send, known: str) -> Send:
    """Sends, with a weak ETag for what is compressed, and for what is ``known`` by that already."""

    async def sent(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(raw=message["headers"])
            tag = f"W/{headers.get('etag', '')}"
            if tag.startswith('W/"') and ("content-encoding" in headers or (message["status"] == 304 and tag in known)):
                headers["etag"] = tag
        await send(message)

    return sent
