"""The page of all trees, with a search."""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import urlencode

from service.addresses import tree_path
from service.pages.html import Html, link, table, tag
from service.pages.layout import document
from service.queries.trees import Tree
from service.viewer import PUBLIC


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


def trees_page(trees: Sequence[Tree], q: str, following: str | None) -> bytes:
    """The bytes of the page; ``following``: the name after which the next page begins."""
    label = "Search by name"
    form = tag(
        "form",
        tag("input", type="search", name="q", value=q, placeholder=label, aria_label=label),
        tag("button", "Search", type="submit"),
        method="get",
        action="/trees",
        class_="bar",
    )
    listed = trees_table(trees) if trees else tag("p", "None.", class_="quiet")
    more = tag("p", link("Next", f"/trees?{urlencode({'q': q, 'after': following})}")) if following else Html()
    return document("Trees - substructures", tag("h1", "Trees"), form, listed, more)
