"""The route of evaluations: one state of a pinned tree with kernels in memory is answered on the event loop itself.

No dependencies and no thread: they would take longer than the numbers. Whatever is not at hand, or asks for more than
numbers, is handled as on every route.
"""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import Request, Response
from fastapi.routing import APIRoute

from service.answers import JSON
from service.http.requests import authenticated, credentials, store_of
from service.http.responses import response_of
from service.operations import at_hand
from service.operations.exchange import choose_media_type
from service.references import is_pinned


class OneStateRoute(APIRoute):
    """A route ``/{ref}/evaluations``."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Answer what is at hand, and let all else be handled as ever."""
        handle = super().get_route_handler()

        async def handled(request: Request) -> Response:
            """The answer of one or the other."""
            found = await _at_hand(request) if _is_short(request) else None
            return await handle(request) if found is None else found

        return handled


def _is_short(request: Request) -> bool:
    """Whether a request asks for numbers of a pinned tree alone, in JSON and with a small body."""
    headers = request.headers
    length = headers.get("content-length", "")
    return (
        is_pinned(request.path_params["ref"])
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
