"""Frames of an SDF file by their full names, ``model::link``: poses relative to each other, resolved on demand."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from substructures.array import Array
from substructures.errors import among
from substructures.interchange.numbers import triple, value
from substructures.interchange.report import Place, refuse
from substructures.interchange.rotations import from_quaternion, from_rpy, turn
from substructures.interchange.xml import Node, numbers_in

WORLD = "world"
#: R and origin in the frame of the outermost model
Pose = tuple[Array, Array]


@dataclass(frozen=True)
class Framed:
    """A pose relative to a frame by its full name."""

    relative_to: str
    R: Array
    r: Array
    place: Place


@dataclass
class Frames:
    """All frames of the file by their full names, ``model::link``; resolved on demand."""

    given: dict[str, Framed] = field(default_factory=dict)
    _known: dict[str, Pose] = field(default_factory=dict)

    def add(self, name: str, framed: Framed) -> None:
        """A frame by its full name. Raises InvalidDocument for a second one of this name."""
        if name in self.given:
            raise refuse(framed.place, "duplicate-name", f"a second frame '{name}': give it another name")
        self.given[name] = framed

    def pose(self, name: str, place: Place) -> Pose:
        """In the outermost model. Raises InvalidDocument for frames that are not there, and circles."""
        chain: dict[str, None] = {}
        here = name
        while here not in self._known:
            if here == "":
                self._known[""] = np.eye(3), np.zeros(3)
                continue
            if here not in self.given:
                raise refuse(place, "unknown-frame", f"there is no frame '{here}'{among(here, self.given)}")
            if here in chain:
                raise refuse(place, "cycle", f"the frame '{here}' is placed relative to itself")
            chain[here] = None
            here = self.given[here].relative_to
        for each in reversed(chain):
            own = self.given[each]
            R, r = self._known[own.relative_to]
            self._known[each] = R @ own.R, r + R @ own.r
        return self._known[name]


def full_name(prefix: str, name: str) -> str:
    """Of a name in a model; the world is the frame in which the outermost model stands."""
    if name == WORLD:
        return ""
    return f"{prefix}__model__" if name == "__model__" else prefix + name


def framed(pose: Node | None, prefix: str, place: Place, default: str = "") -> Framed:
    """A <pose>: x y z roll pitch yaw, with degrees or quat_xyzw as its attributes say."""
    if pose is None or not pose.text.strip():
        R, r = np.eye(3), np.zeros(3)
    else:
        quaternion = pose.attributes.get("rotation_format", "euler_rpy") == "quat_xyzw"
        numbers = numbers_in(pose.text, 7 if quaternion else 6, pose.place, "pose")
        r = np.array([value(x) for x in numbers[:3]])
        if quaternion:
            x, y, z, w = (value(n) for n in numbers[3:])
            if not any((x, y, z, w)):
                raise refuse(pose.place, "zero-axis", "the quaternion is zero")
            R = from_quaternion((w, x, y, z))
        elif pose.attributes.get("degrees", "false") in ("true", "1"):
            roll, pitch, yaw = np.radians([value(n) for n in numbers[3:]])
            R = turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
        else:
            R = from_rpy(triple(numbers[3:]))
    # 'frame' until SDF 1.6
    given = "" if pose is None else pose.attributes.get("relative_to") or pose.attributes.get("frame", "")
    return Framed(full_name(prefix, given) if given else default, R, r, place)
