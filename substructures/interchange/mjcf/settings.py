"""What holds for a whole MJCF file: compiler settings, default classes, attributes with both applied."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import among
from substructures.interchange.numbers import Number, decimal_of, multiple_of_pi, value
from substructures.interchange.report import refuse
from substructures.interchange.rotations import from_axis_angle, from_quaternion, from_z_axis, turn
from substructures.interchange.xml import Node

MAIN = "main"
#: what defaults for any kind of actuator are kept as
ACTUATOR = "actuator"
_ACTUATORS = (
    "general", "motor", "position", "velocity", "intvelocity", "orientation", "pid", "damper", "cylinder", "muscle",
    "adhesion", "dcmotor",
)  # fmt: skip
#: what defaults of a kind make of all actuators: forces of feedback, or those of an input alone
_FORCES: dict[str, dict[str, str]] = {
    **{x: {"biastype": "affine"} for x in ("position", "velocity", "intvelocity", "cylinder", "muscle", "dcmotor")},
    "damper": {"gaintype": "affine"}, "motor": {"biastype": "none", "gaintype": "fixed", "dyntype": "none"},
}  # fmt: skip
_ORIENTATIONS = ("quat", "axisangle", "xyaxes", "zaxis", "euler")
_YES = {"true": True, "false": False}


@dataclass(frozen=True)
class Compiler:
    """The attributes of <compiler> that change mechanics, with their defaults."""

    degrees: bool = True
    eulerseq: str = "xyz"
    autolimits: bool = True
    inertiafromgeom: str = "auto"
    inertiagrouprange: tuple[float, float] = (0, 5)
    boundmass: float = 0
    boundinertia: float = 0
    settotalmass: float = -1
    balanceinertia: bool = False
    exactmeshinertia: bool = False
    meshdir: str = ""
    strippath: bool = False

    @classmethod
    def of(cls, root: Node) -> Compiler:
        """Of all <compiler> elements in turn. Raises InvalidDocument for settings that are not known any more."""
        found = cls()
        for node in root.all("compiler"):
            found = found._with(node)
        return found

    def _with(self, node: Node) -> Compiler:
        given = node.attributes
        if given.get("coordinate", "local") != "local":
            raise refuse(node.place, "global-coordinates", "coordinate='global' is no longer in MJCF: use 'local'")
        changes: dict[str, Any] = {name: read(node) for name, read in _SETTINGS.items() if name in given}
        if "assetdir" in changes:
            changes = {"meshdir": changes.pop("assetdir"), **changes}
        if "angle" in changes:
            changes["degrees"] = changes.pop("angle") == "degree"
        return replace(self, **changes)

    def angle(self, x: Number) -> Number:
        """An angle of the file in rad; exact multiples of pi of whole degrees."""
        if not self.degrees:
            return x
        degrees = Fraction(str(x))
        if (degrees / 15).denominator == 1:
            return multiple_of_pi(degrees / 180)
        return decimal_of(math.radians(float(degrees)))


def name_of(node: Node, otherwise: str, taken: Container[str]) -> str:
    """Its name; ``otherwise`` where it has none, with as much behind it that it is none of those taken in the file."""
    while otherwise in taken:
        otherwise += "_"
    return node.attributes.get("name", otherwise)


def names_of(nodes: Iterable[Node]) -> set[str]:
    """Those that are given."""
    return {node.attributes["name"] for node in nodes if "name" in node.attributes}


def range_of(node: Node, compiler: Compiler) -> tuple[Number, Number] | None:
    """The limits of a joint or tendon, in the units of the file, None of one that has none.

    Without ``limited`` a range of which the first number is not below the second, such as 0 0, is none; with it, it is
    refused. Raises InvalidDocument.
    """
    limited = node.attributes.get("limited", "auto")
    if "range" not in node.attributes or limited == "false" or (limited == "auto" and not compiler.autolimits):
        return None
    low, high = node.numbers("range", 2)
    if value(low) < value(high):
        return low, high
    if limited == "true":
        raise refuse(node.place, "bad-value", f"the range {low} {high} needs a first number below the second")
    return None


def _sequence(node: Node) -> str:
    found = node.text_of("eulerseq")
    if len(found) != 3 or not set(found.lower()) <= set("xyz"):
        raise refuse(node.place, "bad-value", "eulerseq needs three letters out of xyzXYZ")
    return found


def choice(node: Node, name: str, known: Sequence[str]) -> str:
    """An attribute that is one of several words. Raises InvalidDocument."""
    found = node.text_of(name)
    if found not in known:
        raise refuse(node.place, "bad-value", f"{name}='{found[:40]}' is none of {', '.join(known)}")
    return found


#: the readers of attributes of <compiler>
_SETTINGS: dict[str, Callable[[Node], Any]] = {
    "angle": lambda node: choice(node, "angle", ("radian", "degree")),
    "eulerseq": _sequence,
    "inertiafromgeom": lambda node: choice(node, "inertiafromgeom", ("true", "false", "auto")),
    "autolimits": lambda node: _YES[choice(node, "autolimits", tuple(_YES))],
    "balanceinertia": lambda node: _YES[choice(node, "balanceinertia", tuple(_YES))],
    "exactmeshinertia": lambda node: _YES[choice(node, "exactmeshinertia", tuple(_YES))],
    "strippath": lambda node: _YES[choice(node, "strippath", tuple(_YES))],
    "assetdir": lambda node: node.text_of("assetdir"),
    "meshdir": lambda node: node.text_of("meshdir"),
    "boundmass": lambda node: value(node.number("boundmass")),
    "boundinertia": lambda node: value(node.number("boundinertia")),
    "settotalmass": lambda node: value(node.number("settotalmass")),
    "inertiagrouprange": lambda node: tuple(map(value, node.numbers("inertiagrouprange", 2))),
}


class Defaults:
    """Default classes: the attributes that elements of a tag have where they say nothing else.

    All actuators have the same: what <motor> says there holds for <general>, too, and what comes later replaces it.
    """

    def __init__(self, root: Node) -> None:
        self._classes: dict[str, dict[str, dict[str, str]]] = {MAIN: {}}
        for node in root.all("default"):
            self._read(node, {}, MAIN)

    def _read(self, node: Node, inherited: dict[str, dict[str, str]], name: str) -> None:
        known = self._classes.get(name, {}) if name == MAIN else {}
        own = {tag: dict(attributes) for tag, attributes in (known or inherited).items()}
        for child in node.children:
            if child.tag != "default":
                tag = ACTUATOR if child.tag in _ACTUATORS else child.tag
                own[tag] = _over(own.get(tag, {}), _FORCES.get(child.tag, {}) | child.attributes)
        self._classes[name] = own
        for child in node.all("default"):
            self._read(child, own, child.text_of("class"))

    def applied(self, node: Node, childclass: str | None) -> Node:
        """The element with the attributes of its class. Raises InvalidDocument for a class that is not there."""
        name = node.attributes.get("class", childclass or MAIN)
        if name not in self._classes:
            message = f"there is no default class '{name[:60]}'{among(name, self._classes)}"
            raise refuse(node.place, "unknown-class", message)
        return replace(node, attributes=_over(self._classes[name].get(node.tag, {}), node.attributes))


def _over(inherited: Mapping[str, str], given: Mapping[str, str]) -> dict[str, str]:
    """Attributes over inherited ones: any orientation is in the place of another, and of a size those numbers are that
    are given.
    """
    left = dict(inherited)
    if any(k in given for k in _ORIENTATIONS):
        left = {k: v for k, v in inherited.items() if k not in _ORIENTATIONS}
    found = {**left, **given}
    if "size" in inherited and "size" in given:
        sizes = given["size"].split()
        found["size"] = " ".join([*sizes, *inherited["size"].split()[len(sizes) :]])
    return found


def orientation(node: Node, compiler: Compiler) -> Array:
    """R of an element by quat, axisangle, xyaxes, zaxis or euler. Raises InvalidDocument for several of them."""
    given = [name for name in _ORIENTATIONS if name in node.attributes]
    if len(given) > 1:
        raise refuse(node.place, "two-orientations", f"give one of {' and '.join(given)}")
    if not given:
        return np.eye(3)
    counts = {"quat": 4, "axisangle": 4, "xyaxes": 6, "zaxis": 3, "euler": 3}
    numbers = [value(x) for x in node.numbers(given[0], counts[given[0]])]
    if given[0] == "euler":
        return _euler(node, compiler)
    if np.linalg.norm(numbers[:3] if given[0] == "axisangle" else numbers) < 1e-14:
        raise refuse(node.place, "zero-axis", f"{given[0]} has no direction")
    if given[0] == "quat":
        return from_quaternion(numbers)
    if given[0] == "axisangle":
        by = compiler.angle(node.numbers("axisangle", 4)[3])
        return from_axis_angle(numbers[:3], value(by))
    return from_z_axis(numbers) if given[0] == "zaxis" else _xyaxes(node, numbers)


def _euler(node: Node, compiler: Compiler) -> Array:
    """Small letters: about axes that turn along, R = R R_i; capital letters: about fixed axes, R = R_i R."""
    R = np.eye(3)
    for letter, x in zip(compiler.eulerseq, node.numbers("euler", 3), strict=True):
        one = turn("xyz".index(letter.lower()), value(compiler.angle(x)))
        R = R @ one if letter.islower() else one @ R
    return R


def _xyaxes(node: Node, six: list[float]) -> Array:
    """The y axis is made orthogonal to the x axis."""
    x, y = np.array(six[:3]), np.array(six[3:])
    x = x / max(np.linalg.norm(x), 1e-300)
    y = y - x * (x @ y)
    if np.linalg.norm(x) < 0.5 or np.linalg.norm(y) < 1e-14:
        raise refuse(node.place, "zero-axis", "xyaxes needs two directions")
    y = y / np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])
