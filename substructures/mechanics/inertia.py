"""Mass, first and second moment of bodies and of everything they carry (mathematics.md, section 5)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from substructures.mechanics.joints import OneDofJoint
from substructures.mechanics.linear3 import (
    ZERO,
    ZERO6,
    Rotation,
    Scalar,
    Symmetric,
    Vector,
    add,
    add6,
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


def binet(theta: Symmetric, half: Scalar = Fraction(1, 2)) -> Symmetric:
    """J = tr(Theta)/2 1 - Theta from the inertia tensor Theta (xx, yy, zz, xy, xz, yz)."""
    xx, yy, zz, xy, xz, yz = theta
    return half * (yy + zz - xx), half * (zz + xx - yy), half * (xx + yy - zz), -xy, -xz, -yz


def composites(joints: tuple[OneDofJoint, ...], bodies: tuple[Inertia, ...]) -> tuple[list[Inertia], Inertia]:
    """Inertia of every subtree about O_k in frame k, and of the whole about the interface (without fixed bodies).

    One pass from the leaves to the base; ``bodies`` are given about the body frame origins. Joints that are parallel
    all the way to the base never need J_xx and J_yy alone, only their sum, which their turns leave as it is
    (mathematics.md, section 8.4).
    """
    total: list[Inertia] = list(bodies)
    parallel = _parallel_to_root(joints)
    base = Inertia()
    for k in reversed(range(len(joints))):
        joint = joints[k]
        total[k] = total[k].shifted((0, 0, joint.tau))
        up = total[k].turned_back(joint.rotation)
        if parallel[k]:
            up = replace(up, polar=total[k].about_third_axis)
        up = up.shifted(joint.offset)
        if joint.parent < 0:
            base = base + up
        else:
            total[joint.parent] = total[joint.parent] + up
    return total, base


def _parallel_to_root(joints: tuple[OneDofJoint, ...]) -> list[bool]:
    """For every joint but a root: whether it and its ancestors turn about one direction, down to the root's axis."""
    group: list[bool] = []
    for joint in joints:
        group.append(joint.parent < 0 or (joint.rotation.keeps_third_axis and group[joint.parent]))
    return [is_in and joint.parent >= 0 for is_in, joint in zip(group, joints, strict=True)]
