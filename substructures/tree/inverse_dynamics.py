"""Newton and Euler's recursion through a coupled tree, one pass out and one back: O(n) operations.

It gives the velocity forces Gamma_abc q'^b q'^c without the Christoffel symbols, and inverse dynamics without these and
without the metric (Luh, Walker, Paul 1980).
"""

from __future__ import annotations

from collections.abc import Sequence

from substructures.mechanics.linear3 import Scalar, Vector, negate
from substructures.mechanics.newton_euler import BodyMotion, Wrench, inertial_load
from substructures.part.topology import INTERFACE
from substructures.tree.mounted_part import WORLD, Mounted, State, applied_wrenches


def bias_forces(mounted: Sequence[Mounted], states: Sequence[State], rates: Sequence[Scalar]) -> list[Scalar]:
    """Gamma_abc q'^b q'^c for the velocities ``rates`` of all coordinates of the tree; hosts come first."""
    loads = _inertial_loads(states, body_motions(mounted, states, rates))
    return _pass_back(mounted, states, loads, len(rates))


def inverse_dynamics(
    mounted: Sequence[Mounted], states: Sequence[State], rates: Sequence[Scalar], accelerations: Sequence[Scalar]
) -> list[Scalar]:
    """g_ab q''^b + Gamma_abc q'^b q'^c - Q_a: what actuators have to do beyond the inputs that Q_a contains.

    Gravity is a world accelerated upwards; forces and torques act on their bodies, what the joints do by themselves
    (armature, springs, dampers, actuators) on their coordinates.
    """
    loads = _inertial_loads(states, body_motions(mounted, states, rates, accelerations))
    for m, state, own in zip(mounted, states, loads, strict=True):
        for carrier, force, moment in applied_wrenches(m, state):
            own[carrier] += Wrench(negate(force), negate(moment))
    result = _pass_back(mounted, states, loads, len(rates))
    for m, state in zip(mounted, states, strict=True):
        for c in range(len(state.links)):
            a = m.first + c
            rotor = state.own.scalar("armature", c) * accelerations[a]
            result[a] = result[a] + rotor - state.stored.scalar("applied", c)
    return result


def body_motions(
    mounted: Sequence[Mounted],
    states: Sequence[State],
    rates: Sequence[Scalar],
    accelerations: Sequence[Scalar] | None = None,
) -> list[list[BodyMotion]]:
    """For every part the motions of its joints' body frames, and last of its interface.

    With ``accelerations`` the world is accelerated against gravity; without, q'' = 0 in a world at rest.
    """
    motions: list[list[BodyMotion]] = []
    for m, state in zip(mounted, states, strict=True):
        own = [_interface(m, state, motions, accelerations is not None)]
        for c, link in enumerate(state.links):
            a = m.first + c
            before = own[link.parent].at(from_body(state, link.parent, link.Z), link.rotation)
            second = 0 if accelerations is None else accelerations[a]
            own.insert(c, before.moved(link.s, rates[a], state.tau[c], second))
        motions.append(own)
    return motions


def from_body(state: State, carrier: int, z: Vector) -> Vector:
    """A vector from O of a carrier, as vector from its body frame origin."""
    return z if carrier == INTERFACE else (z[0], z[1], z[2] - state.tau[carrier])


def _interface(m: Mounted, state: State, motions: Sequence[Sequence[BodyMotion]], falling: bool) -> BodyMotion:
    """Of a part's interface."""
    if state.host is None or state.link is None:
        return BodyMotion(a=negate(state.gamma[INTERFACE])) if falling else BodyMotion()
    carrier = state.link.parent
    return motions[m.host][carrier].at(from_body(state.host, carrier, state.link.Z), state.link.rotation)


def _inertial_loads(states: Sequence[State], motions: Sequence[Sequence[BodyMotion]]) -> list[list[Wrench]]:
    """What moves every body, and last what is fixed to the interface, like that."""
    result = []
    for state, own in zip(states, motions, strict=True):
        inertias = [*(state.own.inertia("inertia", c) for c in range(len(state.links))), state.own.inertia("base")]
        result.append([inertial_load(*pair) for pair in zip(own, inertias, strict=True)])
    return result


def _pass_back(mounted: Sequence[Mounted], states: Sequence[State], loads: list[list[Wrench]], n: int) -> list[Scalar]:
    result: list[Scalar] = [0] * n
    for i in reversed(range(len(mounted))):
        m, state, own = mounted[i], states[i], loads[i]
        for c in reversed(range(len(state.links))):
            link, load = state.links[c], own[c]
            result[m.first + c] = load.f[2] if link.s else load.n[2]
            x, y, z = load.n
            tau = state.tau[c]
            at_joint = Wrench(load.f, (x - tau * load.f[1], y + tau * load.f[0], z))
            own[link.parent] += at_joint.before(from_body(state, link.parent, link.Z), link.rotation)
        if m.host != WORLD and state.host is not None and state.link is not None:
            carrier = state.link.parent
            z_host = from_body(state.host, carrier, state.link.Z)
            loads[m.host][carrier] += own[INTERFACE].before(z_host, state.link.rotation)
    return result
