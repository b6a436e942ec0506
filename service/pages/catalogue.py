"""The first page: what this is, everything that is stored, how to bring a robot, how to couple two parts."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

import orjson

from service.pages.found import Found, results
from service.pages.html import Html, link, tag
from service.pages.layout import document
from service.queries.catalogue import Version

EQUATION = Html(
    "g<sub>ab</sub>(q)&#8201;q&#776;<sup>b</sup> + &#915;<sub>abc</sub>(q)&#8201;q&#775;<sup>b</sup>"
    "&#8201;q&#775;<sup>c</sup> = Q<sub>a</sub>"
)
PREFERRED = ("puma560", "parallel-gripper", "flange")
SORTS = {
    "": "best first",
    "name": "name",
    "dof": "fewest dof",
    "-dof": "most dof",
    "-created": "newest",
    "created": "oldest",
}


def page(found: Found, address: str, with_key: bool, may_write: bool, refused: int = 0) -> bytes:
    """The bytes of the page; ``address`` is the server's own, ``with_key``: requests from elsewhere need an API key,
    ``may_write``: whoever looks at it stores parts; ``refused``: so many files of its folder are.
    """
    is_first = not found.query
    return document(
        "substructures",
        tag("h1", "Equations of motion from stored parts"),
        _refused(refused) if refused else Html(),
        tag(
            "p",
            "Every part is stored with its formulas, derived once and verified; coupling parts to a tree gives ",
            EQUATION,
            " of the whole, as formulas or as numbers, with any parameters left open.",
        ),
        search_form(found.query),
        results(found),
        *(_bring(address, may_write) if is_first else ()),
        *(_example(found.parts.items, address, with_key) if is_first else ()),
        search=False,
    )


def _refused(count: int) -> Html:
    told = (
        "1 file of the folder of parts is refused"
        if count == 1
        else f"{count} files of the folder of parts are refused"
    )
    return tag("p", told, ": ", link("which, and why", "/v1/folder"), class_="warn")


def search_form(query: Mapping[str, str]) -> Html:
    """Words and order of a search, as the address has them."""
    label = "Name, title, tag or words of the description"
    box = tag(
        "input",
        id="filter",
        type="search",
        name="q",
        value=query.get("q", ""),
        placeholder=label,
        aria_label=label,
        autocomplete="off",
    )
    now = query.get("sort", "")
    options = [
        tag("option", told, value=sort, selected="selected" if sort == now else None) for sort, told in SORTS.items()
    ]
    return tag(
        "form",
        box,
        tag("select", options, name="sort", aria_label="Order"),
        tag("button", "Search", type="submit"),
        method="get",
        action="/",
        class_="bar",
        id="search",
        role="search",
    )


def _example(versions: Sequence[Version], address: str, with_key: bool) -> list[Html]:
    chosen = _pair(versions)
    if chosen is None:
        text = f"Nothing is stored yet: send a definition to POST {address}/v1/substructures."
        return [
            tag("h2", "Couple two parts"),
            tag("p", text, " All requests: ", link("openapi.json", "/openapi.json"), "."),
        ]
    key = ' -H "Authorization: Bearer $SUBSTRUCTURES_KEY"' if with_key else ""
    arm, hand, port = (json.dumps(name) for name in (chosen[0], chosen[1], f"arm.{chosen[2]}"))
    command = (
        f"curl -s {address}/v1/trees -H 'Content-Type: application/json'{key} -d '{{\n"
        f'  "name": "cell", "gravity": [0, 0, "-9.81"],\n'
        f'  "instances": [{{"name": "arm", "substructure": {arm}}},\n'
        f'                {{"name": "hand", "substructure": {hand}, "at": {port}}}]}}\''
    )
    metric = f"{address}/v1/trees/cell/metric?format=text"
    after = (
        "Then read its metric at ",
        tag("code", metric),
        " and see it at ",
        tag("code", f"{address}/trees/cell"),
        "; all requests: ",
    )
    return [
        tag("h2", "Couple two parts"),
        tag("pre", tag("code", command), tabindex="0"),
        tag("p", after, link("openapi.json", "/openapi.json"), "."),
    ]


KINDS = ".urdf,.xml,.mjcf,.sdf,.usd,.usda,.usdc,.usdz,.csv,.json,.par,.zip"


def _bring(address: str, may_write: bool) -> list[Html]:
    """A place for files, or for those whose key only reads, the command that sends one with another key."""
    kinds = "URDF, MJCF, SDF, USD, Denavit-Hartenberg tables, SYMORO"
    label = f"A robot file of yours ({kinds}): it is read, derived and drawn, and every remark is told"
    if not may_write:
        command = f'substructures submit FILE --server {address} --key "$SUBSTRUCTURES_KEY"'
        return [tag("h2", "Bring a robot"), tag("p", label, "."), tag("pre", tag("code", command), tabindex="0")]
    chosen = tag("input", id="file", type="file", accept=KINDS, aria_label=label)
    asked = "Links that begin parts of their own, separated by commas"
    cut = tag("input", id="cut", placeholder="cut at links, such as left_shoulder", aria_label=asked, title=asked)
    told = f"{label}; with its meshes as a zip. Nothing is stored before you say so. "
    told += "Choose it, or drop it anywhere on this page. "
    place = tag("section", id="import", aria_live="polite", aria_label="What was read")
    return [tag("h2", "Bring a robot"), tag("p", told, chosen, " ", cut), place]


def _pair(versions: Sequence[Version]) -> tuple[str, str, str] | None:
    """Two parts and the port of the first that the second is mounted on."""
    ports = {version.name: orjson.loads(version.ports) for version in versions}
    arm, hand, port = PREFERRED
    if port in ports.get(arm, ()) and hand in ports:
        return PREFERRED
    return next(((name, name, some[-1]) for name, some in ports.items() if some), None)
