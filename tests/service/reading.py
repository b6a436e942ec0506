"""Reads pages and pictures strictly, as the tests of both need it."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from xml.etree import ElementTree

from fastapi.testclient import TestClient

KNOWN = {
    "html",
    "head",
    "meta",
    "title",
    "style",
    "body",
    "header",
    "nav",
    "main",
    "script",
    "a",
    "p",
    "div",
    "span",
} | {
    *(
        "form",
        "button",
        "select",
        "option",
        "b",
        "label",
        "noscript",
        "svg",
        "rect",
        "path",
        "text",
        "link",
        "details",
        "summary",
    ),
    *("h1", "h2", "h3", "pre", "code", "input", "img", "article", "sub", "sup", "progress"),
    *("math", "mrow", "mi", "mn", "mo", "msub", "msup", "msubsup", "mfrac", "msqrt", "mtext", "mover", "mspace", "wbr"),
    *("link", "label", "details", "summary", "output", "section", "ol"),
    *("table", "thead", "tbody", "tr", "th", "td", "dl", "dt", "dd", "ul", "li"),
}


class Page(HTMLParser):
    """Reads a page strictly: known elements that are closed in order, no handlers, no inline styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: set[str] = set()
        self.words: list[str] = []
        self.inline: dict[str, str] = {}
        self.attributes: list[tuple[str, str | None]] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag in KNOWN, tag
        self.attributes += attrs
        self.links |= {value or "" for name, value in attrs if name in ("href", "src")}
        if tag not in ("meta", "img", "input", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("script", "style"):
            self.inline[self.open[-1]] = data
        else:
            self.words.append(data)

    @property
    def text(self) -> str:
        """The text of the page, without the space between elements."""
        return " ".join("".join(self.words).split())


def read(client: TestClient, path: str, **headers: str) -> Page:
    answer = client.get(path, headers=headers)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "text/html; charset=utf-8"
    page = Page(answer.text)
    names = {name for name, _ in page.attributes}
    assert not [name for name in names if name.startswith("on") or name == "style"]
    assert all(re.match(r"/(?!/)|#[a-z]+$", address) for address in page.links), page.links
    return page


def draw(client: TestClient, path: str, **query: str) -> ElementTree.Element:
    answer = client.get(path, params=query)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "image/svg+xml"
    assert answer.headers["x-content-type-options"] == "nosniff"
    assert answer.headers["content-security-policy"].startswith("default-src 'none'")
    root = ElementTree.fromstring(answer.text)  # noqa: S314 -- drawn by this package
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    return root
