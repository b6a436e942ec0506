"""Exceptions to RFC 9457 problem documents: every answer that is not a success has this one shape.

::

    Refused                a request that cannot be served: status, code, detail
    InvalidDocument        422, one error for every fault, with a pointer into the document
    TooLarge, MissingValue 422
    anything else          500; the log has the trace, the client the request id
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any

import orjson
from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute
from sqlalchemy.exc import DataError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from starlette.exceptions import HTTPException

from service.request_id import current_request_id
from substructures.documents import pointer_step
from substructures.errors import Fault, InvalidDocument, MissingValue, TooLarge

MEDIA_TYPE = "application/problem+json"
_log = logging.getLogger(__name__)

_CODES = {404: "not-found", 405: "method-not-allowed"}


class Refused(Exception):
    """A request that cannot be served. ``code`` is for programs, ``detail`` for people."""

    def __init__(
        self,
        status: int,
        code: str,
        detail: str,
        faults: Sequence[Fault] = (),
        headers: Mapping[str, str] | None = None,
        **members: Any,
    ) -> None:
        super().__init__(detail)
        self.status, self.code, self.detail = status, code, detail
        self.faults, self.headers, self.members = tuple(faults), dict(headers or {}), members


def not_found(detail: str, code: str = "not-found") -> Refused:
    """404."""
    return Refused(404, code, detail)


def unprocessable(code: str, detail: str, pointer: str = "", **members: Any) -> Refused:
    """422 with a pointer to the culprit."""
    return Refused(422, code, detail, [Fault(pointer, code, detail)], **members)


def as_refused(error: Exception) -> Refused:
    """What a client is told about an exception."""
    match error:
        case Refused():
            return error
        case InvalidDocument():
            detail = "; ".join(str(fault) for fault in error.faults[:3])
            return Refused(422, "invalid-document", detail, error.faults)
        case TooLarge():
            return unprocessable("too-large", str(error), what=error.what, size=error.size, limit=error.limit)
        case MissingValue():
            return unprocessable("missing-value", str(error), "/parameters" + pointer_step(error.name))
        case RequestValidationError():
            faults = [_validation_fault(item) for item in error.errors()]
            return Refused(422, "invalid-request", "; ".join(map(str, faults[:3])), faults)
        case HTTPException():
            code = _CODES.get(error.status_code, "http-error")
            return Refused(error.status_code, code, str(error.detail), headers=error.headers)
        case DataError():
            return unprocessable("invalid-text", "a text holds characters that the database cannot store, such as NUL")
        case OperationalError() | PoolTimeout() if _is_unavailable(error):
            _log.error("the database does not answer: %s", error)
            detail = "the database does not answer; nothing was changed"
            return Refused(503, "database-unavailable", detail, headers={"Retry-After": "1"})
    _log.error("unexpected %s", type(error).__name__, exc_info=error)
    return Refused(500, "internal-error", "an error in the service; please report it with the request id")


def _is_unavailable(error: Exception) -> bool:
    """Locked, full or not to be reached; SQLite reports wrong statements under the same exception."""
    return getattr(getattr(error, "orig", None), "sqlite_errorname", "") != "SQLITE_ERROR"


def _validation_fault(item: Mapping[str, Any]) -> Fault:
    return Fault("".join(map(pointer_step, item["loc"])), str(item["type"]).replace("_", "-"), str(item["msg"]))


def document(refused: Refused, instance: str) -> dict[str, Any]:
    """The problem document."""
    return {
        "type": f"urn:problem-type:substructures:{refused.code}",
        "title": HTTPStatus(refused.status).phrase,
        "status": refused.status,
        "detail": refused.detail,
        "instance": instance,
        "code": refused.code,
        "request_id": current_request_id(),
        "errors": [{"pointer": f.pointer, "code": f.code, "message": f.message} for f in refused.faults],
        **refused.members,
    }


def response(error: Exception, instance: str) -> Response:
    """The answer to a request that ended in an exception."""
    refused = as_refused(error)
    headers = {"Cache-Control": "no-store", **refused.headers}
    body = orjson.dumps(document(refused, instance))
    return Response(body, refused.status, headers, MEDIA_TYPE)


def install(app: FastAPI, routes: Sequence[APIRoute]) -> None:
    """Let the app answer with problem documents; ``service.middleware`` catches what no handler is for."""

    def handle(request: Request, error: Exception) -> Response:
        answer = response(error, request.url.path)
        if answer.status_code == 405:  # the framework names the methods of the first route only
            found = [route for route in routes if route.path_regex.fullmatch(request.url.path)]
            answer.headers["Allow"] = ", ".join(sorted({method for route in found for method in route.methods or ()}))
        return answer

    for kind in (Refused, InvalidDocument, TooLarge, MissingValue, RequestValidationError, HTTPException):
        app.add_exception_handler(kind, handle)
