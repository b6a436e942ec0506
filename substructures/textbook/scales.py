"""Numbers of products and quotients as they were given: ``(a + 9.81*b)/c``, not ``0.01*(100*a + 981*b)/c``.

Irreducible factors are known up to numbers only; as polynomials with integers they hide decimal numbers. Every factor
is divided by the power of ten that leaves the fewest digits, and a decimal number before the product belongs to one of
its sums unless that is longer, as in sums that are not divided by anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import gcd, lcm

from substructures.textbook.collect import is_fraction

#: integers that are written as such
LARGE = 1000
#: coefficients, and the power of the sum
Part = tuple[Sequence[Fraction], int]


def divisors(number: Fraction, parts: Sequence[Part]) -> list[Fraction]:
    """The numbers by which sums in number * product of sum^n are divided, so that the numbers are short in all.

    >>> divisors(Fraction(1, 100), [([Fraction(100), Fraction(981)], 1)])
    [Fraction(100, 1)]
    >>> divisors(Fraction(2), [([Fraction(1), Fraction(3)], 1)])
    [Fraction(1, 1)]
    """
    found: list[Fraction] = []
    for coefficients, n in parts:
        found.append(_power_of_ten(number, coefficients, n))
        number *= found[-1] ** n
    sums = [[c / scale for c in coefficients] for (coefficients, _), scale in zip(parts, found, strict=True)]
    inside = [i for i, (_, n) in enumerate(parts) if n == 1 and _belongs(number, sums[i])]
    longer = {i: digits(c * number for c in sums[i]) - digits(sums[i]) for i in inside}
    best = min(inside, key=lambda i: longer[i], default=None)
    if best is not None and longer[best] <= digits([number]):
        found[best] /= number
    return found


def _belongs(number: Fraction, coefficients: Sequence[Fraction]) -> bool:
    """Whether one of number * sum is a decimal number, and what is in the sum then can be written."""
    if len(coefficients) == 1 or all(c.denominator % 5 for c in (number, *coefficients)):
        return False
    return all(is_fraction(c * number) or _places(c * number) is not None for c in coefficients)


def _power_of_ten(number: Fraction, coefficients: Sequence[Fraction], n: int) -> Fraction:
    """The power of ten by which a sum^n after a number is divided: the fewest digits in the sum, then in all."""
    if len(coefficients) == 1:
        return Fraction(1)
    largest = int(max(map(abs, coefficients)))
    tens = len(str(largest)) - 1 if largest >= LARGE else _tens(number if n > 0 else 1 / number) // abs(n)
    ways = [Fraction(10) ** k for k in range(tens + 1)]
    if largest < LARGE and _places(number) is None:
        # 1/300*(100*a + 2943*b) hides 1/3*a + 9.81*b, but 1/180*(180*a + b) no decimal number
        ways = [c for c in ways if c == 1 or c in coefficients or -c in coefficients]
    sizes = [digits(x / c for x in coefficients) for c in ways]
    ways = [c for c, size in zip(ways, sizes, strict=True) if size == min(sizes)]
    return ways[-1] if largest >= LARGE else min(ways, key=lambda c: digits([number * c**n]))


def _tens(number: Fraction) -> int:
    """How often a number is divided by ten."""
    k = 0
    while number.denominator % 10 ** (k + 1) == 0:
        k += 1
    return k


def digits(numbers: Iterable[Fraction]) -> int:
    """How many digits are written; none for 1.

    >>> digits([Fraction(1)]), digits([Fraction("9.81")]), digits([Fraction("0.05")]), digits([Fraction(-1, 3)])
    (0, 3, 2, 2)
    """
    return sum(_digits(abs(n)) for n in numbers)


def _digits(number: Fraction) -> int:
    if number == 1:
        return 0
    places = None if is_fraction(number) else _places(number)
    if places is None:
        return len(str(number.numerator)) + (len(str(number.denominator)) if number.denominator > 1 else 0)
    return max(len(str(int(number * 10**places))), places)


def _places(number: Fraction) -> int | None:
    """Decimal places, if a number has an end."""
    places, rest = 0, number.denominator
    for p in (10, 2, 5):
        while rest % p == 0:
            rest, places = rest // p, places + 1
    return places if rest == 1 else None


def primitive(numbers: Sequence[Fraction]) -> Fraction:
    """The number that leaves integers without a common factor."""
    return Fraction(gcd(*(n.numerator for n in numbers)), lcm(*(n.denominator for n in numbers)))
