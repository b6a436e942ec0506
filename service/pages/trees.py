"""The page of all trees, with a search."""

from __future__ import annotations

from urllib.parse import urlencode

from service.operations.searches import Page
from service.pages.found import trees_table
from service.pages.html import Html, link, tag
from service.pages.layout import document
from service.queries.trees import Tree

NAME = {"pattern": r"[a-z0-9][a-z0-9\-]*", "title": "lower-case letters, digits and -"}


def trees_page(page: Page[Tree], q: str, part: str, may_write: bool) -> bytes:
    """The bytes of the page of what was found for ``q``; ``part``: to be coupled onto one of them or a new one."""
    label = "Search by name"
    form = tag(
        "form",
        tag("input", type="search", name="q", value=q, placeholder=label, aria_label=label),
        tag("input", type="hidden", name="part", value=part) if part else None,
        tag("button", "Search", type="submit"),
        method="get",
        action="/trees",
        class_="bar",
    )
    told = [tag("p", f"'{word}' is nowhere; this is '{other}'.") for word, other in page.instead.items()]
    told += [tag("p", "Choose the tree that ", tag("code", part), " is coupled onto, or begin one.")] if part else []
    listed = trees_table(page.items, part) if page.items else tag("p", "None.", class_="quiet")
    query = urlencode({name: x for name, x in (("q", q), ("part", part), ("after", page.next_token)) if x})
    more = tag("p", link("Next", f"/trees?{query}")) if page.next_token else Html()
    new = _new(part) if may_write else Html()
    return document("Trees - substructures", tag("h1", "Trees"), form, *told, listed, more, new)


def _new(part: str) -> Html:
    """A form that begins a tree, with a part on the world; a script sends it, and lets it be sent."""
    fields = [
        tag("label", "name ", tag("input", name="name", required="required", **NAME)),
        tag("label", "first part ", tag("input", name="substructure", required="required", value=part)),
        tag("label", "gravity in m/s^2 ", tag("input", name="gravity", value="0, 0, -9.81")),
    ]
    form = tag("form", fields, tag("button", "Begin", type="submit", disabled="disabled"), class_="bar", id="begin")
    return tag("section", tag("h2", "Begin a tree"), form, tag("p", id="told", role="status"))
