"""Frames of an SDF file by their full names, ``model::link``: poses relative to each other, resolved on demand."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from substructures.array import Array
from substructures.errors import among
from substructures.interchange.merge import vector
from substructures.interchange.numbers import Triple, triple, value
from substructures.interchange.report import Place, refuse
from substructures.interchange.rotations import from_quaternion, from_rpy, turn
from substructures.interchange.xml import Node, numbers_in

WORLD = "world"
#: R and origin in the frame of the outermost model
Pose = tuple[Array, Array]
HERE: Pose = (np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Framed:
    """A pose relative to a frame by its full name: its own, or that of ``placement``, which is given relative to it."""

    relative_to: str
    R: Array
    r: Array
    place: Place
    placement: str = ""


@dataclass
class Frames:
    """All frames of the file by their full names, ``model::link``; resolved on demand."""

    given: dict[str, Framed] = field(default_factory=dict)
    _known: dict[str, Pose] = field(default_factory=lambda: {"": HERE})
    _inside: dict[str, Pose | None] = field(default_factory=dict)  #: of placement frames, in what they place

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
                message = "the world is no frame of a model: a frame that places one is given in it"
                raise refuse(place, "unknown-frame", message)
            if here not in self.given:
                raise refuse(place, "unknown-frame", f"there is no frame '{here}'{among(here, self.given)}")
            if here in chain:
                raise refuse(place, "cycle", f"the frame '{here}' is placed relative to itself")
            chain[here] = None
            here = self.given[here].relative_to
        for each in reversed(chain):
            own = self.given[each]
            found = _beyond(self._known[own.relative_to], (own.R, own.r))
            if own.placement:
                R, r = self._placement(each, own)
                found = _beyond(found, (R.T, -R.T @ r))
            self._known[each] = found
        return self._known[name]

    def _placement(self, name: str, own: Framed) -> Pose:
        """Of a placement frame, in the frame that it places, and that it has to be given in."""
        if name not in self._inside:
            self._inside[name] = None  # until it is known
            self._inside[name] = Frames(self.given, {name: HERE}, self._inside).pose(own.placement, own.place)
        found = self._inside[name]
        if found is None:
            raise refuse(own.place, "cycle", f"the frame '{name}' is placed by one that is not given in it")
        return found


def _beyond(one: Pose, other: Pose) -> Pose:
    """A pose that is given in one."""
    return one[0] @ other[0], one[1] + one[0] @ other[1]


def place_in(frame: Pose, r: Array) -> Triple:
    """A point in a frame that is given beside it, without what is only rounding of both places."""
    return vector(frame[0].T @ (r - frame[1]), float(max(np.abs(r).max(), np.abs(frame[1]).max())))


def full_name(prefix: str, name: str) -> str:
    """Of a name in a model; the world is the frame in which the outermost model stands."""
    if name == WORLD:
        return ""
    return f"{prefix}__model__" if name == "__model__" else prefix + name


def is_true(text: str) -> bool:
    """Of a bool of the format."""
    return text.strip().lower() in ("1", "true")


def by_placement(own: Framed, node: Node, prefix: str) -> Framed:
    """A model's pose as that of its frame ``placement_frame``, where it has this attribute."""
    name = node.attributes.get("placement_frame", "")
    return replace(own, placement=full_name(prefix, name)) if name else own


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
        elif is_true(pose.attributes.get("degrees", "")):
            roll, pitch, yaw = np.radians([value(n) for n in numbers[3:]])
            R = turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)
        else:
            R = from_rpy(triple(numbers[3:]))
    # 'frame' until SDF 1.6
    given = "" if pose is None else pose.attributes.get("relative_to") or pose.attributes.get("frame", "")
    return Framed(full_name(prefix, given) if given else default, R, r, place)
