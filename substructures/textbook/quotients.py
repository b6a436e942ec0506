"""A cancelled rational function as a product of powers of irreducible factors: ``2*m1*cos(q2)/(l1*l2*(...)^2)``.

Numerator and denominator, polynomials in tangents of half angles without common factor, are divided by the same power
of 1 + t^2, the least that makes both of them polynomials in cosines and sines. They are factored as such: those
without squares of sines or those without squares of cosines, whichever has fewer terms.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from substructures.expr.graph import Expr
from substructures.expr.rationals import fraction, to_fmpq
from substructures.textbook.atoms import INPUT, MASS, MOVING, Atoms, Monomial, times
from substructures.textbook.collect import length
from substructures.textbook.contents import Ring, divided, monomial_of
from substructures.textbook.divisors import content as content_of
from substructures.textbook.divisors import is_fraction
from substructures.textbook.field import Field
from substructures.textbook.forces import Grouped, grouped
from substructures.textbook.forms import Factor, Sum, Term, Trig, leaves, product
from substructures.textbook.layout import Layout
from substructures.textbook.products import but_for_one_term
from substructures.textbook.scales import divisors, primitive
from substructures.textbook.springs import Content, stretches

#: terms of a polynomial that is factored
FACTORED = 400
Powers = Sequence[tuple[Factor, int]]


class Quotients:
    """Writes values of a field."""

    def __init__(self, field: Field, atoms: Atoms) -> None:
        self.field, self.atoms = field, atoms
        generators = field.generators
        self.exprs = [generators.atoms[i] for i in field.plain]
        self.places = [atoms.place[e] for e in self.exprs]
        self.size = len(self.exprs)
        self.angles = [generators.atoms[i] for i in field.angles]
        self.units = [field.units[i] for i in field.angles]
        self.layout = Layout(atoms, self.angles, self.units, field.work)
        self.ring = Ring(self.places, len(self.angles), field.work)
        self._forms: dict[str, Sum] = {}

    def __call__(self, expr: Expr) -> Sum:
        """The textbook form of one of the field's expressions."""
        terms: list[Term] = []
        for numerator, denominator in self._joined(self._parts(*self.field.values[expr])):
            monomial = monomial_of(denominator)
            if monomial is None:
                terms.append(self._ratio(numerator, denominator))
            else:
                terms += self._sum(divided(numerator, *monomial))
        return Sum(tuple(terms))

    def _joined(self, parts: Sequence[tuple[Any, Any]]) -> list[tuple[Content, Content]]:
        """Numerators and denominators; two with the same rates are one: (J - A)*q'^2/A for J*q'^2/A - q'^2."""
        contents = [self._contents(*part) for part in parts]
        if len(parts) == 2 and monomial_of(contents[0][1]) and not monomial_of(contents[1][1]):
            one, other = ({(self._rates_of(m), k) for m, h in top.items() for k in h} for top, _ in contents)
            if one <= other and all(rates for rates, _ in one):
                return [self._contents(*self.field.add(*parts))]
        return contents

    def _rates_of(self, monomial: Monomial) -> Monomial:
        return tuple((i, n) for i, n in monomial if self.atoms.is_rate(self.atoms.exprs[i]))

    def _sum(self, content: Content) -> list[Term]:
        """A sum, with k*(s - l)/s for k - k*l/s."""
        found, left = stretches(content, self.atoms)
        terms = list(self.layout(left).terms) if left else []
        for force, s, (monomial, number) in found:
            _, common = content_of(dict.fromkeys(force, Fraction(1)))
            inner = self.layout({times(m, common, -1): h for m, h in force.items()})
            stretched = self.layout.distance(((s, 1),), {monomial: number})
            factors: list[tuple[Factor, int]] = [(inner, 1), (stretched, 1), (self.atoms.exprs[s], -1)]
            terms.append(product(Fraction(1), [*self.atoms.factors(common), *factors]))
        return terms

    def _parts(self, above: Any, below: Any) -> list[tuple[Any, Any]]:
        """Parts with different sums in their denominators, the shortest denominator first.

        Atoms that these sums are free of tell terms apart; p^2/(2 C) leaves p^2 (C c^2 + B s^2)/(2 B C s^2) so.
        """
        core = self._core(below)
        degrees = [max(int(n), 0) for n in core.degrees()]
        free = [i for i in range(self.size) if not degrees[i]]
        groups: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
        for exponents, c in above.to_dict().items():
            groups.setdefault(tuple(int(exponents[i]) for i in free), {})[exponents] = c
        parts: dict[str, list[Any]] = {}
        for terms in groups.values():
            some = self.field.context.from_dict(terms)
            _, bottom = self.field.lowest(some, below)
            key = str(self._core(bottom))
            parts.setdefault(key, [len(bottom), self.field.context.constant(0)])[1] += some
        found = [(size, key, *self.field.lowest(p, below)) for key, (size, p) in parts.items()]
        return [(top, bottom) for _, _, top, bottom in sorted(found, key=lambda item: item[:2])]

    def _core(self, poly: Any) -> Any:
        """A denominator without powers of atoms and of 1 + t^2."""
        lowest = list(map(min, zip(*poly.monoms(), strict=True)))[: self.size]
        powers = [*map(int, lowest), *[0] * (len(poly.degrees()) - self.size)]
        poly = poly / self.field.context.term(exp_vec=tuple(powers))
        for n in range(len(self.angles)):
            unit = 1 + self.field.context.gen(self.size + n) ** 2
            while True:
                quotient, rest = divmod(poly, unit)
                if len(rest):
                    break
                poly = quotient
        return poly / poly.leading_coefficient()

    def _contents(self, above: Any, below: Any) -> tuple[Content, Content]:
        """Numerator and denominator in cosines and sines."""
        degrees = [max(a, b) for a, b in zip(above.degrees(), below.degrees(), strict=True)][self.size :]
        halves = [(max(int(n), 0) + 1) // 2 for n in degrees]
        numerator, denominator = (self.ring.from_tangents(p, halves) for p in (above, below))
        return numerator, denominator

    def _ratio(self, numerator: Content, denominator: Content) -> Term:
        number, above = self._factors(numerator)
        below_number, below = self._factors(denominator)
        return self._product(number / below_number, [*above, *((part, -n) for part, n in below)])

    def _factors(self, content: Content) -> tuple[Fraction, list[tuple[Any, int]]]:
        """A number and polynomials without content, irreducible unless they are large, with their powers."""
        poly, _ = self.ring.fewest(content)
        if len(poly) > FACTORED:
            number = primitive([fraction(c) for c in poly.coeffs()])
            return number, [(poly / to_fmpq(number), 1)]
        c, parts = self.field.work.factor(poly)
        return fraction(c), parts

    def _product(self, number: Fraction, parts: Sequence[tuple[Any, int]]) -> Term:
        """A product of powers of polynomials in its order, those below last."""
        parts = _squares(parts)
        scales = divisors(number, [([fraction(c) for c in part.coeffs()], n) for part, n in parts])
        factors: list[tuple[Factor, int]] = []
        for (part, n), scale in zip(parts, scales, strict=True):
            form = self._form(part / to_fmpq(scale))
            sign = -1 if form.terms[0].coefficient < 0 else 1
            number *= (sign * scale) ** n
            factors.append((Sum(tuple(t.scaled(Fraction(sign)) for t in form.terms)), n))
        found = sorted(factors, key=lambda item: (item[1] < 0, *self._key(item)))
        return product(*self._positive(number, found))

    def _positive(self, number: Fraction, factors: Powers) -> tuple[Fraction, Powers]:
        """B*(f - y) - A*(e - x) for -(A*(e - x) - B*(f - y)), where inputs act on both."""
        found = list(factors)
        for i, (factor, n) in enumerate(factors):
            terms = factor.terms if isinstance(factor, Sum) and n == 1 else ()
            if (
                number < 0
                and [t.coefficient > 0 for t in terms] == [True, False]
                and all(self.atoms.acts(leaves(Sum((t,)))) for t in terms)
            ):
                found[i] = (Sum(tuple(t.scaled(Fraction(-1)) for t in reversed(terms))), 1)
                number = -number
        return number, found

    def _form(self, poly: Any) -> Sum:
        """The shortest form of an irreducible polynomial: a sum, or a product of sums and a term."""
        key = str(poly)
        if key not in self._forms:
            self._forms[key] = self._shortest(poly)
        return self._forms[key]

    def _shortest(self, poly: Any) -> Sum:
        is_exact = all(is_fraction(fraction(c)) for c in poly.coeffs())
        found = self._grouped(poly) if is_exact and self._rates(poly) else None
        if found is not None:
            return self._with_forces(found)
        content = self.ring.back(poly)
        forms = [self.layout(content)]
        if is_exact and not self._rates(poly):
            forms += self._products(content)
        return min(forms, key=length)

    def _rates(self, poly: Any) -> bool:
        """Whether something besides cosines and sines moves."""
        used = [p for p, n in zip(self.places, poly.degrees(), strict=False) if n > 0]
        return any(self.atoms.ranks[p] == MOVING for p in used)

    def _grouped(self, poly: Any) -> Grouped | None:
        """The polynomial with forces times what they are multiplied with."""
        degrees, ranks = list(poly.degrees())[: self.size], [self.atoms.ranks[p] for p in self.places]
        inputs = [n for n, rank in enumerate(ranks) if rank == INPUT and degrees[n] == 1]
        masses = [n for n, rank in enumerate(ranks) if rank == MASS and degrees[n]]
        return grouped(poly, inputs, masses)

    def _with_forces(self, found: Grouped) -> Sum:
        one = self._product(Fraction(1), [(found.minor, 1), (found.force, 1)])
        return Sum((one, self._product(*self._factors(self.ring.back(found.rest)))) if len(found.rest) else (one,))

    def _products(self, content: Content) -> Iterator[Sum]:
        """The forms that are a product of sums but for one term."""
        _, sines = self.ring.fewest(content)
        for i in range(len(self.angles)):
            others = tuple(n for n in sines if n != i)
            cosine = self.size + 2 * i
            for some, square, other in ((others, cosine, cosine + 1), ((*others, i), cosine + 1, cosine)):
                for number, parts, rest in but_for_one_term(
                    self.ring.polynomial(content, some), square, other, self.field.work
                ):
                    factors: list[tuple[Factor, int]] = [(self.layout(self.ring.back(part)), n) for part, n in parts]
                    one = product(fraction(number), sorted(factors, key=self._key))
                    yield Sum((one, *self.layout(self.ring.back(rest)).terms))

    def _key(self, item: tuple[Factor, int]) -> tuple[int, int, list[int]]:
        """Total masses, atoms, sums of atoms, inputs, cosines and sines by their angles, sums with them, rates."""
        form = item[0]
        assert isinstance(form, Sum)  # noqa: S101 -- for the type checker
        found = list(leaves(form))
        atoms = [x for x in found if isinstance(x, Expr)]
        places = [self.atoms.place[x] for x in atoms]
        is_sum = len(form.terms) > 1 or not form.terms[0].factors
        if any(map(self.atoms.is_rate, atoms)):
            return 5, len(form) if is_sum else 0, places
        if len(atoms) < len(found):
            return (4, len(form), places) if is_sum else (3, 0, self._angle_places(found[0]))
        if self.atoms.acts(atoms):
            return 2, len(form) if is_sum else 0, places
        if not is_sum:
            return 0, 0, places[:1]
        is_total = bool(places) and all(map(self.layout.collect.is_mass, form.terms))
        return -1 if is_total else 1, len(form), places

    def _angle_places(self, trig: Expr | Trig) -> list[int]:
        """The order of a cosine or sine: by its first angle, single angles before sums, sines before cosines."""
        angle = [self.angles.index(a) for a, _ in trig.angle] if isinstance(trig, Trig) else []
        return [*angle[:1], len(angle), *angle[1:], isinstance(trig, Trig) and trig.op == "cos"]


def _squares(parts: Sequence[tuple[Any, int]]) -> list[tuple[Any, int]]:
    """The factors with c^2 - x^2 for (c - x)*(c + x), where x is one term."""
    found = list(parts)
    for i, (one, n) in enumerate(parts):
        for other, m in parts[:i]:
            twice = next((x for x in (one + other, one - other) if x.is_constant()), None)
            if n == m and twice is not None and len(one - twice / 2) == 1:
                found = [item for item in found if item[0] not in (one, other)] + [(one * other, n)]
    return found
