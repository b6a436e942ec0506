"""Exact numbers: their limits, square roots of rationals."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

#: Constants are exact; numerator and denominator may have this many bits.
MAX_BITS = 4096
MAX_EXPONENT = 64


def split_square(value: Fraction) -> tuple[Fraction, int]:
    """value = outside**2 * inside with a small square-free part taken out by trial division."""
    inside = value.numerator * value.denominator
    outside = Fraction(1, value.denominator)
    root = isqrt(inside)
    if root * root == inside:
        return outside * root, 1
    for p in (2, 3, 5, 7, 11, 13):
        while inside % (p * p) == 0:
            inside //= p * p
            outside *= p
    return outside, inside
