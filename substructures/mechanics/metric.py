"""Metric, Christoffel symbols and gravity forces from base functions and composites (mathematics.md, section 5)."""

from __future__ import annotations

from dataclasses import dataclass

from substructures.mechanics.base_functions import Columns, Twist
from substructures.mechanics.inertia import Inertia
from substructures.mechanics.linear3 import Matrix, Scalar, Vector, cross, dot


@dataclass(frozen=True, slots=True)
class JointMomentum:
    """What joint c's unit velocity does to the mass it carries, about O_c in frame c.

    ``p`` linear momentum, ``H`` angular momentum, ``K`` the matrix of the Christoffel cubic form.
    Revolute: p = e3 x s, H = tr(J) e3 - J e3, K = skew(e3)^T J; prismatic: p = m e3, H = s x e3, K = -skew(s) skew(e3).
    """

    s: int
    p: Vector
    H: Vector
    composite: Inertia

    def moment(self, omega: Vector) -> Vector:
        """K omega."""
        if self.s:
            x, y, z = self.composite.s
            # -s x (e3 x omega) = omega (s . e3) - ... : only two components of e3 x omega are non-zero
            return omega[0] * z, omega[1] * z, -(omega[0] * x + omega[1] * y)
        xx, yy, _, xy, xz, yz = self.composite.J
        return dot((xy, yy, yz), omega), -dot((xx, xy, xz), omega), 0

    def matrix(self) -> Matrix:
        """K."""
        x, y, z = self.composite.s
        if self.s:
            return (z, 0, 0), (0, z, 0), (-x, -y, 0)
        xx, yy, _, xy, xz, yz = self.composite.J
        return (xy, yy, yz), (-xx, -xy, -xz), (0, 0, 0)


def joint_momentum(s: int, composite: Inertia) -> JointMomentum:
    """p, H (and K) of a joint of kind s (1 prismatic, 0 revolute) from the inertia that it carries."""
    x, y, _ = composite.s
    if s:
        return JointMomentum(1, (0, 0, composite.m), (y, -x, 0), composite)
    _, _, _, _, xz, yz = composite.J
    return JointMomentum(0, (-y, x, 0), (-xz, -yz, composite.about_third_axis), composite)


def pairing(twist: Twist, force: Vector, moment: Vector) -> Scalar:
    """U . f + Omega . n: power of a wrench on a twist."""
    return dot(twist.U, force) + dot(twist.Omega, moment)


def metric_column(c: int, columns: Columns, momentum: JointMomentum) -> dict[int, Scalar]:
    """g_ac for all a <= c (keys a): g_cc = H_3 or m, g_ac = U_ca . p + Omega_ca . H."""
    own = momentum.p[2] if momentum.s else momentum.H[2]
    return {a: own if a == c else pairing(t, momentum.p, momentum.H) for a, t in columns.items()}


def christoffel_block(
    c: int, columns: Columns, momentum: JointMomentum, inside: int = 0
) -> dict[tuple[int, int], Scalar]:
    """Gamma_abc for a < c, b <= c (keys a, b): U_ca . (Omega_cb x p) + Omega_ca^T K Omega_cb.

    ``inside``: leave out pairs in which both a and b are at least this coordinate (they are known already).
    """
    block: dict[tuple[int, int], Scalar] = {}
    for b, twist in columns.items():
        force = cross(twist.Omega, momentum.p)
        moment = momentum.moment(twist.Omega)
        for a, other in columns.items():
            if a != c and (a < inside or b < inside or not inside):
                block[a, b] = pairing(other, force, moment)
    return block
