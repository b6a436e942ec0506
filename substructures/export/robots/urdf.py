"""The URDF text of links (http://wiki.ros.org/urdf/XML), and what it cannot say as remarks at its beginning.

An origin is a position and the angles of R = Rz(yaw) Ry(pitch) Rx(roll); an inertia is about the mass centre in the
axes of the link, ixy = -integral of x y dm.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.etree import ElementTree as Tree

import numpy as np

from substructures.array import Array
from substructures.export.robots.rigid import RigidLink, Robot
from substructures.export.robots.text import cleaned, document, number, numbers

#: what URDF asks for where nothing limits a joint
UNLIMITED = 1e9


def urdf(robot: Robot, name: str, reference: str, digest: str) -> bytes:
    """The file of a robot with angles in place of the quaternions of ball joints."""
    root = Tree.Element("robot", name=name)
    for link in robot.links:
        root.append(_link(link))
        if link.parent is not None:
            root.append(_joint(link, link.parent))
    return document(root, reference, digest, _remarks(robot))


def _remarks(robot: Robot) -> Iterator[str]:
    """What is not in it."""
    drives = [link.drive for link in robot.links if link.drive]
    if drives:
        free = (f", position of '{drive.coordinate}'" for drive in drives if drive.is_slide and not drive.limits)
        yield f"limits that are not known are {UNLIMITED:.0e}: effort and velocity of all joints" + "".join(free)
    left_out = [*_left_out(robot), *robot.left_out]
    if left_out:
        yield "left out, as URDF cannot say it:"
    yield from left_out


def _left_out(robot: Robot) -> Iterator[str]:
    for link in robot.links:
        if any(link.damping):
            yield f"the damping of the joint of '{link.name}'"
        if link.armature:
            yield f"the armature {link.armature!r} of the joint of '{link.name}'"
        if link.ball == "ball":
            yield f"the quaternion of '{link.name}': yaw, pitch, roll here"
        if link.drive and link.drive.stiffness:
            yield f"the spring of '{link.drive.coordinate}'"
        if link.drive and link.drive.armature:
            yield f"the armature {link.drive.armature!r} of '{link.drive.coordinate}'"
    for loop in robot.loops:
        yield f"the closure '{loop.name}' ({loop.type}): URDF has no loops"


def _link(link: RigidLink) -> Tree.Element:
    """A link; nothing of an inertia where there is none."""
    element = Tree.Element("link", name=link.name)
    if not link.is_massless:
        inertial = Tree.SubElement(element, "inertial")
        Tree.SubElement(inertial, "origin", xyz=numbers(link.com))
        Tree.SubElement(inertial, "mass", value=number(link.mass))
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = link.inertia
        six = {"ixx": xx, "ixy": xy, "ixz": xz, "iyy": yy, "iyz": yz, "izz": zz}
        Tree.SubElement(inertial, "inertia", {key: number(x) for key, x in six.items()})
    return element


def _joint(link: RigidLink, parent: str) -> Tree.Element:
    """The joint that carries a link, with the name of its coordinate."""
    drive, kind = link.drive, link.ball if link.ball == "floating" else "fixed"
    bare = {"name": f"{link.name}_{kind}", "type": kind}
    element = Tree.Element("joint", bare if drive is None else {"name": drive.coordinate, "type": _kind(link)})
    Tree.SubElement(element, "parent", link=parent)
    Tree.SubElement(element, "child", link=link.name)
    R, r = link.pose
    Tree.SubElement(element, "origin", xyz=numbers(cleaned(r)), rpy=numbers(cleaned(rpy_of(R), 1.0)))
    if drive is None:
        return element
    Tree.SubElement(element, "axis", xyz=numbers(cleaned(drive.axis, 1.0)))
    if drive.damping:
        Tree.SubElement(element, "dynamics", damping=number(drive.damping))
    limits = {"effort": number(UNLIMITED), "velocity": number(UNLIMITED)}
    low, high = drive.limits or (-UNLIMITED, UNLIMITED)
    if drive.is_slide or drive.limits:
        limits |= {"lower": number(low), "upper": number(high)}
    Tree.SubElement(element, "limit", limits)
    if drive.mimic is not None:
        of, multiplier, offset = drive.mimic
        Tree.SubElement(element, "mimic", joint=of, multiplier=number(multiplier), offset=number(offset))
    return element


def _kind(link: RigidLink) -> str:
    drive = link.drive
    if drive is not None and drive.is_slide:
        return "prismatic"
    return "revolute" if drive is not None and drive.limits else "continuous"


def rpy_of(R: Array) -> Array:
    """Roll, pitch, yaw of R = Rz(yaw) Ry(pitch) Rx(roll); yaw is 0 where only its sum with roll is known."""
    across = math.hypot(R[0, 0], R[1, 0])
    pitch = math.atan2(-R[2, 0], across)
    if across < 1e-12:
        return np.array([math.atan2(-R[1, 2], R[1, 1]), pitch, 0.0])
    roll = math.atan2(R[2, 1], R[2, 2])
    # of R Rx(-roll): what rounding does to roll where |cos(pitch)| is small, yaw takes back
    y = math.cos(roll) * R[:, 1] - math.sin(roll) * R[:, 2]
    return np.array([roll, pitch, math.atan2(-y[0], y[1])])
