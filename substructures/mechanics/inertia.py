"""Mass, first and second moment of bodies and of everything they carry (mathematics.md, section 5)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from substructures.mechanics.joints import Joint
from substructures.mechanics.linear3 import (
    ZERO,
    ZERO6,
    Rotation,
    S,
    Symmetric,
    Vector,
    add,
    add6,
    exactly,
    scale,
)


@dataclass(frozen=True, slots=True)
class Inertia:
    """m [kg], s = m h [kg m] and J = integral of x x^T dm [kg m^2] (Binet tensor) about a point, in a frame."""

    m: S = 0
    s: Vector = ZERO
    J: Symmetric = ZERO6

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia(self.m + other.m, add(self.s, other.s), add6(self.J, other.J))

    def shifted(self, z: Vector) -> Inertia:
        """The same masses about a point at -z: s + m z, J + s z^T + z s^T + m z z^T."""
        if all(exactly(component, 0) for component in z):
            return self
        s = add(self.s, scale(self.m, z))
        both = add(self.s, s)
        j = self.J
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
        )

    def turned_back(self, rotation: Rotation) -> Inertia:
        """Components in the parent frame: E^T s, E^T J E."""
        return Inertia(self.m, rotation.back(self.s), rotation.back_tensor(self.J))


def binet(theta: Symmetric, half: S = Fraction(1, 2)) -> Symmetric:
    """J = tr(Theta)/2 1 - Theta from the inertia tensor Theta (xx, yy, zz, xy, xz, yz)."""
    xx, yy, zz, xy, xz, yz = theta
    return half * (yy + zz - xx), half * (zz + xx - yy), half * (xx + yy - zz), -xy, -xz, -yz


def composites(joints: tuple[Joint, ...], bodies: tuple[Inertia, ...]) -> tuple[list[Inertia], Inertia]:
    """Inertia of every subtree about O_k in frame k, and of the whole about the interface (without fixed bodies).

    One pass from the leaves to the base; ``bodies`` are given about the body frame origins.
    """
    total: list[Inertia] = list(bodies)
    base = Inertia()
    for k in reversed(range(len(joints))):
        joint = joints[k]
        total[k] = total[k].shifted((0, 0, joint.tau))
        up = total[k].turned_back(joint.rotation).shifted(joint.offset)
        if joint.parent < 0:
            base = base + up
        else:
            total[joint.parent] = total[joint.parent] + up
    return total, base
