"""Exceptions to RFC 9457 problem documents: every answer that is not a success has this one shape.

::

    Refused                a request that cannot be served: status, code, detail
    InvalidInput           422, one error for every fault, with a pointer into the body
    TooLarge, MissingValue 422
    anything else          500; the log has the trace, the client the request id
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from sqlalchemy.exc import DataError, DBAPIError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from starlette.exceptions import HTTPException
from starlette.routing import Route

from service.http.request_id import current_request_id
from service.messages.refusals import Refused, known_refusal, not_found, problem, unprocessable
from service.models.formulas import QUANTITIES
from service.queries.common import is_conflict, is_full, is_outage, is_read_only
from substructures.documents import message_of, pointer_step
from substructures.errors import Fault, InvalidInput, MissingValue, TooLarge, VerificationFailed, among
from substructures.quantities.quantity import TABLE

MEDIA_TYPE = "application/problem+json"
#: the page of a problem document, and its headers
Page = Callable[[Mapping[str, Any]], tuple[bytes, Mapping[str, str]]]
_log = logging.getLogger(__name__)


def as_refused(error: Exception) -> Refused:
    """What a client is told about an exception."""
    known = known_refusal(error)
    if known is not None:
        return known
    match error:
        case RequestValidationError():
            faults = [_validation_fault(item) for item in error.errors()]
            return Refused(422, "invalid-request", "; ".join(map(str, faults[:3])), faults)
        case HTTPException(status_code=404):
            return not_found("there is nothing at this path; /openapi.json lists all there are")
        case HTTPException():
            return Refused(error.status_code, "http-error", str(error.detail), headers=error.headers)
        case DataError():
            return _not_storable("")
        case DBAPIError() | PoolTimeout() if _is_unavailable(error):
            _log.error("the database does not answer: %s", error)
            return Refused(503, "database-unavailable", _why(error), headers={"Retry-After": "1"})
    _log.error("unexpected %s", type(error).__name__, exc_info=error)
    return Refused(500, "internal-error", "an error in the service; please report it with the request id")


def _is_unavailable(error: Exception) -> bool:
    """Locked, full or not to be reached; SQLite reports wrong statements under the same exception."""
    if isinstance(error, DBAPIError) and not is_outage(error):
        return False
    return getattr(getattr(error, "orig", None), "sqlite_errorname", "") != "SQLITE_ERROR"


def _why(error: Exception) -> str:
    if is_full(error):
        return "the disk of the database is full; nothing was changed"
    if is_read_only(error):
        return "the database takes no changes: it is read-only, or a standby; nothing was changed"
    what = "is busy with changes of others" if is_conflict(error) else "does not answer"
    return f"the database {what}; nothing was changed"


def _validation_fault(item: Mapping[str, Any]) -> Fault:
    return Fault("".join(map(pointer_step, item["loc"])), str(item["type"]).replace("_", "-"), message_of(item))


def _not_storable(pointer: str) -> Refused:
    which = f" of {pointer}" if pointer else ""
    return unprocessable("invalid-text", f"the text{which} holds what the database cannot store, such as NUL", pointer)


def _with_nul(request: Request) -> str:
    """The pointer to what the address gives with a NUL, which PostgreSQL takes in no text."""
    query = [("query", *given) for given in request.query_params.multi_items()]
    path = [("path", *given) for given in request.path_params.items()]
    found = (f"/{kind}" + pointer_step(name) for kind, name, value in query + path if "\0" in str(value))
    return next(found, "")


def document(refused: Refused, instance: str) -> dict[str, Any]:
    """The problem document."""
    return problem(refused, instance=instance, request_id=current_request_id())


def response(error: Exception, instance: str, page: Page | None = None) -> Response:
    """The answer to a request that ended in an exception; ``page``: what makes a page of it."""
    refused = as_refused(error)
    headers = {"Cache-Control": "no-store", **refused.headers}
    if page is not None:
        content, of_page = page(document(refused, instance))
        return Response(content, refused.status, {**of_page, **headers})
    body = orjson.dumps(document(refused, instance))
    return Response(body, refused.status, headers, MEDIA_TYPE)


def _unknown(request: Request, found: Sequence[Route], routes: Sequence[Route]) -> Refused | None:
    """404 where a word that is free for one method is one of a list for another, as POST .../linearisations."""
    parents = {route.path.rpartition("/")[0] for route in found if route.path.endswith("}")}
    ends = [route.path.rpartition("/") for route in routes if request.method in (route.methods or ())]
    words = sorted({word for parent, _, word in ends if parent in parents and not word.startswith("{")})
    if not words:
        return None
    word = request.url.path.rpartition("/")[2]
    if word in TABLE or word in QUANTITIES:  # which GET answers
        return None
    detail = f"{request.method} knows no '{word[:80]}' at this path{among(word, words)}"
    return not_found(detail, "unknown-analysis")


def _other_method(request: Request, found: Sequence[Route]) -> Refused:
    possible = {method for route in found for method in route.methods or ()}
    methods = ", ".join(sorted(possible | ({"HEAD"} if "GET" in possible else set())))
    detail = f"{request.method[:40]} is not possible at this path, but {methods}"
    return Refused(405, "method-not-allowed", detail, headers={"Allow": methods})


def _is_browser(request: Request) -> bool:
    """Whether a person reads the answer."""
    accepted = request.headers.get("accept", "")
    return request.method in ("GET", "HEAD") and not request.url.path.startswith("/v1/") and "text/html" in accepted


def install(app: FastAPI, routes: Sequence[Route], page: Page) -> None:
    """Let the app answer with problem documents, and browsers with pages; ``service.http.middleware`` catches what no
    handler is for.
    """

    async def handle(request: Request, error: Exception) -> Response:
        """The problem document of an error; of a wrong method with those that the path has.

        Made here: another thread takes as long to begin.
        """
        if isinstance(error, HTTPException) and error.status_code == 405:
            # the framework names the methods of the first route only
            found = [route for route in routes if route.path_regex.fullmatch(request.url.path)]
            # .../evaluations is no quantity that could be read
            free = min((len(route.param_convertors) for route in found), default=0)
            found = [route for route in found if len(route.param_convertors) == free]
            error = _unknown(request, found, routes) or _other_method(request, found)
        if isinstance(error, DataError):
            error = _not_storable(_with_nul(request))
        return response(error, request.url.path, page if _is_browser(request) else None)

    for kind in (
        *(Refused, InvalidInput, TooLarge, MissingValue, VerificationFailed),
        *(RequestValidationError, HTTPException, DataError),
    ):
        app.add_exception_handler(kind, handle)
