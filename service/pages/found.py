"""What the catalogue lists for a search: cards of parts, a table of trees, and facets that narrow it, as links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlencode

import orjson

from service.messages.addresses import tree_path, version_path
from service.messages.viewer import PUBLIC
from service.operations.searches import Page
from service.pages.html import Html, html, joined, link, table, tag
from service.queries.catalogue import Version
from service.queries.trees import Tree

#: values of a facet that are shown, those of most parts
MOST = 12
#: of a search, beside its words; what narrows it
NARROWING = ("dof", "joints", "tag", "owner")
TITLES = {"dof": "Degrees of freedom", "joints": "Joints", "tag": "Tags", "owner": "Owner"}


@dataclass(frozen=True, slots=True)
class Found:
    """``parts`` for the ``query`` (of the address: ``q``, ``dof``, ``joints``, ``tag``, ``owner``, ``sort``); ``total``
    and ``more``: how many parts there are at all, whether there are more trees than these.
    """

    parts: Page[Version]
    total: int
    trees: Sequence[Tree]
    more: bool
    query: Mapping[str, str] = field(default_factory=dict)

    def address(self, **changes: str) -> str:
        """Of the page with other values."""
        query = {name: value for name, value in {**self.query, **changes}.items() if value}
        return f"/?{urlencode(query)}" if query else "/"


def trees_table(trees: Sequence[Tree], part: str = "") -> Html:
    """Latest revisions, with what is private marked; ``part``: that is to be coupled onto one of them."""
    chosen = f"/edit?{urlencode({'substructure': part})}" if part else ""
    rows = [
        (
            link(f"{tree.name}@{tree.revision}", f"/trees/{tree.name}@{tree.revision}{chosen}"),
            tree.dof,
            tree.owner if tree.visibility == PUBLIC else f"{tree.owner}, private",
            tree.created[:10],
            link("JSON", tree_path(tree)),
        )
        for tree in trees
    ]
    return table(("latest revision", "dof", "owner", "created", ""), rows)


def results(found: Found) -> Html:
    """All of it, which a script puts in the place of what it was before."""
    count, instead = len(found.parts.items), found.parts.instead.items()
    told = [tag("p", f"'{word}' is nowhere; this is '{other}'.") for word, other in instead]
    following = found.parts.next_token
    more = tag("p", link("More parts", found.address(after=following))) if following else None
    cards = tag("div", [card(version) for version in found.parts.items], class_="cards")
    status = tag("p", f"{count} of {found.total:,} parts", class_="quiet", role="status")
    listed = tag("div", told, status, cards, more, _trees(found))
    kept = [
        tag("input", type="hidden", name=name, value=found.query[name], form="search")
        for name in NARROWING
        if found.query.get(name)
    ]
    return tag("div", kept, _facets(found), listed, id="results", class_="results")


def _facets(found: Found) -> Html:
    counts = {**(found.parts.facets or {})}
    given = {"dof": counts.get("dof", {}), "joints": counts.get("joints", {}), "tag": counts.get("tags", {})}
    owners = dict.fromkeys(version.owner for version in found.parts.items)
    given["owner"] = dict.fromkeys(owners, 0) if len(owners) > 1 or found.query.get("owner") else {}
    groups = [_facet(found, name, given[name]) for name in NARROWING]
    return tag("nav", groups, class_="facets", aria_label="Narrow the search")


def _facet(found: Found, name: str, counts: Mapping[str, int]) -> Html | None:
    chosen = found.query.get(name, "")
    if chosen:
        remove = html(tag("b", chosen), " ", link("any", found.address(**{name: ""})))
        return tag("section", tag("h2", TITLES[name]), tag("ul", tag("li", remove)), class_="chosen")
    often = sorted(counts.items(), key=lambda each: -each[1])[:MOST]
    shown = [(value, n) for value, n in counts.items() if (value, n) in often and value]
    links = [
        tag("li", link(value, found.address(**{name: value})), tag("span", f" {n}" if n else "", class_="quiet"))
        for value, n in shown
    ]
    return tag("section", tag("h2", TITLES[name]), tag("ul", links)) if len(links) > 1 else None


def _trees(found: Found) -> list[Html]:
    if not found.trees:
        return []
    all_of_them = link("all trees", f"/trees?{urlencode({'q': found.query.get('q', '')})}")
    more = tag("p", "There are more: ", all_of_them, ".", class_="quiet") if found.more else Html()
    return [tag("h2", "Trees"), trees_table(found.trees), more]


def card(version: Version) -> Html:
    """A part: picture, name, owner, size, proof, and where it is used."""
    tags = orjson.loads(version.tags)
    path, own = version_path(version), f"/substructures/{version.name}@{version.version}"
    picture = tag(
        "img", src=f"{path}/picture", alt=f"Picture of {version.name}", loading="lazy", width="320", height="240"
    )
    mass = "" if version.mass is None else f", {version.mass:.4g} kg"
    owner = f"private to {version.owner}" if not version.is_public else version.owner
    couple = link("+ to tree", f"/trees?part={version.name}@{version.version}")
    about = [couple, link("certificate", f"{own}#certificate"), link("used by", f"{own}#uses"), *links(version)]
    return tag(
        "article",
        link(picture, own),
        tag("h3", link(version.title or version.name, own)),
        tag("div", tag("code", f"{version.name}@{version.version}"), " ", tag("span", owner, class_="quiet small")),
        tag("div", size(version.dof, version.joints) + mass),
        tag("div", proof(orjson.loads(version.certificate)), class_="small"),
        tag("div", joined(tags), class_="quiet small"),
        tag("div", joined(about, " · "), class_="links small"),
        class_="card",
    )


def proof(told: Mapping[str, Any]) -> Html:
    """What a certificate says, in some words."""
    errors: Mapping[str, Any] = told.get("direct_form", {}).get("max_relative_error") or {}
    known = [float(error) for error in errors.values() if error is not None]
    if not known:
        return tag("span", "nothing moves", class_="quiet")
    warnings = len(told.get("warnings", ()))
    remark = f", {warnings} warning{'s' if warnings > 1 else ''}" if warnings else ""
    return tag("span", f"{len(known)} of {len(errors)} quantities agree to {max(known):.0e}{remark}")


def size(dof: int, joints: str) -> str:
    """Degrees of freedom and joints in words."""
    return f"{dof} dof, joints {joints}" if dof else "0 dof"


def links(version: Version) -> list[Html]:
    """Where the API gives definition and formulas of a version."""
    path = version_path(version)
    metric: list[Any] = [link("metric as text", f"{path}/formulas/metric?format=text")] if version.dof else []
    return [link("definition", f"{path}/definition"), link("formulas", f"{path}/formulas"), *metric]
