"""The page of all trees, with a search."""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import urlencode

from service.messages.addresses import tree_path
from service.messages.viewer import PUBLIC
from service.operations.searches import Page
from service.pages.html import Html, link, table, tag
from service.pages.layout import document
from service.queries.trees import Tree


def trees_table(trees: Sequence[Tree]) -> Html:
    """Latest revisions, with what is private marked."""
    rows = [
        (
            link(f"{tree.name}@{tree.revision}", f"/trees/{tree.name}@{tree.revision}"),
            tree.dof,
            tree.owner if tree.visibility == PUBLIC else f"{tree.owner}, private",
            tree.created[:10],
            link("JSON", tree_path(tree)),
        )
        for tree in trees
    ]
    return table(("latest revision", "dof", "owner", "created", ""), rows)


def trees_page(page: Page[Tree], q: str) -> bytes:
    """The bytes of the page of what was found for ``q``."""
    label = "Search by name"
    form = tag(
        "form",
        tag("input", type="search", name="q", value=q, placeholder=label, aria_label=label),
        tag("button", "Search", type="submit"),
        method="get",
        action="/trees",
        class_="bar",
    )
    told = [tag("p", f"'{word}' is nowhere; this is '{other}'.") for word, other in page.instead.items()]
    listed = trees_table(page.items) if page.items else tag("p", "None.", class_="quiet")
    query = urlencode({"q": q, "after": page.next_token or ""})
    more = tag("p", link("Next", f"/trees?{query}")) if page.next_token else Html()
    return document("Trees - substructures", tag("h1", "Trees"), form, *told, listed, more)
