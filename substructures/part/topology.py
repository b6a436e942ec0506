"""The names and the topology of a definition: chains of one degree of freedom joints, frames and loads, no formulas."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.errors import Fault, InvalidDocument, among
from substructures.expr.steps import RESERVED
from substructures.mechanics.balls import BallJoint
from substructures.mechanics.kinematics import INTERFACE
from substructures.part.balls import BALLS, ball_faults, ball_names
from substructures.part.definition import Body, Definition, Relation

BASE = "base"

#: (kind, axis of the frame before the joint) of every one degree of freedom joint in a joint type, in order.
#: ``spherical`` is yaw, pitch, roll (about the third, the new second, the new first axis); singular at pitch = +-pi/2.
CHAINS: dict[str, tuple[tuple[int, int], ...]] = {
    "revolute": ((0, 2),),
    "prismatic": ((1, 2),),
    "fixed": (),
    "universal": ((0, 2), (0, 1)),
    "spherical": ((0, 2), (0, 1), (0, 0)),
    "cylindrical": ((0, 2), (1, 2)),
    "planar": ((1, 0), (1, 1), (0, 2)),
    "free": ((1, 0), (1, 1), (1, 2), (0, 2), (0, 1), (0, 0)),
    # in the axes of the body that they carry, at rest there: their rates are no derivatives of coordinates
    "ball": ((0, 0), (0, 1), (0, 2)),
    "floating": ((1, 0), (1, 1), (1, 2), (0, 0), (0, 1), (0, 2)),
}


@dataclass(frozen=True, slots=True)
class JointEntry:
    """One degree of freedom: coordinate, parent carrier, 1 prismatic / 0 revolute, axis, place in the definition."""

    coordinate: str
    parent: int
    s: int
    axis: int
    body: int  #: index of the body in the definition
    step: int  #: place in the chain of a compound joint
    last: bool  #: carries the named body
    is_rate: bool = False  #: ``coordinate`` names a rate, of a ball joint or of a floating one


@dataclass(frozen=True, slots=True)
class Topology:
    """Joints in order (parents first), the carrier of every named body (-1: interface) and the order of the bodies."""

    joints: tuple[JointEntry, ...]
    carrier: dict[str, int]
    order: tuple[int, ...]  #: indices of the bodies in the definition, parents first
    before: tuple[int, ...]  #: by joint the one with which a relation moves it, or itself
    balls: tuple[BallJoint, ...] = ()

    @property
    def movers(self) -> tuple[int, ...]:
        """The joints whose coordinates are those of the part: all that no relation moves."""
        return tuple(a for a, other in enumerate(self.before) if a == other)

    @property
    def moving(self) -> tuple[JointEntry, ...]:
        """The joints that have a coordinate."""
        return tuple(self.joints[a] for a in self.movers)

    @property
    def moved_by(self) -> tuple[int, ...]:
        """By joint, the number of the coordinate that moves it."""
        number = {a: i for i, a in enumerate(self.movers)}
        return tuple(number[_root(self.before, a) or 0] for a in range(len(self.joints)))

    @property
    def is_related(self) -> bool:
        """Whether there are joints that move with another one."""
        return len(self.movers) < len(self.joints)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Coordinate names in order."""
        return tuple(joint.coordinate for joint in self.moving)

    @property
    def body_of(self) -> dict[int, str]:
        """The body by which every moving carrier goes, the first one on it; none inside compound joints."""
        # backwards, so that of all bodies on a carrier the first one stays
        return {carrier: body for body, carrier in reversed(self.carrier.items()) if carrier != INTERFACE}

    @property
    def kinds(self) -> str:
        """'R' or 'P' for every coordinate."""
        return "".join("P" if joint.s else "R" for joint in self.moving)


def topology(definition: Definition) -> Topology:
    """Names and topology. Raises InvalidDocument: unknown parents, cycles, duplicate, reserved or missing names."""
    faults = _name_faults(definition)
    order, more = _order(definition)
    faults += more
    joints: list[JointEntry] = []
    balls: list[BallJoint] = []
    carrier = {BASE: INTERFACE}
    for i in order:
        body = definition.bodies[i]
        is_ball = body.joint.type in BALLS
        names = ball_names(body, i, faults) if is_ball else ((), _coordinates(body, i, faults))
        if is_ball:
            balls.append(BallJoint(i, len(joints), names[0]))
        k = carrier.get(body.parent, INTERFACE)
        chain = CHAINS[body.joint.type]
        for step, ((s, axis), name) in enumerate(zip(chain, names[1], strict=True)):
            joints.append(JointEntry(name, k, s, axis, i, step, step == len(chain) - 1, is_ball))
            k = len(joints) - 1
        carrier[body.name] = k
    faults += _coordinate_faults(definition, joints, balls)
    faults += ball_faults(definition, {joint.coordinate for joint in joints if joint.is_rate})
    before, more = _related(definition.relations, [joint.coordinate for joint in joints])
    faults += more
    if faults:
        raise InvalidDocument(faults)
    return Topology(tuple(joints), carrier, tuple(order), before, tuple(balls))


def _name_faults(definition: Definition) -> list[Fault]:
    faults = []
    seen = {BASE: True}
    for i, body in enumerate(definition.bodies):
        if body.name in seen:
            message = f"'{BASE}' is the interface frame" if body.name == BASE else f"duplicate body '{body.name}'"
            faults.append(Fault(f"/bodies/{i}/name", "duplicate-name", message))
        seen[body.name] = True
    ports = set()
    for i, port in enumerate(definition.ports):
        if port.name in ports or port.name in seen:
            faults.append(Fault(f"/ports/{i}/name", "duplicate-name", f"duplicate port or body name '{port.name}'"))
        ports.add(port.name)
        if port.body not in seen:
            message = f"unknown body '{port.body}'{among(port.body, seen, len(faults))}"
            faults.append(Fault(f"/ports/{i}/body", "unknown-body", message))
    for kind, names in (("parameters", definition.parameters), ("inputs", definition.inputs)):
        for name in names:
            if name in RESERVED:
                faults.append(Fault(f"/{kind}/{name}", "reserved-name", f"'{name}' has a fixed meaning in expressions"))
            if kind == "inputs" and name in definition.parameters:
                faults.append(Fault(f"/inputs/{name}", "duplicate-name", f"'{name}' is a parameter, too"))
    return faults


def _order(definition: Definition) -> tuple[list[int], list[Fault]]:
    """Bodies with parents first, otherwise in the order given; faults for unknown parents and cycles."""
    names = dict.fromkeys([BASE, *(body.name for body in definition.bodies)])
    orphans = [(i, body) for i, body in enumerate(definition.bodies) if body.parent not in names]
    faults = [
        Fault(f"/bodies/{i}/parent", "unknown-parent", f"unknown parent '{body.parent}' of body '{body.name}'{like}")
        for k, (i, body) in enumerate(orphans)
        for like in [among(body.parent, names, k)]
    ]
    children: dict[str, list[int]] = {}
    for i, body in enumerate(definition.bodies):
        children.setdefault(body.parent, []).append(i)
    if _in_order(definition):
        return list(range(len(definition.bodies))), faults
    order: list[int] = []
    ready = list(children.get(BASE, []))
    while ready:
        i = ready.pop(0)
        # twice only behind a name that is there twice, which is told: the others are on no cycle
        if i in order:
            continue
        order.append(i)
        ready += children.get(definition.bodies[i].name, [])
    if not faults:
        left = [i for i in range(len(definition.bodies)) if i not in order]
        faults += [
            Fault(
                f"/bodies/{i}/parent", "cycle", f"body '{definition.bodies[i].name}' is on or behind a cycle of parents"
            )
            for i in left
        ]
    return order, faults


def _in_order(definition: Definition) -> bool:
    seen = {BASE}
    for body in definition.bodies:
        if body.parent not in seen:
            return False
        seen.add(body.name)
    return True


def _coordinates(body: Body, i: int, faults: list[Fault]) -> list[str]:
    """The coordinate names of a body's joint; q_<body> (with a number) by default."""
    given, n = body.joint.coordinate, len(CHAINS[body.joint.type])
    if given is None:
        return [f"q_{body.name}"] if n == 1 else [f"q_{body.name}_{j + 1}" for j in range(n)]
    names = [given] if isinstance(given, str) else list(given)
    if len(names) != n:
        advice = f"give {n}, or leave 'coordinate' out" if n else "leave 'coordinate' out"
        message = f"joint type '{body.joint.type}' has {n} coordinate(s), {len(names)} given: {advice}"
        faults.append(Fault(f"/bodies/{i}/joint/coordinate", "wrong-length", message))
        return [f"q_{body.name}_{j + 1}" for j in range(n)]
    return names


def _coordinate_faults(definition: Definition, joints: Sequence[JointEntry], balls: Sequence[BallJoint]) -> list[Fault]:
    faults = []
    seen: set[str] = set()
    named = [(x.coordinate, x.body, "velocities" if x.is_rate else "coordinate") for x in joints]
    named += [(name, ball.body, "coordinate") for ball in balls for name in ball.positions]
    for name, body, field in named:
        pointer = f"/bodies/{body}/joint/{field}"
        if name in seen or name in definition.parameters or name in definition.inputs:
            faults.append(
                Fault(pointer, "duplicate-name", f"coordinate '{name}' is used twice (coordinates, parameters, inputs)")
            )
        if name in RESERVED:
            faults.append(Fault(pointer, "reserved-name", f"'{name}' has a fixed meaning in expressions"))
        seen.add(name)
    return faults


def _related(relations: Sequence[Relation], names: Sequence[str]) -> tuple[tuple[int, ...], list[Fault]]:
    """By joint the one that it depends on, itself where it depends on none; ``names``: of their coordinates."""
    index, before, faults = {name: a for a, name in enumerate(names)}, list(range(len(names))), list[Fault]()
    for i, each in enumerate(relations):
        unknown = [
            (field, name) for field, name in (("coordinate", each.coordinate), ("of", each.of)) if name not in index
        ]
        for field, name in unknown:
            message = f"there is no coordinate '{name}'{among(name, names)}"
            faults.append(Fault(f"/relations/{i}/{field}", "unknown-coordinate", message))
        if unknown:
            continue
        a = index[each.coordinate]
        if any(other.coordinate == each.coordinate for other in relations[:i]):
            message = f"'{each.coordinate}' depends on another coordinate already: a joint has one relation"
            faults.append(Fault(f"/relations/{i}/coordinate", "several-relations", message))
            continue
        before[a] = index[each.of]
        if _root(before, a) is None or each.of == each.coordinate:
            before[a] = a
            message = f"'{each.coordinate}' depends on itself: of a circle of relations one has to be left out"
            faults.append(Fault(f"/relations/{i}/of", "cycle", message))
    return tuple(before), faults


def _root(before: Sequence[int], a: int) -> int | None:
    """The joint whose coordinate moves joint a; None on a circle."""
    for _ in before:
        if before[a] == a:
            return a
        a = before[a]
    return a if before[a] == a else None
