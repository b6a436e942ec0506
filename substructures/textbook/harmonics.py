"""Trigonometric polynomials in their shortest form: products of powers of cosines and sines, or sums of angles.

A trigonometric polynomial is given by its harmonics, sum over k of a_k cos(k.q) + b_k sin(k.q), which are unique. In
a basis of angles (q1, q1 + q2, say, which is chosen so that the harmonics become small) it is a polynomial in c_i and
s_i, from which c_i^2 + s_i^2 = 1 takes either all c_i^2 or all s_i^2. The shortest of these forms and of the harmonics
themselves is what a person would write: sin(q)^2, not 1/2 - 1/2 cos(2 q), and cos(q1 + q2), not c1 c2 - s1 s2.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import permutations
from math import comb, prod

from flint import fmpq

from substructures.expr.rationals import fraction, to_fmpq
from substructures.textbook.work import Work

#: a harmonic: multiples of the angles, the first of which that is not zero is positive
Mode = tuple[int, ...]
#: cosine and sine coefficient of every harmonic
Harmonics = Mapping[Mode, tuple[Fraction, Fraction]]
#: powers of (cos, sin) of every angle of a basis
Powers = tuple[tuple[int, int], ...]
Polynomial = dict[Powers, fmpq]
#: a factor: "cos" or "sin", multiples of the angles, power
Wave = tuple[str, Mode, int]
#: a sum of number * product of waves
Waves = tuple[tuple[Fraction, tuple[Wave, ...]], ...]


def shortest(harmonics: Harmonics, work: Work) -> Waves:
    """The shortest form of a trigonometric polynomial, terms and factors in their order. Raises TooLarge."""
    plain = _as_they_are(harmonics)
    if len(harmonics) == 1 and all(abs(n) <= 1 for k in harmonics for n in k):
        return plain
    basis, modes = _reduced(list(harmonics), work)
    polynomial: Polynomial = {}
    for mode, (a, b) in zip(modes, harmonics.values(), strict=True):
        _add(polynomial, mode, to_fmpq(a), to_fmpq(b), work)
    written = [_written(form, basis) for form in _eliminated(polynomial, work)]
    return min([*written, plain], key=lambda form: (cost(form), form is plain))


def _as_they_are(harmonics: Harmonics) -> Waves:
    terms = []
    for k, both in sorted(harmonics.items(), key=lambda item: _mode_key(item[0])):
        for op, c in zip(("cos", "sin"), both, strict=True):
            if c:
                terms.append((c, ((op, k, 1),) if any(k) else ()))
    return tuple(terms)


def _mode_key(k: Mode) -> tuple[object, ...]:
    return sum(map(abs, k)), tuple(-abs(n) for n in k), tuple(-n for n in k)


def cost(form: Waves) -> int:
    """Signs that are written: terms, factors, sums of angles; multiples of angles are dear."""
    cost = 0
    for c, waves in form:
        cost += 2 + (abs(c) != 1)
        for _, k, n in waves:
            cost += 2 + (n != 1) + sum(1 for m in k if m) - 1 + sum(3 for m in k if abs(m) > 1)
    return cost


def _reduced(modes: list[Mode], work: Work) -> tuple[list[Mode], list[Mode]]:
    """Angles (multiples of the given ones) in which the harmonics are smallest, and the harmonics in them.

    As long as it helps one angle i is replaced by its sum or difference with another one: with phi = q_i + s q_j,
    k_i q_i + k_j q_j = k_i phi + (k_j - s k_i) q_j.
    """
    size = len(modes[0]) if modes else 0
    basis = [tuple(int(i == j) for j in range(size)) for i in range(size)]
    if max((sum(1 for n in k if n) for k in modes), default=0) < 2:
        return basis, modes
    while True:
        work.steps(2 * size * size * len(modes))
        best = _best_exchange(modes, size)
        if best is None:
            return _forwards(basis, modes)
        i, j, sign = best
        basis[i] = tuple(a + sign * b for a, b in zip(basis[i], basis[j], strict=True))
        modes = [tuple(n - sign * k[i] if m == j else n for m, n in enumerate(k)) for k in modes]


def _best_exchange(modes: Sequence[Mode], size: int) -> tuple[int, int, int] | None:
    """(i, j, sign): q_i + sign q_j in place of q_i makes the multiples of q_j smallest; None where none does."""
    best, gain = None, (0, 0)
    for i, j in permutations(range(size), 2):
        for sign in (1, -1):
            pairs = [(abs(k[j]), abs(k[j] - sign * k[i])) for k in modes]
            change = sum(a - b for a, b in pairs), sum(a * a - b * b for a, b in pairs)
            if change > gain:
                best, gain = (i, j, sign), change
    return best


def _forwards(basis: Sequence[Mode], modes: list[Mode]) -> tuple[list[Mode], list[Mode]]:
    """Angles whose first multiple is positive, and the harmonics in them."""
    signs = [-1 if next(n for n in angle if n) < 0 else 1 for angle in basis]
    angles = [tuple(sign * n for n in angle) for sign, angle in zip(signs, basis, strict=True)]
    return angles, [tuple(sign * n for sign, n in zip(signs, k, strict=True)) for k in modes]


@lru_cache(maxsize=1000)
def _multiple(k: int) -> tuple[tuple[tuple[int, int], int, int], ...]:
    """(c + i s)^k as ((power of c, power of s), coefficient, power of i)."""
    n, sign = abs(k), 1 if k >= 0 else -1
    return tuple(((n - m, m), comb(n, m) * sign**m, m) for m in range(n + 1))


def _add(polynomial: Polynomial, mode: Mode, a: fmpq, b: fmpq, work: Work) -> None:
    """Add a cos(k.q) + b sin(k.q): real and imaginary part of the product of (c_i + i s_i)^k_i."""
    # binomial coefficients of k have about k digits
    work.steps(prod(abs(k) + 1 + k * k // 64 for k in mode))
    terms: list[tuple[Powers, int, int]] = [((), 1, 0)]
    for k in mode:
        terms = [((*powers, p), c * d, (m + n) % 4) for powers, c, m in terms for p, d, n in _multiple(k)]
    for powers, c, m in terms:
        value = (a if m % 2 == 0 else b) * (c if m < 2 else -c)
        if value:
            polynomial[powers] = polynomial.get(powers, 0) + value


def polynomial_of(harmonics: Harmonics, sines: Sequence[int], work: Work) -> Polynomial:
    """The polynomial in cosines and sines without c_i^2 for the angles ``sines``, and without s_i^2 for the others."""
    polynomial: Polynomial = {}
    for mode, (a, b) in harmonics.items():
        _add(polynomial, mode, to_fmpq(a), to_fmpq(b), work)
    for i in range(len(next(iter(harmonics), ()))):
        polynomial = _without(polynomial, i, 0 if i in sines else 1, work)
    return {powers: c for powers, c in polynomial.items() if c}


def _eliminated(polynomial: Polynomial, work: Work) -> Iterable[Polynomial]:
    """The forms without s_i^2, or without c_i^2, whichever has fewer terms; first, and last for every angle."""
    size = len(next(iter(polynomial))) if polynomial else 0
    first = dict(polynomial)
    for i in range(size):
        first = _without(first, i, 1, work)
    for i in range(size):
        other = _without(first, i, 0, work)
        if len(other) < len(first):
            first = other
    work.steps(4 * size * len(first))
    yield _merged(first)


def _merged(polynomial: Polynomial) -> Polynomial:
    """c x - c x c_i^2 = c x s_i^2, and the other way round, one by one, or else all: 2 x - x c_1^2 - x c_2^2."""
    result = dict(polynomial)
    for powers in sorted(polynomial, key=lambda p: (sum(map(sum, p)), p)):
        sides = [(i, which) for i in range(len(powers)) for which in (0, 1)]
        for some in (*([side] for side in sides), sides):
            _merge(result, powers, some)
    return result


def _merge(result: Polynomial, powers: Powers, sides: Iterable[tuple[int, int]]) -> None:
    """Merge a term with those that have a further square of c_i or s_i, if these are its negative as a whole."""
    pairs: list[tuple[Powers, Powers]] = []
    c = result.get(powers, 0)
    for i, which in sides:
        partner, merged = (_squared(powers, i, k) for k in (which, 1 - which))
        if result.get(partner, 0) * c < 0 and merged not in result:
            pairs.append((partner, merged))
    if pairs and sum(result[partner] for partner, _ in pairs) == -c:
        del result[powers]
        for partner, merged in pairs:
            result[merged] = -result.pop(partner)


def _squared(powers: Powers, i: int, which: int) -> Powers:
    """Powers with a further square of c_i (``which`` 0) or s_i (1)."""
    both = list(powers[i])
    both[which] += 2
    return (*powers[:i], (both[0], both[1]), *powers[i + 1 :])


def _without(polynomial: Polynomial, i: int, which: int, work: Work) -> Polynomial:
    """The polynomial without squares of c_i (``which`` 0) or s_i (1)."""
    work.steps(sum(1 + powers[i][which] // 2 for powers in polynomial))
    result: Polynomial = {}
    for powers, c in polynomial.items():
        both = powers[i]
        n, other = both[which], both[1 - which]
        for m in range(n // 2 + 1):
            # x^n = x^(n mod 2) (1 - y^2)^(n div 2)
            new = (n % 2, other + 2 * m) if which == 0 else (other + 2 * m, n % 2)
            key = (*powers[:i], new, *powers[i + 1 :])
            value = result.get(key, 0) + c * (comb(n // 2, m) * (-1) ** m)
            if value:
                result[key] = value
            else:
                result.pop(key, None)
    return result


def _written(polynomial: Polynomial, basis: Sequence[Mode]) -> Waves:
    order = sorted(range(len(basis)), key=lambda i: angle_key(basis[i]))
    terms = []
    for powers, c in polynomial.items():
        waves: list[Wave] = []
        for i in order:
            waves += [(op, basis[i], n) for op, n in zip(("sin", "cos"), reversed(powers[i]), strict=True) if n]
        terms.append((fraction(c), tuple(waves)))
    return tuple(sorted(terms, key=lambda term: wave_key(term[1])))


def angle_key(k: Mode) -> tuple[object, ...]:
    """Angles by their first coordinate, single ones before sums."""
    first = next((i for i, n in enumerate(k) if n), len(k))
    return first, sum(1 for n in k if n), tuple(-n for n in k)


def wave_key(waves: tuple[Wave, ...]) -> tuple[object, ...]:
    """Order of products: constants, then by angles, cosines before sines."""
    return tuple((angle_key(k), op, n) for op, k, n in waves)


def normal(harmonics: Mapping[Mode, tuple[Fraction, Fraction]]) -> dict[Mode, tuple[Fraction, Fraction]]:
    """Harmonics by the sign rule of :data:`Mode`, zeros left out."""
    result: dict[Mode, tuple[Fraction, Fraction]] = {}
    for k, (a, b) in harmonics.items():
        turned = next((n for n in k if n), 1) < 0
        key = tuple(-n for n in k) if turned else k
        old = result.get(key, (Fraction(0), Fraction(0)))
        result[key] = old[0] + a, old[1] + (-b if turned else b)
    return {k: (a, b if any(k) else Fraction(0)) for k, (a, b) in result.items() if a or (b and any(k))}
