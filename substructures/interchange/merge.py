"""Links that do not move against each other as one: their inertias summed, their frames placed in one frame."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from substructures.interchange.numbers import ORIGIN, ZERO, Number, Triple, cleaned, decimal_of, is_zero, triple, value
from substructures.interchange.report import Place, Report, refuse
from substructures.interchange.robot import Inertial
from substructures.interchange.rotations import from_rpy, six_of, steiner, tensor, to_rpy, turned_inertia


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
        origin = np.array([value(x) for x in self.position])
        moved = from_rpy(self.rpy) @ [value(x) for x in p]
        return vector(origin + moved, float(max(np.abs(origin).max(), np.abs(moved).max())))

    def beyond(self, other: Seat) -> Seat:
        """A frame that is placed in it."""
        position = self.point(other.position)
        if not self.is_turned or not other.is_turned:
            return Seat(position, other.rpy if other.is_turned else self.rpy)
        return Seat(position, to_rpy(from_rpy(self.rpy) @ from_rpy(other.rpy)))

    def inertial(self, own: Inertial) -> Inertial:
        """An inertia that is given in it: R I R^T about its own mass centre."""
        six = own.inertia
        if not all(map(is_zero, six)):
            six = turned_inertia(six, from_rpy(self.rpy))
        return Inertial(own.mass, self.point(own.com), six)


def vector(xyz: Iterable[float], scale: float = 0.0) -> Triple:
    """Computed doubles as numbers; ``scale``: of what they were computed of."""
    return triple(cleaned(xyz, scale))


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
    parts = [p for p in parts if not p.is_nothing]
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
    total: Number = ZERO
    for p in parts:
        total = _sum(total, p.mass)
    return Inertial(total, vector(com), cleaned(six_of(theta), float(np.abs(moved).max())))


def judge(place: Place, mass: Number, com: Triple, six: tuple[Number, ...], report: Report) -> None:
    """Warn of masses and tensors that no rigid body can have, and of mass centres that are far away."""
    m, numbers = value(mass), [value(x) for x in six]
    if m < 0:
        raise refuse(place, "negative-mass", f"the mass {mass} kg is negative")
    moments = np.linalg.eigvalsh(tensor(numbers))
    largest = max(float(np.abs(moments).max()), 1e-300)
    if moments[0] < -1e-9 * largest or moments[0] + moments[1] < moments[2] * (1 - 1e-9):
        shown = ", ".join(f"{x:.4g}" for x in moments)
        report.warning(
            place, f"no rigid body has the principal moments {shown} kg m^2 (triangle inequality)", "physics"
        )
    if m == 0 and any(numbers):
        report.warning(place, "a moment of inertia without a mass", "physics")
    distance = float(np.linalg.norm([value(x) for x in com]))
    if m > 0 and distance > 10 and distance**2 * m > 100 * largest:
        report.warning(place, f"the mass centre is {distance:.3g} m away: are these millimetres?", "physics")


def ordered_limits(place: Place, low: Number, high: Number, report: Report) -> tuple[Number, Number] | None:
    """The limits of a coordinate; none, told, where they are reversed, and told where they leave it one place."""
    if value(low) > value(high):
        report.warning(place, f"the lower limit {low} is above the upper one {high}: limits are left out")
        return None
    if value(low) == value(high):
        message = f"both limits are {low}, and limits do not hold a joint here: make it fixed if it is to stand still"
        report.warning(place, message, "topology")
    return low, high
