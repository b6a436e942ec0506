"""The velocity forces Gamma_abc q'^b q'^c of a coupled tree in one pass out and one back, O(n) operations."""

from __future__ import annotations

from collections.abc import Sequence

from substructures.coupling import WORLD, Mounted, State
from substructures.mechanics.linear3 import S, Vector
from substructures.mechanics.newton_euler import Load, Motion, inertial_load
from substructures.skeleton import INTERFACE


def bias_forces(mounted: Sequence[Mounted], states: Sequence[State], rates: Sequence[S]) -> list[S]:
    """Gamma_abc q'^b q'^c for the velocities ``rates`` of all coordinates of the tree; hosts come first."""
    motions = body_motions(mounted, states, rates)
    loads: list[list[Load]] = []
    for state, own in zip(states, motions, strict=True):
        inertias = [state.own.inertia("inertia", c) for c in range(len(state.links))]
        loads.append([inertial_load(*pair) for pair in zip(own, [*inertias, state.own.inertia("base")], strict=True)])
    return _pass_back(mounted, states, loads, len(rates))


def body_motions(mounted: Sequence[Mounted], states: Sequence[State], rates: Sequence[S]) -> list[list[Motion]]:
    """For every part the motions at q'' = 0 of its joints' body frames, and last of its interface."""
    motions: list[list[Motion]] = []
    for m, state in zip(mounted, states, strict=True):
        motions.append(_motions(m, state, motions, rates))
    return motions


def from_body(state: State, carrier: int, z: Vector) -> Vector:
    """A vector from O of a carrier, as vector from its body frame origin."""
    return z if carrier == INTERFACE else (z[0], z[1], z[2] - state.tau[carrier])


def _motions(m: Mounted, state: State, motions: list[list[Motion]], rates: Sequence[S]) -> list[Motion]:
    """Of every joint's body frame, and last of the interface."""
    interface = Motion()
    if state.host is not None and state.link is not None:
        carrier = state.link.parent
        host = motions[m.host][carrier]
        interface = host.at(from_body(state.host, carrier, state.link.Z), state.link.rotation)
    own = [interface]
    for c, link in enumerate(state.links):
        before = own[link.parent].at(from_body(state, link.parent, link.Z), link.rotation)
        own.insert(c, before.moved(link.s, rates[m.first + c], state.tau[c]))
    return own


def _pass_back(mounted: Sequence[Mounted], states: Sequence[State], loads: list[list[Load]], n: int) -> list[S]:
    result: list[S] = [0] * n
    for i in reversed(range(len(mounted))):
        m, state, own = mounted[i], states[i], loads[i]
        for c in reversed(range(len(state.links))):
            link, load = state.links[c], own[c]
            result[m.first + c] = load.f[2] if link.s else load.n[2]
            x, y, z = load.n
            tau = state.tau[c]
            at_joint = Load(load.f, (x - tau * load.f[1], y + tau * load.f[0], z))
            own[link.parent] += at_joint.before(from_body(state, link.parent, link.Z), link.rotation)
        if m.host != WORLD and state.host is not None and state.link is not None:
            carrier = state.link.parent
            z_host = from_body(state.host, carrier, state.link.Z)
            loads[m.host][carrier] += own[INTERFACE].before(z_host, state.link.rotation)
    return result
