"""Applied forces of a substructure: wrenches on bodies, point-to-point springs, joint laws (HTTP contract, section 1).

Springs and joint laws act between parts of the substructure, so that they do no work in a motion of the interface:
their generalised forces are complete without a host. Forces and torques act on the host, too: kept as wrenches.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from substructures.expr.graph import Expr
from substructures.expr.laws import tanh
from substructures.mechanics.linear3 import ZERO, Vector, apply, cross, dot, sub, transpose
from substructures.mechanics.newton_euler import Wrench
from substructures.part.definition import (
    Definition,
    ForceLoad,
    JointLoad,
    PotentialLoad,
    SpringLoad,
    TorqueLoad,
)
from substructures.part.frames import Frame
from substructures.part.load_names import depends_on_state, load_names, names_in, velocity_in
from substructures.part.mechanism import Friction, Mechanism, Stops
from substructures.part.potentials import found_potential, gradient_forces, spring_potential
from substructures.part.scope import Lookup


@dataclass(frozen=True)
class AppliedWrench:
    """A force at a point, or a moment: ``at`` [m] in the carrier's body frame, vector in its axes or in the world's."""

    carrier: int
    moment: bool
    world: bool
    at: Vector
    vector: Vector


@dataclass(frozen=True)
class Spring:
    """Spring and damper between two points fixed in carriers (body frames)."""

    ends: tuple[tuple[int, Vector], tuple[int, Vector]]
    stiffness: Expr
    damping: Expr
    length: Expr
    pointer: str


@dataclass(frozen=True)
class Loads:
    """All applied loads, read: wrenches in order, springs, extra joint forces by coordinate index, potentials.

    ``joint_terms``: the terms of the joint forces as they are written.
    """

    wrenches: tuple[AppliedWrench, ...]
    springs: tuple[Spring, ...]
    joint_forces: dict[int, Expr]
    joint_terms: dict[int, list[Expr]]
    potentials: tuple[Expr, ...] = ()


def wrench_places(definition: Definition, carrier: Mapping[str, int]) -> tuple[tuple[int, bool, bool], ...]:
    """(carrier, moment, world) of every force and torque: what coupling has to know beside the formulas."""
    return tuple(
        (carrier[load.body], isinstance(load, TorqueLoad), load.frame == "world")
        for load in definition.loads
        if isinstance(load, (ForceLoad, TorqueLoad))
    )


def dead_loads(definition: Definition) -> tuple[bool, ...]:
    """Of every force and torque, whether it is a force that is constant in the world: V = -F . x."""
    return tuple(
        isinstance(load, ForceLoad)
        and load.frame == "world"
        and all(names_in(x) <= definition.parameters.keys() for x in load.vector)
        for load in definition.loads
        if isinstance(load, (ForceLoad, TorqueLoad))
    )


def steady_loads(definition: Definition, coordinates: Iterable[str]) -> tuple[bool, ...]:
    """Of every force and torque, whether its vector depends on coordinates and parameters alone, but for those with a
    potential in closed form (:func:`dead_loads`).
    """
    known = definition.parameters.keys() | set(coordinates)
    loads = (load for load in definition.loads if isinstance(load, (ForceLoad, TorqueLoad)))
    return tuple(
        not is_dead and all(names_in(x) <= known for x in load.vector)
        for load, is_dead in zip(loads, dead_loads(definition), strict=True)
    )


def read_loads(m: Mechanism) -> Loads:
    """Read the loads; expressions may name parameters, coordinates, velocities (q'), inputs and the time t."""
    lookup = load_names(m.scope, m.definition, m.topology)
    wrenches: list[AppliedWrench] = []
    springs: list[Spring] = []
    forces: dict[int, Expr] = {}
    terms: dict[int, list[Expr]] = {}
    potentials: list[Expr] = []
    for i, load in enumerate(m.definition.loads):
        pointer = f"/loads/{i}"
        if isinstance(load, (ForceLoad, TorqueLoad)):
            wrenches += _wrench(m, load, pointer, lookup)
        elif isinstance(load, SpringLoad):
            springs += _spring(m, load, pointer, lookup)
        elif isinstance(load, PotentialLoad):
            potentials.append(_potential(m, load, pointer, lookup))
        else:
            _joint_force(m, load, pointer, lookup, forces, terms)
    m.scope.finish()
    return Loads(tuple(wrenches), tuple(springs), forces, terms, tuple(potentials))


def velocity(m: Mechanism, a: int) -> Expr:
    """The symbol of q'^a."""
    joint = m.topology.joints[a]
    return m.scope.declare(f"{joint.coordinate}'", "velocity", "m/s" if joint.s else "rad/s")


def _frame(m: Mechanism, body: str, pointer: str) -> Frame | None:
    frame = m.bodies.get(body)
    if frame is None:
        m.scope.fault(pointer, "unknown-body", f"unknown body '{body}'")
    return frame


def _wrench(m: Mechanism, load: ForceLoad | TorqueLoad, pointer: str, lookup: Lookup) -> list[AppliedWrench]:
    frame = _frame(m, load.body, f"{pointer}/body")
    if frame is None:
        return []
    vector: Vector = m.scope.vector(load.vector, f"{pointer}/vector", lookup)
    at = ZERO
    if isinstance(load, ForceLoad):
        at = frame.point(m.scope.vector(load.at, f"{pointer}/at"))
    world = load.frame == "world"
    if not world:
        # from the axes of the body to those of its carrier: E^T v
        vector = apply(transpose(frame.E), vector)
    return [AppliedWrench(frame.carrier, isinstance(load, TorqueLoad), world, at, vector)]


def _spring(m: Mechanism, load: SpringLoad, pointer: str, lookup: Lookup) -> list[Spring]:
    ends = []
    for key, end in (("from", load.from_), ("to", load.to)):
        frame = _frame(m, end.body, f"{pointer}/{key}/body")
        if frame is None:
            return []
        ends.append((frame.carrier, frame.point(m.scope.vector(end.at, f"{pointer}/{key}/at"))))
    names = ("stiffness", "damping", "length")
    stiffness, damping, length = (m.scope.read(getattr(load, name), f"{pointer}/{name}", lookup) for name in names)
    return [Spring((ends[0], ends[1]), stiffness, damping, length, pointer)]


def _potential(m: Mechanism, load: PotentialLoad, pointer: str, lookup: Lookup) -> Expr:
    """V(q, u, t) as given; a velocity in it is a fault, since then -d_a V would not be the force."""
    place = f"{pointer}/potential"
    energy = m.scope.read(load.potential, place, lookup)
    rate = velocity_in(m.topology, [energy])
    if rate is not None:
        message = f"a potential depends on coordinates, not on velocities: '{rate}' is one"
        m.scope.fault(place, "velocity-in-potential", message)
    return energy


def _joint_force(
    m: Mechanism,
    load: JointLoad,
    pointer: str,
    lookup: Lookup,
    forces: dict[int, Expr],
    terms: dict[int, list[Expr]],
) -> None:
    if load.coordinate not in m.topology.coordinates:
        m.scope.fault(f"{pointer}/coordinate", "unknown-coordinate", f"unknown coordinate '{load.coordinate}'")
        return
    a = m.topology.coordinates.index(load.coordinate)
    forces[a] = forces.get(a, m.graph.zero) + m.scope.read(load.force, f"{pointer}/force", lookup)
    terms.setdefault(a, []).extend(m.scope.terms(load.force, f"{pointer}/force", lookup))


@dataclass(frozen=True)
class PointKinematics:
    """Position and own partial velocities of a point, in the interface frame."""

    position: Vector
    u: Mapping[int, Vector]


def applied_forces(
    m: Mechanism, loads: Loads, point: Callable[[int, Vector], PointKinematics]
) -> tuple[list[Expr], Expr]:
    """(generalised forces of joint laws, actuators, springs and potentials; potential energy): notation.md, section 7.

    The potential energy is that of as much of these forces as has one: -d_a V is a part of Q_a, exactly.
    """
    zero = m.graph.zero
    forces = [loads.joint_forces.get(a, zero) for a in range(len(m.joints))]
    #: terms of those that are given as formulas: whether they have a potential is to be found out
    given = [list(loads.joint_terms.get(a, ())) for a in range(len(m.joints))]
    potential = zero
    for a, entry in enumerate(m.topology.joints):
        stretch = m.graph.symbol(entry.coordinate) - m.laws[a].rest
        tau = m.scope.declare(f"tau.{entry.coordinate}", "input", "N" if entry.s else "N m")
        forces[a] = forces[a] + tau
        potential = potential + _joint_law(m, a, stretch, forces, given)
    for energy in loads.potentials:
        # Q_a = -d_a V
        forces = [x + y for x, y in zip(forces, gradient_forces(m, energy), strict=True)]
        potential = potential + energy
    for spring in loads.springs:
        potential = potential + _spring_force(m, spring, point, forces)
    m.scope.finish()
    return forces, potential + found_potential(m, given)


def _joint_law(m: Mechanism, a: int, stretch: Expr, forces: list[Expr], given: list[list[Expr]]) -> Expr:
    """Adds Q_a = -k (q - rest) - c q' and the stops; returns V, k (q - rest)^2 / 2 where k and rest are no functions of
    the state. Where they are, the force is ``given`` as a formula.
    """
    law = m.laws[a]
    forces[a] = forces[a] - law.stiffness * stretch
    if not law.damping.is_zero:
        forces[a] = forces[a] - law.damping * velocity(m, a)
    if law.friction is not None:
        forces[a] = forces[a] - _friction_force(m, a, law.friction)
    energy = m.graph.zero
    if depends_on_state(m.topology, law.stiffness, law.rest):
        k, rest = (x if isinstance(x, str) else format(x, "f") for x in law.given)
        lookup = load_names(m.scope, m.definition, m.topology)
        terms = m.scope.terms(f"-({k})*({m.topology.coordinates[a]} - ({rest}))", "", lookup)
        given[a] += terms or [-(law.stiffness * stretch)]
    else:
        energy = law.stiffness * Fraction(1, 2) * (stretch * stretch)
    return energy if law.stops is None else energy + _stop_force(m, a, law.stops, forces)


def _stop_force(m: Mechanism, a: int, stops: Stops, forces: list[Expr]) -> Expr:
    """Adds Q_a = -(k + c q') p above the upper limit and (k - c q') p below the lower one, p beyond; returns k p^2 / 2.

    With p = max(0, x) = (x + |x|)/2 and |x| = sqrt(x^2) the force is continuous where it begins, and no formula has to
    ask on which side it is (K. H. Hunt and F. R. E. Crossley, J. Applied Mechanics 42, 1975).
    """
    q, potential = m.graph.symbol(m.topology.coordinates[a]), m.graph.zero
    for sign, beyond in ((1, q - stops.high), (-1, stops.low - q)):
        p = (beyond + m.graph.sqrt(beyond * beyond)) * Fraction(1, 2)
        # N = (k + c p') p pushes back
        push = stops.stiffness * p
        potential = potential + push * p * Fraction(1, 2)
        if not stops.damping.is_zero:
            push = push + stops.damping * (velocity(m, a) * sign) * p
        forces[a] = forces[a] - push * sign
    return potential


def _friction_force(m: Mechanism, a: int, law: Friction) -> Expr:
    """(F_c + (F_s - F_c) exp(-(q'/v_s)^2)) tanh(q'/v_0), which changes its direction over some v_0.

    The first factor: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30, 1994.
    """
    rate, size = velocity(m, a), law.coulomb
    if law.stribeck is not None:
        size = size + (law.static - law.coulomb) * m.graph.function("exp", -((rate / law.stribeck) ** 2))
    return size * tanh(rate / law.velocity)


def _spring_force(
    m: Mechanism, spring: Spring, point: Callable[[int, Vector], PointKinematics], forces: list[Expr]
) -> Expr:
    """Adds Q_a = -(k (1 - l0/l) + c l'/l) x . dx_a, x from end to end; returns V = k (l - l0)^2 / 2, or where k or l0
    depend on the state what is found.
    """
    start, end = (point(*e) for e in spring.ends)
    # x = r_to - r_from,   w_a = x . (u_to,a - u_from,a),   l l' = w_a q'^a
    x = sub(end.position, start.position)
    reach = {a: m.graph.lift(dot(x, sub(end.u.get(a, ZERO), start.u.get(a, ZERO)))) for a in {**start.u, **end.u}}
    length2 = m.graph.lift(dot(x, x))
    if length2.is_zero:
        m.scope.fault(spring.pointer, "coincident-ends", "the ends of the spring are one and the same point")
        return m.graph.zero
    # of a spring without rest length: k, and V = k l^2 / 2
    factor: Expr = spring.stiffness
    energy: Expr = spring.stiffness * length2
    if not spring.length.is_zero:
        # k (1 - l0/l) in place of k, and V = k (l - l0)^2 / 2
        length = m.graph.sqrt(length2)
        factor = factor - spring.stiffness * spring.length / length
        energy = spring.stiffness * (length - spring.length) ** 2
    if depends_on_state(m.topology, spring.stiffness, spring.length):
        # then k (l - l0)^2 / 2 is no potential of the force k (l - l0)
        energy = 2 * spring_potential(m, {a: -(factor * w) for a, w in reach.items()}, spring.pointer)
    if not spring.damping.is_zero:
        speed = m.graph.sum(velocity(m, a) * w for a, w in reach.items() if w is not m.graph.zero)
        # c l'/l = c (l l') / l^2
        factor = factor + spring.damping * speed / length2
    # Q_a = -(k (1 - l0/l) + c l'/l) w_a
    for a, w in reach.items():
        forces[a] = forces[a] - factor * w
    return energy * Fraction(1, 2)


def wrench_about_origin(at: Vector, vector: Vector, moment: bool) -> Wrench:
    """The wrench of a force at a point, or of a moment, about the carrier's body frame origin."""
    # n = x x f of a force at x
    return Wrench(ZERO, vector) if moment else Wrench(vector, cross(at, vector))
