"""The route of evaluations: one state of a pinned tree with kernels in memory is answered on the event loop itself.

No dependencies and no thread: they would take longer than the numbers. Whatever is not at hand, or asks for more than
numbers, is handled as on every route.
"""

from __future__ import annotations

from collections.abc import Iterator

from fastapi import Request, Response
from fastapi.routing import APIRoute
from starlette.types import Message, Receive, Scope, Send

from service.http.requests import authenticated, credentials, store_of
from service.http.responses import response_of
from service.messages.answers import JSON
from service.messages.references import is_pinned
from service.operations import at_hand
from service.operations.exchange import choose_media_type


class OneStateRoute(APIRoute):
    """A route ``/{ref}/evaluations``."""

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer what is at hand, and let all else be handled as ever, with its body as it came."""
        request = Request(scope, receive)
        if not _is_short(request):
            await super().handle(scope, receive, send)
            return
        found = await _at_hand(request)
        if found is not None:
            await found(scope, receive, send)
            return
        kept: Iterator[Message] = iter([{"type": "http.request", "body": await request.body()}])

        async def again() -> Message:
            """The body, then what is received."""
            return next(kept, None) or await receive()

        await super().handle(scope, again, send)


def _is_short(request: Request) -> bool:
    """Whether a request asks for numbers of a pinned tree alone, in JSON and with a small body."""
    headers = request.headers
    length = headers.get("content-length", "")
    return (
        request.method == "POST"
        and is_pinned(request.path_params["ref"])
        and headers.get("content-type") == JSON
        and length.isascii()
        and length.isdigit()
        and int(length) <= at_hand.BODY
        and not request.scope["query_string"]
        and "idempotency-key" not in headers
        and "prefer" not in headers
        and choose_media_type(headers.get("accept", "*/*"), JSON) == JSON
    )


async def _at_hand(request: Request) -> Response | None:
    store = store_of(request)
    viewer = await authenticated(store, credentials(request.method, request.headers))
    viewer.require("read")
    answer = at_hand.answer(store, viewer, request.path_params["ref"], await request.body())
    return None if answer is None else response_of(answer)
