"""Accelerations as forces times what they are multiplied with: ``(J + m*l^2)*(tau - b*q') - m*L*l*cos(q)*(...)``.

A numerator of forward dynamics is linear in the inputs. What an input is multiplied with, a minor of the mass matrix,
is what all of its force is multiplied with: the numerator is divided by it, in a moment that it is linear in.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from flint import fmpq_mpoly

#: terms of a numerator that is divided, the fewest and the most
FEWEST, MOST = 5, 150


class Grouped(NamedTuple):
    """minor * force + rest."""

    minor: Any
    force: Any
    rest: Any

    @property
    def terms(self) -> int:
        """How many there are."""
        return len(self.minor) + len(self.force) + len(self.rest)


def grouped(poly: fmpq_mpoly, inputs: Sequence[int], masses: Sequence[int]) -> Grouped | None:
    """The shortest way to divide by what one of the inputs is multiplied with; None where all are longer."""
    if not FEWEST <= len(poly) <= MOST:
        return None
    ways = []
    for i in inputs:
        minor = poly.derivative(i)
        for g in masses if len(minor) > 1 else ():
            slope = minor.derivative(g)
            if slope.is_constant() and len(slope):
                force, rest = _divided(poly, minor / slope, g)
                ways.append(Grouped(minor, force / slope, rest))
    best = min(ways, key=lambda way: way.terms, default=None)
    return best if best is not None and best.terms <= len(poly) else None


def _divided(poly: fmpq_mpoly, divisor: fmpq_mpoly, g: int) -> tuple[Any, Any]:
    """Quotient and rest of a division by a polynomial that is linear in generator g, and begins with it."""
    context = poly.context()
    x, zero = context.gen(g), context.constant(0)
    powers: dict[int, dict[tuple[int, ...], Any]] = {}
    for raw, c in poly.to_dict().items():
        exponents = tuple(map(int, raw))
        powers.setdefault(exponents[g], {})[(*exponents[:g], 0, *exponents[g + 1 :])] = c
    others, value, quotient = divisor - x, zero, zero
    for n in range(max(powers), -1, -1):
        # Horner's scheme at g = -others
        quotient = quotient * x + value
        value = (context.from_dict(powers[n]) if n in powers else zero) - others * value
    return quotient, value
