"""Mechanisms of sympy.physics.mechanics as documents: a ``System`` of bodies on joints of one degree of freedom."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import sympy
from sympy.physics.mechanics import Force, Particle, PinJoint, PrismaticJoint, RigidBody, System, WeldJoint
from sympy.physics.vector import ReferenceFrame, Vector, dynamicsymbols

from substructures.errors import InvalidArgument
from substructures.interchange.symbolic.texts import expression_of, from_sympy

Plain = dict[str, Any]
_TYPES = {PinJoint: "revolute", PrismaticJoint: "prismatic", WeldJoint: "fixed"}
_AXES = ("x", "y", "z")


@dataclass
class _Seat:
    """Where the frame of a body here is in that of SymPy: its axes, and its origin."""

    name: str
    frame: Any
    origin: Any


@dataclass
class _Reader:
    names: Mapping[Any, str]
    free: set[Any] = field(default_factory=set)

    def text(self, expression: Any, what: str) -> str | int:
        """A formula of parameters. Raises InvalidArgument where it moves."""
        given = expression_of(expression)
        if given.has(dynamicsymbols._t):
            raise _refused(what, f"varies with time: {given}")
        self.free |= given.free_symbols
        return int(given) if given.is_Integer else from_sympy(given, self.names)

    def parameters(self) -> dict[str, Plain]:
        """Of the symbols that were read; they have no values."""
        return {from_sympy(symbol, self.names): {} for symbol in sorted(self.free, key=str)}

    def vector(self, vector: Any, frame: Any, what: str) -> list[str | int]:
        """Its three components."""
        return [self.text(x, what) for x in (vector.to_matrix(frame) if vector != 0 else (0, 0, 0))]

    def turned(self, outer: Any, inner: Any, what: str) -> list[str | int]:
        """Roll, pitch and yaw of R = Rz(yaw) Ry(pitch) Rx(roll) from the inner frame to the outer one."""
        R = sympy.simplify(outer.dcm(inner))
        if R[2, 0] in (1, -1):
            angles = (0, sympy.asin(-R[2, 0]), sympy.atan2(-R[0, 1], R[1, 1]))
        else:
            angles = (sympy.atan2(R[2, 1], R[2, 2]), sympy.asin(-R[2, 0]), sympy.atan2(R[1, 0], R[0, 0]))
        return [self.text(angle, what) for angle in angles]


def tree_of_system(system: Any, name: str = "system", names: Mapping[Any, str] | None = None) -> Plain:
    """A ``sympy.physics.mechanics.System`` as the document of a tree with one part, its bodies on its joints.

    Pin, prismatic and weld joints of a tree with one root; each body has the axes of its joint's child frame, with the
    origin in its child point. Symbols are parameters without values. Of loads, gravity alone is taken, equal for all
    bodies. ``names``: as of ``from_sympy``.

    Raises InvalidArgument for other joints, loops, loads and constraints, naming them.
    """
    if not isinstance(system, System):
        raise _refused(f"a {type(system).__name__}", "does not know its joints: give the System that it comes from")
    reader, world, joints = _Reader(names or {}), _Reader(names or {}), list(system.joints)
    for kind in ("holonomic_constraints", "nonholonomic_constraints", "velocity_constraints", "actuators"):
        if more := list(getattr(system, kind)):
            raise _refused(kind.replace("_", " "), f"are not taken over: {more[0]}")
    seats = {_root(system, joints): _Seat("base", system.frame, system.fixed_point)}
    bodies = [_body(reader, joint, seats) for joint in _in_order(joints, seats)]
    definition = {"name": name, "bodies": bodies, "parameters": reader.parameters()}
    return {
        "name": name,
        "gravity": _gravity(world, system, seats),
        "parameters": world.parameters(),
        "instances": [{"name": name, "definition": definition}],
    }


def _refused(what: str, why: str) -> InvalidArgument:
    return InvalidArgument.at("/system", "no-counterpart", f"{what} {why}")


def _root(system: Any, joints: list[Any]) -> Any:
    children = [joint.child for joint in joints]
    roots = {joint.parent for joint in joints} - set(children)
    if len(roots) != 1 or len(set(children)) != len(children):
        names = ", ".join(sorted(str(each.name) for each in roots)) or "none"
        raise _refused("the joints", f"make no tree with one root (roots: {names}; a body has one parent)")
    (root,) = roots
    try:
        root.masscenter.pos_from(system.fixed_point)
    except ValueError:
        raise _refused(
            f"body '{root.name}'", "is on no joint, and not at the fixed point: System.from_newtonian"
        ) from None
    for body in system.bodies:
        if body is not root and body not in children:
            raise _refused(f"body '{body.name}'", "is on no joint")
    return root


def _in_order(joints: list[Any], seats: Mapping[Any, _Seat]) -> Iterator[Any]:
    """Parents before children."""
    waiting = list(joints)
    while waiting:
        ready = [joint for joint in waiting if joint.parent in seats]
        if not ready:
            raise _refused(f"joint '{waiting[0].name}'", "is in a loop")
        yield ready[0]
        waiting.remove(ready[0])


def _body(reader: _Reader, joint: Any, seats: dict[Any, _Seat]) -> Plain:
    kind, what, body = _TYPES.get(type(joint)), f"joint '{joint.name}'", joint.child
    if kind is None:
        raise _refused(what, f"is a {type(joint).__name__}: pin, prismatic and weld joints are taken over")
    host = seats[joint.parent]
    placement = {
        "position": reader.vector(joint.parent_point.pos_from(host.origin), host.frame, what),
        "rpy": reader.turned(host.frame, joint.parent_interframe, what),
    }
    described: Plain = {"type": kind, "placement": placement}
    if kind != "fixed":
        described["axis"] = reader.vector(joint.joint_axis, joint.parent_interframe, what)
        described["coordinate"] = from_sympy(joint.coordinates[0], reader.names)
    seats[body] = seat = _Seat(str(body.name), joint.child_interframe, joint.child_point)
    return {"name": seat.name, "parent": host.name, "joint": described, **_inertia(reader, body, seat)}


def _inertia(reader: _Reader, body: Any, seat: _Seat) -> Plain:
    what = f"body '{seat.name}'"
    if not isinstance(body, RigidBody | Particle):
        raise _refused(what, f"is a {type(body).__name__}: rigid bodies and particles are taken over")
    found: Plain = {
        "mass": reader.text(body.mass, what),
        "com": reader.vector(body.masscenter.pos_from(seat.origin), seat.frame, what),
    }
    if isinstance(body, RigidBody):
        tensor = body.central_inertia.to_matrix(seat.frame)
        pairs = ((a, b) for a in range(3) for b in range(a, 3))
        found["inertia"] = {_AXES[a] + _AXES[b]: reader.text(tensor[a, b], what) for a, b in pairs}
    return found


def _gravity(reader: _Reader, system: Any, seats: Mapping[Any, _Seat]) -> list[str | int]:
    """In axes of the root; every body has to have the same, but for the root, which stands still."""
    forces: dict[Any, Any] = {}
    for body in () if system.loads else seats:
        if body.potential_energy != 0:
            what = f"the potential energy of body '{body.name}'"
            raise _refused(what, "is not taken over: give gravity as a load (apply_uniform_gravity)")
    for load in system.loads:
        if not isinstance(load, Force):
            raise _refused(f"the load {load}", "is no force of gravity")
        forces[load.point] = forces.get(load.point, Vector(0)) + load.force
    frame: ReferenceFrame = system.frame
    weights = [(body.mass, forces.pop(body.masscenter, Vector(0)).to_matrix(frame)) for body in seats][1:]  # no root's
    g = next((force / mass for mass, force in weights if mass != 0), sympy.zeros(3, 1)).applyfunc(sympy.simplify)
    if forces or any(sympy.simplify(force - mass * g) != sympy.zeros(3, 1) for mass, force in weights):
        raise _refused("the loads", "are not the gravity of all bodies; give others as loads of the tree")
    return [reader.text(x, "gravity") for x in g]
