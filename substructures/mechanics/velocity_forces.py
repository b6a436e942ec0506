"""Gamma_abc q'^b q'^c from the composites of the metric, over any scalar: O(n) operations (notation.md, section 5).

Summed over the larger one of b and c. Where that is a joint c > a, its Christoffel symbols are those of a wrench that
joint c alone needs, on the axis of a; where both are less than a, everything beyond a moves as one rigid body.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from substructures.mechanics.composite_form import Inertia, JointMomentum
from substructures.mechanics.kinematics import INTERFACE, Link
from substructures.mechanics.linear3 import Scalar, dot, scale
from substructures.mechanics.newton_euler import BodyMotion
from substructures.mechanics.wrench import Wrench


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
    return [each.force for each in transmitted(chain, momenta, rates, motions_before(chain, rates, start or {}))]


@dataclass(frozen=True, slots=True)
class Transmitted:
    """At a joint, about O_k in frame k: the wrench that it transmits from joints beyond it, its ``own`` for what it
    carries, and the generalised force.
    """

    beyond: Wrench
    own: Wrench
    force: Scalar


def transmitted(
    chain: Sequence[Link], momenta: Sequence[JointMomentum], rates: Sequence[Scalar], before: Sequence[BodyMotion]
) -> list[Transmitted]:
    """The velocity forces of all joints; ``before``: what :func:`motions_before` gives."""
    n = len(chain)
    wrenches, result = [Wrench()] * n, list[Transmitted]()
    for a in reversed(range(n)):
        link, momentum, motion = chain[a], momenta[a], before[a]
        # bias_a = (wrenches of joints c > a, on axis a) + p_a . a + H_a . alpha - omega . K_a omega
        total = wrenches[a].f[2] if link.s else wrenches[a].n[2]
        # one by one: a . p of a root is the gravity force, which may be known as a longer formula
        for x, p in zip(motion.a, momentum.p, strict=True):
            total = total + x * p
        of_mass, own = (_sliding if link.s else _turning)(momentum.composite, motion, rates[a])
        result.append(Transmitted(wrenches[a], own, total + of_mass))
        if link.parent != INTERFACE:
            wrenches[link.parent] += (wrenches[a] + own).before(link.Z, link.rotation)
    return result[::-1]


def motions_before(chain: Sequence[Link], rates: Sequence[Scalar], start: Mapping[int, BodyMotion]) -> list[BodyMotion]:
    """omega, alpha and the acceleration of O_k for q'' = 0, in frame k, of what joint k is fixed to."""
    before: list[BodyMotion] = []
    after: list[BodyMotion] = []
    for k, link in enumerate(chain):
        outer = start.get(k, BodyMotion()) if link.parent == INTERFACE else after[link.parent]
        before.append(outer.at_joint(link, link.Z))
        after.append(before[k].moved(link.s, rates[k], 0))
    return before


def _turning(carried: Inertia, before: BodyMotion, rate: Scalar) -> tuple[Scalar, Wrench]:
    """Of a revolute joint c: H . alpha - omega . K omega, and F_c = q' (w x p), N_c = q' K w with w = 2 omega + q' e3.

    ``before``: the motion of what the joint is fixed to.
    """
    x, y, z = before.omega
    u, v, _ = before.third_column()
    xx, yy, _, xy, xz, yz = carried.J
    # (i, j, .) = J (omega_1, omega_2, 0)
    i, j = x * xx + y * xy, x * xy + y * yy
    # H . alpha - omega . K omega is the third component of axial(A J)
    n = (v * xz - u * yz) + (y * i - x * j) + before.alpha[2] * carried.about_third_axis
    # q' w = (2 q' omega_1, 2 q' omega_2, h)
    twice, h = 2 * rate, rate * (2 * z + rate)
    sx, sy, _ = carried.s
    force = -(h * sx), -(h * sy), twice * (x * sx + y * sy)
    return n, Wrench(force, (twice * j + h * yz, -(twice * i + h * xz), 0))


def _sliding(carried: Inertia, before: BodyMotion, rate: Scalar) -> tuple[Scalar, Wrench]:
    """The same of a prismatic joint c: w = 2 omega."""
    x, y, _ = before.omega
    sx, sy, sz = carried.s
    twice = 2 * rate
    p = twice * carried.m
    # H . alpha - omega . K omega = (A s)_3
    f = dot(before.field()[2], carried.s)
    return f, Wrench((p * y, -(p * x), 0), scale(twice, (x * sz, y * sz, -(x * sx + y * sy))))
