"""URDF (http://wiki.ros.org/urdf/XML): links with inertial origins, joints with axes in any direction.

A joint's frame is the frame of its child link; its axis is given there, and mass and inertia in the frame of the
inertial origin: with the rotation R of that origin the tensor in the link's axes is R I R^T. The products of inertia
are entries of the tensor, ixy = -integral of x y dm.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from substructures.errors import among, meant
from substructures.interchange.bindings import mimic_of
from substructures.interchange.known.check import acting
from substructures.interchange.known.urdf import URDF
from substructures.interchange.merge import judge, ordered_limits
from substructures.interchange.numbers import (
    ONE,
    ORIGIN,
    ZERO,
    Number,
    Triple,
    angle,
    axis_of,
    direction,
    is_zero,
    triple,
    undusted,
    value,
)
from substructures.interchange.report import Report, refuse
from substructures.interchange.robot import Inertial, Link, Mimic, Motion, MotionType, Robot, in_order
from substructures.interchange.rotations import from_rpy, from_z_axis, turned_inertia
from substructures.interchange.urdf.transmissions import armatures
from substructures.interchange.xml import Node

X_AXIS: Triple = (ONE, ZERO, ZERO)
_MOTION: dict[str, MotionType] = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical")
WORLD = "world"
#: elements without influence on the equations of motion
_SHOWN_ONLY = {
    "visual": "how it looks", "collision": "contacts", "contact": "contacts", "sensor": "sensors",
    "self_collision_checking": "contacts", "material": "colours", "gazebo": "what another program needs",
    "ros2_control": "controllers", "safety_controller": "controllers", "calibration": "calibration",
    "mujoco": "what another program needs", "collision_filter_group": "contacts", "frame": "frames",
}  # fmt: skip
#: what other programs take as mechanics in their own elements, and the values with which it is none
_ACTING: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("springStiffness", "dampingFactor", "boundmass", "boundinertia"), ("0", "0.0", "")),
    **dict.fromkeys(("turnGravityOff", "balanceinertia"), ("0", "false")),
    **dict.fromkeys(("linear_bushing_rpy", "ball_constraint", "loop_joint", "loop"), ()),
    "gravity": ("1", "true"), "inertia_scaling": ("1", "1.0"), "settotalmass": ("-1",),
    "inertiafromgeom": ("false", "auto"),
}  # fmt: skip


@dataclass(frozen=True)
class _Joint:
    """A joint of the file, read."""

    node: Node
    name: str
    type: str
    parent: str
    child: str


def read_urdf(root: Node) -> Robot:
    """The robot of a URDF document. Raises InvalidDocument with line and element."""
    if root.tag != "robot":
        raise refuse(root.place, "not-urdf", "the root of a URDF file is <robot>")
    report = Report()
    URDF.tell(root, report)
    _tell_of_others(root, report)
    links = {}
    for node in root.all("link"):
        name = node.text_of("name")
        if name in links:
            raise refuse(node.place, "duplicate-name", f"a second link '{name}': give it another name")
        links[name] = node
    if not links:
        raise refuse(root.place, "no-links", "the robot has no <link>")
    _with_world(root, links, report)
    joints = list(_joints(root, links))
    made = [_root(links, joints, report)]
    mimics: list[Mimic] = []
    single = {joint.name: joint.type in _MOTION for joint in joints}
    rotors = armatures(root, single, report)
    for joint in joints:
        made.append(_link(joint, links[joint.child], rotors, report))
        mimics += _mimic(joint, single, report)
    return Robot(root.attributes.get("name", ""), in_order(made), report, mimics=tuple(mimics))


def _with_world(root: Node, links: dict[str, Node], report: Report) -> None:
    """The link 'world' is there without being written, where joints hang on it."""
    ends = [end for joint in root.all("joint") for end in joint.all("parent") if end.attributes.get("link") == WORLD]
    if ends and WORLD not in links:
        links[WORLD] = Node("link", {"name": WORLD}, ends[0].line)
        report.merged(ends[0].place, "the link 'world' is not in the file: it is the frame that the part stands on")


def _joints(root: Node, links: dict[str, Node]) -> Iterator[_Joint]:
    seen: set[str] = set()
    children: dict[str, str] = {}
    for node in root.all("joint"):
        name, kind = node.text_of("name"), node.text_of("type")
        if name in seen:
            raise refuse(node.place, "duplicate-name", f"a second joint '{name}': give it another name")
        if kind not in _TYPES:
            message = f"type '{kind[:40]}' is none of {', '.join(_TYPES)}{meant(kind, _TYPES)}"
            raise refuse(node.place, "unknown-type", message)
        seen.add(name)
        ends = [_end(node, tag, links) for tag in ("parent", "child")]
        if ends[1] in children:
            message = f"the link '{ends[1]}' is the child of '{children[ends[1]]}' already: a tree has one parent each"
            raise refuse(node.place, "two-parents", message)
        children[ends[1]] = name
        yield _Joint(node, name, kind, ends[0], ends[1])


def _end(node: Node, tag: str, links: dict[str, Node]) -> str:
    found = node.one(tag)
    if found is None:
        raise refuse(node.place, "missing-element", f"<{tag} link='...'/> is needed")
    name = found.text_of("link")
    if name not in links:
        raise refuse(found.place, "unknown-link", f"there is no link '{name}'{among(name, links)}")
    return name


def _root(links: dict[str, Node], joints: list[_Joint], report: Report) -> Link:
    """The one link that is nobody's child, fixed to the interface."""
    moved = {joint.child for joint in joints}
    roots = [name for name in links if name not in moved]
    if not roots:
        raise refuse(joints[0].node.place, "cycle", "every link is the child of a joint: there is a cycle")
    if len(roots) > 1:
        message = f"there are several roots ({', '.join(roots[:5])}): connect them by fixed joints to one link"
        raise refuse(links[roots[1]].place, "several-roots", message)
    node = links[roots[0]]
    return Link(roots[0], None, node.place, inertial=_inertial(node, report), has_shape=_is_shown(node))


def _link(joint: _Joint, node: Node, rotors: Mapping[str, Number], report: Report) -> Link:
    """The child link of a joint."""
    _tell_of_others(joint.node, report)
    position, rpy = _origin(joint.node)
    motions: tuple[Motion, ...] = ()
    if joint.type == "floating":
        motions = (Motion(joint.name, "free", joint.node.place),)
    elif joint.type == "spherical":  # of Bullet and MuJoCo
        motions = (Motion(joint.name, "spherical", joint.node.place),)
    elif joint.type == "planar":
        motions = _planar(joint)
    elif joint.type != "fixed":
        motions = (_motion(joint, rotors.get(joint.name, ZERO), report),)
    if motions and joint.type not in _MOTION:
        if not is_zero(_damping(joint.node, report)):
            message = f"damping of a {joint.type} joint is not read: add loads for it"
            report.lost(joint.node.place, message)
        for limit in joint.node.all("limit"):
            if {"lower", "upper"} & limit.attributes.keys():
                report.lost(limit.place, f"limits of a {joint.type} joint are not read: it moves anywhere here")
    inertial = _inertial(node, report)
    return Link(joint.child, joint.parent, node.place, position, rpy, motions, inertial, joint.name, _is_shown(node))


def _is_shown(link: Node) -> bool:
    return any(link.all("visual", "collision"))


def _motion(joint: _Joint, armature: Number, report: Report) -> Motion:
    """A joint of one degree of freedom."""
    node = joint.node
    kind = _MOTION[joint.type]
    made = Motion(joint.name, kind, node.place, _axis(node), damping=_damping(node, report), armature=armature)
    return replace(made, limits=_limits(joint, report))


def _damping(node: Node, report: Report) -> Number:
    """Of <dynamics>; its dry friction is told."""
    dynamics = node.one("dynamics")
    if dynamics is None:
        return ZERO
    if not is_zero(dynamics.number("friction", ZERO)):
        message = "dry friction is not read: add a load of the type 'friction', with a velocity, for it"
        report.lost(dynamics.place, message)
    return dynamics.number("damping", ZERO)


def _planar(joint: _Joint) -> tuple[Motion, ...]:
    """Along two axes across the given one, then about it."""
    n = _axis(joint.node)
    R = from_z_axis([value(x) for x in n])
    along = [direction(R[:, i].tolist()) for i in (0, 1)]
    place = joint.node.place
    return (
        Motion(f"{joint.name}_1", "prismatic", place, along[0]),
        Motion(f"{joint.name}_2", "prismatic", place, along[1]),
        Motion(f"{joint.name}_3", "revolute", place, n),
    )


def _axis(node: Node) -> Triple:
    axis = node.one("axis")
    if axis is None:
        return X_AXIS
    xyz = triple(axis.numbers("xyz", 3, X_AXIS))
    if all(map(is_zero, xyz)):
        raise refuse(axis.place, "zero-axis", "the axis has no direction: give a vector that is not zero")
    return axis_of(triple(undusted(xyz)))


def _limits(joint: _Joint, report: Report) -> tuple[Number, Number] | None:
    limit = joint.node.one("limit")
    if limit is None:
        return None
    if joint.type == "continuous" or not {"lower", "upper"} & limit.attributes.keys():
        return None
    low, high = limit.number("lower", ZERO), limit.number("upper", ZERO)
    found = ordered_limits(limit.place, low, high, report)
    return None if is_zero(low) and is_zero(high) else found


def _mimic(joint: _Joint, single: Mapping[str, bool], report: Report) -> list[Mimic]:
    node = joint.node.one("mimic")
    if node is None:
        return []
    factors = node.number("multiplier", ONE), node.number("offset", ZERO)
    return mimic_of(joint.name, node.text_of("joint"), factors, node.place, single, report)


def _origin(node: Node) -> tuple[Triple, Triple]:
    """Position and roll, pitch, yaw of the child <origin>; nothing where it is missing."""
    origin = node.one("origin")
    if origin is None:
        return ORIGIN, ORIGIN
    if "quat_xyzw" in origin.attributes:
        raise refuse(origin.place, "unknown-attribute", "'quat_xyzw' is not in URDF 1.1: give rpy")
    roll, pitch, yaw = map(angle, origin.numbers("rpy", 3, ORIGIN))
    return triple(undusted(origin.numbers("xyz", 3, ORIGIN))), (roll, pitch, yaw)


def _inertial(node: Node, report: Report) -> Inertial:
    """Mass, mass centre, and R I R^T."""
    _tell_of_others(node, report)
    inertial = node.one("inertial")
    if inertial is None:
        return Inertial()
    mass_of, inertia_of = inertial.one("mass"), inertial.one("inertia")
    if mass_of is None:
        raise refuse(inertial.place, "missing-element", "<mass value='...'/> is needed")
    mass = mass_of.number("value")
    com, rpy = _origin(inertial)
    if inertia_of is None:
        report.lost(inertial.place, "no <inertia>: the link is a point mass", "physics")
        return Inertial(mass, com)
    six: tuple[Number, ...] = (
        *(inertia_of.number(name) for name in ("ixx", "iyy", "izz")),
        *(inertia_of.number(name, ZERO) for name in ("ixy", "ixz", "iyz")),
    )
    six = turned_inertia(undusted(six), from_rpy(rpy))
    judge(inertial.place, mass, com, six, report)
    return Inertial(mass, com, six)


def _tell_of_others(node: Node, report: Report) -> None:
    """One remark for every kind of element that is known and not read here; each thing in them that acts is told."""
    told: set[str] = set()
    for child in node.children:
        if child.tag not in _SHOWN_ONLY and child.tag not in _ACTING:
            continue
        found = list(acting(child, _ACTING))
        for each in found:
            report.lost(
                each.place, f"<{each.tag}> of <{child.tag}> is not read: what it says of the mechanics is left out"
            )
        if not found and child.tag not in told and child.tag in _SHOWN_ONLY:
            told.add(child.tag)
            report.ignored(child.place, f"{_SHOWN_ONLY[child.tag]}: no influence on the equations of motion")
