"""A definition as links on joints with one coordinate each, in numbers, where all coordinates are zero.

A link is placed in its parent by x_parent = R x + r. A revolute or prismatic link moves from there about or along an
axis through its own origin. Compound joints (universal, spherical, ..., free) are chains with massless links between,
and so are ball joints, with yaw, pitch, roll, where a format has no others. Floating ones remain what they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument, MissingValue
from substructures.export.robots.rigid import NOWHERE, Drive, Loop, Pose, RigidLink, Robot, between, beyond
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Program, array, program
from substructures.mechanics.kinematics import INTERFACE
from substructures.part.balls import BALLS, INSTEAD
from substructures.part.definition import Body, Definition, PartClosure
from substructures.part.frames import CutFrames, cut_frames
from substructures.part.mechanism import Mechanism, mechanism
from substructures.part.relations import read_relations
from substructures.part.topology import BASE, JointEntry, Topology, topology

#: numbers for all parameters of a program
Values = Callable[[Program], Mapping[str, Array]]

_MOMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
_TURNS = ("yaw", "pitch", "roll")
#: of joints, as they are called in definitions
LAWS = ("damping", "stiffness", "rest", "armature")


def robot_of(definition: Definition, values: Values, angles: bool, prefix: str = "") -> Robot:
    """The links of a definition, the first is its interface; ``prefix``: of all names; ``angles``: yaw, pitch, roll in
    place of the quaternions of ball joints.

    Raises InvalidArgument for numbers that are not finite, MissingValue for parameters without one.
    """
    layout = topology(definition)
    # joints stand where their own positions are zero: relations come beside them
    m = mechanism(_with_chains(definition, layout).model_copy(update={"relations": ()}))
    fixed = {law: _constants(m, law) for law in LAWS}
    fixed["stiffness"] = {k: x for k, x in fixed["stiffness"].items() if k in fixed["rest"]}
    outputs = _outputs(m, fixed)
    names = m.topology.coordinates
    relations = read_relations(definition.relations, layout.before, names, m.scope)
    outputs["relations"] = array((len(names), 2), lambda k, i: relations[k][1 + i])
    outputs |= loop_outputs([cut_frames(m.scope, each, "") for each in definition.closures])
    numbers = values(program(m.graph, outputs, m.scope.symbols))
    require_finite(numbers, definition.name)
    balls = {b.body: definition.bodies[b.body].joint.type for b in layout.balls}
    reader = _Reader(m, numbers, prefix, [of for of, _, _ in relations], balls, angles)
    loops = tuple(loops_in(definition.closures, numbers, prefix))
    return Robot(tuple(reader.links()), loops, tuple(reader.left_out(fixed)))


def require_finite(numbers: Mapping[str, Array], of: str) -> None:
    """Raises InvalidArgument with the name of numbers that are not; ``of``: what they belong to."""
    for name, x in numbers.items():
        if not np.isfinite(x).all():
            message = f"'{name}' of '{of}' is not finite with these parameters: give others by bind"
            raise InvalidArgument.at("/bind", "not-finite", message)


def loop_outputs(frames: Sequence[CutFrames]) -> dict[str, Formulas]:
    """The frames of closures, in the order of these."""
    outputs: dict[str, Formulas] = {}
    for k, frame in enumerate(frames):
        outputs[f"closure.{k}.start"] = array((3, 3), lambda i, j, E=frame.start: E[i][j])
        outputs[f"closure.{k}.end"] = array((3, 3), lambda i, j, E=frame.end: E[i][j])
        outputs[f"closure.{k}.position"] = array((3,), lambda i, r=frame.position: r[i])
    return outputs


def loops_in(closures: Sequence[PartClosure], numbers: Mapping[str, Array], prefix: str = "") -> Iterator[Loop]:
    """The closures, with the numbers of their frames."""
    for k, each in enumerate(closures):
        start = numbers[f"closure.{k}.start"].T, np.zeros(3)
        end = numbers[f"closure.{k}.end"].T, numbers[f"closure.{k}.position"]
        yield Loop(prefix + each.name, each.type, prefix + each.from_, start, prefix + each.to, end)


def _with_chains(definition: Definition, layout: Topology) -> Definition:
    """With angles, called like the rates, in place of quaternions; where these turn nothing, all are zero."""

    def chain(i: int, body: Body) -> Body:
        """A body whose joint has angles."""
        if body.joint.type not in BALLS:
            return body
        rates = tuple(joint.coordinate for joint in layout.joints if joint.body == i)
        joint = body.joint.model_copy(
            update={"type": INSTEAD[body.joint.type], "coordinate": rates, "velocities": None}
        )
        return body.model_copy(update={"joint": joint})

    return definition.model_copy(update={"bodies": tuple(chain(i, body) for i, body in enumerate(definition.bodies))})


def at_zero(given: Program, values: Mapping[str, float]) -> dict[str, Array]:
    """All outputs where coordinates are zero. Raises MissingValue for parameters that have no value."""
    known = {s.name: values.get(s.name, 0.0 if s.kind == "coordinate" else None) for s in given.symbols}
    for name, x in known.items():
        if x is None:
            raise MissingValue(name)
    return interpret(given, known)


def _constants(m: Mechanism, law: str) -> dict[int, Expr]:
    """Of every joint whose law depends on parameters alone."""

    def is_constant(x: Expr) -> bool:
        """Whether it depends on parameters alone."""
        found = program(m.graph, {"x": array((), lambda: x)}, m.scope.symbols)
        return all(symbol.kind == "parameter" for symbol in found.symbols)

    return {k: x for k, each in enumerate(m.laws) if is_constant(x := getattr(each, law))}


def _outputs(m: Mechanism, laws: Mapping[str, Mapping[int, Expr]]) -> dict[str, Formulas]:
    """Everything that becomes a number."""
    n, bodies = len(m.joints), m.definition.bodies
    frames = [*m.bodies.values(), *m.ports.values()]
    unit = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    turned = [[joint.rotation.forward(e) for e in unit] for joint in m.joints]  # columns of E
    read, vector = m.scope.read, m.scope.vector
    tensors = [_central(m, i) for i in range(len(bodies))]
    limits = list(_limits(m))
    return {
        "rotation": array((n, 3, 3), lambda k, i, j: turned[k][j][i]),
        "offset": array((n, 3), lambda k, i: m.joints[k].offset[i]),
        "tau": array((n,), lambda k: m.joints[k].tau),
        "frame.E": array((len(frames), 3, 3), lambda f, i, j: frames[f].E[i][j]),
        "frame.position": array((len(frames), 3), lambda f, i: frames[f].position[i]),
        "mass": array((len(bodies),), lambda b: read(bodies[b].mass, "")),
        "com": array((len(bodies), 3), lambda b, i: vector(bodies[b].com, "")[i]),
        "inertia": array((len(bodies), 6), lambda b, i: tensors[b][i]),
        "laws": array((n, len(LAWS)), lambda k, i: laws[LAWS[i]].get(k, m.graph.zero)),
        "limits": array((len(limits), 2), lambda k, i: limits[k][1][i]),
    }


def _central(m: Mechanism, i: int) -> tuple[Any, ...]:
    """The inertia tensor of a body about its mass centre: as written, or Theta = tr(J) 1 - J of what Steiner leaves."""
    given = m.definition.bodies[i].inertia
    if given.about == "com":
        return tuple(m.scope.read(getattr(given, entry), "") for entry in _MOMENTS)
    _, (xx, yy, zz, xy, xz, yz) = m.central[i]
    lift = m.graph.lift
    xx, yy, zz = lift(xx), lift(yy), lift(zz)
    return yy + zz, zz + xx, xx + yy, -lift(xy), -lift(xz), -lift(yz)


def _limits(m: Mechanism) -> Iterator[tuple[int, tuple[Expr, Expr]]]:
    """Of every coordinate that has limits, by its index."""
    for k, entry in enumerate(m.topology.joints):
        given = m.definition.bodies[entry.body].joint.limits
        if given:
            low, high = given[entry.step] if isinstance(given[0], tuple) else given
            yield k, (m.scope.read(low, ""), m.scope.read(high, ""))


class _Reader:
    """Numbers to links."""

    def __init__(
        self,
        m: Mechanism,
        numbers: Mapping[str, Array],
        prefix: str,
        movers: Sequence[int],
        balls: Mapping[int, str],
        angles: bool,
    ) -> None:
        """``balls``: by index of the body that a ball or floating joint carries, its type."""
        self.m, self.numbers, self.prefix, self.movers = m, numbers, prefix, movers
        self.balls, self.angles = balls, angles
        self.limits = dict(zip((k for k, _ in _limits(m)), numbers["limits"].tolist(), strict=True))
        names = [*m.bodies, *m.ports]
        self.frame = {name: f for f, name in enumerate(names)}
        self.carriers: dict[int, Pose] = {INTERFACE: NOWHERE}
        for k, joint in enumerate(m.joints):
            R = numbers["rotation"][k].T
            # from the parent's origin to O_k, then along the axis
            own = R, numbers["offset"][k] + R[:, 2] * numbers["tau"][k]
            self.carriers[k] = beyond(self.carriers[joint.parent], own)

    def links(self) -> Iterator[RigidLink]:
        """The interface, bodies with their joints, ports."""
        yield RigidLink(self.prefix + BASE, None)
        entries: dict[int, list[tuple[int, JointEntry]]] = {}
        for k, entry in enumerate(self.m.topology.joints):
            entries.setdefault(entry.body, []).append((k, entry))
        for i in self.m.topology.order:
            yield from self._body(i, entries.get(i, []))
        for port in self.m.definition.ports:
            pose = between(self._pose(port.body), self._pose(port.name))
            yield RigidLink(self.prefix + port.name, self.prefix + port.body, pose)

    def _body(self, i: int, entries: list[tuple[int, JointEntry]]) -> Iterator[RigidLink]:
        """A body, and massless links before it where its joint is compound."""
        body = self.m.definition.bodies[i]
        parent, before = self.prefix + body.parent, self._pose(body.parent)
        ball = self.balls.get(i, "")
        laws = [dict(zip(LAWS, self.numbers["laws"][k].tolist(), strict=True)) for k, _ in entries if ball]
        damping, rotor = tuple(law["damping"] for law in laws), max((law["armature"] for law in laws), default=0.0)
        entries = [] if ball and not (ball == "ball" and self.angles) else entries
        for k, entry in entries[:-1]:
            name = self._between(f"{body.name}_{entry.step + 1}")
            own = self._drive(k, entry, np.eye(3)[2])
            yield RigidLink(name, parent, between(before, self.carriers[k]), own, is_between=True)
            parent, before = name, self.carriers[k]
        drive = None
        if entries:
            k, entry = entries[-1]
            # the axis is the third one of the carrier
            drive = self._drive(k, entry, self.numbers["frame.E"][self.frame[body.name]][:, 2])
        mass, com, six = (self.numbers[name][i] for name in ("mass", "com", "inertia"))
        tensor = np.array([[six[0], six[3], six[4]], [six[3], six[1], six[5]], [six[4], six[5], six[2]]])
        pose = between(before, self._pose(body.name))
        name = self.prefix + body.name
        yield RigidLink(name, parent, pose, drive, ball, damping, rotor, mass=float(mass), com=com, inertia=tensor)

    def _between(self, wanted: str) -> str:
        """A name that no body or port has."""
        while wanted in self.frame:
            wanted += "_"
        return self.prefix + wanted

    def _new(self, wanted: str) -> str:
        """A name that no coordinate has."""
        while wanted in self.m.topology.coordinates:
            wanted += "_"
        return wanted

    def _pose(self, frame: str) -> Pose:
        f = self.frame[frame]
        placed = {**self.m.bodies, **self.m.ports}[frame]
        own = self.numbers["frame.E"][f].T, self.numbers["frame.position"][f]
        return beyond(self.carriers[placed.carrier], own)

    def _drive(self, k: int, entry: JointEntry, axis: Array) -> Drive:
        if entry.body in self.balls:
            body = self.m.definition.bodies[entry.body].name
            return Drive(self.prefix + self._new(f"{body}_{_TURNS[entry.step]}"), False, axis)
        low_high = self.limits.get(k)
        limits = None if low_high is None else (low_high[0], low_high[1])
        laws = self.numbers["laws"][k].tolist()
        drive, mover = Drive(self.prefix + entry.coordinate, bool(entry.s), axis, limits, *laws), self.movers[k]
        if mover == k:
            return drive
        factor, offset = self.numbers["relations"][k].tolist()
        return replace(drive, mimic=(self.prefix + self.m.topology.coordinates[mover], factor, offset))

    def left_out(self, fixed: Mapping[str, Mapping[int, Expr]]) -> Iterator[str]:
        """Laws that vary, end stops, friction and loads. ``fixed``: laws that do not."""
        for k, (entry, law) in enumerate(zip(self.m.topology.joints, self.m.laws, strict=True)):
            name = f"'{self.prefix}{entry.coordinate}'"
            if k not in fixed["stiffness"]:
                yield f"the spring of {name}, which depends on the state"
            if k not in fixed["damping"]:
                yield f"the damping of {name}, which depends on the state"
            if law.stops is not None:
                yield f"the end stops of {name}"
            if law.friction is not None:
                yield f"the dry friction of {name}"
        for number, load in enumerate(self.m.definition.loads):
            if load.type == "friction":
                continue
            yield f"load {number} of '{self.prefix[:-1] or self.m.definition.name}' ({load.type})"
