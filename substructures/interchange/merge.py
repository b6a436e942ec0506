"""Links that do not move against each other as one: their inertias summed, their frames placed in one frame."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from substructures.interchange.numbers import ORIGIN, ZERO, Number, Triple, decimal_of, is_zero, triple, value
from substructures.interchange.robot import Inertial
from substructures.interchange.rotations import from_rpy, six_of, steiner, tensor, to_rpy


@dataclass(frozen=True)
class Seat:
    """A frame placed in another one: position, then fixed-axis roll, pitch, yaw."""

    position: Triple = ORIGIN
    rpy: Triple = ORIGIN

    @property
    def is_turned(self) -> bool:
        """Whether its axes are others."""
        return not all(map(is_zero, self.rpy))

    def point(self, p: Triple) -> Triple:
        """A point that is given in it; exact where nothing is turned."""
        if all(map(is_zero, p)):
            return self.position
        if not self.is_turned:
            return plus(self.position, p)
        moved = np.array([value(x) for x in self.position]) + from_rpy(self.rpy) @ [value(x) for x in p]
        return vector(moved)

    def beyond(self, other: Seat) -> Seat:
        """A frame that is placed in it."""
        position = self.point(other.position)
        if not self.is_turned or not other.is_turned:
            return Seat(position, other.rpy if other.is_turned else self.rpy)
        return Seat(position, to_rpy(from_rpy(self.rpy) @ from_rpy(other.rpy)))

    def inertial(self, own: Inertial) -> Inertial:
        """An inertia that is given in it: R I R^T about its own mass centre."""
        six = own.inertia
        if self.is_turned and not all(map(is_zero, six)):
            R = from_rpy(self.rpy)
            six = tuple(map(decimal_of, six_of(R @ tensor([value(x) for x in six]) @ R.T)))
        return Inertial(own.mass, self.point(own.com), six)


def vector(xyz: Iterable[float]) -> Triple:
    """Computed doubles as numbers."""
    return triple(tuple(decimal_of(float(x)) for x in xyz))


def plus(p: Triple, q: Triple) -> Triple:
    """The sum, exact."""
    return triple(tuple(_sum(a, b) for a, b in zip(p, q, strict=True)))


def minus(p: Triple) -> Triple:
    """The opposite, exact."""
    return triple(tuple(x if is_zero(x) else decimal_of(-value(x)) if isinstance(x, str) else -x for x in p))


def _sum(a: Number, b: Number) -> Number:
    if isinstance(a, str) or isinstance(b, str):
        return decimal_of(value(a) + value(b))
    return a + b


def together(parts: list[Inertial]) -> Inertial:
    """One rigid body of several, given in one frame: masses, mass centre, tensors by Steiner's theorem.

    A single one with mass is taken as it is. Without mass, tensors are summed.
    """
    parts = [p for p in parts if not (is_zero(p.mass) and all(map(is_zero, p.inertia)))]
    if not parts:
        return Inertial()
    if len(parts) == 1:
        return parts[0]
    m = [value(p.mass) for p in parts]
    c = [np.array([value(x) for x in p.com]) for p in parts]
    mass = sum(m)
    com = np.average(c, axis=0, weights=m) if mass else np.zeros(3)
    moved = [steiner(a, b - com) for a, b in zip(m, c, strict=True)]
    theta = np.sum([tensor([value(x) for x in p.inertia]) for p in parts], axis=0) + np.sum(moved, axis=0)
    # what is only rounding of products that cancel
    theta[np.abs(theta) < 1e-15 * np.sum(np.abs(moved))] = 0
    total: Number = ZERO
    for p in parts:
        total = _sum(total, p.mass)
    return Inertial(total, vector(com), tuple(map(decimal_of, six_of(theta))))
