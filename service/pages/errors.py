"""What went wrong as a page, for browsers: the sentence, what was meant perhaps, and the rest folded."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import orjson

from service.pages.catalogue import search_form
from service.pages.html import Html, html, link, tag
from service.pages.layout import HEADERS, document

#: places of a reference in an address
SHELF = re.compile(r"/(substructures|trees)/[^/]+$")
NAMED = re.compile(r"'([a-z0-9][a-z0-9-]*(?:@\d+)?)'")


def error_page(problem: Mapping[str, Any]) -> tuple[bytes, Mapping[str, str]]:
    """The bytes of the page of a problem document, and its headers."""
    told, where = str(problem["detail"]), str(problem.get("instance", ""))
    shelf = SHELF.search(where)
    page = document(
        f"{problem['status']} - substructures",
        tag("h1", f"{problem['title']}"),
        tag("p", _linked(told, where, shelf.group(1)) if shelf else told),
        search_form({}) if where == "/" else Html(),
        tag("p", link("All parts", "/"), " · ", link("All trees", "/trees"), " · ", link("Jobs", "/jobs")),
        tag(
            "details",
            tag("summary", "As data"),
            tag("pre", tag("code", orjson.dumps(dict(problem), option=orjson.OPT_INDENT_2).decode()), tabindex="0"),
        ),
        tag("p", f"Request {problem.get('request_id', '')}", class_="quiet small"),
        search=where != "/",
    )
    return page, HEADERS


def _linked(told: str, where: str, shelf: str) -> Html:
    """The sentence with links where it names what there is."""
    asked = where.rpartition("/")[2]
    parts = NAMED.split(told)
    return html(
        *(
            text if k % 2 == 0 else (link(text, f"/{shelf}/{text}") if text != asked else f"'{text}'")
            for k, text in enumerate(parts)
        )
    )
