"""The URDF text of links (http://wiki.ros.org/urdf/XML), and what it cannot say as remarks at its beginning.

An origin is a position and the angles of R = Rz(yaw) Ry(pitch) Rx(roll); an inertia is about the mass centre in the
axes of the link, ixy = -integral of x y dm. Numbers are written with as many digits as bring the same double back.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from xml.etree import ElementTree as Tree

import numpy as np

from substructures.array import Array
from substructures.export.software import SOFTWARE
from substructures.export.urdf.links import Links, Pose, RigidLink, at_zero, links_of
from substructures.expr.program import Program, array, program
from substructures.part.part import Part
from substructures.tree.assembly import Assembly, assemble
from substructures.tree.document import TreeSpec
from substructures.tree.mounted_part import WORLD

MEDIA_TYPE = "application/xml"
ROOT = "world"
#: what URDF asks for where nothing limits a joint
UNLIMITED = 1e9
#: below this it is rounding of products of rotations
_ROUNDING = 1e-15
#: puts numbers into a program
Bind = Callable[[Program], Program]


def urdf_of_part(part: Part, name: str, reference: str, digest: str, bind: Bind) -> bytes:
    """A part as it stands alone; its interface is the root link. ``bind``: puts numbers in place of parameters.

    Raises InvalidArgument for numbers that are not finite, MissingValue for parameters that have none.
    """
    return _text(name, links_of(part.definition, lambda p: at_zero(bind(p), {})), reference, digest)


def urdf_of_tree(
    spec: TreeSpec, parts: Mapping[str, Part], name: str, reference: str, digest: str, bind: Bind
) -> bytes:
    """A tree with its parts by instance; the root link is the world, names are those of the tree (``arm.link1``).

    Raises InvalidDocument, InvalidArgument, MissingValue as of parts.
    """
    assembly = assemble(spec, parts)
    numbers = at_zero(bind(_values(assembly)), {})
    links, left_out = [RigidLink(ROOT, None)], list(_not_of_trees(spec))
    for k, (instance, mounted) in enumerate(zip(assembly.instances, assembly.mounted, strict=True)):
        own = dict(zip(mounted.part.parameters, numbers[f"parameters.{k}"].tolist(), strict=True))
        found = links_of(mounted.part.definition, lambda p, own=own: at_zero(p, own), f"{instance.name}.")  # type: ignore[misc]
        host = ROOT
        if mounted.host != WORLD:
            frame = assembly.mounted[mounted.host].part.frames[mounted.frame]
            host = f"{assembly.instances[mounted.host].name}.{frame}"
        place: Pose = (numbers[f"E.{k}"].T, numbers[f"position.{k}"])
        links += [replace(found.links[0], parent=host, pose=place), *found.links[1:]]
        left_out += found.left_out
    return _text(name, Links(tuple(links), tuple(left_out)), reference, digest)


def _values(assembly: Assembly) -> Program:
    """Of every instance its parameters and its placement, as formulas in the parameters of the tree."""
    graph, outputs = assembly.scope.graph, {}
    for k, (instance, m) in enumerate(zip(assembly.instances, assembly.mounted, strict=True)):
        own = [assembly.reading.parameter(f"{instance.name}.{name}") for name in m.part.parameters]
        outputs[f"parameters.{k}"] = array((len(own),), lambda i, own=own: own[i])
        outputs[f"E.{k}"] = array((3, 3), lambda i, j, E=m.E: E[i][j])
        outputs[f"position.{k}"] = array((3,), lambda i, r=m.position: r[i])
    return program(graph, outputs, assembly.scope.symbols)


def _not_of_trees(spec: TreeSpec) -> Iterator[str]:
    for closure in spec.closures:
        yield f"the closure '{closure.name}' ({closure.type}): URDF has no loops"
    for load in spec.loads:
        yield f"the load '{load.name}' ({load.type})"
    for name in spec.driven:
        yield f"the given motion of '{name}'"
    for name in spec.ignored:
        yield f"the given momentum of '{name}'"
    for contact in spec.contacts:
        yield f"the contact '{contact.name}'"
    for each in spec.velocity_constraints:
        yield f"the velocity constraint '{each.name}' ({each.type})"


def _text(name: str, made: Links, reference: str, digest: str) -> bytes:
    root = Tree.Element("robot", name=name)
    for line in _head(made, reference, digest):
        root.append(Tree.Comment(f" {re.sub('-(?=-|$)', '- ', line)} "))
    for link in made.links:
        root.append(_link(link))
        if link.parent is not None:
            root.append(_joint(link, link.parent))
    Tree.indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + Tree.tostring(root, "us-ascii", xml_declaration=False) + b"\n"


def _head(made: Links, reference: str, digest: str) -> Iterator[str]:
    """Where it is from, and what is not in it."""
    title, _, number = reference.partition("@")
    yield f"{title}{f' version {number}' if number else ''}, {digest}, written by {SOFTWARE}; units: m, kg, rad, s"
    slides = [link.drive.coordinate for link in made.links if link.drive and link.drive.is_slide]
    free = [link.drive.coordinate for link in made.links if link.drive and not link.drive.limits]
    if any(link.drive for link in made.links):
        yield f"limits that are not known are {UNLIMITED:.0e}: effort and velocity of all joints" + "".join(
            f", position of '{slide}'" for slide in slides if slide in free
        )
    if made.left_out:
        yield "left out, as URDF cannot say it:"
    yield from made.left_out


def _link(link: RigidLink) -> Tree.Element:
    """A link; nothing of an inertia where there is none."""
    element = Tree.Element("link", name=link.name)
    if link.mass or link.inertia.any():
        inertial = Tree.SubElement(element, "inertial")
        Tree.SubElement(inertial, "origin", xyz=_numbers(link.com))
        Tree.SubElement(inertial, "mass", value=_number(link.mass))
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = link.inertia
        six = {"ixx": xx, "ixy": xy, "ixz": xz, "iyy": yy, "iyz": yz, "izz": zz}
        Tree.SubElement(inertial, "inertia", {key: _number(x) for key, x in six.items()})
    return element


def _joint(link: RigidLink, parent: str) -> Tree.Element:
    """The joint that carries a link, with the name of its coordinate."""
    drive, kind = link.drive, "floating" if link.floats else "fixed"
    bare = {"name": f"{link.name}_{kind}", "type": kind}
    element = Tree.Element("joint", bare if drive is None else {"name": drive.coordinate, "type": _kind(link)})
    Tree.SubElement(element, "parent", link=parent)
    Tree.SubElement(element, "child", link=link.name)
    R, r = link.pose
    Tree.SubElement(element, "origin", xyz=_numbers(_clean(r)), rpy=_numbers(_clean(rpy_of(R), 1.0)))
    if drive is None:
        return element
    Tree.SubElement(element, "axis", xyz=_numbers(_clean(drive.axis, 1.0)))
    if drive.damping:
        Tree.SubElement(element, "dynamics", damping=_number(drive.damping))
    limits = {"effort": _number(UNLIMITED), "velocity": _number(UNLIMITED)}
    low, high = drive.limits or (-UNLIMITED, UNLIMITED)
    if drive.is_slide or drive.limits:
        limits |= {"lower": _number(low), "upper": _number(high)}
    Tree.SubElement(element, "limit", limits)
    if drive.mimic is not None:
        of, multiplier, offset = drive.mimic
        Tree.SubElement(element, "mimic", joint=of, multiplier=_number(multiplier), offset=_number(offset))
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
    return np.array([math.atan2(R[2, 1], R[2, 2]), pitch, math.atan2(R[1, 0], R[0, 0])])


def _clean(x: Array, scale: float | None = None) -> Array:
    """Without what is only rounding."""
    largest = float(np.abs(x).max(initial=0)) if scale is None else scale
    return np.where(np.abs(x) <= _ROUNDING * largest, 0.0, x)


def _numbers(x: Sequence[float] | Array) -> str:
    return " ".join(map(_number, x))


def _number(x: float) -> str:
    """The shortest decimal that is this double; 0 and 2 without a point."""
    x = float(x) + 0.0
    return str(int(x)) if x.is_integer() and abs(x) < 1e15 else repr(x)
