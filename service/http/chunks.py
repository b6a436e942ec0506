"""How answers are sent: the head with the first piece, large pieces without a known length from a thread.

The event loop would copy what the connection does not take at once, and be woken for every part of it; a thread waits
in the kernel. It waits for nobody: whoever does not read on for a moment gets the rest from the loop, whose time limits
count (:mod:`service.http.connections`), and so all that follows.
"""

from __future__ import annotations

import asyncio
import socket
from asyncio import AbstractEventLoop
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from time import monotonic
from typing import Any

from starlette.types import Message, Receive, Scope, Send
from uvicorn.protocols.http.httptools_impl import RequestResponseCycle

AT_ONCE = 2**16  # bytes; smaller pieces are not worth it
LAG, MOST = 0.02, 0.5  # seconds: without any progress, and for one piece
_threads = ThreadPoolExecutor(8, thread_name_prefix="send")


class Chunked:
    """An application whose large pieces are sent as chunks (RFC 9112, section 7.1) that are not copied."""

    def __init__(self, cycle: RequestResponseCycle, app: Any, transport: asyncio.Transport) -> None:
        """``transport``: of the connection itself."""
        self._cycle, self._app, self._connection = cycle, app, transport
        self._keeps_up = True

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request."""

        async def framed(message: Message) -> None:
            """Send; a large piece between its length and the end of its line."""
            body = message.get("body", b"")
            if len(body) > AT_ONCE and self._cycle.chunked_encoding and message.get("more_body"):
                await self._send(memoryview(body))
            else:
                await send(message)

        await self._app(scope, receive, framed)

    async def _send(self, body: memoryview) -> None:
        cycle, transport = self._cycle, self._cycle.transport
        if cycle.flow.write_paused and not cycle.disconnected:
            await cycle.flow.drain()
        if cycle.disconnected:
            return
        transport.write(b"%x\r\n" % len(body))
        sent = 0
        found = self._connection.get_extra_info("socket")
        if self._keeps_up and found is not None and not self._connection.get_write_buffer_size():
            connection = found.dup()  # not closed, nor its number given to another one, while the thread has it
            pushed = _threads.submit(_pushed, connection, body)
            pushed.add_done_callback(lambda ended: connection.close() if ended.cancelled() else None)
            sent = await asyncio.wrap_future(pushed)
            self._keeps_up = sent == len(body)
        if sent < len(body):
            transport.write(body[sent:])
        transport.write(b"\r\n")


def _pushed(connection: socket.socket, body: memoryview) -> int:
    """So many bytes the connection has taken before its other end let us wait, or went away."""
    sent, until = 0, monotonic() + MOST
    with connection, suppress(OSError):
        connection.settimeout(LAG)
        while sent < len(body) and monotonic() < until:
            sent += connection.send(body[sent:])
    return sent


class Joined:
    """The transport of an answer, whose head leaves with the first piece of its body: two sends would cost twice."""

    def __init__(self, loop: AbstractEventLoop, transport: asyncio.Transport) -> None:
        self._loop, self._transport, self._held = loop, transport, b""
        self._is_begun = False

    def write(self, data: bytes | bytearray | memoryview) -> None:
        """Hold the first one back, at most until the loop goes on."""
        if not self._is_begun:
            self._is_begun, self._held = True, bytes(data)
            self._loop.call_soon(self._send)
        elif len(data) <= AT_ONCE:
            self._send(data)
        else:
            self._send()
            self._transport.write(data)

    def _send(self, more: bytes | bytearray | memoryview = b"") -> None:
        held, self._held = self._held, b""
        if held or more:
            self._transport.write(b"".join((held, more)) if held else more)

    def is_closing(self) -> bool:
        """As of the connection."""
        return self._transport.is_closing()

    def close(self) -> None:
        """Send, and close."""
        self._send()
        self._transport.close()
