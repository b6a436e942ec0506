"""Bodies of an MJCF file: placements, joints in order, masses given or of geoms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from substructures.interchange.merge import Seat, judge, vector
from substructures.interchange.mjcf.geoms import Mass, mass_of, summed
from substructures.interchange.mjcf.meshes import Meshes, UnknownMass
from substructures.interchange.mjcf.settings import Compiler, Defaults, choice, name_of, orientation, range_of
from substructures.interchange.numbers import (
    ONE,
    ORIGIN,
    ZERO,
    Number,
    Triple,
    axis_of,
    cleaned,
    decimal_of,
    direction,
    is_zero,
    triple,
    undusted,
    value,
)
from substructures.interchange.report import Place, Report, refuse
from substructures.interchange.robot import Inertial, Link, Motion, MotionType, NamedFrame
from substructures.interchange.rotations import from_z_axis, six_of, tensor, to_rpy, turned_inertia
from substructures.interchange.turning import is_turning
from substructures.interchange.xml import Node

_MOTION: dict[str, MotionType] = {"hinge": "revolute", "slide": "prismatic", "ball": "spherical", "free": "free"}
_REFUSED = {
    "composite": "write its bodies out",
    "flexcomp": "deformable bodies have no relative coordinates",
    "attach": "put the other model here",
    "include": "put the file's content here",
}
_IGNORED = {"camera": "cameras", "light": "lights", "plugin": "plugins", "user": "user data"}
_Z: Triple = (ZERO, ZERO, ONE)


@dataclass
class Bodies:
    """Reads <worldbody>: ``links`` and ``frames`` in the order of the file."""

    compiler: Compiler
    defaults: Defaults
    meshes: Meshes
    report: Report
    links: list[Link] = field(default_factory=list)
    frames: list[NamedFrame] = field(default_factory=list)
    sites: dict[str, tuple[str | None, Seat]] = field(default_factory=dict)
    armatures: Mapping[str, Number] = field(default_factory=dict)  #: of actuators, by joint
    dampings: Mapping[str, Number] = field(default_factory=dict)
    springdampers: dict[str, tuple[float, float]] = field(default_factory=dict)  #: timeconst and dampratio, by joint
    _joints: int = 0
    _moving: set[str] = field(default_factory=set)
    _named: set[str] = field(default_factory=set)  #: names in the file, which nothing without a name gets

    def world(self, node: Node) -> None:
        """The bodies on the world; what else is there does not move."""
        left = [node]
        while left:
            here = left.pop()
            left += here.children
            self._named |= {here.attributes["name"]} if "name" in here.attributes else set()
        self._children(node, None, node.attributes.get("childclass"), Seat())

    def _children(self, node: Node, parent: str | None, childclass: str | None, outer: Seat) -> None:
        """Bodies of a body or <frame>, whose placement ``outer`` they are given in, and its sites."""
        for child in node.children:
            if child.tag in _REFUSED:
                raise refuse(child.place, "not-read", f"<{child.tag}> is not read: {_REFUSED[child.tag]}")
            if child.tag == "body":
                self._body(child, parent, childclass, outer)
            elif child.tag == "frame":
                inner = child.attributes.get("childclass", childclass)
                self._children(child, parent, inner, outer.beyond(self._seat(child)))
            elif child.tag == "site" and "name" in child.attributes:
                seat = outer.beyond(self._seat(self.defaults.applied(child, childclass)))
                self.sites[child.attributes["name"]] = parent, seat
                if parent is not None:
                    self.frames.append(NamedFrame(child.attributes["name"], parent, seat.position, seat.rpy))
            elif child.tag in _IGNORED:
                self.report.ignored(child.place, f"{_IGNORED[child.tag]}: no influence on the equations of motion")

    def _seat(self, node: Node) -> Seat:
        if "fromto" in node.attributes:
            ends = np.array([value(x) for x in node.numbers("fromto", 6)]).reshape(2, 3)
            if np.linalg.norm(ends[0] - ends[1]) < 1e-12:
                raise refuse(node.place, "zero-length", "the ends of fromto are one point")
            return Seat(vector(ends.mean(axis=0)), to_rpy(from_z_axis(ends[0] - ends[1])))
        return Seat(triple(node.numbers("pos", 3, ORIGIN)), to_rpy(orientation(node, self.compiler)))

    def _body(self, node: Node, parent: str | None, childclass: str | None, outer: Seat) -> None:
        name = name_of(node, f"body{len(self.links) + 1}", self._named)
        childclass = node.attributes.get("childclass", childclass)
        if float(value(node.number("gravcomp", ZERO))):
            message = "gravcomp, a force against gravity, is left out: add a load for it"
            self.report.lost(node.place, message)
        seat = outer.beyond(self._seat(node))
        inside = list(self._inside(node, childclass, Seat()))
        motions = tuple(self._motion(child, inner) for child, inner in inside if child.tag in ("joint", "freejoint"))
        if len(motions) > 1 and any(m.type == "free" for m in motions):
            raise refuse(node.place, "two-joints", "a free joint is the only one of its body")
        if parent is not None and any(m.type == "free" for m in motions):
            raise refuse(node.place, "free-joint", "only a body of the world may have a free joint")
        if motions or parent in self._moving:
            self._moving.add(name)
        geoms = [(child, inner) for child, inner in inside if child.tag == "geom"]
        unweighed = None if name in self._moving else self._unweighed(node, geoms)
        inertial = self._inertial(node, geoms if unweighed is None else [])
        if len(motions) == 1 and parent not in self._moving:
            motions, inertial = self._rotor(motions[0], inertial)
        made = Link(name, parent, node.place, seat.position, seat.rpy, motions, inertial)
        self.links.append(replace(made, has_shape=bool(geoms), unweighed=unweighed))
        self._children(node, name, childclass, Seat())

    def _inside(self, node: Node, childclass: str | None, outer: Seat) -> Iterator[tuple[Node, Seat]]:
        """Joints and geoms with their classes applied, also those in <frame>s, with what they are placed in."""
        for child in node.children:
            if child.tag == "frame":
                inner = child.attributes.get("childclass", childclass)
                yield from self._inside(child, inner, outer.beyond(self._seat(child)))
            elif child.tag in ("joint", "geom"):
                yield self.defaults.applied(child, childclass), outer
            elif child.tag == "freejoint":
                yield child, outer

    def _motion(self, node: Node, outer: Seat) -> Motion:
        """One joint."""
        self._joints += 1
        name = name_of(node, f"joint{self._joints}", self._named)
        if node.tag == "freejoint":
            return Motion(name, "free", node.place)
        kind = _MOTION[choice(node, "type", tuple(_MOTION))] if "type" in node.attributes else "revolute"
        self._strict(node, kind)
        read = self._angle if kind == "revolute" else _plain
        laws = {key: self._law(node, key) for key in ("stiffness", "damping", "armature")}
        if any(value(x) for x in node.numbers("springdamper", 2, (ZERO, ZERO))):
            self.springdampers[name] = self._springdamper(node)
            laws |= {"stiffness": ZERO, "damping": ZERO}
        laws["armature"] = _sum(laws["armature"], self.armatures.get(name, ZERO))
        laws["damping"] = _sum(laws["damping"], self.dampings.get(name, ZERO))
        if kind in ("free", "spherical"):
            anchor = ORIGIN if kind == "free" else outer.point(triple(node.numbers("pos", 3, ORIGIN)))
            return replace(Motion(name, kind, node.place, anchor=anchor), **laws)  # type: ignore[arg-type] # numbers
        axis = triple(node.numbers("axis", 3, _Z))
        if all(map(is_zero, axis)):
            raise refuse(node.place, "zero-axis", "the axis has no direction: give a vector that is not zero")
        turned = Seat(ORIGIN, outer.rpy).point(axis)
        return Motion(
            name,
            kind,
            node.place,
            axis=direction([value(x) for x in turned]) if outer.is_turned else axis_of(triple(undusted(axis))),
            anchor=outer.point(triple(node.numbers("pos", 3, ORIGIN))) if kind == "revolute" else ORIGIN,
            offset=read(node.number("ref", ZERO)),
            rest=read(node.number("springref", ZERO)),
            limits=self._limits(node, kind),
            **laws,
        )

    def _strict(self, node: Node, kind: str) -> None:
        """What changes mechanics and is not read."""
        if kind in ("free", "spherical") and any(map(value, node.numbers("springdamper", 2, (ZERO, ZERO)))):
            message = "springdamper of a ball or free joint is not read: give its stiffness and damping"
            raise refuse(node.place, "not-read", message)
        if kind == "spherical" and range_of(node, self.compiler) is not None:
            self.report.lost(node.place, "range of a ball joint is not read: it turns to any attitude here")
        if value(node.number("frictionloss", ZERO)):
            message = "dry friction is not read: add a load of the type 'friction', with a velocity, for it"
            self.report.lost(node.place, message)
        if value(node.number("springyield", ZERO)):
            self.report.lost(node.place, "springyield is not read: the spring of the joint does not yield")

    def _springdamper(self, node: Node) -> tuple[float, float]:
        timeconst, dampratio = map(value, node.numbers("springdamper", 2))
        if timeconst <= 0 or dampratio <= 0:
            message = "springdamper needs two positive numbers: a time constant in s and a damping ratio"
            raise refuse(node.place, "bad-value", message)
        return timeconst, dampratio

    def _law(self, node: Node, name: str) -> Number:
        """Stiffness, damping or armature; polynomials of higher order are refused."""
        numbers = node.numbers(name, None, (ZERO,))
        if not numbers or any(value(x) for x in numbers[1:]):
            raise refuse(node.place, "not-read", f"{name} has to be one number")
        return numbers[0]

    def _angle(self, x: Number) -> Number:
        return self.compiler.angle(x)

    def _limits(self, node: Node, kind: str) -> tuple[Number, Number] | None:
        found = range_of(node, self.compiler)
        if found is None or kind != "revolute":
            return found
        low, high = map(self._angle, found)
        return low, high

    def _rotor(self, motion: Motion, inertial: Inertial) -> tuple[tuple[Motion], Inertial]:
        """The armature a of a free or ball joint on what stands still: a |omega|^2 / 2 is a moment a 1 of the body,
        a |v|^2 / 2 remains a law of slides.
        """
        a = motion.armature
        if not is_turning(motion) or is_zero(a):
            return (motion,), inertial
        self.report.merged(motion.place, f"its armature {a} is added to the moments of inertia of the body")
        six = tuple(decimal_of(value(x) + (value(a) if i < 3 else 0)) for i, x in enumerate(inertial.inertia))
        kept = motion if motion.type == "free" else replace(motion, armature=ZERO)
        return (kept,), replace(inertial, inertia=six)

    def _unweighed(self, node: Node, geoms: list[tuple[Node, Seat]]) -> Place | None:
        """Where a body that does not move has a mass that is not known, and needs not be while nothing moves it."""
        of_geoms = self.compiler.inertiafromgeom
        if of_geoms == "false" or (of_geoms == "auto" and node.one("inertial") is not None):
            return None
        for geom, _ in geoms:
            try:
                mass_of(geom, self.compiler, self.meshes)
            except UnknownMass:
                message = "the mass of a mesh needs its file, of a shell <inertial>: left out, as this stands still"
                self.report.lost(geom.place, message, "physics")
                return geom.place
        return None

    def _inertial(self, node: Node, geoms: list[tuple[Node, Seat]]) -> Inertial:
        """As given or, as the compiler says, of the geoms."""
        given, of_geoms = node.one("inertial"), self.compiler.inertiafromgeom
        masses = []
        if of_geoms == "true" or (of_geoms == "auto" and given is None):
            found = ((mass_of(child, self.compiler, self.meshes), outer) for child, outer in geoms)
            masses = [_moved(mass, outer) for mass, outer in found if mass is not None]
        total = summed(masses)
        if total is None:  # as it is without geoms that count
            return self._bounded(node, self._nothing(node) if given is None else self._given(given))
        own = Inertial(cleaned([total.m])[0], vector(total.com, total.size), cleaned(six_of(total.theta)))
        return self._bounded(node, own)

    def _nothing(self, node: Node) -> Inertial:
        """No mass, where MuJoCo puts the least one that the compiler asks for."""
        if not self.compiler.boundmass:
            return Inertial()
        message = "without a mass it gets boundmass, where MuJoCo puts it: at its own 'pos', in its own frame"
        self.report.warning(node.place, message, "physics")
        return Inertial(com=triple(node.numbers("pos", 3, ORIGIN)))

    def _given(self, node: Node) -> Inertial:
        """Mass, and R I R^T of <inertial>."""
        mass, com = node.number("mass"), triple(node.numbers("pos", 3, ORIGIN))
        R = orientation(node, self.compiler)
        if ("fullinertia" in node.attributes) == ("diaginertia" in node.attributes):
            raise refuse(node.place, "missing-attribute", "either 'diaginertia' or 'fullinertia' is needed")
        if "fullinertia" in node.attributes:
            return Inertial(mass, com, turned_inertia(node.numbers("fullinertia", 6), R))
        return Inertial(mass, com, turned_inertia((*node.numbers("diaginertia", 3), ZERO, ZERO, ZERO), R))

    def _bounded(self, node: Node, own: Inertial) -> Inertial:
        """With the least mass and moments that the compiler asks for, and judged as that."""
        found = self._with_bounds(node, own)
        if found.is_nothing:
            return found
        judge(node.place, found.mass, found.com, found.inertia, self.report)
        return found

    def _with_bounds(self, node: Node, own: Inertial) -> Inertial:
        low_mass, low_moment = self.compiler.boundmass, self.compiler.boundinertia
        mass = own.mass if value(own.mass) >= low_mass else decimal_of(low_mass)
        moments, axes = np.linalg.eigh(tensor([value(x) for x in own.inertia]))
        bounded = np.maximum(moments, low_moment)
        if self.compiler.balanceinertia and bounded[0] + bounded[1] < bounded[2]:
            bounded = np.full(3, bounded.mean())
        elif moments[0] >= low_moment:
            return replace(own, mass=mass)
        self.report.warning(node.place, "moments of inertia changed as <compiler> asks for", "physics")
        theta = axes @ np.diag(bounded) @ axes.T
        return Inertial(mass, own.com, cleaned(six_of(theta)))


def _moved(mass: Mass, outer: Seat) -> Mass:
    """The mass of a geom in a <frame>."""
    if outer == Seat():
        return mass
    six = tuple(map(decimal_of, six_of(mass.theta)))
    moved = outer.inertial(Inertial(decimal_of(mass.m), vector(mass.com), six))
    com = np.array([value(x) for x in moved.com])
    return Mass(mass.m, com, tensor([value(x) for x in moved.inertia]))


def _plain(x: Number) -> Number:
    return x


def _sum(a: Number, b: Number) -> Number:
    return a if is_zero(b) else decimal_of(value(a) + value(b))
