"""What acts between bodies of a part, as generalised forces, complete without a host (notation.md, section 7)."""

from __future__ import annotations

from fractions import Fraction

from substructures.expr.graph import Expr
from substructures.mechanics.linear3 import ZERO, dot, sub
from substructures.part.kinematics import Kinematics, own_place, point_kinematics
from substructures.part.load_names import depends_on_state, load_names
from substructures.part.loads import Between, Loads, PairVector, Spring
from substructures.part.mechanism import Mechanism, Stops
from substructures.part.pair_laws import bushing_forces, kept
from substructures.part.pairs import Pair, Reach, axes_in_world
from substructures.part.potentials import found_potential, gradient_forces, spring_potential


def velocity(m: Mechanism, a: int) -> Expr:
    """The symbol of q'^a."""
    joint = m.topology.joints[a]
    return m.scope.declare(f"{joint.coordinate}'", "velocity", "m/s" if joint.s else "rad/s")


def applied_forces(m: Mechanism, loads: Loads, k: Kinematics) -> tuple[list[Expr], Expr]:
    """(generalised forces of joint laws, actuators, potentials and what acts between frames; potential energy):
    notation.md, section 7.

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
        potential = potential + _spring_force(m, spring, k, forces)
    for reach, energy in (*loads.measured, *(_between(m, each, k) for each in loads.between)):
        for a, Q in reach.items():
            forces[a] = forces[a] + Q
        potential = potential + energy
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
        forces[a] = forces[a] - law.friction.force(velocity(m, a))
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


def _between(m: Mechanism, load: Between, k: Kinematics) -> tuple[Reach, Expr]:
    """What a bushing, a force or a moment between two frames does, and its potential."""
    pair = Pair(m.graph, own_place(k, load.start), own_place(k, load.end, load.at))
    law = load.law
    if isinstance(law, PairVector):
        vector = axes_in_world(pair.A if law.of_start else pair.B, law.vector)
        return pair.reach(N=vector) if law.moment else pair.reach(F=vector), m.graph.zero
    forces, along, about = bushing_forces(pair, law, [velocity(m, a) for a in range(len(m.joints))])
    energy = kept(along, load.steady[0], m.scope, f"{load.pointer}/stiffness")
    return forces, energy + kept(about, load.steady[1], m.scope, f"{load.pointer}/angular_stiffness")


def _spring_force(m: Mechanism, spring: Spring, k: Kinematics, forces: list[Expr]) -> Expr:
    """Adds Q_a = -(k (1 - l0/l) + c l'/l) x . dx_a, x from end to end; returns V = k (l - l0)^2 / 2, or where k or l0
    depend on the state what is found.
    """
    start, end = (point_kinematics(k, *e) for e in spring.ends)
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
    if spring.measured:
        energy = kept(energy, False, m.scope, spring.pointer)
    elif depends_on_state(m.topology, spring.stiffness, spring.length):
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
