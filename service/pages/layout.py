"""The frame of every page: one document with its style inside, and headers that let nothing else in."""

from __future__ import annotations

import hashlib
from base64 import b64encode
from pathlib import Path

from fastapi import Request, Response

from service.http.requests import store_of
from service.http.responses import conditional
from service.messages.answers import Answer, etag
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
PLACES = tuple((name, f"/{name}") for name in ("trees", "jobs", "docs", "account", "openapi.json"))
HEADERS = {
    "Content-Type": "text/html; charset=utf-8",
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "same-origin",
}


def document(title: str, *content: Html, script: str = "", refresh: int | None = None) -> bytes:
    """The bytes of a page, which is loaded again after ``refresh`` seconds where scripts do not run."""
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
        link("substructures", "/"),
        tag("nav", joined([link(name, address) for name, address in PLACES], " · ")),
    )
    body = tag("body", top, tag("main", *content), tag("script", Html(script)) if script else None)
    return f"<!doctype html>\n{tag('html', tag('head', head), body, lang='en')}\n".encode()


def answer(request: Request, page: bytes) -> Response:
    """The page, or 304 when the browser has it. While the store is derived anew, it says how far that is."""
    with store_of(request).database.read() as connection:
        renewal = renewals.progress(connection)
    if renewal is not None and renewal[0] < renewal[1]:
        told = tag("p", "{} of {} parts and trees are derived anew".format(*renewal), class_="small")
        page = page.replace(b"<main>", b"<main>" + str(told).encode(), 1)
    tag_of_content = etag("page", hashlib.sha256(page).hexdigest())
    return conditional(request, tag_of_content, False, lambda: Answer(200, page, HEADERS))
