"""Parts whose loops have a closed form, one of every kind, for the tests of the reduced level."""

from __future__ import annotations

from typing import Any

from closed_trees import tree_model

from substructures import Model

Plain = dict[str, Any]
INERTIA = {"xx": "0.01", "yy": "0.02", "zz": "0.02"}
FLAT = {"axis": [1, 0, 0], "placement": {}}


def body(name: str, parent: str, coordinate: str, **joint: Any) -> Plain:
    """On a hinge about the third axis, by default."""
    turning = {"type": "revolute", "coordinate": coordinate, **joint}
    return {"name": name, "parent": parent, "joint": turning, "mass": 1, "com": [0.1, 0.05, 0.02], "inertia": INERTIA}


def part(name: str, lengths: Plain, bodies: list[Plain], ends: Plain, closure: Plain, start: Plain) -> Plain:
    """``ends``: places by port and body; independent is the first coordinate of ``start``."""
    ports = [{"name": port, "body": on, "position": place} for port, (on, place) in ends.items()]
    return {
        "name": name,
        "parameters": {x: {"value": value, "unit": "m"} for x, value in lengths.items()},
        "bodies": bodies,
        "ports": ports,
        "closures": [{"name": "loop", **closure}],
        "independent": [next(iter(start))],
        "start": start,
    }


PIN = {"type": "pin", "from": "end", "to": "tip"}
ROCKER = {"l0": "1", "l1": "0.3", "l2": "0.9", "l3": "0.7"}
CRANK, ROD = body("crank", "base", "phi"), body("rod", "crank", "psi", d="r")
COUPLER, SWING = body("coupler", "crank", "psi", d="l1"), body("rocker", "base", "chi", d="l0")
SPRUNG = body("rocker", "base", "chi", d="l0", stiffness=3, rest="0.7", damping="0.2", armature="0.1")
ENDS = {"end": ("coupler", ["l2", 0, 0]), "tip": ("rocker", ["l3", 0, 0])}
BLOCK = body("slider", "base", "x", type="prismatic", damping=1, **FLAT)
GEARED = part(
    "geared",
    ROCKER,
    [body("gear", "base", "motor"), CRANK, COUPLER, SWING],
    ENDS,
    PIN,
    {"motor": "-2.4", "psi": "-0.6", "chi": "1.5"},
)
PARTS: list[Plain] = [
    part("crank-rocker", ROCKER, [CRANK, COUPLER, SPRUNG], ENDS, PIN, {"phi": "1", "psi": "-0.6", "chi": "1.5"}),
    part("by-coupler", ROCKER, [CRANK, COUPLER, SWING], ENDS, PIN, {"psi": "-0.6", "phi": "1", "chi": "1.5"}),
    part(
        "slider-pin",
        {"r": "0.3", "l": "0.8"},
        [CRANK, ROD, BLOCK],
        {"end": ("rod", ["l", 0, 0]), "tip": ("slider", [0, 0, 0])},
        PIN,
        {"phi": "0.5", "psi": "-0.7", "x": "1"},
    ),
    part(
        "slider-cut",
        {"r": "0.3", "l": "0.8", "e": "0.1"},
        [CRANK, ROD, body("block", "rod", "chi", d="l")],
        {},
        {"type": "slider", "from": "block", "to": "base", "axis": [1, 0, 0], "placement": {"position": [0, "e", 0]}},
        {"phi": "0.5", "psi": "-0.7", "chi": "0.2"},
    ),
    part(
        "rod",
        {"l0": "1", "r": "0.3", "l": "0.9", "s": "0.7"},
        [CRANK, body("rocker", "base", "psi", d="l0")],
        {"end": ("crank", ["r", 0, 0]), "tip": ("rocker", ["s", 0, 0])},
        {"type": "rod", "from": "end", "to": "tip", "length": "l"},
        {"phi": "0.5", "psi": "1.7"},
    ),
    part(
        "inverted",
        {"l0": "1", "r": "0.3"},
        [CRANK, body("arm", "base", "psi", d="l0"), body("block", "arm", "x", type="prismatic", **FLAT)],
        {"end": ("crank", ["r", 0, 0])},
        {"type": "revolute", "from": "end", "to": "block"},
        {"phi": "0.5", "psi": "2.9", "x": "0.8"},
    ),
    part(
        "weld",
        ROCKER,
        [CRANK, COUPLER, body("rocker", "coupler", "chi", d="l2"), body("last", "rocker", "w", d="l3")],
        {"ground": ("base", ["l0", 0, 0])},
        {"type": "weld", "from": "last", "to": "ground"},
        {"phi": "1", "psi": "-0.6", "chi": "-2", "w": "1.6"},
    ),
    part(
        "yoke",
        {"r": "0.3"},
        [
            CRANK,
            body("yoke", "base", "x", type="prismatic", **FLAT),
            body("block", "yoke", "y", type="prismatic", axis=[0, 1, 0], placement={}),
        ],
        {"end": ("crank", ["r", 0, 0])},
        {"type": "pin", "from": "end", "to": "block"},
        {"phi": "0.5", "x": "0.26", "y": "0.14"},
    ),
    {**GEARED, "relations": [{"coordinate": "phi", "of": "motor", "multiplier": "-1/3", "offset": "0.2"}]},
]
ARM: Plain = {
    "name": "arm",
    "bodies": [body("a", "base", "a"), body("b", "a", "b", theta="pi/2", d="0.5")],
    "ports": [{"name": "tip", "body": "b", "position": ["0.3", 0, "0.1"]}],
}


def hull(joint: dict[str, Any]) -> dict[str, Any]:
    """A body with a port; ``joint``: that it moves by."""
    inertia = {"xx": 1, "yy": 2, "zz": 1.5, "xy": "0.1"}
    body = {"name": "hull", "parent": "base", "mass": 3, "com": [0.1, 0.2, 0], "inertia": inertia, "joint": joint}
    return {
        "name": "hull",
        "bodies": [body],
        "ports": [{"name": "deck", "body": "hull", "position": ["0.1", 0, "0.2"]}],
    }


def on_a_hull(name: str, joint: dict[str, Any], level: str | None = None, is_handed: bool = True) -> Model:
    """A linkage on a body, and two links on the last body of the linkage."""
    named = {each["name"]: each for each in PARTS}
    linkage = {"name": "x", "substructure": name, "at": "hull.deck", "placement": {"rpy": ["0.3", 0, "0.1"]}}
    hand = {"name": "hand", "substructure": "arm", "at": f"x.{named[name]['bodies'][-1]['name']}"}
    instances = [{"name": "hull", "substructure": "hull"}, linkage | ({"level": level} if level else {})]
    return tree_model(
        {"gravity": [1, "-9.81", 2], "instances": [*instances, hand] if is_handed else instances},
        {"hull": hull(joint), "arm": ARM, name: named[name]},
    )
