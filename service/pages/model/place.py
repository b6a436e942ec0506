"""The first screen of the page of a part or a tree: view, sliders, formulas; and what it is made of without scripts."""

from __future__ import annotations

import orjson

from service.pages.html import Html, html, link, tag
from service.pages.model.grid import tabs
from service.pages.model.shown import Shown, described
from service.schemas.scenes import LARGEST

STEPS = 1000  # of a slider
ENTRY = "Choose an entry to read its formula, its value here, and the bodies that it comes from."
NONE_CHOSEN = tag("section", tag("p", ENTRY, class_="quiet"), id="entry")


def formulas(shown: Shown, quantity: str, drawn: Html) -> Html:
    """The right side, the same in every pose: ``drawn``, the entries of a quantity, room for one that is chosen,
    parameters.
    """
    entries = tag("div", tabs(shown, quantity), drawn, class_="formulas")
    return tag("div", entries, NONE_CHOSEN, parameters(shown), class_="right", id="formulas")


def state(shown: Shown, picture: str) -> Html:
    """The left side: view and sliders; ``picture``: the address of the drawing of the server, for those without
    WebGL.
    """
    return tag("div", view(shown, picture), sliders(shown), class_="left")


def place(shown: Shown, left: str, right: str, entry: Html | None) -> Html:
    """The whole: :func:`state`, and :func:`formulas` in this pose with an entry."""
    right = Html(right if entry is None else right.replace(NONE_CHOSEN, entry, 1))
    work = tag("div", Html(left), right, class_="place", id="place", data_model=model_data(shown))
    return html(_jumps(shown), work)


def _jumps(shown: Shown) -> Html:
    """To what is below each other where the screen is narrow."""
    places = [("model", "#view"), ("state", "#sliders"), ("formulas", "#formulas"), ("about", "#about")]
    places += [("motion", f"{shown.path}/motion")] if shown.kind == "trees" else []
    return tag("nav", [link(*each) for each in places], class_="jumps", aria_label="On this page")


def model_data(shown: Shown) -> str:
    """What scripts begin with, as JSON."""
    return orjson.dumps(described(shown)).decode()


def view(shown: Shown, picture: str) -> Html:
    """Where the model is drawn: the drawing of the server until there is another one."""
    drawn = tag("img", src=picture, alt=f"Picture of {shown.reference}", width="640", height="480", id="picture")
    return tag("div", drawn, id="view", class_="view")


def sliders(shown: Shown) -> Html:
    """The state, as a form that works without scripts, too."""
    values = shown.chart.values(shown.pose or shown.chart.rest)
    rows = [_slider(shown, k, name, values[k]) for k, name in enumerate(shown.chart.labels)]
    random = tag("button", "random", type="button", id="random", hidden="hidden")
    send = tag("button", "Numbers in this pose", type="submit", id="send")
    told = tag(
        "p", tag("span", "eigenvalues of M: ", class_="quiet"), tag("output", id="eigenvalues"), class_="small told"
    )
    return tag(
        "form", rows, tag("p", random, send), told if rows else None, method="get", action=shown.path, id="sliders"
    )


def _slider(shown: Shown, k: int, name: str, value: float) -> Html:
    """A row of the state: a slider with its number, and its rate."""
    unit, (low, high), at = {"P": "m", "R": "rad"}[shown.joints[k]], shown.ranges[k], repr(value)
    span = {"min": repr(low), "max": repr(high), "step": repr((high - low) / STEPS)}
    any_ = {"min": repr(-LARGEST), "max": repr(LARGEST), "step": "any"}
    told = name if name in shown.chart.positions else f"rotation vector, with the rate {name}"
    return tag(
        "div",
        tag("label", name, for_=f"q{k}", title=told),
        tag("input", type="range", id=f"q{k}", value=at, data_q=k, **span),
        tag("input", type="number", name="q", value=at, data_number=k, aria_label=f"{name} in {unit}", **any_),
        tag("span", unit, class_="quiet unit"),
        tag("input", type="number", value="0", data_rate=k, aria_label=f"rate of {shown.coordinates[k]}", **any_),
        tag("span", f"{unit}/s", class_="quiet unit"),
        class_="slider",
    )


def parameters(shown: Shown) -> Html:
    """A table of parameters to be changed; nothing where there are none."""
    vector = shown.interface.vectors["p"]
    rows = [
        tag(
            "tr",
            tag("th", tag("code", name), scope="row"),
            tag("td", tag("input", type="number", step="any", data_p=k, value=_default(x), aria_label=name)),
            tag("td", unit, class_="quiet"),
            tag("td", tag("button", "reset", type="button", data_reset=k, hidden="hidden")),
        )
        for k, (name, unit, x) in enumerate(zip(vector.names, vector.units, vector.defaults, strict=True))
    ]
    if not rows:
        return Html()
    everything = tag("button", "reset all", type="button", id="reset", hidden="hidden")
    summary = tag("summary", f"{len(rows)} parameters ", tag("span", id="changed", class_="quiet"))
    table = tag("table", tag("tbody", rows, id="parameters"))
    return tag("details", summary, everything, tag("div", table, class_="scroll"), class_="parameters")


def _default(x: float) -> str:
    return "" if x != x else repr(x)


def requests(shown: Shown, address: str) -> Html:
    """The same as requests, to be copied: of a tree numbers in the pose, of a part the formula."""
    texts = _numbers(shown, address) if shown.kind == "trees" else _formula(shown.reference, address)
    each = [
        tag("details", tag("summary", name), tag("pre", tag("code", text), tabindex="0"))
        for name, text in texts.items()
    ]
    json = link("JSON", f"/v1/{shown.kind}/{shown.reference}")
    return html(tag("h2", "As a request"), tag("p", json), tag("div", each, class_="copies", id="requests"))


def _numbers(shown: Shown, address: str) -> dict[str, str]:
    pose = list(shown.pose or shown.chart.rest)
    body = orjson.dumps({"q": pose, "quantities": ["metric"]}).decode()
    url = f"{address}/v1/trees/{shown.reference}/evaluations"
    return {
        "curl": f"curl -s {url} -H 'Content-Type: application/json' -d '{body}'",
        "Python": _python(address, f'client.evaluate("{shown.reference}", q={pose}, quantities=["metric"])'),
        "MATLAB": f'webwrite("{url}", struct("q", {pose}, "quantities", {{{{"metric"}}}}), '
        'weboptions("MediaType", "application/json"))',
    }


def _formula(reference: str, address: str) -> dict[str, str]:
    url = f"{address}/v1/substructures/{reference}/formulas/metric?format=text"
    python = _python(address, f'client.part_formula("{reference}", "metric", "text")')
    return {"curl": f"curl -s '{url}'", "Python": python, "MATLAB": f'webread("{url}")'}


def _python(address: str, call: str) -> str:
    return f'from substructures.client import Client\n\nwith Client("{address}") as client:\n    print({call})'
