"""What divides the terms of polynomials: numbers, monomials, irreducible factors."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from math import gcd, lcm
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from substructures.expr.rationals import fraction, to_fmpq
from substructures.textbook.atoms import Monomial, Polynomial, monomial_key, times
from substructures.textbook.work import Work

#: terms of a polynomial that is factored
FACTORED = 60


def content(polynomial: Polynomial) -> tuple[Fraction, Monomial]:
    """The greatest number and monomial that divide all terms; with the sign of the first term."""
    first = min(polynomial, key=monomial_key)
    number = common_number(polynomial.values())
    powers = dict(first)
    for monomial in polynomial:
        here = dict(monomial)
        powers = {i: _shared(powers.get(i, 0), here.get(i, 0)) for i in {*powers, *here}}
    common = tuple(sorted((i, n) for i, n in powers.items() if n))
    return (-number if polynomial[first] < 0 else number), common


def _shared(m: int, n: int) -> int:
    """The power that x^m and x^n have in common: none of 1 and 1/x."""
    return min(m, n, key=abs) if m * n > 0 else 0


def common_number(numbers: Iterable[Fraction]) -> Fraction:
    """The greatest positive number of which all are integer multiples; a common factor of decimals stays inside.

    >>> common_number([Fraction(2), Fraction(4)]), common_number([Fraction(12, 10), Fraction(18, 10)])
    (Fraction(2, 1), Fraction(1, 1))
    """
    values = {abs(n) for n in numbers}
    if len(values) == 1:
        return values.pop()
    if not all(is_fraction(n) for n in values):
        return Fraction(1)
    return Fraction(gcd(*(n.numerator for n in values)), lcm(*(n.denominator for n in values)))


def is_fraction(number: Fraction) -> bool:
    """Whether a number is written as a fraction (1/3, 3/4), not as a decimal number (0.2)."""
    return 12 % number.denominator == 0


def divided(polynomial: Polynomial, number: Fraction, common: Monomial) -> dict[Monomial, Fraction]:
    """The polynomial over a number and a monomial."""
    return {times(m, common, -1): c / number for m, c in polynomial.items()}


def factored(polynomial: Polynomial, number: Fraction, work: Work) -> tuple[Fraction, list[tuple[Polynomial, int]]]:
    """number * polynomial as a number and irreducible factors with their powers; large ones stay as they are."""
    if not 3 <= len(polynomial) <= FACTORED or any(not is_fraction(c) for c in polynomial.values()):
        return number, [(polynomial, 1)]
    used = sorted({i for m in polynomial for i, _ in m})
    context = fmpq_mpoly_ctx.get([f"g{i}" for i in range(len(used))], Ordering.lex)
    exponents = {tuple(dict(m).get(i, 0) for i in used): c for m, c in polynomial.items()}
    if any(n < 0 for k in exponents for n in k):
        return number, [(polynomial, 1)]
    c, parts = work.factor(context.from_dict({k: to_fmpq(x) for k, x in exponents.items()}))
    if len(parts) == 1 and parts[0][1] == 1:
        return number, [(polynomial, 1)]
    number *= fraction(c)
    found: list[tuple[Polynomial, int]] = []
    for part, n in parts:
        inner = _read_polynomial(part, used)
        sign = -1 if inner[min(inner, key=monomial_key)] < 0 else 1
        number *= sign**n
        found.append(({m: x * sign for m, x in inner.items()}, n))
    return number, sorted(found, key=lambda item: sorted(map(monomial_key, item[0])))


def _read_polynomial(poly: Any, used: Sequence[int]) -> Polynomial:
    """A polynomial of FLINT, whose variables are the atoms ``used``."""
    return {
        tuple((i, int(e)) for i, e in zip(used, k, strict=True) if e): fraction(x) for k, x in poly.to_dict().items()
    }
