"""Connections of clients, bounded in number, time and bytes, whatever their other end does.

Every second each connection is asked what it waits for, and loses patience with a client that lets it wait:

====== ============================================================ ================================================
waits  while                                                        patience, seconds
====== ============================================================ ================================================
head   no request is being served, and the next head is not whole   ``head_seconds``
body   the head is there and the body is not                        ``body_seconds``, and what RATE earns
rest   the answer was sent before the body has ended                ``body_seconds``
answer what was sent is not read                                    ``answer_seconds``
====== ============================================================ ================================================

A connection beyond the limits takes the place of the one whose client has used up most of its patience, so that clients
which only hold connections lock nobody out. Where all are being served the newcomer is answered 503.
"""

from __future__ import annotations

import asyncio
import logging
import resource
import socket
from asyncio import AbstractEventLoop
from collections.abc import Callable
from contextvars import copy_context
from typing import Any, cast

import httptools
from fastapi import Response
from uvicorn.config import Config
from uvicorn.protocols.http.httptools_impl import STATUS_LINE, HttpToolsProtocol, RequestResponseCycle
from uvicorn.server import ServerState

from service.http import problems
from service.http.authority import network_of, origin_form
from service.http.chunks import Chunked, Joined
from service.http.middleware import GUARDED
from service.http.request_id import begin_request
from service.messages.refusals import Refused
from service.settings import Limits

AHEAD = 2**20  # bytes of a body that wait to be taken
RATE = 500  # bytes a second that a body has to have in the long run
_log = logging.getLogger(__name__)


class Connections:
    """The open connections of a server, by address and in the order in which they came."""

    def __init__(self, limits: Limits, note: Callable[[int], None] = lambda _: None) -> None:
        """``note`` is told how many there are."""
        self.limits, self._note = limits, note
        descriptors, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
        # the other half: the database, runners, spooled bodies, and connections that were accepted a moment ago
        self.most = min(limits.connections, descriptors // 2)
        self._open: dict[str, dict[Connection, None]] = {}
        self._count = 0

    def enter(self, connection: Connection) -> bool:
        """Note a connection; False where there is no room for it and nobody who could go."""
        same = self._open.setdefault(connection.address, {})
        crowd = same
        is_full = len(same) >= self.limits.connections_per_address
        if not is_full and self._count >= self.most:
            is_full, crowd = True, max(self._open.values(), key=len)
        given_up = min(crowd, key=lambda each: each.left, default=None) if is_full else None
        same[connection] = None
        self._count += 1
        self._note(self._count)
        if given_up is None or given_up.left == float("inf"):
            return not is_full
        given_up.end(too_many())
        self.leave(given_up)
        return True

    def leave(self, connection: Connection) -> None:
        """Forget a connection, once."""
        same = self._open.get(connection.address, {})
        if connection in same:
            del same[connection]
            self._count -= 1
            self._note(self._count)
            if not same:
                del self._open[connection.address]

    def sweep(self, seconds: float) -> None:
        """So much time has passed: end those that have waited too long."""
        for same in list(self._open.values()):
            for connection in list(same):
                connection.pass_time(seconds)


def too_many() -> Refused:
    """503: no room for one more connection."""
    detail = "too many connections are open; try again"
    return Refused(503, "too-many-connections", detail, headers={"Retry-After": "1"})


class Connection(HttpToolsProtocol):
    """One connection; uvicorn parses and serves, here is only what bounds it."""

    def __init__(
        self, connections: Connections, config: Config, server_state: ServerState, app_state: dict[str, Any], _loop: Any
    ) -> None:
        super().__init__(config, server_state, app_state, _loop)
        self._all, self._limits = connections, connections.limits
        self.address = ""
        self.patience = float("inf")
        self._waits = ""
        self._is_open = False  # a head was read, and its body has not ended
        self._unused = 0  # bytes since the last head or piece of a body was whole
        self._received = 0  # bytes of bodies since time passed
        self._unsent = 0  # bytes of answers when time passed
        self._refusal: Refused | None = None

    def connection_made(self, transport: Any) -> None:
        """Enter, or note that there is no room: then the first request is answered 503."""
        super().connection_made(transport)
        # asyncio does so only where the listening socket knows its protocol; bodies waited until heads were confirmed
        connected = transport.get_extra_info("socket")
        if connected is not None and connected.family in (socket.AF_INET, socket.AF_INET6):
            connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.address = network_of(self.client[0]) if self.client else ""
        self._wait("head")
        if not self._all.enter(self):
            self.app = _no_room

    def connection_lost(self, exc: Exception | None) -> None:
        """Leave."""
        self._all.leave(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read on, unless there is no end of what is to be read."""
        self._unused += len(data)
        super().data_received(data)
        if self._unused > self._limits.head_bytes + self._limits.url_bytes and not self.transport.is_closing():
            self.end(_too_long_head(self._limits.head_bytes))

    def on_message_begin(self) -> None:
        """Note that a head has begun."""
        super().on_message_begin()
        self._unused = max(self._unused, 1)

    def on_header(self, name: bytes, value: bytes) -> None:
        """Keep a header; what stands behind a body is of no use, and has no bounds."""
        if not self._is_open:
            super().on_header(name, value)

    def on_headers_complete(self) -> None:
        """Serve a request whose head is not too long."""
        size = sum(len(name) + len(value) + 4 for name, value in self.headers)
        if len(self.url) > self._limits.url_bytes:
            limit = self._limits.url_bytes
            self._refusal = Refused(414, "url-too-long", f"the URL is longer than {limit:,} bytes", limit=limit)
        elif size > self._limits.head_bytes:
            self._refusal = _too_long_head(self._limits.head_bytes)
        elif self.parser.get_method() == b"CONNECT":
            self._refusal = Refused(405, "method-not-allowed", "this is no proxy", headers={"Allow": "GET, POST"})
        else:
            try:
                self.url = origin_form(self.url, self.parser.get_method(), self.headers)
            except Refused as refused:
                self._refusal = refused
        if self._refusal is not None:
            raise httptools.HttpParserError
        self._is_open, self._unused = True, 0
        self._waits, self.patience = "", float("inf")  # until time passes it is we who are waited for
        super().on_headers_complete()

    def _start_asgi_task(self, cycle: RequestResponseCycle, app: Any) -> None:
        """Serve a request, with less work for the answer."""
        cycle.transport = cast(asyncio.Transport, Joined(self.loop, self.transport))
        super()._start_asgi_task(cycle, cast(Any, Chunked(cycle, app, self.transport)))

    def on_body(self, body: bytes) -> None:
        """Note that a body goes on; more of it is read ahead than uvicorn would, in fewer turns of the loop."""
        self._unused = 0
        self._received += len(body)
        cycle = self.cycle
        if cycle is None or cycle.response_complete:
            return
        cycle.body += body
        if len(cycle.body) > AHEAD:
            self.flow.pause_reading()
        cycle.message_event.set()

    def on_message_complete(self) -> None:
        """Note the end of a body."""
        self._is_open, self._unused = False, 0
        super().on_message_complete()

    def send_400_response(self, _msg: str) -> None:
        """Answer what is no request with a problem document."""
        self.end(self._refusal or Refused(400, "invalid-http", "this is no request in HTTP/1.1"))

    def end(self, refused: Refused) -> None:
        """Close, with a problem document where it cannot be mistaken for something else."""
        if self.transport.is_closing():
            return
        is_answering = self.cycle is not None and self.cycle.response_started and not self.cycle.response_complete
        is_idle = self.cycle is not None and not (self._unused or self._is_open or self._refusal)
        if not is_answering and not is_idle:
            self.transport.write(copy_context().run(_written, refused, self.server_state.default_headers))
        self.transport.close()

    def pass_time(self, seconds: float) -> None:
        """Lose patience with a client that lets us wait, and end the connection when there is none left."""
        unsent, received = self.transport.get_write_buffer_size(), self._received
        waits = "answer" if unsent and unsent == self._unsent else self._waiting_for()
        self._unsent, self._received = unsent, 0
        if waits != self._waits:
            self._wait(waits)
            return
        self.patience -= seconds
        if waits == "body":
            self.patience = min(self.patience + received / RATE, self._limits.body_seconds)
        if self.patience > 0:
            return
        if unsent:
            self.transport.abort()  # nothing that is written now would be read
            return
        self.end(Refused(408, "request-timeout", f"the {waits} of the request did not come in time"))

    def _waiting_for(self) -> str:
        """``head``, ``body`` or ``rest``; nothing while it is us who are to act."""
        cycle = self.cycle
        is_served = cycle is None or cycle.response_complete
        if not self._is_open:
            return "head" if is_served else ""
        if is_served:
            return "rest"
        return "" if self.flow.read_paused or cycle.waiting_for_100_continue else "body"

    @property
    def left(self) -> float:
        """The patience that is left, also where time has not passed since the client let us wait."""
        return self.patience if self._waits else self._most(self._waiting_for())

    def _wait(self, waits: str) -> None:
        self._waits, self.patience = waits, self._most(waits)

    def _most(self, waits: str) -> float:
        """The patience at first, in seconds."""
        limits = self._limits
        return {
            "head": limits.head_seconds,
            "body": limits.body_seconds,
            "rest": limits.body_seconds,
            "answer": limits.answer_seconds,
        }.get(waits, float("inf"))


def _too_long_head(limit: int) -> Refused:
    return Refused(431, "head-too-large", f"the head of the request is longer than {limit:,} bytes", limit=limit)


def _written(refused: Refused, defaults: list[tuple[bytes, bytes]]) -> bytes:
    """A whole answer: there is no request that an application could answer."""
    answer = _last(refused, "")
    headers = [*defaults, *answer.raw_headers]
    lines = [b"%s: %s\r\n" % header for header in headers]
    return b"".join([STATUS_LINE[refused.status], *lines, b"\r\n", bytes(answer.body)])


async def _no_room(scope: Any, receive: Any, send: Any) -> None:
    """The application of a connection for which there is no room."""
    await _last(too_many(), scope["path"])(scope, receive, send)


def _last(refused: Refused, instance: str) -> Response:
    """The last answer of a connection."""
    identifier = begin_request(None)
    answer = problems.response(refused, instance)
    answer.headers.update({**GUARDED, "X-Request-Id": identifier, "Connection": "close"})
    return answer


class Complaints:
    """The handler of errors of an event loop: what happens a thousand times a second is said once in a while."""

    def __init__(self, pause: float = 60.0) -> None:
        self._pause, self._next = pause, 0.0

    def __call__(self, loop: AbstractEventLoop, context: dict[str, Any]) -> None:
        """Log an error; of connections that cannot be accepted in a line, and once in ``pause`` seconds."""
        error = context.get("exception")
        if not isinstance(error, OSError) or "accept" not in str(context.get("message")):
            loop.default_exception_handler(context)
        elif loop.time() >= self._next:
            self._next = loop.time() + self._pause
            _log.error("connections cannot be accepted: %s; this is not said again for %g s", error, self._pause)
