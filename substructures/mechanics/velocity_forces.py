"""Gamma_abc q'^b q'^c from the composites of the metric, over any scalar: O(n) operations (notation.md, section 5).

Summed over the larger one of b and c. Where that is a joint c > a, its Christoffel symbols are those of a wrench that
joint c alone needs, on the axis of a; where both are less than a, everything beyond a moves as one rigid body.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.mechanics.composite_form import JointMomentum
from substructures.mechanics.kinematics import INTERFACE, Link
from substructures.mechanics.linear3 import Scalar, cross, dot, scale
from substructures.mechanics.newton_euler import BodyMotion, Wrench


def velocity_forces(
    chain: Sequence[Link],
    momenta: Sequence[JointMomentum],
    rates: Sequence[Scalar],
    start: Mapping[int, BodyMotion] | None = None,
) -> list[Scalar]:
    """Gamma_abc q'^b q'^c for all a, from p, H and K of all joints.

    ``start``: the motion of what carries the first joints, by joint, in the axes and at the origin from which their
    links lead; with -gamma for its acceleration the result is Gamma_abc q'^b q'^c - Q_a of gravity.
    """
    n = len(chain)
    before = _motions_before(chain, rates, start or {})
    wrenches, result = [Wrench()] * n, list[Scalar]([0] * n)
    for a in reversed(range(n)):
        link, momentum, motion = chain[a], momenta[a], before[a]
        # bias_a = (wrenches of joints c > a, on axis a) + p_a . a + H_a . alpha - omega . K_a omega
        total = wrenches[a].f[2] if link.s else wrenches[a].n[2]
        # one by one: a . p of a root is the gravity force, which may be known as a longer formula
        for x, p in zip(motion.a, momentum.p, strict=True):
            total = total + x * p
        result[a] = total + dot(motion.alpha, momentum.H) - dot(motion.omega, momentum.moment(motion.omega))
        if link.parent != INTERFACE:
            needed = wrenches[a] + _wrench(momentum, motion, rates[a])
            wrenches[link.parent] += needed.before(link.Z, link.rotation)
    return result


def _motions_before(
    chain: Sequence[Link], rates: Sequence[Scalar], start: Mapping[int, BodyMotion]
) -> list[BodyMotion]:
    """omega, alpha and the acceleration of O_k for q'' = 0, in frame k, of what joint k is fixed to."""
    before: list[BodyMotion] = []
    after: list[BodyMotion] = []
    for k, link in enumerate(chain):
        outer = start.get(k, BodyMotion()) if link.parent == INTERFACE else after[link.parent]
        before.append(outer.at(link.Z, link.rotation))
        after.append(before[k].moved(link.s, rates[k], 0))
    return before


def _wrench(momentum: JointMomentum, before: BodyMotion, rate: Scalar) -> Wrench:
    """About O_c: F_c = q'_c (w x p_c), N_c = q'_c K_c w, w = 2 omega + q'_c Omega_cc with omega before joint c."""
    x, y, z = scale(2, before.omega)
    w = (x, y, z) if momentum.s else (x, y, z + rate)
    return Wrench(scale(rate, cross(w, momentum.p)), scale(rate, momentum.moment(w)))
