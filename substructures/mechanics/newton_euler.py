"""Accelerations and the forces they need: Gamma_abc q'^b q'^c without the Christoffel symbols, inverse dynamics.

Written for a body frame with origin B: omega, alpha and the acceleration of B in frame k. With the matrix
A = skew(alpha) + skew(omega)^2 a point x of the body has the acceleration a + A x, so that (m, s, J) about B give the
force m a + A s and the moment s x a + axial(A J), n_i = eps_ijk (A J)_kj (Luh, Walker, Paul 1980, in Binet form).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import Link
from substructures.mechanics.linear3 import (
    E3,
    ZERO,
    Matrix,
    Rotation,
    Scalar,
    Symmetric,
    Vector,
    add,
    apply,
    cross,
    dot,
    exactly,
    scale,
)
from substructures.mechanics.wrench import Wrench


@dataclass(frozen=True, slots=True)
class BodyMotion:
    """omega [rad/s], alpha [rad/s^2] of a body and the acceleration a [m/s^2] of a point of it, in its frame.

    ``along``: A e3, where the body before gives it; ``sparing``: whether A_11 is then formed by way of
    omega_1^2 - omega_3^2, which inertias with J_13 need anyway.
    """

    omega: Vector = ZERO
    alpha: Vector = ZERO
    a: Vector = ZERO
    along: Vector | None = None
    sparing: bool = False

    def field(self) -> Matrix:
        """A = skew(alpha) + skew(omega)^2."""
        # skew(omega)^2 = omega omega^T - |omega|^2 1
        x, y, z = self.omega
        xx, zz, xy, xz, yz = x * x, z * z, x * y, x * z, y * z
        p, q, r = self.alpha
        A13, A23, A33 = self.third_column()
        A11 = A33 + (xx - zz) if self.along and self.sparing else -(y * y + zz)
        return (A11, xy - r, A13), (xy + r, -(xx + zz), A23), (xz - q, yz + p, A33)

    def third_column(self) -> Vector:
        """A e3."""
        x, y, z = self.omega
        p, q, _ = self.alpha
        return self.along or (x * z + q, y * z - p, -(x * x + y * y))

    def differences(self, A: Matrix) -> Vector:
        """A_33 - A_22, A_11 - A_33, A_22 - A_11; ``A``: the field."""
        xx, yy, zz = (component * component for component in self.omega)
        return (A[2][2] - A[1][1], xx - zz, A[1][1] - A[0][0]) if self.along else (zz - yy, xx - zz, yy - xx)

    def at(self, z: Vector, rotation: Rotation) -> BodyMotion:
        """The same body's motion at the point z, in a turned frame."""
        # a + A z
        a = add(self.a, apply(self.field(), z))
        return BodyMotion(rotation.forward(self.omega), rotation.forward(self.alpha), rotation.forward(a))

    def at_joint(self, link: Link, z: Vector) -> BodyMotion:
        """The motion of what joint k is fixed to, from this one of its parent: at O_k, which is at z, in frame k.

        Where the joint's axis is one of the parent's, a column of the parent's A is turned in place of alpha.
        """
        here = self.at(z, link.rotation)
        axis = link.rotation.back(E3)
        if sum(exactly(component, 0) for component in axis) < 2:
            return here
        # A_13 = omega_1 omega_3 + alpha_2,   A_23 = omega_2 omega_3 - alpha_1
        x, y, w = here.omega
        along = link.rotation.forward(apply(self.field(), axis))
        alpha = y * w - along[1], along[0] - x * w, dot(axis, self.alpha)
        return replace(here, alpha=alpha, along=along)

    def moved(self, s: int, rate: Scalar, tau: Scalar, acceleration: Scalar = 0, sparing: bool = False) -> BodyMotion:
        """The motion of body k at B_k = O_k + tau e3 from that :meth:`at_joint`, in frame k; q' = rate, q''."""
        x, y, z = self.omega
        u, v, w = self.third_column()
        # a_B = a_O + A tau e3, with A of the parent
        a = add(self.a, (tau * u, tau * v, tau * w))
        if s:
            # a_k = a_B + 2 q' omega x e3 + q'' e3
            turning = scale(2, scale(rate, (y, -x, 0)))
            a = add(add(a, turning), (0, 0, acceleration))
            return replace(self, a=a, sparing=sparing)
        # omega_k = omega + q' e3,   alpha_k = alpha + q' omega x e3 + q'' e3: both leave A e3 as it is
        z = z + rate
        alpha = y * z - v, u - x * z, self.alpha[2] + acceleration
        return BodyMotion((x, y, z), alpha, a, self.along, sparing)


def inertial_load(motion: BodyMotion, inertia: Inertia) -> Wrench:
    """What moves the body like that: m a + A s, s x a + axial(A J)."""
    A = motion.field()
    force = add(scale(inertia.m, motion.a), apply(A, inertia.s))
    return Wrench(force, add(cross(inertia.s, motion.a), _axial(motion, A, inertia.J)))


def _axial(motion: BodyMotion, A: Matrix, J: Symmetric) -> Vector:
    """axial(A J), axial(X) = (X_32 - X_23, X_13 - X_31, X_21 - X_12), with differences of A's diagonal."""
    # n_1 = A_32 J_22 - A_23 J_33 + (A_33 - A_22) J_23 + A_31 J_12 - A_21 J_13,   n_2 and n_3 likewise
    xx, yy, zz, xy, xz, yz = J
    (_, Axy, Axz), (Ayx, _, Ayz), (Azx, Azy, _) = A
    p, q, r = motion.alpha
    x, y, z = (exactly(component, 0) for component in motion.omega)
    D = motion.differences(A)
    return (
        _pair(p, Azy, Ayz, yy, zz, y or z) + D[0] * yz + Azx * xy - Ayx * xz,
        _pair(q, Axz, Azx, zz, xx, x or z) + D[1] * xz + Axy * yz - Azy * xy,
        _pair(r, Ayx, Axy, xx, yy, x or y) + D[2] * xy + Ayz * xz - Axz * yz,
    )


def _pair(alpha: Scalar, forth: Scalar, back: Scalar, i: Scalar, j: Scalar, alone: bool) -> Scalar:
    """A_kl i - A_lk j; ``alone``: where A_kl = -A_lk = alpha the sum of parameters first, a moment of inertia."""
    return alpha * (i + j) if alone else forth * i - back * j
