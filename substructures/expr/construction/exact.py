"""Exact numbers: their limits, square roots of rationals."""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

#: Constants are exact; numerator and denominator may have this many bits.
MAX_BITS = 4096
MAX_EXPONENT = 64
#: square-free integers under roots; doubles end at 1024
MAX_ROOT_BITS = 1000


def nearest_float(value: int | Fraction) -> float:
    """An exact number, correctly rounded; infinite beyond the range of doubles."""
    try:
        return value.numerator / value.denominator
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")


def split_square(value: Fraction) -> tuple[Fraction, int | Fraction]:
    """value = outside**2 * inside with a small square-free part taken out by trial division.

    ``inside`` is an integer, and a rational between 1 and 4 where that integer would be beyond the range of doubles.
    """
    inside = value.numerator * value.denominator
    outside = Fraction(1, value.denominator)
    root = isqrt(inside)
    if root * root == inside:
        return outside * root, 1
    for p in (2, 3, 5, 7, 11, 13):
        while inside % (p * p) == 0:
            inside //= p * p
            outside *= p
    if inside.bit_length() > MAX_ROOT_BITS:
        shift = (inside.bit_length() - 1) // 2
        return outside * 2**shift, Fraction(inside, 4**shift)
    return outside, inside
