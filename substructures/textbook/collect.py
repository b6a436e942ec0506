"""Polynomials in parameters as a person collects them: ``(m1 + m2)*l1^2 + m2*l2^2``.

Every term of mechanics is a mass (or moment of inertia) times what is called its geometry here. Terms are gathered by
geometry or by masses, whichever is shorter, and equal sums that result are gathered once more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from math import gcd, lcm

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from substructures.expr.graph import Expr
from substructures.textbook.atoms import MASS, Atoms, Monomial, Polynomial, monomial_key, times
from substructures.textbook.forms import Factor, Sum, Term, product

#: terms of a polynomial that is factored
FACTORED = 60


def content(polynomial: Polynomial) -> tuple[Fraction, Monomial]:
    """The greatest number and monomial that divide all terms; with the sign of the first term."""
    first = min(polynomial, key=monomial_key)
    number = common_number(polynomial.values())
    powers = dict(first)
    for monomial in polynomial:
        here = dict(monomial)
        powers = {i: min(powers.get(i, 0), here.get(i, 0)) for i in {*powers, *here}}
    common = tuple(sorted((i, n) for i, n in powers.items() if n))
    return (-number if polynomial[first] < 0 else number), common


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


class Collector:
    """Collects polynomials in the same atoms."""

    def __init__(self, atoms: Atoms) -> None:
        self.atoms = atoms

    def __call__(self, polynomial: Polynomial) -> Sum:
        """The shortest of the sum as it is, gathered by geometry, and gathered by masses."""
        plain = self.plain(polynomial)
        if len(polynomial) < 2:
            return plain
        number, parts = factored(polynomial, Fraction(1))
        if sum(n for part, n in parts if len(part) > 1) > 1:
            factors: list[tuple[Factor, int]] = [(self(part), n) for part, n in parts]
            return Sum((product(number, self.in_order(factors)),))
        forms = [self._gathered(polynomial, self._geometry), self._gathered(polynomial, self._masses), plain]
        return min(forms, key=len)

    def factored(self, polynomial: Polynomial) -> Term:
        """One product: common factors, then what is left as sum."""
        number, common = content(polynomial)
        number, parts = factored(divided(polynomial, number, common), number)
        sums: list[tuple[Factor, int]] = [(self(part), n) for part, n in parts]
        return product(number, self.in_order([*self.atoms.factors(common), *sums]))

    def plain(self, polynomial: Polynomial) -> Sum:
        """Term by term."""
        items = sorted(polynomial.items(), key=lambda item: monomial_key(item[0]))
        return Sum(tuple(Term(c, tuple(self.atoms.factors(m))) for m, c in items))

    def _geometry(self, monomial: Monomial) -> Monomial:
        return tuple((i, n) for i, n in monomial if self.atoms.ranks[i] != MASS)

    def _masses(self, monomial: Monomial) -> Monomial:
        return tuple((i, n) for i, n in monomial if self.atoms.ranks[i] == MASS)

    def _gathered(self, polynomial: Polynomial, by: Callable[[Monomial], Monomial]) -> Sum:
        groups: dict[Monomial, dict[Monomial, Fraction]] = {}
        for monomial, c in polynomial.items():
            key = by(monomial)
            groups.setdefault(key, {})[times(monomial, key, -1)] = c
        # groups with proportional sums are one: sum of keys * sum
        same: dict[tuple[tuple[Monomial, Fraction], ...], dict[Monomial, Fraction]] = {}
        for key, inner in groups.items():
            number, common = content(inner)
            rest = tuple(sorted(divided(inner, number, common).items()))
            key = times(key, common)
            same.setdefault(rest, {})[key] = number
        terms = []
        for rest, keys in same.items():
            first = min((times(k, m) for k in keys for m, _ in rest), key=monomial_key)
            terms.append((first, self._product(dict(rest), keys)))
        ordered = sorted(terms, key=lambda item: monomial_key(item[0]))
        flat: list[Term] = []
        for _, some in ordered:
            flat += some
        return Sum(tuple(flat))

    def _product(self, inner: Polynomial, keys: Polynomial) -> list[Term]:
        """Terms of a product of two sums; a sum that is multiplied by a number only needs no parentheses."""
        if tuple(keys) == ((),) and abs(keys[()]) == 1:
            return [t.scaled(keys[()]) for t in self.plain(inner).terms]
        number, common = content(keys)
        outer = self.plain(divided(keys, number, common))
        factors: list[tuple[Factor, int]] = [*self.atoms.factors(common), (self.plain(inner), 1), (outer, 1)]
        return [product(number, self.in_order(factors))]

    def in_order(self, factors: Iterable[tuple[Factor, int]]) -> list[tuple[Factor, int]]:
        """Total masses first, (m1 + m2), then atoms, then other sums."""

        def key(item: tuple[Factor, int]) -> int:
            """0 for sums of masses, 1 for atoms, 2 for other sums."""
            factor = item[0]
            if not isinstance(factor, Sum):
                return 1
            return 0 if all(self._is_mass(t) for t in factor.terms) else 2

        return sorted(factors, key=key)

    def _is_mass(self, term: Term) -> bool:
        ((factor, n),) = term.factors if len(term.factors) == 1 else ((None, 0),)
        return n == 1 and isinstance(factor, Expr) and self.atoms.ranks[self.atoms.place[factor]] == MASS


def factored(polynomial: Polynomial, number: Fraction) -> tuple[Fraction, list[tuple[Polynomial, int]]]:
    """number * polynomial as a number and irreducible factors with their powers; large ones stay as they are."""
    if not 3 <= len(polynomial) <= FACTORED or any(not is_fraction(c) for c in polynomial.values()):
        return number, [(polynomial, 1)]
    used = sorted({i for m in polynomial for i, _ in m})
    context = fmpq_mpoly_ctx.get([f"g{i}" for i in range(len(used))], Ordering.lex)
    exponents = {tuple(dict(m).get(i, 0) for i in used): c for m, c in polynomial.items()}
    if any(n < 0 for k in exponents for n in k):
        return number, [(polynomial, 1)]
    c, parts = context.from_dict({k: fmpq(x.numerator, x.denominator) for k, x in exponents.items()}).factor()
    if len(parts) == 1 and parts[0][1] == 1:
        return number, [(polynomial, 1)]
    number *= Fraction(int(c.p), int(c.q))
    found: list[tuple[Polynomial, int]] = []
    for part, n in parts:
        inner = {
            tuple((i, int(e)) for i, e in zip(used, k, strict=True) if e): Fraction(int(x.p), int(x.q))
            for k, x in part.to_dict().items()
        }
        sign = -1 if inner[min(inner, key=monomial_key)] < 0 else 1
        number *= Fraction(sign) ** int(n)
        found.append(({m: x * sign for m, x in inner.items()}, int(n)))
    return number, sorted(found, key=lambda item: sorted(map(monomial_key, item[0])))
