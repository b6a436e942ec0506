"""Signing in to pages with an API key, and out: a session, known by a cookie that scripts cannot read.

The cookie lets this server's own pages be read. It changes nothing: whoever acts sends the key itself.
"""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from fastapi import Request, Response
from fastapi.concurrency import run_in_threadpool
from fastapi.routing import APIRoute
from starlette.requests import cookie_parser

from service.http.authority import network_of
from service.http.requests import SESSION, RawBody, StoreOf, authenticated, credentials
from service.http.routing import router_of
from service.messages.refusals import Refused
from service.messages.viewer import ANYBODY, Viewer
from service.pages.html import Html, facts, tag
from service.pages.layout import HEADERS, document
from service.store import keys
from service.store.authorisations import Credentials

FORM = "application/x-www-form-urlencoded"
ICON = Path(__file__).with_name("icon.svg").read_bytes()
LONGEST = 2000  # characters of an address to return to

Handler = Callable[[Request], Coroutine[Any, Any, Response]]


class PageRoute(APIRoute):
    """A page that asks for a key where one is needed, and comes back then."""

    def get_route_handler(self) -> Handler:
        """Show the page, or a form in its place, with the same status."""
        show = super().get_route_handler()

        async def shown(request: Request) -> Response:
            """The page or the form."""
            try:
                return await show(request)
            except Refused as refused:
                if refused.status != 401:
                    raise
                target = request.url.path + (f"?{request.url.query}" if request.url.query else "")
                told = "" if refused.code == "key-missing" else refused.detail
                return _answer(_form(target, told), 401, refused.headers)

        return shown


router = router_of(PageRoute, include_in_schema=False)


@router.get("/favicon.ico")
async def icon() -> Response:
    """The sign in tabs and bookmarks."""
    return Response(ICON, media_type="image/svg+xml", headers={"Cache-Control": "public, max-age=86400"})


@router.get("/account")
async def account(request: Request, store: StoreOf) -> Response:
    """Who is signed in."""
    viewer = await authenticated(store, credentials(request.method, request.headers))
    return _answer(_open() if viewer == ANYBODY else _signed_in(viewer))


@router.post("/sign-in")
async def sign_in(request: Request, store: StoreOf, raw: RawBody) -> Response:
    """Begin a session, and return to where the form was shown."""
    _require_own_page(request)
    given = _fields(request, raw)
    target = _target(given.get("next", "/"))
    address, wrong = network_of(request.client.host) if request.client else "", store.runtime.wrong_keys
    try:
        wrong.require_few(address)
        value = await run_in_threadpool(_begin, store, given.get("key", "").strip())
    except Refused as refused:
        if refused.status == 429:
            return _answer(_form(target, refused.detail), 429, refused.headers)
        if refused.status != 401:
            raise
        wrong.note(address)
        return _answer(_form(target, "this is no API key of this server, or none any more"), 401, refused.headers)
    headers = {"Location": target, "Cache-Control": "no-store", "Set-Cookie": _cookie(request, value, _seconds())}
    return Response(status_code=303, headers=headers)


@router.post("/sign-out")
async def sign_out(request: Request, store: StoreOf) -> Response:
    """End the session."""
    _require_own_page(request)
    value = cookie_parser(request.headers.get("cookie", "")).get(SESSION, "")
    await run_in_threadpool(_end, store, value)
    store.runtime.authorisations.forget(Credentials(session=value))
    headers = {"Location": "/account", "Cache-Control": "no-store", "Set-Cookie": _cookie(request, "", 0)}
    return Response(status_code=303, headers=headers)


def _begin(store: StoreOf, token: str) -> str:
    with store.database.write() as connection:
        return keys.sign_in(connection, token)[0]


def _end(store: StoreOf, value: str) -> None:
    with store.database.write() as connection:
        keys.sign_out(connection, value)


def _require_own_page(request: Request) -> None:
    """Raise Refused 403 for a form of another site. Browsers say where it stands, in one header or the other."""
    site, origin = request.headers.get("sec-fetch-site"), request.headers.get("origin")
    own = urlsplit(origin).netloc == request.headers.get("host") if origin is not None else True
    if site not in (None, "same-origin", "none") or not own:
        raise Refused(403, "cross-site", "this form was sent from a page of another site")


def _fields(request: Request, raw: bytes) -> dict[str, str]:
    if not request.headers.get("content-type", "").lower().startswith(FORM):
        raise Refused(415, "unsupported-media-type", f"send {FORM}", headers={"Accept": FORM})
    return {name: values[-1] for name, values in parse_qs(raw.decode(errors="replace")).items()}


def _target(given: str) -> str:
    """An address within this server."""
    is_own = given.startswith("/") and not given.startswith(("//", "/\\")) and given.isprintable() and given.isascii()
    return given if is_own and len(given) <= LONGEST else "/"


def _seconds() -> int:
    return int(keys.SESSION.total_seconds())


def _cookie(request: Request, value: str, seconds: int) -> str:
    secure = "; Secure" if request.url.scheme == "https" else ""
    return f"{SESSION}={value}; Path=/; Max-Age={seconds}; HttpOnly; SameSite=Strict{secure}"


def _answer(page: bytes, status: int = 200, headers: Any = None) -> Response:
    return Response(page, status, {**HEADERS, "Cache-Control": "no-store", **(headers or {})})


def _form(target: str, told: str) -> bytes:
    return document(
        "Sign in - substructures",
        tag("h1", "Sign in"),
        tag("p", told, class_="warn") if told else Html(),
        tag("p", "This server asks for an API key. It is made by ", tag("code", "substructures key create"), "."),
        tag(
            "form",
            tag("input", type="hidden", name="next", value=target),
            # for those who keep keys as passwords
            tag("input", name="username", autocomplete="username", value="API key", hidden="hidden", aria_label="user"),
            tag(
                "input",
                type="password",
                name="key",
                aria_label="API key",
                placeholder="sub_...",
                required="required",
                autocomplete="current-password",
            ),
            tag("button", "Sign in", type="submit"),
            method="post",
            action="/sign-in",
            class_="bar",
        ),
        tag("p", f"You stay signed in for {_seconds() // 3600} hours, or until the key ends.", class_="quiet"),
    )


def _signed_in(viewer: Viewer) -> bytes:
    about = facts([("Owner", viewer.owner), ("Key", tag("code", viewer.key)), ("Scopes", ", ".join(viewer.scopes))])
    out = tag("form", tag("button", "Sign out", type="submit"), method="post", action="/sign-out", class_="bar")
    return document("Account - substructures", tag("h1", "Account"), about, out)


def _open() -> bytes:
    words = "This server has no API keys: whoever reaches it, on this machine alone, may do everything."
    return document("Account - substructures", tag("h1", "Account"), tag("p", words))
