"""Parts whose loops have a closed form, one of every kind, for the tests of the reduced level."""

from __future__ import annotations

import math
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
#: a suspension, the upright on a ball joint and a tie rod; and a linkage with more rows than unknown coordinates
WISHBONE: Plain = {
    "name": "wishbone",
    "parameters": {"l": {"value": "0.23", "unit": "m"}},
    "bodies": [
        body("lower", "base", "lower", axis=[1, 0, 0], placement={}),
        body("upper", "base", "upper", axis=[1, 0, "0.1"], placement={"position": ["0.02", "0.1", "0.25"]}),
        body("x", "lower", "a", axis=[1, 0, 0], placement={"position": [0, "0.35", 0]}),
        body("y", "x", "b", axis=[0, 1, 0], placement={}),
        body("upright", "y", "c", axis=[0, 0, 1], placement={}),
    ],
    "ports": [
        {"name": "arm", "body": "upper", "position": [0, "l", 0]},
        {"name": "top", "body": "upright", "position": ["0.02", "-0.02", "0.25"]},
        {"name": "rack", "body": "base", "position": ["-0.12", "0.03", "0.05"]},
        {"name": "lever", "body": "upright", "position": ["-0.12", 0, "0.05"]},
    ],
    "closures": [
        {"name": "ball", "type": "ball", "from": "arm", "to": "top"},
        {"name": "tie", "type": "rod", "from": "rack", "to": "lever", "length": "0.32"},
    ],
    "independent": ["lower"],
    "start": {"lower": 0, "upper": 0, "a": 0, "b": 0, "c": 0},
    "ranges": {"lower": ["-0.4", "0.4"]},
}
BENNETT: Plain = {
    "name": "bennett",
    "parameters": {
        "a": {"value": "0.4", "unit": "m"},
        "b": {"value": "0.55", "unit": "m"},
        "alpha": {"value": "0.7", "unit": "rad"},
    },
    "bodies": [
        body("first", "base", "phi"),
        body("second", "first", "psi", placement={"position": ["a", 0, 0], "rpy": ["alpha", 0, 0]}),
        body("third", "second", "chi", placement={"position": ["b", 0, 0], "rpy": ["asin(b*sin(alpha)/a)", 0, 0]}),
        {
            "name": "end",
            "parent": "third",
            "joint": {"type": "fixed", "placement": {"position": ["a", 0, 0], "rpy": ["alpha", 0, 0]}},
        },
    ],
    "closures": [
        {
            "name": "loop",
            "type": "revolute",
            "from": "end",
            "to": "base",
            "placement": {"position": ["-b", 0, 0], "rpy": ["-asin(b*sin(alpha)/a)", 0, 0]},
        }
    ],
    "independent": ["phi"],
    "start": {"phi": 1, "psi": "2.87", "chi": -1},
    "ranges": {"phi": ["0.3", "2.8"]},
}
PARTS += [WISHBONE, BENNETT]


def hexapod() -> Plain:
    """A platform on six rods of one length, whose lower ends slide upwards: six closures that are met together."""
    slides, ports, rods = list[Plain](), list[Plain](), list[Plain]()
    for k in range(6):
        low, high = math.pi / 3 * k + 0.25 * (-1) ** k, math.pi / 3 * k - 0.28 * (-1) ** k
        foot = [repr(0.5 * math.cos(low)), repr(0.5 * math.sin(low)), 0]
        slides.append(body(f"s{k}", "base", f"s{k}", type="prismatic", placement={"position": foot}))
        top = [repr(0.2 * math.cos(high)), repr(0.2 * math.sin(high)), 0]
        ports.append({"name": f"p{k}", "body": "plate", "position": top})
        rods.append({"name": f"rod{k}", "type": "rod", "from": f"s{k}", "to": f"p{k}", "length": "0.8"})
    plate = {"name": "plate", "parent": "base", "mass": 3, "inertia": INERTIA}
    joint = {"type": "free", "coordinate": ["x", "y", "z", "a", "b", "c"]}
    names = [f"s{k}" for k in range(6)]
    return {
        "name": "hexapod",
        "bodies": [*slides, {**plate, "joint": joint}],
        "ports": ports,
        "closures": rods,
        "independent": names,
        "start": dict.fromkeys(names, 0) | {"z": "0.7", "c": "0.05"},
        "ranges": {name: ["-0.05", "0.05"] for name in names},
    }


HEXAPOD = hexapod()
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
