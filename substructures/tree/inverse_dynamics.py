"""Newton and Euler's recursion through a coupled tree, one pass out and one back: O(n) operations.

It gives the velocity forces Gamma_abc q'^b q'^c without the Christoffel symbols, and inverse dynamics without these and
without the metric (Luh, Walker, Paul 1980). Motions and loads are kept by carrier: in body frames and the interface.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.mechanics.balls import at_constant_rates
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import INTERFACE, from_body
from substructures.mechanics.linear3 import Scalar, exactly, negate
from substructures.mechanics.newton_euler import BodyMotion, inertial_load
from substructures.mechanics.wrench import Wrench
from substructures.tree.grouping import Inertias, on_carriers
from substructures.tree.mounted_part import WORLD, PlacedPart, balls_in

Motions = dict[int, BodyMotion]
WrenchesByCarrier = dict[int, Wrench]


def bias_forces(
    placed: Sequence[PlacedPart], rates: Sequence[Scalar], falling: bool = False, second: Sequence[Scalar] = ()
) -> list[Scalar]:
    """Gamma_abc q'^b q'^c [N m, N] for the velocities ``rates`` of all joints of the tree; hosts come first.

    ``falling``: less the gravity forces, in a world that is accelerated against gravity; ``second``: q'' where all
    rates are constant, if it is not zero there.
    """
    inertias = on_carriers(placed)
    # without accelerations the world is at rest: to fall it takes q'' = 0 that is given
    motions = body_motions(placed, rates, second or ([0] * len(rates) if falling else None), inertias, falling)
    loads = inertial_loads(inertias, motions)
    return pass_back(placed, loads, len(rates))


def inverse_dynamics(
    placed: Sequence[PlacedPart], rates: Sequence[Scalar], accelerations: Sequence[Scalar]
) -> list[Scalar]:
    """g_ab q''^b + Gamma_abc q'^b q'^c - Q_a: what actuators have to do beyond the inputs that Q_a contains.

    Gravity is a world accelerated upwards; forces and torques act on their bodies, what the joints do by themselves
    (armature, springs, dampers, actuators) on their coordinates.
    """
    inertias, derivatives = on_carriers(placed), list(accelerations)
    for a, turned in enumerate(at_constant_rates(balls_in(placed), rates)):
        derivatives[a] = derivatives[a] - turned
    loads = inertial_loads(inertias, body_motions(placed, rates, accelerations, inertias))
    subtract_applied(placed, loads)
    result = pass_back(placed, loads, len(rates))
    for here in placed:
        # `applied` is stored by coordinate: at its own joint, where mu = 1, N^T leaves it as it is
        own = {c: i for i, c in enumerate(here.part.topology.movers)}
        for c in range(len(here.links)):
            a = here.first + c
            # + armature_a v'^a - Q_a of the joint itself; v' = q'' but of balls
            rotor = here.evaluated.own.scalar("armature", c) * derivatives[a]
            applied = here.outputs.scalar("applied", own[c]) if c in own else 0
            result[a] = result[a] + rotor - applied
    return result


def body_motions(
    placed: Sequence[PlacedPart],
    rates: Sequence[Scalar],
    accelerations: Sequence[Scalar] | None = None,
    inertias: Sequence[Mapping[int, Inertia]] = (),
    falling: bool = True,
) -> list[Motions]:
    """For every part the motions of its body frames and of its interface, by carrier.

    With ``accelerations`` the world is accelerated against gravity, if ``falling``; without, q'' = 0 in a world at
    rest. ``inertias``: of the carriers, by part, unless they are those of the parts.
    """
    motions: list[Motions] = []
    for here, moving in zip(placed, inertias or [here.evaluated.inertias for here in placed], strict=True):
        own = {INTERFACE: _interface_motion(here, motions, falling and accelerations is not None)}
        for c, link in enumerate(here.links):
            a = here.first + c
            # from the body frame of the parent to O_c, then by the joint's own motion to the body frame of c
            second = 0 if accelerations is None else accelerations[a]
            before = own[link.parent].at_joint(link, from_body(here.links, link))
            # J_13 tells in which of two ways A_11 takes fewer operations (BodyMotion)
            J = moving.get(c, Inertia()).J
            own[c] = before.moved(link.s, rates[a], link.tau, second, not exactly(J[4], 0))
        motions.append(own)
    return motions


def _interface_motion(here: PlacedPart, motions: Sequence[Motions], falling: bool) -> BodyMotion:
    """Of the host's carrier at the interface, or of the world."""
    if here.host is None:
        # a = -gamma
        return BodyMotion(a=negate(here.gamma[INTERFACE])) if falling else BodyMotion()
    seat = here.seat
    return motions[here.mounted.host][seat.parent].at(from_body(here.host.links, seat), seat.rotation)


def subtract_applied(placed: Sequence[PlacedPart], loads: Sequence[WrenchesByCarrier]) -> None:
    """A force that acts on a body is one that the joints need not transmit."""
    for here, own in zip(placed, loads, strict=True):
        for carrier, wrench in here.applied_wrenches():
            own[carrier] += Wrench(negate(wrench.f), negate(wrench.n))


def inertial_loads(inertias: Sequence[Inertias], motions: Sequence[Motions]) -> list[WrenchesByCarrier]:
    """What moves all carriers like that, and nothing interfaces."""
    return [
        {c: inertial_load(own[c], moving.get(c, Inertia())) for c in own if c != INTERFACE} | {INTERFACE: Wrench()}
        for moving, own in zip(inertias, motions, strict=True)
    ]


def pass_back(placed: Sequence[PlacedPart], loads: list[WrenchesByCarrier], n: int) -> list[Scalar]:
    """The component along or about its axis of what every joint has to transmit, from the leaves to the root.

    Afterwards ``loads`` are of everything that hangs on a carrier, about its body frame origin in its axes.
    """
    result: list[Scalar] = [0] * n
    for here, own in zip(reversed(placed), reversed(loads), strict=True):
        for c in reversed(range(len(here.links))):
            link, load = here.links[c], own[c]
            # e3 . f (prismatic) or e3 . n (revolute): tau e3 x f has no third component
            result[here.first + c] = load.f[2] if link.s else load.n[2]
            # f and n + tau e3 x f about O_c, turned back and moved to the body frame of the parent
            own[link.parent] += load.about_joint(link.tau).before(from_body(here.links, link), link.rotation)
        if here.mounted.host != WORLD and here.host is not None:
            seat = here.seat
            outer = loads[here.mounted.host]
            outer[seat.parent] += own[INTERFACE].before(from_body(here.host.links, seat), seat.rotation)
    return result
