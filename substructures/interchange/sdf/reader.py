"""An SDF document as a robot: links and joints of a model and of those nested in it.

The model stands in the world, where its pose says. A pose is given relative to the model, of a joint to its child link,
of a frame to what it is attached to, or to ``relative_to``. An axis is given in the frame of its joint, or in that of
``expressed_in``; it goes through the origin of the joint's frame, which need not be that of the child link. Until SDF
1.4, and where ``use_parent_model_frame`` says so until 1.6, it is given in the frame of the model.

The first joint of which a link is the child carries it, but for one that ``must_be_loop_joint`` or closes a circle;
others close loops. A screw is a prismatic joint that moves with a revolute one; a gearbox binds two joints.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from decimal import Decimal

import numpy as np

from substructures.array import Array
from substructures.errors import among
from substructures.interchange.bindings import joints_of, mimic_of
from substructures.interchange.known.sdf import SDF
from substructures.interchange.merge import judge, vector
from substructures.interchange.numbers import (
    ONE,
    ZERO,
    Number,
    Triple,
    direction,
    triple,
    value,
)
from substructures.interchange.report import Report, refuse
from substructures.interchange.robot import Inertial, Link, Loop, Mimic, Motion, MotionType, NamedFrame, Robot, in_order
from substructures.interchange.rotations import to_rpy, turned_inertia
from substructures.interchange.sdf.axes import laws_of, limits_of, number, tell_of_laws
from substructures.interchange.sdf.contents import Contents, text_in
from substructures.interchange.sdf.couplings import CLOSURES, carriers_of, is_cut, lead_of, loop_of, turn_of
from substructures.interchange.sdf.frames import (
    HERE,
    WORLD,
    Pose,
    framed,
    full_name,
    is_true,
    place_in,
)
from substructures.interchange.sdf.includes import with_included
from substructures.interchange.sdf.merging import FLAG
from substructures.interchange.xml import Node, numbers_in

_IN_MODEL_FRAME = "1.4"  #: and where use_parent_model_frame says so
_VERSIONS = (_IN_MODEL_FRAME, "1.5", "1.6", "1.7", "1.8", "1.9", "1.10", "1.11", "1.12")
_TYPES = ("revolute", "continuous", "prismatic", "fixed", "ball", "universal", "revolute2", "screw", "gearbox")
_IN_WORLD = "world::"  #: before the names of frames beside the model
_GRAVITY = (ZERO, ZERO, Decimal("-9.8"))  #: of a world that does not say it


def read_sdf(root: Node, included: Mapping[str, bytes] | None = None) -> Robot:
    """The robot of an SDF document with one model. ``included``: contents of the files of models that it includes, by
    their paths from it. Raises InvalidDocument with line and element.
    """
    report, version = Report(), root.attributes.get("version", "")
    if version not in _VERSIONS:
        raise refuse(root.place, "version", f"version '{version[:20]}' is none of {', '.join(_VERSIONS)}")
    SDF.tell(root, report)
    root = with_included(root, {} if included is None else included, (_IN_MODEL_FRAME,), report)
    worlds = [*root.all("world")]
    models = [m for holder in (worlds or [root]) for m in holder.all("model")]
    if len(models) != 1:
        raise refuse(root.place, "several-models", f"{len(models)} models: one is needed, put them into one file each")
    for joint in (each for world in worlds for each in world.all("joint")):
        report.lost(joint.place, "a joint beside the model is left out: put it into the model", "topology")
    return _Reader(models[0], worlds[0] if worlds else None, report, version == _IN_MODEL_FRAME).robot()


class _Reader:
    """Reads a model with those nested in it."""

    def __init__(self, model: Node, world: Node | None, report: Report, in_model_frame: bool) -> None:
        self.model, self.world, self.report, self.in_model_frame = model, world, report, in_model_frame
        contents = Contents(report)
        for node in () if world is None else world.all("frame"):
            at = full_name(_IN_WORLD, node.attributes.get("attached_to") or WORLD)
            contents.frames.add(_IN_WORLD + node.text_of("name"), framed(node.one("pose"), _IN_WORLD, node.place, at))
        contents.enter(model, "", framed(model.one("pose"), _IN_WORLD, model.place))
        self.frames, self.links, self.joints = contents.frames, contents.links, contents.joints
        self.attached, self.link_of = contents.attached, contents.link_of

    def robot(self) -> Robot:
        """Links with the joints that carry them; roots are fixed to the interface."""
        if not self.links:
            raise refuse(self.model.place, "no-links", "the model has no <link>")
        carried, loops = self._tree()
        roots = [self._root(name, node) for name, node in self.links.items() if name not in carried]
        frames = tuple(self._frame(name, over) for name in self.attached if (over := self.link_of(name)))
        links = in_order([*roots, *carried.values()])
        name = self.model.attributes.get("name", "")
        known = joints_of(links)
        mimics = [mimic for prefix, node in self.joints for mimic in self._mimics(prefix, node, known)]
        for prefix, node in self.joints:
            if node.text_of("type") == "gearbox":
                mimics += self._gearbox(prefix, node, {link.name: link for link in links}, known)
        robot = Robot(name, links, self.report, frames=frames, mimics=tuple(mimics), loops=loops)
        if self.world is None:
            return robot
        gravity = self.world.one("gravity")
        if gravity is None:
            return replace(robot, gravity=_GRAVITY)
        numbers = triple(numbers_in(gravity.text, 3, gravity.place, "gravity"))
        return replace(robot, gravity=numbers, gravity_place=gravity.place)

    def _tree(self) -> tuple[dict[str, Link], tuple[Loop, ...]]:
        """Links by their names with the joints that carry them, and the joints that close loops."""
        joints = [each for each in self.joints if each[1].text_of("type") != "gearbox"]
        joints.sort(key=lambda joint: is_cut(joint[1]))
        ends = [(self._end(p + text_in(node, "child"), node), self._host(p, node, "parent")) for p, node in joints]
        carriers = carriers_of(ends)
        carried = {child: self._carried(*joints[k], child) for k, (child, _) in enumerate(ends) if carriers[child] == k}
        others = ((k, child) for k, (child, _) in enumerate(ends) if carriers[child] != k)
        return carried, tuple(self._loop(*joints[k], carried[child]) for k, child in others)

    def _loop(self, prefix: str, node: Node, child: Link) -> Loop:
        """A joint whose child another one carries."""
        kind, over, name = node.text_of("type"), self._host(prefix, node, "parent"), prefix + node.text_of("name")
        already = f"the link '{child.name}' is the child of '{child.joint}' already"
        if kind not in CLOSURES or over == child.name:
            raise refuse(node.place, "two-parents", f"{already}, and a joint '{kind[:40]}' on '{over}' closes no loop")
        tell_of_laws(node, "a joint that closes a loop", self.report)
        self.report.merged(node.place, f"{already}: this joint closes a loop")
        poses = self.frames.pose(child.name, node.place), self._pose(over, node)
        axes = [self._direction(prefix, node, tag)[1] for tag in CLOSURES[kind][1]]
        return loop_of(node, name, (child.name, over), poses, self.frames.pose(name, node.place), axes)

    def _gearbox(self, prefix: str, node: Node, links: dict[str, Link], known: dict[str, bool]) -> list[Mimic]:
        """Of the angles of parent and child against the reference body: theta_2 = -ratio theta_1."""
        reference = self._host(prefix, node, "gearbox_reference_body")
        ends = [(self._host(prefix, node, end), reference) for end in ("parent", "child")]
        axes = [self._direction(prefix, node, tag)[1] for tag in ("axis", "axis2")]
        (one, k1), (two, k2) = (turn_of(*each, links, self.frames) for each in zip(ends, axes, strict=True))
        if not (one and two):
            message = "no revolute joints about its axes move its parent and child against gearbox_reference_body"
            raise refuse(node.place, "not-read", message)
        tell_of_laws(node, "a gearbox", self.report)
        ratio = -k1 * k2 * number(node, "gearbox_ratio", "1")
        return mimic_of(two, one, (ratio, ZERO), node.place, known, self.report)

    def _mimics(self, prefix: str, joint: Node, known: dict[str, bool]) -> Iterator[Mimic]:
        """Bindings of the axes of a joint: q = multiplier (q_leader - reference) + offset."""
        name = prefix + joint.text_of("name")
        if joint.text_of("type") == "screw":
            lead = lead_of(joint, self.report), ZERO
            yield from mimic_of(f"{name}_slide", name, lead, joint.place, known, self.report)
        for tag in ("axis", "axis2"):
            axis = joint.one(tag)
            for node in () if axis is None else axis.all("mimic"):
                factors = (("multiplier", "1"), ("reference", "0"), ("offset", "0"))
                k, reference, offset = (number(node, each, node.attributes.get(each, x)) for each, x in factors)
                leader = prefix + node.text_of("joint") + ("_2" if node.attributes.get("axis") == "axis2" else "")
                own = name + ("_2" if tag == "axis2" else "")
                yield from mimic_of(own, leader, (k, offset - k * reference), node.place, known, self.report)

    def _carried(self, prefix: str, node: Node, child: str) -> Link:
        """The child link of a joint, placed on its parent, with the joint's axes through the joint's origin."""
        over = self._host(prefix, node, "parent")
        here, host = self.frames.pose(child, node.place), self._pose(over, node)
        position, rpy = place_in(host, here[1]), to_rpy(host[0].T @ here[0])
        own = self.links[child]
        motions, inertial = self._motions(prefix, node, here), self._inertial(own)
        return Link(child, over, own.place, position, rpy, motions, inertial, prefix + node.text_of("name"))

    def _pose(self, link: str | None, joint: Node) -> Pose:
        return HERE if link is None else self.frames.pose(link, joint.place)

    def _host(self, prefix: str, joint: Node, tag: str) -> str | None:
        """The link that a child of the joint names; None for the world."""
        name = text_in(joint, tag)
        return None if name == WORLD else self._end(prefix + name, joint)

    def _end(self, name: str, joint: Node) -> str:
        """The link of an end of a joint, which is one or a frame that is attached to one."""
        found = self.link_of(name)
        if found is None:
            raise refuse(joint.place, "unknown-link", f"there is no link '{name}'{among(name, self.links)}")
        return found

    def _motions(self, prefix: str, node: Node, link: Pose) -> tuple[Motion, ...]:
        kind, name = node.text_of("type"), prefix + node.text_of("name")
        if kind not in _TYPES:
            raise refuse(node.place, "unknown-type", f"type '{kind[:40]}' is none of {', '.join(_TYPES)}")
        if kind == "fixed":
            return ()
        anchor = place_in(link, self.frames.pose(name, node.place)[1])
        if kind == "ball":
            tell_of_laws(node, "a ball joint", self.report)
            return (Motion(name, "spherical", node.place, anchor=anchor),)
        first = self._axis(prefix, node, "axis", name, link, anchor, kind)
        if kind == "screw":
            self.report.merged(node.place, "its coordinate is its angle, of which are limits and all laws of its axis")
            return Motion(f"{name}_slide", "prismatic", node.place, first.axis), first
        if kind not in ("universal", "revolute2"):
            return (first,)
        # the second axis is carried by the first one; both are given at zero
        return first, self._axis(prefix, node, "axis2", f"{name}_2", link, anchor, "revolute")

    def _axis(self, prefix: str, joint: Node, tag: str, name: str, link: Pose, anchor: Triple, kind: str) -> Motion:
        node, axis = self._direction(prefix, joint, tag)
        motion: MotionType = "prismatic" if kind == "prismatic" else "revolute"
        where = anchor if motion == "revolute" else vector(np.zeros(3))
        laws = laws_of(node, joint, self.report)
        limits, along = limits_of(node, kind, self.report), direction((link[0].T @ axis).tolist())
        return Motion(name, motion, node.place, along, where, limits=limits, **laws)

    def _direction(self, prefix: str, joint: Node, tag: str) -> tuple[Node, Array]:
        """An axis of a joint, and where it points."""
        node = joint.one(tag)
        xyz = None if node is None else node.one("xyz")
        if node is None or xyz is None:
            raise refuse(joint.place, "missing-element", f"<{tag}><xyz> is needed")
        numbers = [value(x) for x in numbers_in(xyz.text, 3, xyz.place, "xyz")]
        if not any(numbers):
            raise refuse(xyz.place, "zero-axis", "the axis has no direction: give a vector that is not zero")
        flag = node.one(FLAG)
        in_model = self.in_model_frame if flag is None else is_true(flag.text)
        expressed = xyz.attributes.get("expressed_in") or ("__model__" if in_model else "")
        name = full_name(prefix, expressed) if expressed else prefix + joint.text_of("name")
        return node, self.frames.pose(name, xyz.place)[0] @ numbers

    def _root(self, name: str, node: Node) -> Link:
        """A link that no joint carries."""
        R, r = self.frames.pose(name, node.place)
        self.report.warning(
            node.place, "no joint carries this link: it is fixed to the interface (base=floating: free)", "topology"
        )
        return Link(name, None, node.place, vector(r), to_rpy(R), (), self._inertial(node))

    def _frame(self, name: str, link: str) -> NamedFrame:
        place = self.frames.given[name].place
        here, host = self.frames.pose(name, place), self.frames.pose(link, place)
        return NamedFrame(name, link, place_in(host, here[1]), to_rpy(host[0].T @ here[0]))

    def _inertial(self, node: Node) -> Inertial:
        """Mass, mass centre and R I R^T."""
        own = node.one("inertial")
        if own is None or own.one("inertia") is None:
            message = (
                "no <inertia>: the default of the format, 1 kg m^2 about each axis (and 1 kg where no mass is given)"
            )
            self.report.warning(node.place, message, "physics")
        if own is None:
            return Inertial(ONE, inertia=(ONE,) * 3 + (ZERO,) * 3)
        if own.one("fluid_added_mass") is not None:
            self.report.lost(own.place, "the mass added by a fluid is left out: it differs from axis to axis")
        if is_true(own.attributes.get("auto", "")):
            message = "auto: the mass of shapes is not read; give mass and inertia (gz sdf -p prints them)"
            raise refuse(own.place, "not-read", message)
        pose = framed(own.one("pose"), "", own.place)
        if pose.relative_to:
            raise refuse(own.place, "not-read", "the pose of an <inertial> has no relative_to")
        mass = number(own, "mass", "1")
        inertia = own.one("inertia") or Node("inertia", {}, own.line)
        defaults = {"ixx": "1", "iyy": "1", "izz": "1"}
        names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        six: tuple[Number, ...] = tuple(number(inertia, n, defaults.get(n, "0")) for n in names)
        six = turned_inertia(six, pose.R)
        judge(own.place, mass, vector(pose.r), six, self.report)
        return Inertial(mass, vector(pose.r), six)
