"""Accelerations and the forces they need: Gamma_abc q'^b q'^c without the Christoffel symbols, inverse dynamics.

Written for a body frame with origin B: omega, alpha and the acceleration of B in frame k. With the matrix
A = skew(alpha) + skew(omega)^2 a point x of the body has the acceleration a + A x, so that (m, s, J) about B give the
force m a + A s and the moment s x a + axial(A J), n_i = eps_ijk (A J)_kj (Luh, Walker, Paul 1980, in Binet form).
"""

from __future__ import annotations

from dataclasses import dataclass

from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.linear3 import (
    E3,
    ZERO,
    Matrix,
    Rotation,
    Scalar,
    Vector,
    add,
    apply,
    cross,
    dense,
    dot,
    scale,
    transpose,
)


@dataclass(frozen=True, slots=True)
class BodyMotion:
    """omega [rad/s], alpha [rad/s^2] of a body and the acceleration a [m/s^2] of a point of it, in its frame."""

    omega: Vector = ZERO
    alpha: Vector = ZERO
    a: Vector = ZERO

    def field(self) -> Matrix:
        """A = skew(alpha) + skew(omega)^2."""
        # skew(omega)^2 = omega omega^T - |omega|^2 1
        x, y, z = self.omega
        xx, yy, zz, xy, xz, yz = x * x, y * y, z * z, x * y, x * z, y * z
        p, q, r = self.alpha
        return (-(yy + zz), xy - r, xz + q), (xy + r, -(xx + zz), yz - p), (xz - q, yz + p, -(xx + yy))

    def at(self, z: Vector, rotation: Rotation) -> BodyMotion:
        """The same body's motion at the point z, in a turned frame."""
        # a + A z
        a = add(self.a, apply(self.field(), z))
        return BodyMotion(rotation.forward(self.omega), rotation.forward(self.alpha), rotation.forward(a))

    def moved(self, s: int, rate: Scalar, tau: Scalar, acceleration: Scalar = 0) -> BodyMotion:
        """The motion of body k at B_k = O_k + tau e3 from that of its parent at O_k, in frame k; q' = rate, q''."""
        # a_B = a_O + A tau e3, with A of the parent
        a = add(self.a, apply(self.field(), (0, 0, tau)))
        turning, along = scale(rate, cross(self.omega, E3)), (0, 0, acceleration)
        if s:
            # a_k = a_B + 2 q' omega x e3 + q'' e3
            return BodyMotion(self.omega, self.alpha, add(add(a, scale(2, turning)), along))
        # omega_k = omega + q' e3,   alpha_k = alpha + q' omega x e3 + q'' e3
        return BodyMotion(add(self.omega, (0, 0, rate)), add(add(self.alpha, turning), along), a)


@dataclass(frozen=True, slots=True)
class Wrench:
    """A force and its moment about the origin of a frame, in that frame."""

    f: Vector = ZERO
    n: Vector = ZERO

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(add(self.f, other.f), add(self.n, other.n))

    def about_joint(self, tau: Scalar) -> Wrench:
        """About O_k, from which tau e3 leads to the body frame origin where this one is given: n + tau e3 x f."""
        x, y, z = self.n
        return Wrench(self.f, (x - tau * self.f[1], y + tau * self.f[0], z))

    def before(self, z: Vector, rotation: Rotation) -> Wrench:
        """About the origin of the frame before, from which z leads to this one."""
        # E^T f,   E^T n + z x E^T f
        f = rotation.back(self.f)
        return Wrench(f, add(rotation.back(self.n), cross(z, f)))


def inertial_load(motion: BodyMotion, inertia: Inertia) -> Wrench:
    """What moves the body like that: m a + A s, s x a + axial(A J)."""
    # f = m a + A s,   n = s x a + axial(A J),   axial(X) = (X_32 - X_23, X_13 - X_31, X_21 - X_12)
    A = motion.field()
    x, y, z = transpose(dense(inertia.J))
    moment = (dot(A[2], y) - dot(A[1], z), dot(A[0], z) - dot(A[2], x), dot(A[1], x) - dot(A[0], y))
    force = add(scale(inertia.m, motion.a), apply(A, inertia.s))
    return Wrench(force, add(cross(inertia.s, motion.a), moment))
