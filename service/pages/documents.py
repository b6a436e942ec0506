"""``/docs``: the pages of the folder ``docs``, with what is in them, and a search."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Annotated

from fastapi import Query, Request, Response
from starlette.responses import FileResponse

from service.http.routing import router_of
from service.messages.refusals import not_found
from service.pages.documents_folder import FOLDER
from service.pages.html import Html, html, link, tag
from service.pages.layout import answer, document
from substructures.errors import among

if TYPE_CHECKING:
    from markdown_it import MarkdownIt
    from markdown_it.token import Token

INDEX = "index"
MOST = 40  # places that a search shows
BEFORE, SHOWN = 60, 180  # characters of a place, before the word and in all, at most but for a word
_LINKED = re.compile(r"\]\(([\w/-]+)\.md\)")

DRAWN = {
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
}
router = router_of(include_in_schema=False)
#: around what may be wider than the screen
SCROLLS = '<div class="scroll text" tabindex="0" role="group" aria-label="Table">'


@router.get("/docs")
def docs(request: Request, q: Annotated[str, Query(max_length=200)] = "") -> Response:
    """The index, or what a search finds."""
    return answer(request, _page(INDEX, q))


@router.get("/docs/{name:path}")
def one(name: str, request: Request) -> Response:
    """A page, or a drawing of one. Raises Refused 404."""
    if name in _drawings():
        return FileResponse(FOLDER / name, media_type="image/svg+xml", headers=DRAWN)
    return answer(request, _page(name.removesuffix(".md"), ""))


@cache
def _drawings() -> frozenset[str]:
    return frozenset(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.svg"))


def names() -> list[str]:
    """The pages by their paths without ending, in the order of the index, then the others."""
    found = {path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.md")}
    listed = [INDEX, *_LINKED.findall((FOLDER / "index.md").read_text())]
    return [*dict.fromkeys(name for name in listed if name in found), *sorted(found - set(listed))]


def _page(name: str, words: str) -> bytes:
    known = names()
    if name not in known:
        raise not_found(f"there is no page '{name[:80]}' of the documentation{among(name, known)}", "not-found")
    title, content, headings = _rendered(name)
    shown = _found(words) if words.strip() else content
    here = [tag("li", link(text, f"#{anchor}")) for level, text, anchor in headings if level == 2]
    field = tag("input", name="q", value=words, placeholder="search the documentation", aria_label="Search")
    search = tag("form", field, tag("button", "Search", type="submit"), action="/docs", class_="bar", role="search")
    inside = tag("ul", here, class_="plain") if len(here) > 2 and not words.strip() else None
    nav = tag("p", link("Documentation", "/docs"), class_="quiet")
    if name == INDEX:
        nav = tag(
            "p", "Every request, filled in, to be sent: ", link("the interface by example", "/docs/interface"), "."
        )
    return document(f"{title} - substructures", search, nav, *filter(None, (inside,)), shown)


def _found(words: str) -> Html:
    """Sections that have all words, those with the words in their heading first."""
    wanted = words.lower().split()
    places = [
        (not all(word in heading.lower() for word in wanted), name, heading, anchor, text)
        for name in names()
        for heading, anchor, text in _sections(name)
        if all(word in f"{heading}\n{text}".lower() for word in wanted)
    ]
    places.sort(key=lambda place: place[0])  # stable: otherwise in the order of the pages
    items = [
        tag("li", link(_entitled(name, heading), f"{_address(name)}#{anchor}"), _around(text, wanted[0]))
        for _, name, heading, anchor, text in places[:MOST]
    ]
    more = tag("p", f"There are {len(places) - MOST} more.", class_="quiet") if len(places) > MOST else None
    none = tag("p", "Nothing has these words.", class_="quiet")
    return html(tag("h1", f"{len(places)} places"), tag("ul", items, class_="plain") if items else none, more)


def _address(name: str) -> str:
    return "/docs" if name == INDEX else f"/docs/{name}"


def _entitled(name: str, heading: str) -> str:
    title = _rendered(name)[0]
    return title if title == heading else f"{title}: {heading}"


def _around(text: str, word: str) -> Html:
    """Some whole words before and after the first place of a word."""
    text = " ".join(text.split())
    place = text.lower().find(word)
    start = text.rfind(" ", 0, max(0, place - BEFORE)) + 1 if place > BEFORE else 0
    end = text.find(" ", start + SHOWN)
    return tag("p", "... " if start else "", text[start : end if end > 0 else None], " ..." if end > 0 else "")


@cache
def _reader() -> MarkdownIt:
    """Imported when a document is asked for."""
    found: MarkdownIt = import_module("markdown_it").MarkdownIt("commonmark", {"html": False})
    return found.enable("table")


@cache
def _tokens(name: str) -> tuple[Token, ...]:
    return tuple(_reader().parse((FOLDER / f"{name}.md").read_text(encoding="utf-8")))


@cache
def _rendered(name: str) -> tuple[str, Html, tuple[tuple[int, str, str], ...]]:
    """Title, content, and headings: level, text, anchor."""
    tokens, headings, seen = list(_tokens(name)), list[tuple[int, str, str]](), set[str]()
    for k, token in enumerate(tokens):
        if token.type == "heading_open":
            text = tokens[k + 1].content.replace("`", "").replace("**", "")
            anchor = _anchor(text, seen)
            token.attrSet("id", anchor)
            headings.append((int(token.tag[1]), text, anchor))
        if token.type == "fence":
            token.attrSet("tabindex", "0")
        for child in token.children or ():
            if child.type == "link_open":
                child.attrSet("href", _target(name, str(child.attrGet("href"))))
            if child.type == "image":
                child.attrSet("src", f"/docs/{_resolved(name, str(child.attrGet('src')))}")
                child.attrSet("class", "drawing")
    content = _reader().renderer.render(tokens, _reader().options, {})
    content = content.replace("<table>", f"{SCROLLS}<table>").replace("</table>", "</table></div>")
    title = next((text for _, text, _ in headings), name)
    return title, Html(content.replace("<pre>", '<pre tabindex="0">')), tuple(headings)


def _sections(name: str) -> Iterator[tuple[str, str, str]]:
    """Heading, anchor and text of every section."""
    headings, texts = _rendered(name)[2], list[str]()
    each = iter(headings)
    current: tuple[int, str, str] | None = None
    for token in _tokens(name):
        if token.type == "heading_open":
            if current is not None:
                yield current[1], current[2], "\n".join(texts)
            current, texts = next(each), []
        elif token.type in ("inline", "fence", "code_block"):
            texts.append(_plain(token))
    if current is not None:
        yield current[1], current[2], "\n".join(texts)


def _plain(token: Token) -> str:
    """What a reader sees of a token."""
    seen = [each.content or " " for each in token.children or () if not each.type.endswith(("_open", "_close"))]
    return "".join(seen) if token.children else token.content


def _anchor(text: str, seen: set[str]) -> str:
    """As people link to it: ``5-jobs``."""
    plain = re.sub(r"[^\w -]", "", text.lower()).strip().replace(" ", "-") or "section"
    found = plain if plain not in seen else f"{plain}-{len(seen)}"
    seen.add(found)
    return found


def _target(name: str, address: str) -> str:
    """Where a link of a page leads: to pages here, to what is elsewhere as it stands, else to nothing but the docs."""
    path, mark, anchor = address.partition("#")
    if "://" in address or not path:
        return address
    place = _resolved(name, path)
    is_page = place and path.endswith(".md")
    return _address(place.removesuffix(".md")) + mark + anchor if is_page else "/docs"


def _resolved(name: str, path: str) -> str:
    """The place in the folder of a path that a page names; empty where it leads out of it."""
    parts: list[str] = []
    for step in (PurePosixPath("docs") / name).parent.joinpath(path).parts:
        parts = parts[:-1] if step == ".." else [*parts, step]
    return "/".join(parts[1:]) if parts[:1] == ["docs"] else ""
