"""Wrenches: forces with their moments about a point."""

from __future__ import annotations

from dataclasses import dataclass

from substructures.mechanics.linear3 import ZERO, Rotation, Scalar, Vector, add, cross


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
