"""Requests whose work would hold the interpreter for long, answered by another process of the server.

While one thread of a process derives formulas, every other one waits for the interpreter at each of its steps, short
requests with dozens of them most of all. So deriving, coupling, analyses, and printing what was not printed before are
left to a process of their own: the same application, listening on a socket in a folder that only the server's user can
enter. Requests are passed on as they came, with their credentials and keys.
"""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator, Iterable

import httpx2
from fastapi import Request, Response
from fastapi.responses import StreamingResponse

from service.answers import Answer
from service.http.request_id import current_request_id
from service.refusals import Refused

#: what concerns one connection alone (RFC 9110, section 7.6.1), or is set anew
OF_CONNECTION = frozenset(
    ("connection", "keep-alive", "transfer-encoding", "te", "trailer", "upgrade", "content-length", "expect")
)
OWN = frozenset(("x-request-id", "server", "date", "x-content-type-options", "content-security-policy"))
#: of a request whose answer is kept for others
CONDITIONS = frozenset(("if-none-match", "if-modified-since", "if-match", "range"))
CONNECTIONS, ATTEMPTS = 256, 2
INNER = "localhost"  # of addresses of that process; the host that was asked for is a header like all others
KEPT = 2.0  # seconds; the other side closes connections on which nothing is asked for longer
#: seconds beyond the limit of a request: for the process to start again, and for its answer
SLACK = 60.0
_log = logging.getLogger(__name__)


#: headers that belong to an answer that is kept; the others are made for each request
OF_ANSWER = ("Content-Type", "Content-Disposition", "Content-Security-Policy")


class RefusedThere(Exception):
    """An answer that is no success, with all that there is to say."""

    def __init__(self, response: Response) -> None:
        super().__init__(response.status_code)
        self.response = response


class Away:
    """The process that answers what takes long; ``path``: of its socket."""

    def __init__(self, path: str, seconds: float) -> None:
        limits = httpx2.Limits(max_connections=CONNECTIONS, keepalive_expiry=KEPT)
        timeout = httpx2.Timeout(seconds + SLACK)
        self._async = httpx2.AsyncClient(
            transport=httpx2.AsyncHTTPTransport(uds=path, limits=limits), timeout=timeout, trust_env=False
        )
        self._sync = httpx2.Client(
            transport=httpx2.HTTPTransport(uds=path, limits=limits), timeout=timeout, trust_env=False
        )

    async def answer(self, request: Request, body: Iterable[bytes], stores: bool) -> Response:
        """The answer to a request with this body; ``stores``: it changes something, so that it is not asked again where
        the process was killed meanwhile. Raises Refused 503 then.
        """
        headers, content = _passed_on(request), b"".join(body)
        for attempt in range(1 if stores else ATTEMPTS):
            sent = self._async.build_request(request.method, _address(request), content=content, headers=headers)
            try:
                answer = await self._async.send(sent, stream=True)
            except httpx2.HTTPError as error:
                _log.warning("attempt %d at the process that computes: %r", attempt + 1, error)
            else:
                length = {name: size for name, size in answer.headers.items() if name == "content-length"}
                return StreamingResponse(_pieces(answer), answer.status_code, {**_told(answer), **length})
        raise _gone()

    def printed(self, request: Request) -> Answer:
        """The whole answer to a GET, to be kept. Raises as :meth:`answer`, and RefusedThere."""
        for attempt in range(ATTEMPTS):
            try:
                answer = self._sync.get(_address(request), headers=_passed_on(request, CONDITIONS))
            except httpx2.HTTPError as error:
                _log.warning("attempt %d at the process that computes: %r", attempt + 1, error)
                continue
            if answer.status_code == 200:
                told = {name: answer.headers[name.lower()] for name in OF_ANSWER if name.lower() in answer.headers}
                return Answer(200, answer.content, told)
            raise RefusedThere(Response(answer.content, answer.status_code, _told(answer)))
        raise _gone()


def _address(request: Request) -> str:
    path = request.scope.get("raw_path") or request.url.path.encode()
    query = request.scope["query_string"]
    return f"http://{INNER}{path.decode('ascii')}" + (f"?{query.decode('ascii')}" if query else "")


def _passed_on(request: Request, left_out: frozenset[str] = frozenset()) -> list[tuple[bytes, bytes]]:
    """The headers of a request, with its id."""
    dropped = OF_CONNECTION | OWN | left_out
    kept = [(name, value) for name, value in request.headers.raw if name.decode("latin-1").lower() not in dropped]
    return [*kept, (b"x-request-id", current_request_id().encode())]


def _told(answer: httpx2.Response) -> dict[str, str]:
    return {name: value for name, value in answer.headers.items() if name not in OF_CONNECTION | OWN}


async def _pieces(answer: httpx2.Response) -> AsyncIterator[bytes]:
    try:
        async for piece in answer.aiter_raw():
            yield piece
    finally:
        await answer.aclose()


def _gone() -> Refused:
    detail = "the process that computes was ended and is started again; ask once more"
    return Refused(503, "restarting", detail, headers={"Retry-After": "1"})
