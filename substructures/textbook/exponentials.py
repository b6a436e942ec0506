"""Laurent polynomials in z = exp(i q): products of what is known for one angle, and their harmonics."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from math import comb, prod
from typing import NamedTuple

from flint import fmpq

from substructures.expr.rationals import fraction
from substructures.textbook.harmonics import Mode
from substructures.textbook.work import Work

#: real and imaginary part of every coefficient
Laurent = dict[Mode, tuple[fmpq, fmpq]]
_ZERO = fmpq(0)


class Wave(NamedTuple):
    """i^turns / denominator * sum of coefficient * z^k."""

    coefficients: Mapping[int, int]
    turns: int
    denominator: int


def spread(into: Laurent, waves: Sequence[Wave], c: fmpq, work: Work) -> None:
    """Add c times a product of Laurent polynomials, one in exp(i q) of every angle. Raises TooLarge."""
    work.steps(prod(len(wave.coefficients) for wave in waves))
    terms: list[tuple[Mode, int]] = [((), 1)]
    turns = 0
    for wave in waves:
        terms = [((*k, n), x * y) for k, x in terms for n, y in wave.coefficients.items()]
        turns += wave.turns
        c /= wave.denominator
    c = -c if turns % 4 > 1 else c
    for k, x in terms:
        re, im = into.get(k, (_ZERO, _ZERO))
        into[k] = (re, im + c * x) if turns % 2 else (re + c * x, im)


def harmonics_of(laurent: Laurent) -> dict[Mode, tuple[Fraction, Fraction]]:
    """c z^k + conj(c) z^-k = 2 Re(c) cos(k.q) - 2 Im(c) sin(k.q)."""
    result = {}
    for k, (re, im) in laurent.items():
        leading = next((n for n in k if n), 0)
        if leading >= 0 and (re or im):
            result[k] = (fraction(2 * re), fraction(-2 * im)) if leading else (fraction(re), Fraction(0))
    return result


@lru_cache(maxsize=1000)
def tangent(j: int, e: int) -> Wave:
    """t^j / (1 + t^2)^e = (-i)^j (z - 1)^j (z + 1)^(2 e - j) / (4 z)^e, for t = tan(q/2) and z = exp(i q)."""
    whole = _product([(j, -1), (2 * e - j, 1)])
    return Wave({k - e: c for k, c in enumerate(whole) if c}, -j % 4, 4**e)


@lru_cache(maxsize=1000)
def power(a: int, b: int) -> Wave:
    """cos^a sin^b = (z + 1/z)^a (z - 1/z)^b / (2^a (2 i)^b)."""
    whole = _product([(a, 1), (b, -1)])
    return Wave({2 * k - a - b: c for k, c in enumerate(whole) if c}, -b % 4, 2 ** (a + b))


def _product(factors: Sequence[tuple[int, int]]) -> list[int]:
    """Coefficients of the product of (z + sign)^n."""
    coefficients = [1]
    for n, sign in factors:
        new = [0] * (len(coefficients) + n)
        for i, a in enumerate(coefficients):
            for m in range(n + 1):
                new[i + m] += a * comb(n, m) * sign ** (n - m)
        coefficients = new
    return coefficients
