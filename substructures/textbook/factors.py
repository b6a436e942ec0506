"""Factors of trigonometric polynomials: ``(cos(q2)*sin(q5) + sin(q2)*cos(q4)*cos(q5))^2``, not its five terms.

With t = tan(q/2) a polynomial in cosines and sines is a polynomial in t over powers of 1 + t^2, which FLINT factors;
factors of even degree are polynomials in cosines and sines again.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import isqrt
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from substructures.expr.rationals import fraction, to_fmpq
from substructures.textbook.divisors import is_fraction
from substructures.textbook.exponentials import Laurent, harmonics_of, spread, tangent
from substructures.textbook.harmonics import Mode, Waves, angle_key, cost, normal, shortest
from substructures.textbook.work import Work

#: terms and angles of what is factored
TERMS, ANGLES = 40, 6

Factors = tuple[Fraction, tuple[tuple[Waves, int], ...]]


def factors(waves: Waves, work: Work) -> Factors:
    """A number and factors with their powers, the polynomial itself where it has no shorter ones. Raises TooLarge."""
    whole: Factors = Fraction(1), ((waves, 1),)
    angles = sorted({k for _, some in waves for _, k, _ in some}, key=angle_key)
    if not 3 <= len(waves) <= TERMS or not 1 <= len(angles) <= ANGLES:
        return whole
    degrees = [max(sum(n for _, k, n in some if k == angle) for _, some in waves) for angle in angles]
    number, parts = work.factor(_polynomial(waves, angles, degrees))
    if sum(int(n) for part, n in parts if not _is_unit(part)) < 2:
        return whole
    found = _trigonometric(parts, angles, degrees, work)
    if found is not None:
        found = fraction(number) * found[0], found[1]
        if not all(is_fraction(c / waves[0][0]) for c, _ in waves):
            found = _number_inside(found)
    if found is None or sum(3 + cost(form) for form, _ in found[1]) >= 3 + cost(waves):
        return whole
    return found[0], tuple(sorted(found[1], key=lambda item: (cost(item[0]), item)))


def _trigonometric(
    parts: Sequence[tuple[Any, int]], angles: Sequence[Mode], degrees: Sequence[int], work: Work
) -> Factors | None:
    """Factors in tangents over powers ``degrees`` of 1 + t^2 as polynomials in cosines and sines, and the number that
    is taken out of these; None where one has no such form.
    """
    value, found, left = Fraction(1), list[tuple[Waves, int]](), list(degrees)
    for part, n in parts:
        form, halves = _read(part, angles, work)
        if form is None:
            return None
        left = [d - n * h for d, h in zip(left, halves, strict=True)]
        if any(halves) and form != ((Fraction(1), ()),):
            scale = form[0][0] if len({abs(c) for c, _ in form}) == 1 else Fraction(-1 if form[0][0] < 0 else 1)
            value *= scale**n
            found.append((tuple((c / scale, some) for c, some in form), n))
    return None if any(left) else (value, tuple(found))


def _number_inside(found: Factors) -> Factors | None:
    """Numbers as given: 0.2*cos(q) + 0.1*sin(q), not a tenth of 2*cos(q) + sin(q); None where that cannot be."""
    value, forms = found
    root = _root(value, forms[0][1]) if len(forms) == 1 else None
    if root is None:
        return None
    ((form, n),) = forms
    return Fraction(1), ((tuple((c * root, some) for c, some in form), n),)


def _root(value: Fraction, n: int) -> Fraction | None:
    """The square root of a number, where it has one."""
    above, below = isqrt(max(value.numerator, 0)), isqrt(value.denominator)
    return Fraction(above, below) if n == 2 and value == Fraction(above**2, below**2) else None


def _polynomial(waves: Waves, angles: Sequence[Mode], degrees: Sequence[int]) -> Any:
    """The polynomial in tangents, over powers ``degrees`` of 1 + t^2."""
    context = fmpq_mpoly_ctx.get([f"g{i}" for i in range(len(angles))], Ordering.lex)
    ts = context.gens()
    result = context.constant(0)
    for c, some in waves:
        term = context.constant(to_fmpq(c))
        left = list(degrees)
        for op, k, n in some:
            i = angles.index(k)
            left[i] -= n
            term *= (1 - ts[i] ** 2 if op == "cos" else 2 * ts[i]) ** n
        for t, n in zip(ts, left, strict=True):
            term *= (1 + t**2) ** n
        result += term
    return result


def _is_unit(part: Any) -> bool:
    """Whether a factor is 1 + t^2 for one of the tangents, or constant."""
    return len(part) < 2 or (list(part.coeffs()) == [1, 1] and sorted(map(int, part.degrees()))[-2:] in ([2], [0, 2]))


def _read(part: Any, angles: Sequence[Mode], work: Work) -> tuple[Waves | None, list[int]]:
    """A factor over the power of 1 + t^2 that makes it trigonometric, and that power; None where there is none."""
    degrees = [max(int(n), 0) for n in part.degrees()]
    halves = [n // 2 for n in degrees]
    if any(n % 2 for n in degrees):
        return None, halves
    laurent: Laurent = {}
    for exponents, c in part.to_dict().items():
        some = [tangent(int(j), e) for j, e in zip(exponents, halves, strict=True)]
        spread(laurent, some, c, work)
    waves = shortest(normal(harmonics_of(laurent)), work)
    size = len(angles[0])
    return tuple((c, tuple((op, _sum(k, angles, size), n) for op, k, n in some)) for c, some in waves), halves


def _sum(k: Mode, angles: Sequence[Mode], size: int) -> Mode:
    return tuple(sum(n * angle[i] for n, angle in zip(k, angles, strict=True)) for i in range(size))
