"""Around every request: id, Host check, metrics, log line, and a problem document when nothing else caught an error."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from time import perf_counter

from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.http import problems
from service.http.authority import host_of
from service.http.request_id import begin_request
from service.messages.refusals import Refused
from service.metrics import Metrics

#: nothing that is served is anything else than it says, or a page that may load something, unless it says so
GUARDED = {"X-Content-Type-Options": "nosniff", "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'"}
#: pages of formulas have a style of their own, and nothing of them is loaded or run
GUARDED_PAGE = GUARDED | {
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'; frame-ancestors 'none'"
}
_ID, _TYPE, _PAGE = b"x-request-id", b"content-type", b"application/xhtml+xml"
_GUARDS, _GUARDS_OF_PAGE = (
    [(name.lower().encode(), value.encode()) for name, value in some.items()] for some in (GUARDED, GUARDED_PAGE)
)
NOT_MODIFIED = 304
GONE = 499  # as log lines of proxies have it
_log = logging.getLogger("service.access")


#: headers that are lists, of which a client may send each element in a line of its own
LISTS = frozenset((b"accept", b"accept-encoding", b"if-match", b"if-none-match"))


def joined(headers: Iterable[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
    """Headers with one line of each list (RFC 9110, section 5.3)."""
    given = list(headers)
    for name in LISTS:
        values = [value for key, value in given if key == name]
        if len(values) > 1:
            given = [*(pair for pair in given if pair[0] != name), (name, b", ".join(values))]
    return given


class Conventions:
    """ASGI middleware; sits outside of everything else."""

    def __init__(self, app: ASGIApp, allowed_hosts: tuple[str, ...], metrics: Metrics) -> None:
        self.app, self.allowed_hosts, self.metrics = app, allowed_hosts, metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request; other events of the server pass."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        await self._serve(scope, receive, send)

    async def _serve(self, given: Scope, receive: Receive, send: Send) -> None:
        is_head = given["method"] == "HEAD"  # what GET would answer, without the body
        scope = {**given, "headers": joined(given["headers"])} | ({"method": "GET"} if is_head else {})
        headers = Headers(scope=scope)
        identifier = begin_request(headers.get("x-request-id"))
        start = perf_counter()
        status = 0

        async def send_with_id(message: Message) -> None:
            """Send, and note the status; the head of the answer gets the id."""
            nonlocal status
            is_start = message["type"] == "http.response.start"
            if is_start:
                status = message["status"]
                pairs = [pair for pair in message.get("headers", ()) if pair[0] != _ID]
                told = {name for name, _ in pairs}
                is_page = any(name == _TYPE and value.startswith(_PAGE) for name, value in pairs)
                # of what a browser has already these would take the place of its own
                wanted = [] if status == NOT_MODIFIED else _GUARDS_OF_PAGE if is_page else _GUARDS
                guards = [pair for pair in wanted if pair[0] not in told]
                message["headers"] = [*pairs, (_ID, identifier.encode()), *guards]
            if is_start or not is_head:
                await send(message)
            if is_start and is_head:  # whatever is still to come of a stream
                await send({"type": "http.response.body"})

        try:
            self._require_accepted(host_of(scope["headers"]))
            await self.app(scope, receive, send_with_id)
        except ClientDisconnect:  # it went before it had sent all, and nobody is there to be told
            status = status or GONE
        except Exception as error:
            if status:  # the answer has begun: nothing can be said any more
                raise
            await problems.response(error, scope["path"])(scope, receive, send_with_id)
        finally:
            self._record(given["method"], scope, status, perf_counter() - start)

    def _require_accepted(self, host: str) -> None:
        if "*" not in self.allowed_hosts and host not in self.allowed_hosts:
            detail = f"the Host header names '{host[:80]}', which is not served here"
            raise Refused(400, "host-not-allowed", f"{detail}; SUBSTRUCTURES_ALLOWED_HOSTS adds hosts")

    def _record(self, method: str, scope: Scope, status: int, seconds: float) -> None:
        route = getattr(scope.get("route"), "path", "(none)")
        self.metrics.observe(method, route, status, seconds)
        _log.info("%s %r %d %.1f ms", method, scope["path"], status, 1000 * seconds)
