"""Polynomials in parameters as a person collects them: ``(m1 + m2)*l1^2 + m2*l2^2``.

Every term of mechanics is a mass (or moment of inertia) times what is called its geometry here. Terms are gathered by
geometry or by masses, whichever is shorter, and equal sums that result are gathered once more.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from functools import partial

from substructures.expr.graph import Expr
from substructures.textbook.atoms import INPUT, MASS, Atoms, Monomial, Polynomial, monomial_key, times
from substructures.textbook.divisors import content, divided, factored
from substructures.textbook.forms import Factor, Sum, Term, leaves, product
from substructures.textbook.work import Work

#: terms of a sum that may be a product but for one term, the fewest and the most
FEWEST, MOST = 4, 13
#: steps for every term of a sum in all ways in which it is gathered
WAYS = 32
#: terms, and the monomial where they belong
Placed = tuple[Monomial, list[Term]]


class Collector:
    """Collects polynomials in the same atoms."""

    def __init__(self, atoms: Atoms, work: Work) -> None:
        self.atoms, self.work = atoms, work
        self._known: dict[frozenset[tuple[Monomial, Fraction]], Sum] = {}

    def __call__(self, polynomial: Polynomial) -> Sum:
        """The shortest of the sum as it is, gathered by geometry, by masses, and by what acts or moves."""
        key = frozenset(polynomial.items())
        if key not in self._known:
            self._known[key] = self._shortest(polynomial)
        return self._known[key]

    def _shortest(self, polynomial: Polynomial) -> Sum:
        plain = self.plain(polynomial)
        if len(polynomial) < 2:
            return plain
        self.work.steps(WAYS * len(polynomial))
        number, parts = factored(polynomial, Fraction(1), self.work)
        if sum(n for part, n in parts if len(part) > 1) > 1:
            factors: list[tuple[Factor, int]] = [(self(part), n) for part, n in parts]
            return Sum((product(number, self.in_order(factors)),))
        forms = [in_order(way) for way in (*self._ways(polynomial), *self._acting(polynomial))]
        forms += [self.squared(polynomial), self._with_squares(polynomial), *self._but_for_one_term(polynomial)]
        return min(forms, key=length)

    def _but_for_one_term(self, polynomial: Polynomial) -> Iterator[Sum]:
        """A product of sums and one term: (I + m*l^2)*(J + n*r^2) + J*n*l^2."""
        if not FEWEST <= len(polynomial) <= MOST:
            return
        for one in sorted(polynomial, key=monomial_key):
            rest = {m: c for m, c in polynomial.items() if m != one}
            number, parts = factored(rest, Fraction(1), self.work)
            if sum(n for part, n in parts if len(part) > 1) > 1:
                whole = product(number, self.in_order((self(part), n) for part, n in parts))
                terms = [(min(rest, key=monomial_key), [whole]), *self._terms({one: polynomial[one]})]
                yield in_order(terms)

    def factored(self, polynomial: Polynomial) -> Term:
        """One product: common factors, then what is left as sum."""
        number, common = content(polynomial)
        number, parts = factored(divided(polynomial, number, common), number, self.work)
        sums: list[tuple[Factor, int]] = [(self(part), n) for part, n in parts]
        return product(number, self.in_order([*self.atoms.factors(common), *sums]))

    def plain(self, polynomial: Polynomial) -> Sum:
        """Term by term."""
        return in_order(self._terms(polynomial))

    def written(self, polynomial: Polynomial) -> Sum:
        """Irreducible factors, squares of binomials, or else term by term."""
        number, parts = factored(polynomial, Fraction(1), self.work)
        if sum(n for part, n in parts if len(part) > 1) < 2:
            acting = map(in_order, self._acting(polynomial)) if FEWEST <= len(polynomial) <= MOST else ()
            return min([self.squared(polynomial), *acting], key=length)
        return Sum((product(number, self.in_order((self.squared(part), n) for part, n in parts)),))

    def squared(self, polynomial: Polynomial) -> Sum:
        """Term by term, but (x + y)^2 for x^2 + 2*x*y + y^2."""
        squares, left = self._squares(polynomial)
        return in_order([*self._terms(left), *((first, [Term(c, ((both, 2),))]) for first, both, c in squares)])

    def _squares(self, polynomial: Polynomial) -> tuple[list[tuple[Monomial, Sum, Fraction]], Polynomial]:
        """x^2, x + y and c of every c*(x + y)^2 among the terms, and what is left."""
        found, left = list[tuple[Monomial, Sum, Fraction]](), dict(polynomial)
        for mixed in sorted(polynomial, key=monomial_key):
            if [n for _, n in mixed] != [1, 1] or mixed not in left:
                continue
            (x, _), (y, _) = mixed
            one: Monomial = ((x, 2),)
            other: Monomial = ((y, 2),)
            c = left.get(one)
            if c is not None and left.get(other) == c and abs(left[mixed]) == 2 * abs(c):
                both = self.plain({((x, 1),): Fraction(1), ((y, 1),): left[mixed] / (2 * c)})
                found.append((one, both, c))
                left = {m: n for m, n in left.items() if m not in (one, other, mixed)}
        return found, left

    def _with_squares(self, polynomial: Polynomial) -> Sum:
        """Squares of binomials times masses, and the rest gathered."""
        geometries: dict[Monomial, dict[Monomial, Fraction]] = {}
        for monomial, c in polynomial.items():
            masses = self._masses(monomial)
            geometries.setdefault(masses, {})[times(monomial, masses, -1)] = c
        groups: dict[tuple[Monomial, Sum], dict[Monomial, Fraction]] = {}
        left: dict[Monomial, Fraction] = {}
        for masses, inner in geometries.items():
            squares, rest = self._squares(inner)
            for first, both, c in squares:
                groups.setdefault((first, both), {})[masses] = c
            left |= {times(masses, m): c for m, c in rest.items()}
        found: list[Placed] = []
        for (first, both), sizes in groups.items():
            number, common = content(sizes)
            some = self.plain(divided(sizes, number, common))
            term = product(number, self.in_order([*self.atoms.factors(common), (some, 1), (both, 2)]))
            found.append((min((times(m, first) for m in sizes), key=monomial_key), [term]))
        if not found:
            return self.plain(polynomial)
        rest_ = min((*self._ways(left), self._terms(left)), key=lambda items: length(in_order(items)))
        return in_order([*found, *rest_])

    def _ways(self, polynomial: Polynomial) -> Iterator[list[Placed]]:
        """Gathered by geometry, by masses, and what does not go one way by the other."""
        ways = (self._geometry, self._masses)
        for by in ways:
            yield self._gathered(polynomial, by)
        for by, then in (ways, ways[::-1]):
            counts = Counter(map(by, polynomial))
            alone = {m: c for m, c in polynomial.items() if counts[by(m)] == 1}
            others = {m: c for m, c in polynomial.items() if m not in alone}
            yield [*self._gathered(others, by), *self._gathered(alone, then)]

    def _acting(self, polynomial: Polynomial) -> Iterator[list[Placed]]:
        """Gathered by inputs and rates, or by what these are multiplied with: (J + m*l^2)*(tau_1 - b*q1')."""
        if len({self.atoms.ranks[i] >= INPUT for m in polynomial for i, _ in m}) < 2:
            return
        acting, resting = partial(self._those, True), partial(self._those, False)
        yield self._gathered(polynomial, acting, self)
        counts = Counter(map(resting, polynomial))
        alone = {m: c for m, c in polynomial.items() if counts[resting(m)] == 1}
        others = {m: c for m, c in polynomial.items() if m not in alone}
        yield [*self._gathered(others, resting, self), *self._gathered(alone, acting, self)]

    def _those(self, acts: bool, monomial: Monomial) -> Monomial:
        """Inputs and what moves in a monomial, or the rest."""
        return tuple((i, n) for i, n in monomial if (self.atoms.ranks[i] >= INPUT) == acts)

    def _terms(self, polynomial: Polynomial) -> list[Placed]:
        return [(m, [Term(c, tuple(self.atoms.factors(m)))]) for m, c in polynomial.items()]

    def _geometry(self, monomial: Monomial) -> Monomial:
        return tuple((i, n) for i, n in monomial if self.atoms.ranks[i] != MASS)

    def _masses(self, monomial: Monomial) -> Monomial:
        return tuple((i, n) for i, n in monomial if self.atoms.ranks[i] == MASS)

    def _gathered(
        self,
        polynomial: Polynomial,
        by: Callable[[Monomial], Monomial],
        write: Callable[[Polynomial], Sum] | None = None,
    ) -> list[Placed]:
        """Sums of what has the same key, and of the keys of the same sum, both written by ``write``."""
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
        terms: list[Placed] = []
        for rest, keys in same.items():
            if rest == (((), Fraction(1)),):
                terms += self._terms(keys)
                continue
            first = min((times(k, m) for k in keys for m, _ in rest), key=monomial_key)
            terms.append((first, self._product(dict(rest), keys, write or self.written)))
        return terms

    def _product(self, inner: Polynomial, keys: Polynomial, write: Callable[[Polynomial], Sum]) -> list[Term]:
        """Terms of a product of two sums; a sum that is multiplied by a number only needs no parentheses."""
        if tuple(keys) == ((),) and abs(keys[()]) == 1:
            return [t.scaled(keys[()]) for t in self.squared(inner).terms]
        number, common = content(keys)
        outer = write(divided(keys, number, common))
        factors: list[tuple[Factor, int]] = [*self.atoms.factors(common), (write(inner), 1), (outer, 1)]
        return opened(product(number, self.in_order(factors)))

    def in_order(self, factors: Iterable[tuple[Factor, int]]) -> list[tuple[Factor, int]]:
        """Total masses first, (m1 + m2), then atoms, then other sums, then inputs, then rates."""

        def key(item: tuple[Factor, int]) -> int:
            """0 for sums of masses, 1 for atoms, 2 for other sums; 3 with inputs, 4 for rates, 5 for sums of rates."""
            factor = item[0]
            atoms = [x for x in leaves(factor) if isinstance(x, Expr)] if isinstance(factor, Sum) else []
            if isinstance(factor, Expr):
                atoms = [factor]
            if any(map(self.atoms.is_rate, atoms)):
                return 5 if isinstance(factor, Sum) else 4
            if any(self.atoms.ranks[self.atoms.place[x]] == INPUT for x in atoms):
                return 3
            if not isinstance(factor, Sum):
                return 1
            return 0 if all(map(self.is_mass, factor.terms)) else 2

        return sorted(factors, key=key)

    def is_mass(self, term: Term) -> bool:
        """Whether it is a mass or moment of inertia alone, times a number."""
        ((factor, n),) = term.factors if len(term.factors) == 1 else ((None, 0),)
        return n == 1 and isinstance(factor, Expr) and self.atoms.ranks[self.atoms.place[factor]] == MASS


def in_order(found: Iterable[Placed]) -> Sum:
    """Terms in the order of the monomials where they belong."""
    return Sum(tuple(term for _, some in sorted(found, key=lambda item: monomial_key(item[0])) for term in some))


def length(form: Sum) -> tuple[int, int]:
    """How much is written; of equal lengths what is gathered is better."""
    return len(form), len(form.terms)


def opened(term: Term) -> list[Term]:
    """The terms of a sum that is multiplied by nothing."""
    ((only, n),) = term.factors if len(term.factors) == 1 else ((None, 0),)
    if isinstance(only, Sum) and n == 1 and abs(term.coefficient) == 1:
        return [t.scaled(term.coefficient) for t in only.terms]
    return [term]
