"""The frame of every page: one document with its style inside, and headers that let nothing else in."""

from __future__ import annotations

import hashlib
from base64 import b64encode
from collections.abc import Sequence
from pathlib import Path

from fastapi import Request, Response

from service.http.requests import store_of
from service.http.responses import conditional
from service.messages.answers import Answer, etag
from service.messages.viewer import ANYBODY
from service.pages.html import Html, html, joined, link, tag
from service.queries import renewals

STYLE = Path(__file__).with_name("style.css").read_text(encoding="utf-8")


def _script(*names: str) -> str:
    return "".join(Path(__file__).with_name(f"{name}.js").read_text(encoding="utf-8") for name in names)


#: of pages of jobs: follows what happens, and carries out what buttons say
LIVE = _script("live")


def _source(text: str) -> str:
    """How a policy names an inline text: by its hash."""
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


POLICY = "; ".join(
    [
        "default-src 'none'",
        "img-src 'self'",
        f"style-src {_source(STYLE)}",
        f"script-src {_source(LIVE)}",
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'self'",
        "frame-ancestors 'none'",
    ]
)
ACCOUNT = link("account", "/account")
PLACES = (link("catalogue", "/"), *(link(name, f"/{name}") for name in ("trees", "jobs", "docs")), ACCOUNT)
MAIN = b'<main id="content">'
HEADERS = {
    "Content-Type": "text/html; charset=utf-8",
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
}


def document(
    title: str,
    *content: Html,
    script: str = "",
    refresh: int | None = None,
    crumbs: Sequence[tuple[str, str]] = (),
    search: bool = True,
) -> bytes:
    """The bytes of a page, which is loaded again after ``refresh`` seconds where scripts do not run; ``crumbs``: names
    and addresses of what it is part of; ``search``: with a search of the catalogue.
    """
    head = html(
        tag("meta", charset="utf-8"),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        None if refresh is None else tag("noscript", tag("meta", http_equiv="refresh", content=refresh)),
        tag("link", rel="icon", href="/favicon.ico"),
        tag("title", title),
        tag("style", Html(STYLE)),
    )
    top = tag(
        "header",
        tag("a", "skip to the content", href="#content", class_="skip"),
        link("substructures", "/"),
        _search() if search else None,
        tag("nav", joined(PLACES, " · "), aria_label="Pages"),
    )
    path = tag("nav", joined([link(*each) for each in crumbs], " / "), " /", class_="crumbs", aria_label="Part of")
    main = tag("main", path if crumbs else None, *content, id="content")
    body = tag("body", top, main, tag("script", Html(script)) if script else None)
    return f"<!doctype html>\n{tag('html', tag('head', head), body, lang='en')}\n".encode()


def _search() -> Html:
    label = "Search the catalogue"
    box = tag("input", type="search", name="q", aria_label=label, placeholder=label, autocomplete="off", id="find")
    return tag("form", box, method="get", action="/", role="search", aria_label=label)


def answer(request: Request, page: bytes) -> Response:
    """The page, with who is signed in, or 304 when the browser has it. While the store is derived anew, it says how far
    that is."""
    viewer = getattr(request.state, "viewer", ANYBODY)
    if viewer != ANYBODY:
        page = page.replace(ACCOUNT.encode(), link(viewer.owner, "/account").encode(), 1)
    with store_of(request).database.read() as connection:
        renewal = renewals.progress(connection)
    if renewal is not None and renewal[0] < renewal[1]:
        told = tag("p", "{} of {} parts and trees are derived anew".format(*renewal), class_="small")
        page = page.replace(MAIN, MAIN + str(told).encode(), 1)
    tag_of_content = etag("page", hashlib.sha256(page).hexdigest())
    return conditional(request, tag_of_content, False, lambda: Answer(200, page, HEADERS))
