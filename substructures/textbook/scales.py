"""Numbers of products and quotients as they were given: ``(a + 9.81*b)/c``, not ``0.01*(100*a + 981*b)/c``.

Irreducible factors are known up to numbers only; as polynomials with integers they hide decimal numbers. Every factor
is divided by the power of ten that leaves the fewest digits, and a decimal number before the product belongs to one of
its sums unless that is longer, as in sums that are not divided by anything.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import gcd, lcm

from substructures.textbook.divisors import is_fraction

#: integers that are written as such
LARGE = 1000
#: terms of a sum that is tried with each of its numbers as 1
SHORT = 12
#: coefficients, and the power of the sum
Part = tuple[Sequence[Fraction], int]


def divisors(number: Fraction, parts: Sequence[Part]) -> list[Fraction]:
    """The numbers by which sums in number * product of sum^n are divided, so that the numbers are short in all.

    >>> divisors(Fraction(1, 100), [([Fraction(100), Fraction(981)], 1)])
    [Fraction(100, 1)]
    >>> divisors(Fraction(2), [([Fraction(1), Fraction(3)], 1)])
    [Fraction(1, 1)]
    """
    tens: list[Fraction] = []
    rest = number
    for coefficients, n in parts:
        tens.append(_power_of_ten(rest, coefficients, n))
        rest *= tens[-1] ** n
    ways = [_with_number_inside(number, parts, tens)]
    if any(_is_long(x) for x in _written(number, parts, ways[0])):
        ones = [_one_of_them(coefficients, scale) for (coefficients, _), scale in zip(parts, tens, strict=True)]
        singles = [[*tens[:i], one, *tens[i + 1 :]] for i, one in enumerate(ones) if one != tens[i]]
        ways += [_with_number_inside(number, parts, way) for way in (*singles, ones)]
    return min(ways, key=lambda way: digits(_written(number, parts, way)))


def _is_long(number: Fraction) -> bool:
    """Whether it is neither a simple fraction nor a small integer."""
    return not is_fraction(number) or max(number.numerator, number.denominator) >= LARGE


def _written(number: Fraction, parts: Sequence[Part], scales: Sequence[Fraction]) -> list[Fraction]:
    """All numbers of the product of sums that are divided by these numbers."""
    for (_, n), scale in zip(parts, scales, strict=True):
        number *= scale**n
    return [*ratio(number, True), *(c / s for (some, _), s in zip(parts, scales, strict=True) for c in some)]


def _one_of_them(coefficients: Sequence[Fraction], scale: Fraction) -> Fraction:
    """The number that leaves the fewest digits in a short sum: one of its own, so that this is 1, or else ``scale``."""
    if not 1 < len(coefficients) <= SHORT:
        return scale
    ones = sorted({abs(c) for c in coefficients})
    ways = [one for one in ones if all(_is_written(c / one) for c in coefficients)]
    return min([scale, *ways], key=lambda x: digits(c / x for c in coefficients))


def _with_number_inside(number: Fraction, parts: Sequence[Part], scales: Sequence[Fraction]) -> list[Fraction]:
    """The divisors with the number before the product taken into one of its sums, unless that is longer."""
    found = list(scales)
    for (_, n), scale in zip(parts, found, strict=True):
        number *= scale**n
    sums = [[c / scale for c in coefficients] for (coefficients, _), scale in zip(parts, found, strict=True)]
    inside = [i for i, (_, n) in enumerate(parts) if abs(n) == 1 and _belongs(number**n, sums[i])]
    longer = {i: digits(c * number ** parts[i][1] for c in sums[i]) - digits(sums[i]) for i in inside}
    best = min(inside, key=lambda i: longer[i], default=None)
    if best is not None and longer[best] <= digits(ratio(number, True)):
        found[best] /= number ** parts[best][1]
    return found


def _belongs(number: Fraction, coefficients: Sequence[Fraction]) -> bool:
    """Whether one of number * sum is a decimal number, and what is in the sum then can be written."""
    if len(coefficients) == 1 or all(c.denominator % 5 for c in (number, *coefficients)):
        return False
    return all(_is_written(c * number) for c in coefficients)


def _is_written(number: Fraction) -> bool:
    """Whether it is a simple fraction or a decimal number."""
    return is_fraction(number) or _places(number) is not None


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


def ratio(number: Fraction, divides: bool) -> tuple[Fraction, Fraction]:
    """What is written above and below the line for a number, decimals as they were given: a/0.024222337776.

    ``divides``: whether something else is below the line.

    >>> [tuple(map(float, ratio(Fraction(*n), True))) for n in ((3, 2), (1, 20), (10, 3), (42500, 29679))]
    [(3.0, 2.0), (0.05, 1.0), (1.0, 0.3), (4.25, 2.9679)]
    """
    above, below = Fraction(number.numerator), Fraction(number.denominator)
    whole = (above, below) if divides and below > 1 and not _is_decimal(number) else (number, Fraction(1))
    if above % 10 or _is_decimal(number) or not (divides or below >= LARGE):
        return whole
    if _places(1 / number) is not None and (below >= LARGE or number <= LARGE):
        return Fraction(1), 1 / number
    tens = len(str(min(above, below))) - 1 if max(above, below) >= LARGE else 0
    shorter = above / 10**tens, below / 10**tens
    return shorter if digits(shorter) < digits([above, below]) else whole


def _is_decimal(number: Fraction) -> bool:
    """Whether it is an integer, or a decimal number and no simple fraction."""
    return number.denominator == 1 or (_places(number) is not None and not is_fraction(number))


def digits(numbers: Iterable[Fraction]) -> int:
    """How many digits are written; none for 1.

    >>> digits([Fraction(1)]), digits([Fraction("9.81")]), digits([Fraction("0.05")]), digits([Fraction(-1, 3)])
    (0, 3, 2, 2)
    """
    return sum(_digits(abs(n)) for n in numbers)


def _digits(number: Fraction) -> int:
    if number == 1:
        return 0
    places = _places(number)
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
