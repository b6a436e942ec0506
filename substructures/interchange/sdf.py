"""SDF 1.5 to 1.11 (http://sdformat.org/spec): links, joints and frames placed relative to each other, nested models.

A pose is given relative to the model, of a joint to its child link, of a frame to what it is attached to, or to
``relative_to``. An axis is given in the frame of its joint, or in that of ``expressed_in``; it goes through the origin
of the joint's frame, which need not be that of the child link.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from decimal import Decimal

import numpy as np

from substructures.array import Array
from substructures.errors import among
from substructures.interchange.bindings import mimic_of, single_coordinates
from substructures.interchange.merge import vector
from substructures.interchange.numbers import ZERO, Number, Triple, decimal_of, number_of, triple, value
from substructures.interchange.report import Place, Report, refuse
from substructures.interchange.robot import Inertial, Link, Mimic, Motion, MotionType, NamedFrame, Robot, in_order
from substructures.interchange.rotations import from_quaternion, from_rpy, six_of, tensor, to_rpy, turn
from substructures.interchange.urdf import judge
from substructures.interchange.xml import Node, numbers_in

WORLD = "world"
_VERSIONS = ("1.5", "1.6", "1.7", "1.8", "1.9", "1.10", "1.11", "1.12")
_TYPES = ("revolute", "continuous", "prismatic", "fixed", "ball", "universal")
_IGNORED = ("plugin", "static", "allow_auto_disable", "self_collide", "enable_wind", "pose", "model", "link", "joint",
            "frame", "include", "gripper")  # fmt: skip
#: R and origin in the frame of the outermost model
Pose = tuple[Array, Array]


@dataclass(frozen=True)
class _Framed:
    """A pose relative to a frame by its full name."""

    relative_to: str
    R: Array
    r: Array
    place: Place


@dataclass
class _Frames:
    """All frames of the file by their full names, ``model::link``; resolved on demand."""

    given: dict[str, _Framed] = field(default_factory=dict)
    _known: dict[str, Pose] = field(default_factory=dict)

    def add(self, name: str, framed: _Framed) -> None:
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


def read_sdf(root: Node) -> Robot:
    """The robot of an SDF document with one model. Raises InvalidDocument with line and element."""
    version = root.attributes.get("version", "")
    if version not in _VERSIONS:
        raise refuse(root.place, "version", f"version '{version[:20]}' is none of {', '.join(_VERSIONS)}")
    worlds = [*root.all("world")]
    models = [m for holder in (worlds or [root]) for m in holder.all("model")]
    if len(models) != 1:
        raise refuse(root.place, "several-models", f"{len(models)} models: one is needed, put them into one file each")
    return _Reader(models[0], Report()).robot(worlds[0] if worlds else None)


class _Reader:
    """Reads a model with those nested in it."""

    def __init__(self, model: Node, report: Report) -> None:
        self.model, self.report = model, report
        self.frames = _Frames()
        self.links: dict[str, Node] = {}
        self.joints: list[tuple[str, Node]] = []
        self.attached: dict[str, str] = {}  #: of frames what they are attached to
        self.over: dict[str, str | None] = {}  #: of frames the link that carries them, where it was looked for
        self._enter(model, "", _framed(None, "", model.place))

    def robot(self, world: Node | None) -> Robot:
        """Links with the joints that carry them; roots are fixed to the interface."""
        if not self.links:
            raise refuse(self.model.place, "no-links", "the model has no <link>")
        carried: dict[str, Link] = {}
        for prefix, node in self.joints:
            link = self._carried(prefix, node)
            if link.name in carried:
                raise refuse(node.place, "two-parents", f"the link '{link.name}' is the child of another joint already")
            carried[link.name] = link
        roots = [self._root(name, node) for name, node in self.links.items() if name not in carried]
        frames = tuple(self._frame(name, over) for name in self.attached if (over := self._link_of(name)))
        links = in_order([*roots, *carried.values()])
        name = self.model.attributes.get("name", "")
        known = single_coordinates(links)
        mimics = tuple(mimic for prefix, node in self.joints for mimic in self._mimics(prefix, node, known))
        return Robot(name, links, self.report, frames=frames, mimics=mimics, gravity=_gravity(world))

    def _mimics(self, prefix: str, joint: Node, known: set[str]) -> Iterator[Mimic]:
        """Bindings of the axes of a joint: q = multiplier (q_leader - reference) + offset."""
        name = prefix + joint.text_of("name")
        for tag in ("axis", "axis2"):
            axis = joint.one(tag)
            for node in () if axis is None else axis.all("mimic"):
                k, reference, offset = (_number(node, each) for each in ("multiplier", "reference", "offset"))
                exact = isinstance(k, Decimal) and isinstance(reference, Decimal) and isinstance(offset, Decimal)
                shift = offset - k * reference if exact else ZERO  # type: ignore[operator] # decimals, as read
                leader = prefix + node.text_of("joint") + ("_2" if node.attributes.get("axis") == "axis2" else "")
                own = name + ("_2" if tag == "axis2" else "")
                yield from mimic_of(own, leader, (k, shift), node.place, known, self.report)

    def _enter(self, model: Node, prefix: str, placed: _Framed) -> None:
        """All frames of a model: its own, and those of links, joints, frames and models in it."""
        if "placement_frame" in model.attributes:
            raise refuse(model.place, "not-read", "placement_frame is not read: give the pose of the model")
        base = f"{prefix}__model__"
        self.frames.add(base, placed)
        for node in model.children:
            if node.tag == "include":
                raise refuse(node.place, "external-file", "<include> is not followed: put the model's content here")
            if node.tag in ("link", "joint", "frame", "model"):
                self._named(node, prefix, base)
            elif node.tag not in _IGNORED:
                self.report.warning(node.place, f"<{node.tag[:40]}> is not known in <model> and ignored")

    def _named(self, node: Node, prefix: str, base: str) -> None:
        name = prefix + node.text_of("name")
        if node.tag == "link":
            self.links[name] = node
            self.frames.add(name, _framed(node.one("pose"), prefix, node.place, base))
        elif node.tag == "joint":
            self.joints.append((prefix, node))
            child = _text(node, "child")
            self.frames.add(name, _framed(node.one("pose"), prefix, node.place, prefix + child))
        elif node.tag == "frame":
            attached = node.attributes.get("attached_to")
            at = base if attached is None else prefix + attached
            self.attached[name] = at
            self.frames.add(name, _framed(node.one("pose"), prefix, node.place, at))
        else:
            placed = _framed(node.one("pose"), prefix, node.place, base)
            self.frames.add(name, placed)
            none = _Framed(name, np.eye(3), np.zeros(3), node.place)
            self._enter(node, f"{name}::", none)

    def _carried(self, prefix: str, node: Node) -> Link:
        """The child link of a joint, placed on its parent, with the joint's axes through the joint's origin."""
        child, parent = prefix + _text(node, "child"), _text(node, "parent")
        over = None if parent == WORLD else prefix + parent
        for name in (child, over):
            if name is not None and name not in self.links:
                raise refuse(node.place, "unknown-link", f"there is no link '{name}'{among(name, self.links)}")
        here = self.frames.pose(child, node.place)
        R, r = (np.eye(3), np.zeros(3)) if over is None else self.frames.pose(over, node.place)
        position, rpy = vector(R.T @ (here[1] - r)), to_rpy(R.T @ here[0])
        own = self.links[child]
        return Link(child, over, own.place, position, rpy, self._motions(prefix, node, here), self._inertial(own))

    def _motions(self, prefix: str, node: Node, link: Pose) -> tuple[Motion, ...]:
        kind, name = node.text_of("type"), prefix + node.text_of("name")
        if kind not in _TYPES:
            raise refuse(node.place, "unknown-type", f"type '{kind[:40]}' is none of {', '.join(_TYPES)}")
        if kind == "fixed":
            return ()
        R, r = self.frames.pose(name, node.place)
        anchor = vector(link[0].T @ (r - link[1]))
        if kind == "ball":
            return (Motion(name, "spherical", node.place, anchor=anchor),)
        first = self._axis(prefix, node, "axis", name, (R, link[0]), anchor, kind)
        if kind != "universal":
            return (first,)
        # the second axis is carried by the first one; both are given at zero
        return first, self._axis(prefix, node, "axis2", f"{name}_2", (R, link[0]), anchor, "revolute")

    def _axis(
        self, prefix: str, joint: Node, tag: str, name: str, axes: tuple[Array, Array], anchor: Triple, kind: str
    ) -> Motion:
        node = joint.one(tag)
        xyz = None if node is None else node.one("xyz")
        if node is None or xyz is None:
            raise refuse(joint.place, "missing-element", f"<{tag}><xyz> is needed")
        numbers = [value(x) for x in numbers_in(xyz.text, 3, xyz.place, "xyz")]
        if not any(numbers):
            raise refuse(xyz.place, "zero-axis", "the axis has no direction: give a vector that is not zero")
        if (flag := node.one("use_parent_model_frame")) is not None and flag.text.strip() in ("1", "true"):
            raise refuse(flag.place, "not-read", "use_parent_model_frame is not read: use expressed_in")
        expressed = xyz.attributes.get("expressed_in")
        R = axes[0] if not expressed else self.frames.pose(_full(prefix, expressed), xyz.place)[0]
        direction = axes[1].T @ R @ numbers
        laws, motion = self._laws(node), _kind(kind)
        where = anchor if motion == "revolute" else vector(np.zeros(3))
        axis = vector(np.where(np.abs(direction) < 1e-15, 0, direction))
        return Motion(name, motion, node.place, axis, where, limits=_limits(node, kind), **laws)

    def _laws(self, axis: Node) -> dict[str, Number]:
        dynamics = axis.one("dynamics")
        if dynamics is None:
            return {}
        if value(_number(dynamics, "friction")):
            message = "dry friction is not read: add a load of the type 'friction', with a velocity, for it"
            self.report.warning(dynamics.place, message)
        names = {"damping": "damping", "rest": "spring_reference", "stiffness": "spring_stiffness"}
        return {ours: _number(dynamics, theirs) for ours, theirs in names.items()}

    def _root(self, name: str, node: Node) -> Link:
        """A link that no joint carries."""
        R, r = self.frames.pose(name, node.place)
        self.report.warning(
            node.place, "no joint carries this link: it is fixed to the interface (base=floating: free)", "topology"
        )
        return Link(name, None, node.place, vector(r), to_rpy(R), (), self._inertial(node))

    def _link_of(self, name: str) -> str | None:
        """The link that a frame is attached to, perhaps over other frames; None for the model itself."""
        chain: list[str] = []
        while name in self.attached and name not in self.over:
            chain.append(name)
            self.over[name] = None  # of a circle
            name = self.attached[name]
        found = self.over.get(name, name if name in self.links else None)
        self.over.update(dict.fromkeys(chain, found))
        return found

    def _frame(self, name: str, link: str) -> NamedFrame:
        place = self.frames.given[name].place
        (R, r), (R0, r0) = self.frames.pose(name, place), self.frames.pose(link, place)
        return NamedFrame(name, link, vector(R0.T @ (r - r0)), to_rpy(R0.T @ R))

    def _inertial(self, node: Node) -> Inertial:
        """Mass, mass centre and R I R^T."""
        own = node.one("inertial")
        if own is None:
            # the default of the format
            return Inertial(decimal_of(1.0), inertia=(decimal_of(1.0),) * 3 + (ZERO,) * 3)
        if own.one("fluid_added_mass") is not None:
            self.report.warning(own.place, "the mass added by a fluid is left out: it differs from axis to axis")
        pose = _framed(own.one("pose"), "", own.place)
        if pose.relative_to:
            raise refuse(own.place, "not-read", "the pose of an <inertial> has no relative_to")
        mass = _number(own, "mass", "1")
        inertia = own.one("inertia")
        defaults = {"ixx": "1", "iyy": "1", "izz": "1"}
        names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        if inertia is None:
            raise refuse(own.place, "missing-element", "<inertia> is needed")
        six: tuple[Number, ...] = tuple(_number(inertia, n, defaults.get(n, "0")) for n in names)
        if not np.array_equal(pose.R, np.eye(3)):
            six = tuple(map(decimal_of, six_of(pose.R @ tensor([value(x) for x in six]) @ pose.R.T)))
        judge(own.place, mass, vector(pose.r), six, self.report)
        return Inertial(mass, vector(pose.r), six)


def _full(prefix: str, name: str) -> str:
    return f"{prefix}__model__" if name == "__model__" else prefix + name


def _kind(kind: str) -> MotionType:
    return "prismatic" if kind == "prismatic" else "revolute"


def _limits(axis: Node, kind: str) -> tuple[Number, Number] | None:
    limit = axis.one("limit")
    if limit is None or kind == "continuous":
        return None
    low, high = _number(limit, "lower", "-1e16"), _number(limit, "upper", "1e16")
    return None if abs(value(low)) >= 1e16 or abs(value(high)) >= 1e16 else (low, high)


def _text(node: Node, tag: str) -> str:
    found = node.one(tag)
    name = "" if found is None else found.text.strip() or found.attributes.get("link", "")
    if not name:
        raise refuse(node.place, "missing-element", f"<{tag}> is needed")
    return name


def _number(node: Node, tag: str, default: str = "0") -> Number:
    found = node.one(tag)
    return number_of(default if found is None else found.text, node.place if found is None else found.place, tag)


def _framed(pose: Node | None, prefix: str, place: Place, default: str = "") -> _Framed:
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
    given = "" if pose is None else pose.attributes.get("relative_to", "")
    return _Framed(_full(prefix, given) if given else default, R, r, place)


def _gravity(world: Node | None) -> Triple | None:
    found = None if world is None else world.one("gravity")
    return None if found is None else triple(numbers_in(found.text, 3, found.place, "gravity"))
