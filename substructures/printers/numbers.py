"""Exact numbers as decimal text."""

from __future__ import annotations

from fractions import Fraction

_DIGITS = 17
#: digits of a decimal number in a formula for people; smaller ones than LEAST have an exponent
MOST, LEAST = 40, Fraction(1, 1000)


def decimal_text(value: Fraction) -> str | None:
    """A positive number as exact decimal of moderate length, if it is one."""
    found = _digits(value)
    if found is None or found[1] > _DIGITS or len(found[0]) > 2 * _DIGITS:
        return None
    return _pointed(*found)


def shortest_decimal(value: Fraction) -> tuple[str, int] | None:
    """Mantissa and power of ten of a positive number, exact and as short as can be, if it is a decimal number.

    >>> shortest_decimal(Fraction("0.913")), shortest_decimal(Fraction("0.00002")), shortest_decimal(Fraction(1, 3))
    (('0.913', 0), ('2', -5), None)
    """
    found = _digits(value)
    if found is None or len(found[0]) > MOST:
        return None
    if value >= LEAST:
        return _pointed(*found), 0
    digits = found[0].lstrip("0")
    exponent = len(digits) - 1 - found[1]
    return (f"{digits[0]}.{digits[1:]}" if len(digits) > 1 else digits), exponent


def _digits(value: Fraction) -> tuple[str, int] | None:
    """Digits and decimal places, if the number has an end."""
    places, rest = 0, value.denominator
    for p in (10, 2, 5):
        while rest % p == 0:
            rest, places = rest // p, places + 1
    if rest != 1:
        return None
    return str(value.numerator * 10**places // value.denominator).rjust(places + 1, "0"), places


def _pointed(digits: str, places: int) -> str:
    return f"{digits[:-places]}.{digits[-places:]}".rstrip("0") if places else digits
