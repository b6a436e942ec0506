"""A request for content that this server has not derived waits until it has, and is then answered as any other."""

from __future__ import annotations

import asyncio

from fastapi.concurrency import run_in_threadpool
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.messages.refusals import NotDerived
from service.operations.renewing import Renewal
from service.store.store import Store


class DerivesFirst:
    """ASGI middleware around the routes."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer; again, after each thing that had to be derived first. Raises NotDerived where the time for that is
        over, or the body was too long to be kept: what was begun goes on to its end, for those who ask again.
        """
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        store: Store = scope["app"].state.store
        limits = store.settings.limits
        loop = asyncio.get_running_loop()
        due, body, done = loop.time() + limits.sync_seconds, Body(receive, limits.json_bytes), set[tuple[str, str]]()
        while True:
            try:
                await self.app(scope, body.receive, send)
            except NotDerived as wanted:
                if (wanted.kind, wanted.key) in done:
                    raise
                done.add((wanted.kind, wanted.key))
                await _renewed(store, wanted, due - loop.time())
                if not body.rewind():
                    raise
            else:
                return


async def _renewed(store: Store, wanted: NotDerived, seconds: float) -> None:
    """Derive in a thread, which goes on when nobody waits any more. Raises NotDerived then."""
    work = asyncio.ensure_future(run_in_threadpool(Renewal(store).on_request, wanted))
    await asyncio.wait({work}, timeout=max(0.0, seconds))
    if not work.done():
        work.add_done_callback(lambda ended: ended.cancelled() or ended.exception())
        raise wanted
    work.result()


class Body:
    """The messages of a request, of which the first ``limit`` bytes are kept to be received again."""

    def __init__(self, receive: Receive, limit: int) -> None:
        self._receive, self._left = receive, limit
        self._kept: list[Message] = []
        self._place = 0

    async def receive(self) -> Message:
        """The next message."""
        if self._place < len(self._kept):
            self._place += 1
            return self._kept[self._place - 1]
        message = await self._receive()
        self._left -= len(message.get("body", b""))
        if self._left >= 0:
            self._kept.append(message)
            self._place += 1
        else:
            self._kept.clear()
            self._place = 0
        return message

    def rewind(self) -> bool:
        """Begin again; False where that cannot be."""
        self._place = 0
        return self._left >= 0
