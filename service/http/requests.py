"""Dependencies of the routes: store, authorisation, bodies of limited size."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, closing
from typing import Annotated, Any, get_args, get_origin
from urllib.parse import urlsplit

from fastapi import Depends, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.routing import APIRoute
from starlette.datastructures import Headers
from starlette.requests import cookie_parser

from service.content import bundles
from service.messages.answers import JSON
from service.messages.refusals import Refused, unprocessable
from service.messages.spool import Spool
from service.messages.viewer import Viewer
from service.schemas import forms
from service.store import keys
from service.store.authorisations import Credentials
from service.store.store import Store
from substructures.documents import pointer_step, read_json
from substructures.errors import meant
from substructures.formats import arrays, arrow

SUBMISSIONS = "/v1/jobs"  # longer bodies
IMPORTS = "/v1/imports"  # zips of files with meshes
SESSION = "substructures_session"  # cookie
PRECONDITIONS = ("If-Match", "If-None-Match")
SHORT = 2**12  # bytes of JSON that are read in less time than another thread takes to begin


def store_of(request: Request) -> Store:
    """The store of the app; in other dependencies this costs less than one more dependency."""
    store: Store = request.app.state.store
    return store


async def get_store(request: Request) -> Store:
    """The store of the app, as a dependency."""
    return store_of(request)


#: what a form of any site can send without being asked
FORM_TYPES = ("application/x-www-form-urlencoded", "multipart/form-data", "text/plain")
StoreOf = Annotated[Store, Depends(get_store)]


def needs(scope: str) -> Any:
    """The dependency of a route that only API keys with this scope may use."""

    async def authorise(request: Request) -> None:
        """Note who asks, or refuse."""
        viewer = await authenticated(store_of(request), credentials(request.method, request.headers))
        viewer.require(scope)
        check_query(request)
        if scope != "read":
            check_preconditions(request)
        request.state.viewer, request.state.principal = viewer, viewer.key

    return Depends(authorise)


def check_query(request: Request) -> None:
    """Raise Refused 422 for a query parameter that the endpoint does not have, or has once and is given twice."""
    route = request.scope.get("route")
    if not request.url.query or not isinstance(route, APIRoute):
        return
    known = dict(_query_fields(route.dependant))
    for name in request.query_params:
        if name not in known:
            there = f"; there are {', '.join(known)}" if known else "; there are none"
            detail = f"unknown query parameter '{name[:80]}'{meant(name, known) or there}"
            raise unprocessable("unknown-query", detail, "/query" + pointer_step(name[:80]), known=list(known))
        if len(request.query_params.getlist(name)) > 1 and not _is_list(known[name].field_info.annotation):
            detail = f"the query parameter '{name}' is given more than once, and has one value: give it once"
            raise unprocessable("given-twice", detail, "/query" + pointer_step(name))


def check_preconditions(request: Request) -> None:
    """Raise Refused 422 for a condition of a request that changes something, where its endpoint does not look at it: to
    be passed over is the last thing that whoever sets one wants.
    """
    route = request.scope.get("route")
    known = {each.alias for each in route.dependant.header_params} if isinstance(route, APIRoute) else set()
    for name in PRECONDITIONS:
        if name.lower() in request.headers and name.lower() not in known:
            detail = f"{name} has no meaning for {request.method} {request.url.path}: send it without"
            raise unprocessable("unknown-precondition", detail, f"/header/{name}")


def _query_fields(dependant: Any) -> Iterator[tuple[str, Any]]:
    yield from ((field.alias, field) for field in dependant.query_params)
    for each in dependant.dependencies:
        yield from _query_fields(each)


def _is_list(annotation: Any) -> bool:
    return any(get_origin(each) is list for each in (annotation, *get_args(annotation)))


def credentials(method: str, headers: Headers) -> Credentials:
    """What a request shows. The cookie of a session has the scopes of its key, for scripts of our own pages only.

    Raises Refused 403 for a request that another site makes with it, or that a form can send.
    """
    authorization = headers.get("authorization", "")
    session = cookie_parser(headers.get("cookie", "")).get(SESSION, "")
    if authorization or not session:
        return Credentials(authorization)
    site = headers.get("sec-fetch-site", "none")
    if method in ("GET", "HEAD"):
        is_ours = site in ("none", "same-origin")
    else:  # browsers say where a script stands, and no form has such a body
        origin, kind = headers.get("origin", ""), headers.get("content-type", "").partition(";")[0].strip().lower()
        is_ours = site == "same-origin" and urlsplit(origin).netloc == headers.get("host") and kind not in FORM_TYPES
    if not is_ours:
        raise Refused(403, "cross-site", "another site, or a form, asks with the session of a page here")
    return Credentials(session=session)


async def authenticated(store: Store, given: Credentials) -> Viewer:
    """Who asks. Raises Refused 401."""
    known = store.runtime.authorisations.get(given)
    return await run_in_threadpool(_authenticated, store, given) if known is None else known


def _authenticated(store: Store, given: Credentials) -> Viewer:
    with store.database.read() as connection:
        viewer = keys.authenticate(connection, given, store.settings.is_loopback)
    store.runtime.authorisations.put(given, viewer)
    return viewer


async def viewer(request: Request) -> Viewer:
    """Who asks, as a dependency of a route with :func:`needs`."""
    found: Viewer = request.state.viewer
    return found


ViewerOf = Annotated[Viewer, Depends(viewer)]


async def raw_body(request: Request) -> bytes:
    """The request body, refused with 413 as soon as it exceeds its limit."""
    limits = store_of(request).settings.limits
    by_path = {SUBMISSIONS: limits.job_bytes}
    if declared_type(request) == bundles.MEDIA_TYPE:
        by_path[IMPORTS] = limits.binary_bytes
    limit = by_path.get(request.url.path, limits.json_bytes)
    return b"".join([chunk async for chunk in _limited(request, limit)])


@asynccontextmanager
async def spooled_body(request: Request) -> AsyncIterator[Spool]:
    """The request body of any kind; the limit is that of its media type. 413 as soon as the body exceeds it."""
    limits = store_of(request).settings.limits
    by_type = dict.fromkeys((arrays.MEDIA_TYPE, bundles.MEDIA_TYPE), limits.binary_bytes)
    limit = {**by_type, arrow.MEDIA_TYPE: limits.stream_bytes}.get(media_type(request), limits.json_bytes)
    with closing(Spool()) as body:
        await body.fill(_limited(request, limit))
        yield body


async def _limited(request: Request, limit: int) -> AsyncIterator[bytes]:
    coding = request.headers.get("content-encoding", "identity")
    if coding.strip().lower() != "identity":
        detail = f"send the body as it is; Content-Encoding '{coding[:40]}' was received"
        raise Refused(415, "unsupported-media-type", detail, headers={"Accept-Encoding": "identity"})
    declared = request.headers.get("content-length", "0")
    if declared.isdigit() and int(declared) > limit:
        raise _too_long(request, limit)
    size = 0
    async for chunk in request.stream():
        size += len(chunk)
        if size > limit:
            raise _too_long(request, limit)
        yield chunk


def _too_long(request: Request, limit: int) -> Refused:
    how = (
        f"states take fewer bytes as npz ({arrays.MEDIA_TYPE}), any number goes as Arrow ({arrow.MEDIA_TYPE}) or as a "
        f"job (POST {SUBMISSIONS})"
    )
    if request.url.path == IMPORTS:
        most = store_of(request).settings.limits.binary_bytes
        how = f"a zip with the file ({bundles.MEDIA_TYPE}) may have {most:,} bytes"
    detail = f"the request body is larger than {limit:,} bytes, the limit for its media type; {how}"
    return Refused(413, "body-too-large", detail, limit=limit)


RawBody = Annotated[bytes, Depends(raw_body)]


def declared_type(request: Request) -> str:
    """The media type of the request body, without parameters."""
    return request.headers.get("content-type", "").partition(";")[0].strip().lower()


def media_type(request: Request) -> str:
    """As :func:`declared_type`, but JSON's for a form that brings JSON."""
    sent = declared_type(request)
    return JSON if sent == forms.MEDIA_TYPE and not _is_of_page(request) else sent


def _is_of_page(request: Request) -> bool:
    """Whether a browser sends it for a page: each says so with a form, and only browsers do."""
    return any(name in request.headers for name in ("origin", "referer", "sec-fetch-site", "sec-fetch-mode"))


def received(request: Request) -> str:
    """What a body was declared as, for a message."""
    sent = request.headers.get("content-type")
    return "no Content-Type" if sent is None else f"Content-Type '{sent[:80]}'"


def require_json(request: Request) -> None:
    """Refuse a body that is not declared as JSON; this also keeps HTML forms of other sites out."""
    if media_type(request) != JSON:
        detail = f"send Content-Type: application/json; {received(request)} was received"
        raise Refused(415, "unsupported-media-type", detail, headers={"Accept": JSON})


async def json_body(request: Request, raw: RawBody) -> Any:
    """The request body as plain data, numbers exact; a long one is read in a worker thread."""
    require_json(request)
    return _read(raw) if len(raw) <= SHORT else await run_in_threadpool(_read, raw)


def _read(raw: bytes) -> Any:
    return read_json(forms.unpacked(raw))


async def optional_json_body(request: Request, raw: RawBody) -> Any:
    """Like :func:`json_body`; an empty body is an empty object."""
    return await json_body(request, raw) if raw else {}


JsonBody = Annotated[Any, Depends(json_body)]
OptionalJsonBody = Annotated[Any, Depends(optional_json_body)]
