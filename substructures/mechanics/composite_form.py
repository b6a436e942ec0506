"""The composite form of metric, Christoffel symbols and gravity forces, over any scalar (notation.md, section 5).

Inertias are summed from the leaves to the base; what a joint's unit velocity does to the inertia that it carries, its
momentum, paired with the columns of the base functions gives g and Gamma. The direct form of section 4 is what
:mod:`substructures.certificate` compares them with.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from substructures.mechanics.kinematics import INTERFACE, Columns, Link, OneDofJoint, Twist
from substructures.mechanics.linear3 import (
    ZERO,
    ZERO6,
    Matrix,
    Rotation,
    Scalar,
    Symmetric,
    Vector,
    add,
    add6,
    cross,
    dot,
    exactly,
    scale,
)


@dataclass(frozen=True, slots=True)
class Inertia:
    """m [kg], s = m h [kg m] and J = integral of x x^T dm [kg m^2] (Binet tensor) about a point, in a frame.

    ``polar``: J_xx + J_yy where a shorter form than that sum is known: turns about the third axis leave it as it is.
    """

    m: Scalar = 0
    s: Vector = ZERO
    J: Symmetric = ZERO6
    polar: Scalar | None = None

    @property
    def about_third_axis(self) -> Scalar:
        """J_xx + J_yy, the moment of inertia about the third axis."""
        return self.J[0] + self.J[1] if self.polar is None else self.polar

    def __add__(self, other: Inertia) -> Inertia:
        polar = None
        if self.polar is not None or other.polar is not None:
            polar = self.about_third_axis + other.about_third_axis
        return Inertia(self.m + other.m, add(self.s, other.s), add6(self.J, other.J), polar)

    def shifted(self, z: Vector) -> Inertia:
        """The same masses about a point at -z: s + m z, J + s z^T + z s^T + m z z^T."""
        if all(exactly(component, 0) for component in z):
            return self
        s = add(self.s, scale(self.m, z))
        both = add(self.s, s)
        j = self.J
        # s z^T + z s^T + m z z^T has z_i (s_i + (s + m z)_i) on its diagonal and s_i z_j + z_i (s + m z)_j beside it
        polar = None if self.polar is None else self.polar + (z[0] * both[0] + z[1] * both[1])
        return Inertia(
            self.m,
            s,
            (
                j[0] + z[0] * both[0],
                j[1] + z[1] * both[1],
                j[2] + z[2] * both[2],
                j[3] + (self.s[0] * z[1] + z[0] * s[1]),
                j[4] + (self.s[0] * z[2] + z[0] * s[2]),
                j[5] + (self.s[1] * z[2] + z[1] * s[2]),
            ),
            polar,
        )

    def turned_back(self, rotation: Rotation) -> Inertia:
        """Components in the parent frame: E^T s, E^T J E."""
        return Inertia(self.m, rotation.back(self.s), rotation.back_tensor(self.J))

    def in_parent(self, rotation: Rotation, position: Vector) -> Inertia:
        """In and about the frame in which this one is placed: with E and the position of its origin there."""
        return self.turned_back(rotation).shifted(position)


def binet(theta: Symmetric, half: Scalar = Fraction(1, 2)) -> Symmetric:
    """J = tr(Theta)/2 1 - Theta from the inertia tensor Theta (xx, yy, zz, xy, xz, yz)."""
    # J_xx = (Theta_yy + Theta_zz - Theta_xx) / 2,   J_xy = -Theta_xy
    xx, yy, zz, xy, xz, yz = theta
    return half * (yy + zz - xx), half * (zz + xx - yy), half * (xx + yy - zz), -xy, -xz, -yz


def moments_of_inertia(J: Symmetric) -> Symmetric:
    """Theta = tr(J) 1 - J (xx, yy, zz, xy, xz, yz), moments about the axes and negative products, from Binet's J."""
    xx, yy, zz, xy, xz, yz = J
    return yy + zz, zz + xx, xx + yy, -xy, -xz, -yz


def composites(joints: Sequence[OneDofJoint], bodies: Sequence[Inertia]) -> dict[int, Inertia]:
    """Inertia of every carrier with all that hangs on it: about O_k in frame k, of the whole about the interface.

    One pass from the leaves to the base; ``bodies`` are given about the body frame origins, what is fixed to the
    interface is left out. Where all axes on the way are parallel J_xx and J_yy are never needed alone, only their sum,
    which turns about them leave as it is (:func:`about_one_direction`).
    """
    total = {INTERFACE: Inertia(), **dict(enumerate(bodies))}
    parallel = about_one_direction(joints)
    for k in reversed(range(len(joints))):
        joint = joints[k]
        # own body, about O_k: z = tau e3 to the body frame origin
        total[k] = total[k].shifted((0, 0, joint.tau))
        # m_p += m,   s_p += E^T s + m z,   J_p += E^T J E + s z^T + z s^T + m z z^T
        up = total[k].turned_back(joint.rotation)
        if parallel[k]:
            up = replace(up, polar=total[k].about_third_axis)
        total[joint.parent] = total[joint.parent] + up.shifted(joint.offset)
    return total


def with_moments_about_axes(
    chain: Sequence[Link], carried: Sequence[Inertia], body: Callable[[int], Inertia]
) -> list[Inertia]:
    """Composites of which s and J are known, with J_xx + J_yy in the form that :func:`composites` gives it.

    ``body``: what is fixed in the carrier of a joint, about O_k in frame k.
    """
    result, parallel = list(carried), about_one_direction(chain)
    below: dict[int, list[int]] = {link.parent: [] for link, is_in in zip(chain, parallel, strict=True) if is_in}
    for c, link in enumerate(chain):
        if link.parent in below:
            below[link.parent].append(c)
    for k in sorted(below, reverse=True):
        total = body(k).about_third_axis
        # what slides is mostly constant and comes first, the last joint before others
        for c in sorted(below[k], key=lambda c: (not chain[c].s, -c)):
            up = result[c].turned_back(chain[c].rotation)
            if parallel[c]:
                up = replace(up, polar=result[c].about_third_axis)
            total = total + up.shifted(chain[c].Z).about_third_axis
        result[k] = replace(result[k], polar=total)
    return result


def about_one_direction(joints: Sequence[OneDofJoint | Link]) -> list[bool]:
    """For every joint: whether its axis is parallel to all revolute ones before it, of which there is one at least.

    Then what it carries enters moments of inertia about them by J_xx + J_yy alone. The axes of prismatic joints before
    the first revolute one may have any direction: J of what they carry is needed nowhere.
    """
    turns, parallel = [False] * len(joints), [False] * len(joints)
    is_in = list(parallel)
    for k, joint in enumerate(joints):
        p = joint.parent
        before = p != INTERFACE and turns[p]
        turns[k] = before or not joint.s
        parallel[k] = before and is_in[p] and joint.rotation.keeps_line_of_third_axis
        is_in[k] = parallel[k] or not before
    return parallel


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
            # K omega = -s x (e3 x omega) = omega s_3 - e3 (s . omega), whose third component needs no s_3
            return omega[0] * z, omega[1] * z, -(omega[0] * x + omega[1] * y)
        # K omega = skew(e3)^T J omega = -e3 x J omega = ((J omega)_2, -(J omega)_1, 0)
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
        # p = m e3,   H = s x e3
        return JointMomentum(1, (0, 0, composite.m), (y, -x, 0), composite)
    # p = e3 x s,   H = tr(J) e3 - J e3
    _, _, _, _, xz, yz = composite.J
    return JointMomentum(0, (-y, x, 0), (-xz, -yz, composite.about_third_axis), composite)


def pairing(twist: Twist, force: Vector, moment: Vector) -> Scalar:
    """U . f + Omega . n: power of a wrench on a twist."""
    return dot(twist.U, force) + dot(twist.Omega, moment)


def christoffel_block(
    c: int, twists: Columns, p: Vector, moment: Callable[[Vector], Vector], known: int | None = None
) -> dict[tuple[int, ...], Scalar]:
    """Gamma_abc for a < c, b <= c: U_a . (Omega_b x p) + Omega_a^T K Omega_b.

    ``twists``: of the joints on the path to c, in one frame about one point, as p and K; ``moment``: K omega;
    ``known``: leave out pairs in which both a and b are at least this coordinate.
    """
    block: dict[tuple[int, ...], Scalar] = {}
    for b, twist in twists.items():
        # Omega_b x p  and  K Omega_b
        F, N = cross(twist.Omega, p), moment(twist.Omega)
        for a, other in twists.items():
            if a != c and (known is None or min(a, b) < known):
                block[a, b, c] = pairing(other, F, N)
    return block
