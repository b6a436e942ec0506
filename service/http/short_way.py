"""The short way of evaluations that are at hand: no routing, no dependencies, no thread.

Whatever is not at hand, or asks for more than numbers, goes on to the routes with its body as it came.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.answers import JSON, Answer, Stream
from service.http.requests import authenticated, credentials
from service.http.responses import response_of
from service.operations import at_hand
from service.operations.exchange import choose_media_type
from service.references import is_pinned
from service.store import Store
from service.viewer import Viewer

_PATH = re.compile(r"/v1/trees/([^/]+)/evaluations")


@dataclass(frozen=True, slots=True)
class Route:
    """The route that metrics and logs name."""

    path: str = "/v1/trees/{ref}/evaluations"


class ShortWay:
    """ASGI middleware around the routes."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or pass the request on."""
        found = _PATH.fullmatch(scope["path"]) if scope["type"] == "http" and scope["method"] == "POST" else None
        if found is None or not is_pinned(found[1]):
            await self.app(scope, receive, send)
            return
        headers, store = Headers(scope=scope), scope["app"].state.store
        if not _is_short(headers):
            await self.app(scope, receive, send)
            return
        viewer = await authenticated(store, credentials(scope["method"], headers))
        viewer.require("read")
        messages = await _messages(receive)
        answer = _answer(store, viewer, found[1], messages)
        if answer is None:
            await self.app(scope, _again(messages, receive), send)
            return
        scope["route"] = Route()
        await response_of(answer)(scope, receive, send)


def _is_short(headers: Headers) -> bool:
    """Whether a request asks for numbers alone, in JSON and with a small body."""
    length = headers.get("content-length", "")
    return (
        headers.get("content-type") == JSON
        and length.isascii()
        and length.isdigit()
        and int(length) <= at_hand.BODY
        and "idempotency-key" not in headers
        and "prefer" not in headers
        and choose_media_type(headers.get("accept", "*/*"), JSON) == JSON
    )


async def _messages(receive: Receive) -> list[Message]:
    """The body, as the server gives it."""
    messages = [await receive()]
    while messages[-1].get("more_body"):
        messages.append(await receive())
    return messages


def _answer(store: Store, viewer: Viewer, ref: str, messages: list[Message]) -> Answer | Stream | None:
    if messages[-1]["type"] != "http.request":  # the client has gone
        return None
    return at_hand.answer(store, viewer, ref, b"".join(message.get("body", b"") for message in messages))


def _again(messages: list[Message], receive: Receive) -> Receive:
    """The same messages for who comes next."""
    waiting = iter(messages)

    async def replayed() -> Message:
        """The next one that was received, then what is received."""
        return next(waiting, None) or await receive()

    return replayed
