"""The page of motions of a tree: from the state of the sliders, with inputs as expressions; and modes about it."""

from __future__ import annotations

from service.pages.html import Html, link, tag
from service.pages.layout import document
from service.pages.model.place import model_data, sliders, view
from service.pages.model.shown import Shown

NO_SCRIPT = "Motions are played by a script; without one the interface computes them: "


def motion_page(shown: Shown, picture: str) -> bytes:
    """The bytes of the page; ``picture``: the address of the drawing of the server."""
    api = f"/v1/trees/{shown.reference}/simulations"
    left = tag("div", view(shown, picture), _player(), sliders(shown), class_="left")
    right = tag(
        "div",
        _form(shown),
        tag("p", id="verdict", role="status"),
        tag("div", id="plots", class_="plot"),
        tag("section", tag("button", "Modes about this state", type="button", id="linearise"), tag("div", id="modes")),
        tag("p", NO_SCRIPT, tag("code", f"POST {api}"), id="without", class_="quiet small"),
        class_="right",
    )
    place = tag("div", left, right, class_="place", id="place", data_model=model_data(shown))
    title = tag("h1", link(f"Tree {shown.reference}", shown.path), ": motion")
    return document(f"Motion of {shown.reference} - substructures", title, place)


def _player() -> Html:
    speeds = [tag("option", f"x {x}", value=x, selected="selected" if x == "1" else None) for x in SPEEDS]
    return tag(
        "div",
        tag("button", "play", type="button", id="play"),
        tag("input", type="range", id="time", min="0", max="1", step="any", value="0", aria_label="time"),
        tag("output", "0 s", id="clock"),
        tag("select", speeds, id="speed", aria_label="speed"),
        class_="player",
        id="player",
        hidden="hidden",
    )


SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "4")


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
    told = "Inputs: numbers or expressions in coordinates, velocities (q'), parameters and t"
    inputs = tag("details", tag("summary", told), rows)
    return tag(
        "form",
        tag("label", "seconds ", tag("input", type="number", id="span", value="5", min="0.001", step="any")),
        tag("button", "Run", type="submit", id="run"),
        tag("a", "CSV", id="csv", hidden="hidden", download=f"{shown.reference.replace('@', '-')}.csv"),
        inputs,
        id="motion",
        class_="bar",
    )
