"""Dependencies of the routes: store, authorisation, bodies of limited size, conditional answers."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from fastapi import Depends, Request, Response

from service import keys
from service.answers import FOR_EVER, REVALIDATE, Answer
from service.problems import Refused
from service.store import Store
from substructures.documents import read_json

NPZ = "application/x-npz"
SUBMISSIONS = "/v1/jobs"  # longer bodies


async def get_store(request: Request) -> Store:
    """The store of the app."""
    store: Store = request.app.state.store
    return store


StoreOf = Annotated[Store, Depends(get_store)]


def needs(scope: str) -> Any:
    """The dependency of a route that only API keys with this scope may use."""

    def authorise(request: Request, store: StoreOf) -> None:
        with store.database.read() as connection:
            principal = keys.authorise(connection, request.headers.get("authorization"), scope)
        request.state.principal = principal

    return Depends(authorise)


async def raw_body(request: Request, store: StoreOf) -> bytes:
    """The request body, refused with 413 as soon as it exceeds its limit."""
    limits = store.settings.limits
    limit = limits.binary_bytes if media_type(request) == NPZ else limits.json_bytes
    if request.url.path == SUBMISSIONS:
        limit = limits.job_bytes
    declared = request.headers.get("content-length", "0")
    if declared.isdigit() and int(declared) > limit:
        raise _too_long(limit)
    chunks, size = [], 0
    async for chunk in request.stream():
        size += len(chunk)
        if size > limit:
            raise _too_long(limit)
        chunks.append(chunk)
    return b"".join(chunks)


def _too_long(limit: int) -> Refused:
    return Refused(413, "body-too-large", f"the request body is larger than {limit} bytes", limit=limit)


RawBody = Annotated[bytes, Depends(raw_body)]


def media_type(request: Request) -> str:
    """The media type of the request body, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


def require_json(request: Request) -> None:
    """Refuse a body that is not declared as JSON; this also keeps HTML forms of other sites out."""
    if media_type(request) != "application/json":
        raise Refused(
            415, "unsupported-media-type", "send Content-Type: application/json", headers={"Accept": "application/json"}
        )


def json_body(request: Request, raw: RawBody) -> Any:
    """The request body as plain data, numbers exact. Runs in a worker thread."""
    require_json(request)
    return read_json(raw)


def optional_json_body(request: Request, raw: RawBody) -> Any:
    """Like :func:`json_body`; an empty body is an empty object."""
    return json_body(request, raw) if raw else {}


JsonBody = Annotated[Any, Depends(json_body)]
OptionalJsonBody = Annotated[Any, Depends(optional_json_body)]


def conditional(request: Request, tag: str, immutable: bool, make: Callable[[], Answer]) -> Response:
    """304 when the client has the representation already, otherwise make it."""
    headers = {"ETag": tag, "Cache-Control": FOR_EVER if immutable else REVALIDATE, "Vary": "Accept"}
    known = [item.strip().removeprefix("W/") for item in request.headers.get("if-none-match", "").split(",")]
    if tag in known or "*" in known:
        return Response(status_code=304, headers=headers)
    answer = make()
    return Response(answer.body, answer.status, {**answer.headers, **headers})
