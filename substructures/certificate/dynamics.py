"""Metric, Christoffel symbols, momenta and velocity forces from integrals over bodies in one world at one state.

With the velocity u_a = v_a + w_a x x that joint a gives the point x for q'^a = 1, and d_b u_c = w_b x u_c for b <= c
(notation.md, section 3), everything here is an integral over the mass that joint c carries (section 4):

    g_ac      = int u_a . u_c dm                              a <= c
    Gamma_abc = int u_a . (w_b x u_c) dm                      a, b <= c
    f_c, n_c  = int u_c dm,  int x x u_c dm
    F_bc, N_bc = int w_b x u_c dm,  int x x (w_b x u_c) dm     K_c: N_bc = K_c w_b
    kappa_ac  = int u_c x u_a dm

worked out with the moments m, s, J of that mass about the world's origin, in its axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from substructures.certificate.bodies import GROUND, Bodies, Joint, Moments, massless, theta_of
from substructures.certificate.linear import Ball, Matrix, cross, dot, identity, outer, side_by_side, skew, zeros


@dataclass(frozen=True)
class Carried:
    """What joint c carries and how it moves for q'^c = 1; ``path`` to it, W and V: w and v of its joints as columns."""

    w: Matrix
    v: Matrix
    path: list[int]
    W: Matrix
    V: Matrix
    moments: Moments
    f: Matrix
    n: Matrix
    K: Matrix

    def metric(self) -> Matrix:
        """g_ac for all a of the path, a row."""
        # int (v_a + w_a x x) . u_c dm = v_a . f_c + w_a . n_c
        return self.f.transpose() * self.V + self.n.transpose() * self.W

    def forces(self) -> tuple[Matrix, Matrix]:
        """F_bc, N_bc for all b of the path, as columns."""
        return skew(self.f) * self.W * -1, self.K * self.W

    def christoffel(self) -> Matrix:
        """Gamma_abc for all a (rows) and b (columns) of the path."""
        F, N = self.forces()
        # int (v_a + w_a x x) . (w_b x u_c) dm
        return self.V.transpose() * F + self.W.transpose() * N


def carried_by_joints(bodies: Bodies, masses: dict[int, Moments]) -> list[Carried]:
    """For every joint; ``masses``: what is fixed to each carrier, about the world's origin."""
    total = {k: masses.get(k, massless()) for k in range(len(bodies.joints))}
    for k in reversed(range(len(bodies.joints))):
        parent = bodies.joints[k].parent
        if parent != GROUND:
            total[parent] = total[parent] + total[k]
    return [_carried(bodies, c, total[c]) for c in range(len(bodies.joints))]


def _carried(bodies: Bodies, c: int, moments: Moments) -> Carried:
    path, w, v = bodies.path(c), bodies.joints[c].w, bodies.joints[c].v
    m, s, J = moments.m, moments.s, moments.J
    W, V = (side_by_side(getattr(bodies.joints[a], name) for a in path) for name in "wv")
    # int u_c = m v + w x s,   int x x u_c = s x v + Theta w
    f, n = v * m + cross(w, s), cross(s, v) + theta_of(J) * w
    # int x x (y x u_c) = int y (x . u_c) - u_c (x . y),   x . u_c = x . v
    K = identity() * dot(s, v) - outer(v, s) - skew(w) * J
    return Carried(w, v, path, W, V, moments, f, n, K)


def kappa(c: Carried) -> Matrix:
    """kappa_ac for all a of the path, as columns."""
    m, s, J = c.moments.m, c.moments.s, c.moments.J
    w, v = skew(c.w), skew(c.v)
    # int (v_c + w_c x x) x (v_a + w_a x x),   (w_c x x) x (w_a x x) = x (x . (w_c x w_a))
    return v * c.V * m - v * skew(s) * c.W + skew(w * s) * c.V + J * w * c.W


def halved(mass: Moments, b: Joint, c: Joint) -> tuple[Matrix, Matrix]:
    """int 1/2 (w_b x u_c + w_c x u_b) dm and int x x 1/2 (w_b x u_c + w_c x u_b) dm of joints that move as one."""
    m, s, J = mass.m, mass.s, mass.J
    # int w x (v + u x x) = w x (m v + u x s);   int x x (w x (v + u x x)) = s x (w x v) + (J w) x u
    force = cross(b.w, c.v * m + cross(c.w, s)) + cross(c.w, b.v * m + cross(b.w, s))
    moment = cross(s, cross(b.w, c.v) + cross(c.w, b.v)) + cross(J * b.w, c.w) + cross(J * c.w, b.w)
    return force * arb("0.5"), moment * arb("0.5")


@dataclass(frozen=True)
class Motion:
    """Of a body: angular velocity and acceleration w, dw; velocity v of what is at the world's origin, and dv = d v/dt
    there (of the field of velocities, not of a point)."""

    w: Matrix
    v: Matrix
    dw: Matrix
    dv: Matrix

    def velocity(self, p: Matrix) -> Matrix:
        """Of the point of the body at p."""
        return self.v + cross(self.w, p)

    def acceleration(self, p: Matrix) -> Matrix:
        """Of the point of the body at p: dv + dw x p + w x p'."""
        return self.dv + cross(self.dw, p) + cross(self.w, self.velocity(p))

    def turned(self, a: Matrix) -> tuple[Matrix, Matrix]:
        """First and second derivative of a direction fixed in the body."""
        first = cross(self.w, a)
        return first, cross(self.dw, a) + cross(self.w, first)


def motions(
    bodies: Bodies, rates: Sequence[Ball], second: Sequence[Ball] | None = None, world: Matrix | None = None
) -> dict[int, Motion]:
    """By carrier, with q'' = ``second`` (default: 0) and an acceleration of the ``world`` (default: 0)."""
    zero = zeros(3, 1)
    found = {GROUND: Motion(zero, zero, zero, zero if world is None else world)}
    for k, joint in enumerate(bodies.joints):
        before, rate = found[joint.parent], rates[k]
        # (w, v)_k' = (w_p x w_k, w_p x v_k + v_p x w_k): the axis moves with the body before it, or behind its group
        w, v = before.w, before.v
        for a in (a for a in joint.group if a >= k):
            w, v = w + bodies.joints[a].w * rates[a], v + bodies.joints[a].v * rates[a]
        dw = cross(w, joint.w) * rate
        dv = (cross(w, joint.v) + cross(v, joint.w)) * rate
        if second is not None:
            dw, dv = dw + joint.w * second[k], dv + joint.v * second[k]
        w, v = before.w + joint.w * rate, before.v + joint.v * rate
        found[k] = Motion(w, v, before.dw + dw, before.dv + dv)
    return found


def velocity_forces(bodies: Bodies, masses: dict[int, Moments], rates: Sequence[Ball]) -> list[Ball]:
    """Gamma_abc q'^b q'^c: the rates of momentum and moment of momentum at q'' = 0, projected on every joint."""
    loads = {k: required(motion, masses[k]) for k, motion in motions(bodies, rates).items()}
    result = [arb(0)] * len(bodies.joints)
    for k in reversed(range(len(bodies.joints))):
        joint = bodies.joints[k]
        force, moment = loads[k]
        result[k] = dot(joint.v, force) + dot(joint.w, moment)
        outer_force, outer_moment = loads[joint.parent]
        loads[joint.parent] = outer_force + force, outer_moment + moment
    return result


def required(motion: Motion, mass: Moments) -> tuple[Matrix, Matrix]:
    """p' and L' of a body, L about the world's origin; p = m v + w x s, L = s x v + Theta w."""
    m, s, theta = mass.m, mass.s, theta_of(mass.J)
    p = motion.v * m + cross(motion.w, s)
    L = cross(s, motion.v) + theta * motion.w
    force = motion.dv * m + cross(motion.dw, s) + cross(motion.w, p)
    return force, cross(s, motion.dv) + theta * motion.dw + cross(motion.w, L) + cross(motion.v, p)
