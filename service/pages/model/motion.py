"""The page of motions of a tree: from the state of the sliders, with inputs as expressions; modes and roots."""

from __future__ import annotations

from service.pages.forms import submit
from service.pages.html import Html, tag
from service.pages.layout import document
from service.pages.model.place import model_data, parameters, sliders, view
from service.pages.model.shown import Shown

NO_SCRIPT = "Motions are played by a script; without one the interface computes them: "
SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "4")
#: sliders beyond which they are folded at first
MANY = 12
SAVES = {"CSV": "text/csv", "npz": "application/x-npz", "picture": "image/svg+xml"}


def motion_page(shown: Shown, picture: str) -> bytes:
    """The bytes of the page; ``picture``: the address of the drawing of the server."""
    api = f"/v1/trees/{shown.reference}/simulations"
    few = len(shown.coordinates) <= MANY
    start = tag("details", tag("summary", "Start"), sliders(shown), open="open" if few else None, id="start")
    left = tag("div", view(shown, picture), _player(), start, parameters(shown), class_="left")
    saves = [tag("button", name, type="button", class_="copy", data_media=media) for name, media in SAVES.items()]
    right = tag(
        "div",
        _form(shown),
        tag("p", id="verdict", role="status"),
        tag("p", "All of it as ", saves, id="saves", class_="small bar", hidden="hidden"),
        tag("div", id="plots", class_="plot"),
        tag("h2", "Modes"),
        tag("section", tag("button", "Modes about the start", type="button", id="linearise"), tag("div", id="modes")),
        _locus(shown),
        tag("p", NO_SCRIPT, tag("code", f"POST {api}"), id="without", class_="quiet small"),
        class_="right",
    )
    place = tag("div", left, right, class_="place motion", id="place", data_model=model_data(shown))
    crumbs = [("trees", "/trees"), (shown.reference, shown.path)]
    title = tag("h1", f"Motion of {shown.reference}")
    return document(f"Motion of {shown.reference} - substructures", title, place, crumbs=crumbs)


def _player() -> Html:
    speeds = [tag("option", f"x {x}", value=x, selected="selected" if x == "1" else None) for x in SPEEDS]
    bar = tag("input", type="range", id="time", min="0", max="1", step="any", value="0", aria_label="time")
    return tag(
        "div",
        tag("button", "play", type="button", id="play"),
        tag("div", bar, tag("div", id="ticks", class_="ticks"), class_="track"),
        tag("output", "0 s", id="clock"),
        tag("select", speeds, id="speed", aria_label="speed"),
        tag("label", tag("input", type="checkbox", id="loop", checked="checked"), " loop"),
        tag("div", id="happened", class_="happened small"),
        class_="player",
        id="player",
        hidden="hidden",
    )


def _form(shown: Shown) -> Html:
    vector = shown.interface.vectors["u"]
    rows = [
        tag(
            "div",
            tag("label", name, for_=f"u{k}", title=name),
            tag("input", id=f"u{k}", data_input=name, placeholder="0", aria_label=f"{name}, {unit}"),
            tag("span", unit, class_="quiet unit"),
            class_="input",
        )
        for k, (name, unit) in enumerate(zip(vector.names, vector.units, strict=True))
    ]
    told = "Numbers or expressions in coordinates, velocities (q'), parameters and t; empty is its own, or 0."
    return tag(
        "form",
        tag(
            "label",
            "seconds ",
            tag("input", type="number", id="span", value="5", min="0.001", step="any", required="required"),
        ),
        submit("Run", id="run"),
        tag("button", "Cancel", type="button", id="cancel", hidden="hidden"),
        tag(
            "details",
            tag("summary", "Inputs, events, reactions"),
            tag("p", told, class_="quiet small"),
            rows,
            _events(shown),
            _reactions(shown),
            id="more",
        ),
        id="motion",
        class_="bar",
    )


def _events(shown: Shown) -> Html:
    like = f"{shown.coordinates[0]}; {shown.coordinates[-1]}' - 1" if shown.coordinates else ""
    return tag(
        "div",
        tag("label", "events at 0 of", for_="events"),
        tag("input", id="events", placeholder=like, title="expressions; between them semicolons"),
        tag("label", tag("input", type="checkbox", id="stop"), " stop", title="end at the first one"),
        class_="input",
    )


def _reactions(shown: Shown) -> Html:
    bases = [name for name in shown.interface.frames if name.endswith(".base")]
    options = [tag("option", name, value=name) for name in (*shown.coordinates, *bases)]
    chosen = tag("select", tag("option", "none", value=""), options, id="reactions")
    return tag("div", tag("label", "reactions at", for_="reactions"), chosen, class_="input")


def _locus(shown: Shown) -> Html:
    vector = shown.interface.vectors["p"]
    if not vector.names:
        return Html()
    options = [
        tag("option", name, value=name, data_value=repr(x) if x == x else "", data_unit=unit)
        for name, unit, x in zip(vector.names, vector.units, vector.defaults, strict=True)
    ]
    numbers = [tag("label", f"{name} ", tag("input", type="number", name=name, step="any")) for name in ("from", "to")]
    count = tag("input", type="number", name="count", value="21", min="2", max="1000")
    form = tag(
        "form",
        tag("label", "parameter ", tag("select", options, name="parameter")),
        numbers,
        tag("label", "values ", count),
        submit("Draw"),
        id="locus",
        class_="bar",
    )
    return tag("section", tag("h2", "Root locus"), form, tag("div", id="roots", class_="plot"))
