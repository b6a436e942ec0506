"""The MJCF text of a robot (https://mujoco.readthedocs.io/en/stable/XMLreference.html), with remarks at its beginning.

A joint is given in the axes of its body where nothing is moved; several joints of a body act one after the other, so
that compound joints need no bodies between. Frames that carry no mass are sites. A revolute closure equates two points
of its axis; a body that floats on another one slides along three axes, then turns.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree import ElementTree as Tree

import numpy as np

from substructures.array import Array
from substructures.errors import TooLarge
from substructures.export.robots.rigid import NOWHERE, Drive, Pose, RigidLink, Robot, between, beyond
from substructures.export.robots.text import cleaned, document, number, numbers

#: the least mass [kg] and moment of inertia [kg m^2] of a body here: MuJoCo has none below 1e-15, nor is a moment of
#: inertia there larger than the sum of the others
LEAST = 1e-12
#: bodies in bodies; MuJoCo reads elements in no more than 500 others
MOST = 480
#: moments of inertia that MuJoCo finds from six entries are right to this, relative to the largest
_MARGIN = 1e-12
#: points [m] on the third axes of its frames that a closure equates
_CONNECTED = {
    **dict.fromkeys(("ball", "spherical"), (0.0,)),
    **dict.fromkeys(("pin", "revolute"), (0.0, 1.0)),
}
_WELDED = ("weld", "fixed")
_LAWS = ("damping", "stiffness", "armature")


def mjcf(robot: Robot, name: str, reference: str, digest: str) -> bytes:
    """The file of a robot with quaternions of ball joints. Raises TooLarge for bodies in more than MOST others."""
    writer = _Writer(name, robot)
    return document(writer.root, reference, digest, writer.remarks())


@dataclass(frozen=True)
class _Seat:
    """Where a link is: the element that moves with it, and its pose there; the joints of a compound one before it."""

    element: Tree.Element
    pose: Pose = NOWHERE
    joints: tuple[tuple[Drive, Pose], ...] = ()
    depth: int = 0  #: bodies around it


class _Writer:
    """Builds ``root``."""

    def __init__(self, name: str, robot: Robot) -> None:
        self.robot, self.changed, self.left_out = robot, list[str](), list[str]()
        self.root = Tree.Element("mujoco", model=name)
        Tree.SubElement(self.root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false")
        if robot.gravity is not None:
            Tree.SubElement(self.root, "option", gravity=numbers(robot.gravity))
        self.world = Tree.SubElement(self.root, "worldbody")
        self.seats: dict[str, _Seat] = {}
        #: names that there are, of joints and of others
        self.joints = {link.drive.coordinate for link in robot.links if link.drive}
        self.names = {"world", *(link.name for link in robot.links)}
        for link in robot.links:
            self.seats[link.name] = self._seat(link)
        self._equalities()
        self._motors()

    def remarks(self) -> Iterator[str]:
        """What is not in it, or differs."""
        if any(link.drive and link.drive.limits for link in self.robot.links):
            yield "limits act in MuJoCo, by its own law"
        yield from self.changed
        left_out = [*self.left_out, *self.robot.left_out]
        if left_out:
            yield "left out, as MJCF cannot say it:"
        yield from left_out

    def _seat(self, link: RigidLink) -> _Seat:
        """Writes the link as a body, or as a site of what carries it; inside a compound joint there is neither."""
        if link.parent is None:
            return _Seat(self.world)
        carrier = self.seats[link.parent]
        pose = beyond(carrier.pose, link.pose)
        joints = carrier.joints + (((link.drive, pose),) if link.drive else ())
        if link.is_between:
            return replace(carrier, pose=pose, joints=joints)
        name = self._new("world_", self.names) if link.name == "world" else link.name
        if link.is_massless and not joints and not link.ball:
            Tree.SubElement(carrier.element, "site", {"name": name, **_placed(pose)})
            return replace(carrier, pose=pose)
        if carrier.depth == MOST:
            raise TooLarge(f"'{link.name}' in MJCF (in bodies around it)", MOST + 1, MOST)
        body = Tree.SubElement(carrier.element, "body", {"name": name, **_placed(pose)})
        self._inertial(body, link)
        if link.ball:
            self._ball(body, link, carrier.element is self.world)
        for drive, at in joints:
            self._joint(body, drive, between(pose, at))
        return _Seat(body, depth=carrier.depth + 1)

    def _inertial(self, body: Tree.Element, link: RigidLink) -> None:
        mass, tensor = max(link.mass, LEAST), _possible(link.inertia)
        if mass != link.mass or tensor is not link.inertia:
            old, new = (
                f"{number(m)} kg, {numbers(_six(J))} kg m^2" for m, J in ((link.mass, link.inertia), (mass, tensor))
            )
            self.changed.append(f"MuJoCo takes no such mass and moments of '{link.name}': {old}; here {new}")
        element = Tree.SubElement(body, "inertial", pos=numbers(link.com), mass=number(mass))
        six = _six(tensor)
        given = ("fullinertia", six) if six[3:].any() else ("diaginertia", six[:3])
        element.set(given[0], numbers(given[1]))

    def _joint(self, body: Tree.Element, drive: Drive, at: Pose) -> None:
        """``at``: the frame of the axis in the body."""
        axis = numbers(cleaned(at[0] @ drive.axis, 1.0))
        joint = Tree.SubElement(
            body, "joint", name=drive.coordinate, type="slide" if drive.is_slide else "hinge", axis=axis
        )
        if not drive.is_slide and cleaned(at[1]).any():
            joint.set("pos", numbers(cleaned(at[1])))
        if drive.limits and drive.limits[0] < drive.limits[1]:
            joint.set("range", numbers(drive.limits))
        elif drive.limits:
            self.left_out.append(f"the limits of '{drive.coordinate}', of which the first is not the lower one")
        for law in _LAWS:
            if getattr(drive, law):
                joint.set(law, number(getattr(drive, law)))
        if drive.stiffness and drive.rest:
            joint.set("springref", number(drive.rest))

    def _ball(self, body: Tree.Element, link: RigidLink, on_world: bool) -> None:
        """A ball joint, a free one or, where it is not on the world, three slides and a ball joint."""
        is_free = link.ball == "floating" and on_world
        # a free joint has one damping, slides and a ball joint have two
        groups = [link.damping] if is_free else [link.damping[:-3], link.damping[-3:]]
        if all(len(set(group)) <= 1 for group in groups):
            slides, laws = ({"damping": number(group[0])} if any(group) else {} for group in (groups[0], groups[-1]))
        else:
            slides = laws = {}
            self.left_out.append(f"the damping of the joint of '{link.name}', which differs by direction")
        if link.ball == "floating" and not is_free:
            for axis, e in zip("xyz", np.eye(3), strict=True):
                name = self._new(f"{link.name}_{axis}", self.joints)
                Tree.SubElement(body, "joint", {"name": name, "type": "slide", "axis": numbers(e), **slides})
        name = self._new(f"{link.name}_{link.ball}", self.joints)
        laws |= {"armature": number(link.armature)} if link.armature else {}
        Tree.SubElement(body, "joint", {"name": name, "type": "free" if is_free else "ball", **laws})

    def _equalities(self) -> None:
        """Relations between coordinates, and closures between sites."""
        equality = Tree.Element("equality")
        for drive in (link.drive for link in self.robot.links if link.drive):
            if drive.mimic:
                of, factor, offset = drive.mimic
                law = numbers((offset, factor, 0, 0, 0))
                Tree.SubElement(equality, "joint", joint1=drive.coordinate, joint2=of, polycoef=law)
        for loop in self.robot.loops:
            points = _CONNECTED.get(loop.type, (0.0,) if loop.type in _WELDED else ())
            for k, z in enumerate(points):
                name = loop.name if k == 0 else self._new(f"{loop.name}_{k + 1}", self.names)
                ends = {}
                for end, link, pose in (("1", loop.start, loop.start_pose), ("2", loop.end, loop.end_pose)):
                    seat = self.seats[link]
                    at = beyond(seat.pose, beyond(pose, (np.eye(3), np.array([0, 0, z]))))
                    ends[f"site{end}"] = site = self._new(f"{name}_site{end}", self.names)
                    Tree.SubElement(seat.element, "site", {"name": site, **_placed(at)})
                Tree.SubElement(equality, "weld" if loop.type in _WELDED else "connect", {"name": name, **ends})
            if not points:
                self.left_out.append(f"the closure '{loop.name}' ({loop.type})")
        if len(equality):
            self.root.append(equality)

    def _motors(self) -> None:
        """One at each coordinate of one joint."""
        actuator = Tree.Element("actuator")
        for drive in (link.drive for link in self.robot.links if link.drive):
            if not drive.mimic:
                Tree.SubElement(actuator, "motor", name=drive.coordinate, joint=drive.coordinate)
        if len(actuator):
            self.root.append(actuator)

    def _new(self, wanted: str, known: set[str]) -> str:
        """A name that is not known, and is from then on."""
        while wanted in known:
            wanted += "_"
        known.add(wanted)
        return wanted


def _placed(pose: Pose) -> dict[str, str]:
    """Position and axes, where there are any."""
    R, r = cleaned(pose[0], 1.0), cleaned(pose[1])
    found = {"pos": numbers(r)} if r.any() else {}
    return found if np.array_equal(R, np.eye(3)) else found | {"xyaxes": numbers((*R[:, 0], *R[:, 1]))}


def _six(tensor: Array) -> Array:
    """xx, yy, zz, xy, xz, yz."""
    return tensor[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)]


def _possible(tensor: Array) -> Array:
    """The same tensor or, where MuJoCo would not take it, one with the two lesser moments raised."""
    is_diagonal = np.array_equal(tensor, np.diag(np.diag(tensor)))
    low, mid, high = sorted(np.diag(tensor)) if is_diagonal else np.linalg.eigvalsh(tensor)
    margin = 0.0 if is_diagonal else _MARGIN * high
    if low >= LEAST and low + mid >= high + margin:
        return tensor
    _, axes = np.linalg.eigh(tensor)
    high, mid = max(high, LEAST), max(mid, LEAST)
    return axes @ np.diag([max(low, LEAST, high - mid + margin), mid, high]) @ axes.T
