"""A definition with all its formulas in a graph: joints, inertias, frames and loads (notation.md, section 2)."""

from __future__ import annotations

from dataclasses import dataclass

from substructures.documents.units import si_unit
from substructures.errors import among
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Symbol
from substructures.expr.trigonometry import cos_sin
from substructures.loads.friction import FrictionLoad
from substructures.loads.scope import Lookup, Scope, no_names
from substructures.mechanics.balls import BallJoint
from substructures.mechanics.composite_form import Inertia, binet
from substructures.mechanics.kinematics import INTERFACE, OneDofJoint, joint_rotation
from substructures.mechanics.linear3 import (
    IDENTITY,
    ZERO,
    Matrix,
    Planar,
    Rotation,
    Symmetric,
    Turn,
    Vector,
    multiply,
    scale,
    transpose,
)
from substructures.mechanics.ratios import Ratios
from substructures.part.balls import quaternion_turn
from substructures.part.definition import Body, Definition
from substructures.part.forces.joint_laws import JointLaw, JointLaws
from substructures.part.forces.load_names import load_names
from substructures.part.frames import AXES, Frame, axis_rotation
from substructures.part.relations import read_relations
from substructures.part.topology import BASE, JointEntry, Topology, topology

UNITS = ("rad", "m")  #: of a revolute and of a prismatic coordinate


@dataclass(frozen=True)
class Mechanism:
    """Joints with the inertia of everything fixed to them; frames of bodies and ports."""

    definition: Definition
    topology: Topology
    scope: Scope
    joints: tuple[OneDofJoint, ...]
    own: tuple[Inertia, ...]  #: own inertia of carrier k about its body frame origin
    base: Inertia  #: what is fixed to the interface
    laws: tuple[JointLaw, ...]
    bodies: dict[str, Frame]
    ports: dict[str, Frame]
    central: dict[int, tuple[Expr, Symmetric]]  #: mass and Binet tensor about the mass centre, by body index
    names: Lookup  #: of loads and joint laws, without measures
    ratios: Ratios
    multipliers: tuple[Expr, ...]  #: mu of all joints, 1 of those that no relation moves
    offsets: tuple[Expr, ...]  #: delta of all joints
    positions: tuple[Expr, ...]  #: q^a of all joints

    @property
    def graph(self) -> Graph:
        """The graph of all formulas."""
        return self.scope.graph


def mechanism(definition: Definition) -> Mechanism:
    """Read all expressions of a definition. Raises InvalidDocument with a pointer to every fault."""
    layout = topology(definition)
    scope = _scope(definition, layout)
    builder = _Builder(definition, layout, scope)
    for i in layout.order:
        builder.add(i, definition.bodies[i])
    ports = {}
    for i, port in enumerate(definition.ports):
        pointer = f"/ports/{i}"
        E = scope.rpy(port.rotation.rpy, f"{pointer}/rotation/rpy").matrix()
        ports[port.name] = builder.bodies[port.body].placed(E, scope.vector(port.position, f"{pointer}/position"))
    for i, load in enumerate(definition.loads):
        known = [joint.coordinate for joint in layout.joints]
        if isinstance(load, FrictionLoad) and load.coordinate not in known:
            message = f"unknown coordinate '{load.coordinate}'{among(load.coordinate, known, len(scope.faults))}"
            scope.fault(f"/loads/{i}/coordinate", "unknown-coordinate", message)
    scope.finish()
    return Mechanism(
        definition,
        layout,
        scope,
        tuple(builder.joints),
        tuple(builder.own[k] for k in range(len(builder.joints))),
        builder.own[INTERFACE],
        tuple(builder.laws),
        builder.bodies,
        ports,
        builder.central,
        builder.names,
        Ratios(layout.moved_by, tuple(mu for _, mu, _ in builder.relations), layout.movers),
        tuple(mu for _, mu, _ in builder.relations),
        tuple(delta for _, _, delta in builder.relations),
        tuple(builder.positions),
    )


def _scope(definition: Definition, layout: Topology) -> Scope:
    scope = Scope(Graph())
    aside = Scope(Graph(), faults=scope.faults)  # formulas have the same order whatever the defaults are
    for name, parameter in sorted(definition.parameters.items()):
        scope.declare(name, "parameter", si_unit(parameter.unit))
        if parameter.value is not None:
            aside.read(parameter.value, f"/parameters/{name}/value", no_names)
    for name, given in sorted(definition.inputs.items()):
        if given.default is not None:
            aside.read(given.default, f"/inputs/{name}/default", no_names)
    for a in layout.movers:
        if not layout.joints[a].is_rate:
            scope.symbols[layout.joints[a].coordinate] = _coordinate(layout.joints[a])
    for ball in layout.balls:
        units = dict.fromkeys(ball.quaternion, "") | dict.fromkeys(ball.place, "m")
        scope.symbols |= {name: Symbol(name, "coordinate", units[name]) for name in ball.positions}
    return scope


def _coordinate(joint: JointEntry) -> Symbol:
    return Symbol(joint.coordinate, "coordinate", UNITS[joint.s])


class _Builder:
    """Adds bodies one by one, parents first."""

    def __init__(self, definition: Definition, layout: Topology, scope: Scope) -> None:
        self.definition, self.scope = definition, scope
        self.entries: dict[int, list[JointEntry]] = {}
        for entry in layout.joints:
            self.entries.setdefault(entry.body, []).append(entry)
        self.balls = {ball.body: ball for ball in layout.balls}
        self.joints: list[OneDofJoint] = []
        self.own = {INTERFACE: Inertia()}
        self.laws: list[JointLaw] = []
        self.central: dict[int, tuple[Expr, Symmetric]] = {}
        self.bodies = {BASE: Frame(INTERFACE, IDENTITY, ZERO)}
        inputs = {name: si_unit(each.unit) for name, each in definition.inputs.items()}
        names = [entry.coordinate for entry in layout.joints]
        self.relations = read_relations(definition.relations, layout.before, names, scope)
        # names of all joints before the first one is added: its laws may depend on coordinates further out
        kinds = {names[a]: layout.joints[a].s for a in layout.movers}
        moved = {
            names[a]: (mu * scope.graph.symbol(names[of]) + delta, mu, names[of])
            for a, (of, mu, delta) in enumerate(self.relations)
            if of != a
        }
        self.positions: list[Expr] = []
        rates = frozenset(entry.coordinate for entry in layout.joints if entry.is_rate)
        self.names = load_names(scope, inputs, kinds, moved, rates)
        self.joint_laws = JointLaws(definition, self.entries, scope, self.names)

    def add(self, i: int, body: Body) -> None:
        """Place the joint(s) of a body, then give its inertia to the carrier."""
        pointer = f"/bodies/{i}"
        frame = self._placed(self.bodies[body.parent], body, f"{pointer}/joint")
        axis = self._axis(body, f"{pointer}/joint")
        if i in self.balls:
            frame = self._turned(frame, self.balls[i])
        for entry in self.entries.get(i, []):
            frame = self._joint(frame, entry, body, axis, f"{pointer}/joint")
        if body.joint.type == "fixed":
            frame = self._fixed(frame, body, f"{pointer}/joint")
        self.bodies[body.name] = frame
        self._inertia(frame, i, body, pointer)

    def _placed(self, parent: Frame, body: Body, pointer: str) -> Frame:
        """The frame before the joint moves: by the row psi, theta, d, sigma or by a placement."""
        joint, read = body.joint, self.scope.read
        psi, theta = (read(getattr(joint, name), f"{pointer}/{name}") for name in ("psi", "theta"))
        d, sigma = (read(getattr(joint, name), f"{pointer}/{name}") for name in ("d", "sigma"))
        if joint.placement is not None:
            if any(not x.is_zero for x in (psi, theta, d, sigma)):
                message = "give either psi, theta, d, sigma or a placement, not both"
                self.scope.fault(f"{pointer}/placement", "row-and-placement", message)
            # A and Z as constants in place of the row
            rotation = self.scope.rpy(joint.placement.rpy, f"{pointer}/placement/rpy")
            return parent.placed(
                rotation.matrix(), self.scope.vector(joint.placement.position, f"{pointer}/placement/position")
            )
        # A = Rx(theta)^T Rz(psi)^T,   (d cos psi, d sin psi, sigma)
        c, s = cos_sin(psi)
        E = Rotation((Planar(2, c, s), Planar(0, *cos_sin(theta)))).matrix()
        return parent.placed(E, (d * c, d * s, sigma))

    def _fixed(self, frame: Frame, body: Body, pointer: str) -> Frame:
        """Rz(phi) Tz(tau), both constant; nothing moves that could have a spring, a damper, a rotor or limits."""
        for name in ("stiffness", "rest", "damping", "armature", "limits", "limits_act", "friction"):
            if getattr(body.joint, name) not in (0, None):
                self.scope.fault(f"{pointer}/{name}", "law-of-fixed", f"a fixed joint has no {name}")
        phi, tau = (self.scope.read(getattr(body.joint, name), f"{pointer}/{name}") for name in ("phi", "tau"))
        return frame.placed(Planar(2, *cos_sin(phi)).matrix(), (self.scope.graph.zero, self.scope.graph.zero, tau))

    def _turned(self, frame: Frame, ball: BallJoint) -> Frame:
        """The frame of the body that a ball or floating joint carries, from which its joints, at zero, do not lead."""
        graph, names = self.scope.graph, ball.place
        place: Vector = (graph.symbol(names[0]), graph.symbol(names[1]), graph.symbol(names[2])) if names else ZERO
        return frame.placed(quaternion_turn(graph, ball.quaternion), place)

    def _axis(self, body: Body, pointer: str) -> Matrix:
        """E from the placed frame to the frame whose third axis is the joint axis."""
        joint = body.joint
        if joint.axis is None:
            return IDENTITY
        if joint.placement is None or joint.type not in ("revolute", "prismatic"):
            message = "'axis' goes with a placement, {} where nothing is moved, and a revolute or prismatic joint"
            self.scope.fault(f"{pointer}/axis", "axis-without-placement", message)
            return IDENTITY
        return axis_rotation(self.scope, joint.axis, f"{pointer}/axis")

    def _joint(self, frame: Frame, entry: JointEntry, body: Body, axis: Matrix, pointer: str) -> Frame:
        """One degree of freedom; returns the frame that moves with it, turned back from the joint axis."""
        turned = multiply(AXES[entry.axis], axis) if body.joint.axis is not None else AXES[entry.axis]
        # joints of a ball stand at zero behind its quaternion: what they have are rates (section 14)
        q = (None if entry.is_rate else self.names(entry.coordinate)) or self.scope.graph.zero
        self.positions.append(q)
        phi, tau = self._offsets(entry, body, pointer)
        constant = multiply(turned, frame.E)
        # revolute: phi = q + phi0, tau constant;   prismatic: tau = q + tau0, phi constant
        phi, tau = (phi, q + tau) if entry.s else (q + phi, tau)
        rotation = joint_rotation(constant, *cos_sin(phi))
        self.joints.append(OneDofJoint(frame.carrier, entry.s, rotation, frame.position, tau))
        self.own[len(self.joints) - 1] = Inertia()
        self.laws.append(self.joint_laws.law(entry, body, pointer))
        # the body is described in the placed frame: back from the axes in which its joint axis is e3
        return Frame(len(self.joints) - 1, transpose(turned), ZERO)

    def _offsets(self, entry: JointEntry, body: Body, pointer: str) -> tuple[Expr, Expr]:
        """phi and tau: constants of the joint (compound joints have none)."""
        phi, tau = (self.scope.read(getattr(body.joint, name), f"{pointer}/{name}") for name in ("phi", "tau"))
        for name, offset in (("phi", phi), ("tau", tau)):
            if len(self.entries[entry.body]) > 1 and not offset.is_zero:
                message = f"{name} does not go with a {body.joint.type} joint"
                self.scope.fault(f"{pointer}/{name}", "offset-of-compound", message)
        return phi, tau

    def _inertia(self, frame: Frame, i: int, body: Body, pointer: str) -> None:
        scope, tensor = self.scope, body.inertia
        mass = scope.read(body.mass, f"{pointer}/mass")
        com = scope.vector(body.com, f"{pointer}/com")
        xx, yy, zz = (scope.read(getattr(tensor, e), f"{pointer}/inertia/{e}") for e in ("xx", "yy", "zz"))
        xy, xz, yz = (scope.read(getattr(tensor, e), f"{pointer}/inertia/{e}") for e in ("xy", "xz", "yz"))
        J = binet((xx, yy, zz, xy, xz, yz))
        # J = J_C + m h h^T, s = m h about the body frame origin
        if tensor.about == "com":
            inertia = Inertia(mass, ZERO, J).shifted(com)
        else:
            inertia = Inertia(mass, scale(mass, com), J)
            # J_C = J - m h h^T
            J = Inertia(-mass, ZERO, J).shifted(com).J
        self.central[i] = mass, J
        moved = inertia.in_parent(Rotation((Turn(frame.E),)), frame.position)
        self.own[frame.carrier] = self.own[frame.carrier] + moved
