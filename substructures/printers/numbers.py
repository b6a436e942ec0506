"""Exact numbers as decimal text."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from substructures.textbook.divisors import is_fraction

#: digits of a decimal number in a formula for people; smaller ones than LEAST, and integers that end in more zeros than
#: ZEROS, have an exponent
MOST, LEAST, ZEROS = 40, Fraction(1, 1000), 5


def has_decimals(numbers: Iterable[Fraction]) -> bool:
    """Whether one of them can be written as a decimal number only: beside it 1/2 is 0.5."""
    return any(not is_fraction(n) and shortest_decimal(abs(n)) is not None for n in numbers)


def shortest_decimal(value: Fraction) -> tuple[str, int] | None:
    """Mantissa and power of ten of a positive number, exact and as short as can be, if it is a decimal number.

    >>> shortest_decimal(Fraction("0.913")), shortest_decimal(Fraction("0.00002")), shortest_decimal(Fraction(1, 3))
    (('0.913', 0), ('2', -5), None)
    >>> shortest_decimal(Fraction(10) ** 30), shortest_decimal(Fraction(2500))
    (('1', 30), ('2500', 0))
    """
    places, rest = 0, value.denominator
    for p in (10, 2, 5):
        while rest % p == 0:
            rest, places = rest // p, places + 1
    whole = str(value.numerator * 10**places // value.denominator) if rest == 1 else ""
    digits = whole.rstrip("0")
    if not whole or (places and len(digits) > MOST):
        return None
    if value < LEAST or len(whole) - len(digits) - places > ZEROS:
        return f"{digits[0]}.{digits[1:]}".rstrip("."), len(whole) - 1 - places
    if not places:
        return whole, 0
    whole = whole.rjust(places + 1, "0")
    return f"{whole[:-places]}.{whole[-places:]}".rstrip("0").rstrip("."), 0
