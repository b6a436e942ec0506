"""The first page: what this is, how to couple two parts, and everything that is stored."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from urllib.parse import urlencode

import orjson

from service.messages.addresses import version_path
from service.operations.searches import Page
from service.pages.html import Html, joined, link, tag
from service.pages.layout import SCRIPT, document
from service.pages.trees import trees_table
from service.queries.catalogue import Version
from service.queries.trees import Tree

EQUATION = Html(
    "g<sub>ab</sub>(q)&#8201;q&#776;<sup>b</sup> + &#915;<sub>abc</sub>(q)&#8201;q&#775;<sup>b</sup>"
    "&#8201;q&#775;<sup>c</sup> = Q<sub>a</sub>"
)
PREFERRED = ("puma560", "parallel-gripper", "flange")


@dataclass(frozen=True, slots=True)
class Shown:
    """What the page lists: ``page`` of the parts found for ``q``. ``total`` and ``more``: how many parts there are,
    whether there are more trees.
    """

    page: Page[Version]
    q: str
    total: int
    trees: Sequence[Tree]
    more: bool


def page(shown: Shown, address: str, with_key: bool) -> bytes:
    """The bytes of the page; ``address`` is the server's own, ``with_key``: requests need an API key."""
    return document(
        "substructures",
        tag("h1", "Equations of motion from stored parts"),
        tag("p", "Every part below is stored with its formulas, derived once and verified."),
        tag(
            "p",
            "Coupling parts to a tree gives ",
            EQUATION,
            " of the whole, as formulas or as numbers, with any parameters left open.",
        ),
        *(() if shown.q else (*_example(shown.page.items, address, with_key), *_upload(address, with_key))),
        *_catalogue(shown),
        *_trees(shown),
        script=SCRIPT,
    )


def _example(versions: Sequence[Version], address: str, with_key: bool) -> list[Html]:
    chosen = _pair(versions)
    if chosen is None:
        text = f"Nothing is stored yet: send a definition to POST {address}/v1/substructures."
        return [tag("h2", "Couple two parts"), tag("p", text)]
    key = ' -H "Authorization: Bearer $SUBSTRUCTURES_KEY"' if with_key else ""
    arm, hand, port = (json.dumps(name) for name in (chosen[0], chosen[1], f"arm.{chosen[2]}"))
    command = (
        f"curl -s {address}/v1/trees -H 'Content-Type: application/json'{key} -d '{{\n"
        f'  "name": "cell", "gravity": [0, 0, "-9.81"],\n'
        f'  "instances": [{{"name": "arm", "substructure": {arm}}},\n'
        f'                {{"name": "hand", "substructure": {hand}, "at": {port}}}]}}\''
    )
    metric = f"{address}/v1/trees/cell/metric?format=text"
    after = ("Then read its metric at ", tag("code", metric), " and see it at ", tag("code", f"{address}/trees/cell"))
    return [tag("h2", "Couple two parts"), tag("pre", tag("code", command), tabindex="0"), tag("p", after, ".")]


def _upload(address: str, with_key: bool) -> list[Html]:
    """A form, or for those who are signed in, whose session changes nothing, the command that sends a key."""
    kinds = "URDF, MJCF, SDF, Denavit-Hartenberg tables, SYMORO"
    label = f"A robot file of yours ({kinds}): it is read, derived and stored, and every remark is told"
    if with_key:
        command = f'substructures submit FILE --server {address} --key "$SUBSTRUCTURES_KEY"'
        return [tag("h2", "Bring a robot"), tag("p", label, "."), tag("pre", tag("code", command), tabindex="0")]
    chosen = tag("input", id="file", type="file", accept=".urdf,.xml,.mjcf,.sdf,.csv,.json,.par", aria_label=label)
    asked = "Links that begin parts of their own, separated by commas (before the file is chosen)"
    cut = tag(
        "input",
        id="cut",
        placeholder="cut at links, such as left_shoulder, right_shoulder",
        aria_label=asked,
        title=asked,
    )
    return [tag("h2", "Bring a robot"), tag("p", label, ". ", chosen, " ", cut), tag("ul", id="report", role="status")]


def _pair(versions: Sequence[Version]) -> tuple[str, str, str] | None:
    """Two parts and the port of the first that the second is mounted on."""
    ports = {version.name: orjson.loads(version.ports) for version in versions}
    arm, hand, port = PREFERRED
    if port in ports.get(arm, ()) and hand in ports:
        return PREFERRED
    return next(((name, name, some[-1]) for name, some in ports.items() if some), None)


def _catalogue(shown: Shown) -> list[Html]:
    versions = shown.page.items
    note = [tag("span", len(versions), id="count"), f" of {shown.total:,} parts"]
    label = "Name, title, tag or words of the description"
    box = tag(
        "input",
        id="filter",
        type="search",
        name="q",
        value=shown.q,
        placeholder=label,
        aria_label=label,
        autocomplete="off",
    )
    form = tag(
        "form",
        box,
        tag("button", "Search all", type="submit"),
        tag("span", note, class_="quiet", role="status"),
        method="get",
        action="/",
        class_="bar",
    )
    told = [tag("p", f"'{word}' is nowhere; this is '{other}'.") for word, other in shown.page.instead.items()]
    query = urlencode({"q": shown.q, "after": shown.page.next_token or ""})
    more = tag("p", link("More parts", f"/?{query}")) if shown.page.next_token else Html()
    return [tag("h2", "Catalogue"), form, *told, tag("div", [_card(v) for v in versions], class_="cards"), more]


def _card(version: Version) -> Html:
    tags = orjson.loads(version.tags)
    path, own = version_path(version), f"/substructures/{version.name}@{version.version}"
    words = (version.name, version.title, version.description, *tags, version.joints)
    picture = tag(
        "img", src=f"{path}/picture", alt=f"Picture of {version.name}", loading="lazy", width="320", height="240"
    )
    return tag(
        "article",
        link(picture, own),
        tag("h3", link(version.title or version.name, own)),
        tag("div", tag("code", f"{version.name}@{version.version}")),
        tag("div", size(version.dof, version.joints)),
        None if version.is_public else tag("div", f"private to {version.owner}", class_="quiet small"),
        tag("div", joined(tags), class_="quiet small"),
        tag("div", joined(links(version), " · "), class_="links small"),
        class_="card",
        data_text=" ".join(words).lower(),
    )


def size(dof: int, joints: str) -> str:
    """Degrees of freedom and joints in words."""
    return f"{dof} dof, joints {joints}" if dof else "0 dof"


def links(version: Version) -> list[Html]:
    """Where the API gives definition and formulas of a version."""
    path = version_path(version)
    metric: list[Any] = [link("metric as text", f"{path}/formulas/metric?format=text")] if version.dof else []
    return [link("definition", f"{path}/definition"), link("formulas", f"{path}/formulas"), *metric]


def _trees(shown: Shown) -> list[Html]:
    if not shown.trees:
        return []
    more = tag("p", "There are more: ", link("all trees", "/trees"), ".", class_="quiet") if shown.more else Html()
    return [tag("h2", "Trees"), trees_table(shown.trees), more]
