"""The loads of a part: read, and what acts between its bodies as generalised forces (notation.md, section 7).

Springs, bushings and what else acts between parts of the substructure do no work in a motion of the interface: their
generalised forces are complete without a host. Forces and torques act on the host, too: kept as wrenches
(:mod:`substructures.part.forces.wrenches`), as are those between two frames in the axes of the world.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from substructures.expr.graph import Expr
from substructures.loads.document import Law, LoadFormulas
from substructures.loads.joint import JointForce
from substructures.loads.pairs import Reach
from substructures.part.forces.joint_laws import Stops
from substructures.part.forces.load_names import depends_on_state
from substructures.part.forces.own_names import OwnNames
from substructures.part.forces.potentials import found_potential
from substructures.part.forces.wrenches import AppliedWrench, acts_on_host, read_wrenches
from substructures.part.kinematics import Kinematics
from substructures.part.mechanism import Mechanism


@dataclass
class Loads:
    """All applied loads, read: wrenches, forces on coordinates and all other laws, each in order."""

    wrenches: list[AppliedWrench] = field(default_factory=list)
    joints: list[JointForce] = field(default_factory=list)
    laws: list[Law] = field(default_factory=list)


def read_loads(m: Mechanism) -> Loads:
    """Read the loads; expressions may name parameters, coordinates, velocities (q'), inputs, the time t and measures of
    frames. Friction is a law of the joint (:mod:`substructures.part.mechanism`).
    """
    names, found = OwnNames(m), Loads()
    for i, load in enumerate(m.definition.loads):
        if acts_on_host(load):
            found.wrenches += read_wrenches(names, load, f"/loads/{i}")
            continue
        law = load.law(names, f"/loads/{i}")
        if isinstance(law, JointForce):
            found.joints.append(law)
        elif law is not None:
            found.laws.append(law)
    m.scope.finish()
    return found


def velocity(m: Mechanism, a: int) -> Expr:
    """q'^a of joint a: the symbol of the coordinate that moves it, times its multiplier."""
    joint = m.topology.joints[m.topology.movers[m.ratios.of[a]]]
    rate = m.scope.declare(f"{joint.coordinate}'", "velocity", "m/s" if joint.s else "rad/s")
    return rate * m.multipliers[a]


def applied_forces(m: Mechanism, loads: Loads, k: Kinematics) -> tuple[list[Expr], Expr]:
    """Q_a of joint laws, actuators, potentials and what acts between frames, by joint [N m, N], and potential energy
    [J]: notation.md, section 7.

    The potential energy is that of as much of these forces as has one: -d_a V is a part of Q_a, exactly. Raises
    InvalidDocument for faults of the loads.
    """
    zero, names = m.graph.zero, OwnNames(m, k)
    forces = [zero for _ in m.joints]
    #: terms of those that are given as formulas: whether they have a potential is to be found out
    given: list[list[Expr]] = [[] for _ in m.joints]
    potential = zero
    for load in loads.joints:
        forces[load.a] = forces[load.a] + load.force
        # along rates, which are no derivatives of coordinates, a force is no gradient
        given[load.a] += [] if m.topology.joints[load.a].is_rate else load.terms
    # all is by joint here, of which one that a relation moves has laws, but no coordinate and so no actuator
    movers = set(m.topology.movers)
    for a, entry in enumerate(m.topology.joints):
        stretch = m.positions[a] - m.laws[a].rest
        if a in movers:
            forces[a] = forces[a] + m.scope.declare(f"tau.{entry.coordinate}", "input", "N" if entry.s else "N m")
        potential = potential + _joint_law(m, a, stretch, forces, given)
    found = LoadFormulas(Reach(dict(enumerate(forces))), potential)
    for law in loads.laws:
        law.acts(names, found)
    m.scope.finish()
    # Q_i = N_ai Q_a (section 6) for the potential, a function of coordinates; the forces have theirs at the end of all
    whole: list[list[Expr]] = [[] for _ in m.topology.coordinates]
    for i, mu, terms in zip(m.ratios.of, m.multipliers, given, strict=True):
        whole[i] += [term * mu for term in terms]
    return list(found.forces.values()), found.potential + found_potential(m.scope, m.topology.coordinates, whole)


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
    if depends_on_state(m.topology.coordinates, law.stiffness, law.rest):
        k, rest = (x if isinstance(x, str) else format(x, "f") for x in law.given)
        # read once more as a sum: which of its terms depend on the time is told as it is written (section 7)
        terms = m.scope.terms(f"-({k})*({m.topology.joints[a].coordinate} - ({rest}))", "", m.names)
        given[a] += terms or [-(law.stiffness * stretch)]
    else:
        energy = law.stiffness * Fraction(1, 2) * (stretch * stretch)
    return energy if law.stops is None else energy + _stop_force(m, a, law.stops, forces)


def _stop_force(m: Mechanism, a: int, stops: Stops, forces: list[Expr]) -> Expr:
    """Adds Q_a = -(k + c q') p above the upper limit and (k - c q') p below the lower one, p beyond; returns k p^2 / 2.

    With p = max(0, x) = (x + |x|)/2 and |x| = sqrt(x^2) the force is continuous where it begins, and no formula has to
    ask on which side it is (K. H. Hunt and F. R. E. Crossley, J. Applied Mechanics 42, 1975).
    """
    q, potential = m.positions[a], m.graph.zero
    for sign, beyond in ((1, q - stops.high), (-1, stops.low - q)):
        p = (beyond + m.graph.sqrt(beyond * beyond)) * Fraction(1, 2)
        # N = (k + c p') p pushes back
        push = stops.stiffness * p
        potential = potential + push * p * Fraction(1, 2)
        if not stops.damping.is_zero:
            push = push + stops.damping * (velocity(m, a) * sign) * p
        forces[a] = forces[a] - push * sign
    return potential
