"""What is read is compressed where it is text or WebAssembly; answers to POST and binary numbers are not."""

from __future__ import annotations

from starlette.datastructures import Headers
from starlette.middleware.gzip import DEFAULT_EXCLUDED_CONTENT_TYPES, GZipMiddleware
from starlette.types import ASGIApp, Receive, Scope, Send

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
        is_packed = is_read and not is_refused(Headers(scope=scope).get("accept-encoding", ""), "gzip")
        await (self._packing if is_packed else self._plain)(scope, receive, send)
