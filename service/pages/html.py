"""HTML out of values: everything is escaped unless it was made here.

>>> tag("p", "1 < 2", tag("b", "!"), class_="note")
'<p class="note">1 &lt; 2<b>!</b></p>'
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from html import escape

#: control characters, and those that turn the direction of the text around them
_CONTROLS = "\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff"
_INVISIBLE = re.compile(f"[{_CONTROLS}]")
_SPECIAL = re.compile(f"[&<>\"'{_CONTROLS}]")  # few texts have any
_VOID = frozenset(("img", "input", "link", "meta"))


class Html(str):
    """Text that is HTML already."""

    __slots__ = ()


Content = str | int | None | Iterable["Content"]


def html(*content: Content) -> Html:
    """Content as HTML, one after the other; None is nothing."""
    return Html("".join(map(_one, content)))


def _one(content: Content) -> str:
    if isinstance(content, Html):
        return content
    if isinstance(content, str):
        return escape(_INVISIBLE.sub("\ufffd", content)) if _SPECIAL.search(content) else content
    if content is None:
        return ""
    return str(content) if isinstance(content, int) else "".join(map(_one, content))


def tag(name: str, /, *content: Content, **attributes: str | int | None) -> Html:
    """An element. ``class_`` is the attribute class, ``data_text`` is data-text; None leaves an attribute out."""
    start = f"<{name}"
    for key, value in attributes.items():
        if value is not None:
            start += f' {_attribute(key)}="{_one(value)}"'
    start += ">"
    return Html(start if name in _VOID else f"{start}{html(*content)}</{name}>")


@cache
def _attribute(key: str) -> str:
    return key.rstrip("_").replace("_", "-")


def table(columns: Iterable[Content], rows: Iterable[Iterable[Content]]) -> Html:
    """A table that scrolls sideways where the screen is narrow."""
    named = ((column, html(column)) for column in columns)
    head = tag("thead", tag("tr", [tag("th", column, scope="col") if text else tag("td") for column, text in named]))
    body = tag("tbody", [tag("tr", [tag("td", cell) for cell in row]) for row in rows])
    return tag("div", tag("table", head, body), class_="scroll", tabindex="0", role="group", aria_label="Table")


def facts(pairs: Iterable[tuple[str, Content]]) -> Html:
    """A list of names and values; what has no value is left out."""
    shown = ((name, html(value)) for name, value in pairs)
    return tag("dl", [html(tag("dt", name), tag("dd", value)) for name, value in shown if value])


def link(text: Content, address: str) -> Html:
    """A link within this server."""
    return tag("a", text, href=address)


def joined(items: Iterable[Content], separator: str = ", ") -> Html:
    """Items with a separator between them."""
    return Html(html(separator).join(html(item) for item in items))
