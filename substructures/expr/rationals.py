"""Rational numbers of Python and of FLINT."""

from __future__ import annotations

from fractions import Fraction

from flint import fmpq


def to_fmpq(value: Fraction | int) -> fmpq:
    """A number for FLINT."""
    return fmpq(value.numerator, value.denominator)


def fraction(value: fmpq) -> Fraction:
    """A number of FLINT."""
    return Fraction(int(value.p), int(value.q)) if value.q != 1 else Fraction(int(value.p))
