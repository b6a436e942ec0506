"""A cancelled rational function as a product of powers of irreducible factors: ``2*m1*cos(q2)/(l1*l2*(...)^2)``.

Numerator and denominator, polynomials in tangents of half angles without common factor, are divided by the same power
of 1 + t^2, the least that makes both of them polynomials in cosines and sines. They are factored as such: those
without squares of sines or those without squares of cosines, whichever has fewer terms.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from substructures.expr.graph import Expr
from substructures.textbook.atoms import MOVING, Atoms, Monomial, times
from substructures.textbook.collect import is_fraction
from substructures.textbook.exponentials import Complex, harmonics_of, power, spread, tangent
from substructures.textbook.field import Field, to_fmpq
from substructures.textbook.forms import Factor, Sum, Term, Trig, leaves, product
from substructures.textbook.harmonics import Mode, normal, polynomial_of
from substructures.textbook.layout import Content, Layout

#: terms of a polynomial that is factored
FACTORED = 400
_ZERO = Fraction(0)


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
        self.layout = Layout(atoms, self.angles, self.units)
        names = [f"g{i}" for i in range(self.size + 2 * len(self.angles))]
        self.context = fmpq_mpoly_ctx.get(names, Ordering.lex)

    def __call__(self, expr: Expr) -> Sum:
        """The textbook form of one of the field's expressions."""
        above, below = self.field.values[expr]
        terms: list[Term] = []
        for top, bottom in self._parts(above, below):
            terms += self._ratio(top, bottom)
        return Sum(tuple(terms))

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
        powers = [min(int(m[i]) for m in poly.monoms()) if i < self.size else 0 for i in range(len(poly.degrees()))]
        poly = poly / self.field.context.term(exp_vec=tuple(powers))
        for n in range(len(self.angles)):
            unit = 1 + self.field.context.gen(self.size + n) ** 2
            while True:
                quotient, rest = divmod(poly, unit)
                if len(rest):
                    break
                poly = quotient
        return poly / poly.leading_coefficient()

    def _ratio(self, above: Any, below: Any) -> list[Term]:
        degrees = [max(a, b) for a, b in zip(above.degrees(), below.degrees(), strict=True)][self.size :]
        halves = [(max(int(n), 0) + 1) // 2 for n in degrees]
        numerator, denominator = (_content(p, self.size, self.places, halves) for p in (above, below))
        if len(denominator) == 1:
            ((monomial, waves),) = denominator.items()
            if all(not any(k) for k in waves):
                return list(self.layout(_divided(numerator, monomial, next(iter(waves.values()))[0])).terms)
        top, bottom = self._factors(numerator), self._factors(denominator)
        return [product(top[0] / bottom[0], [*top[1], *((f, -n) for f, n in bottom[1])])]

    def _factors(self, content: Content) -> tuple[Fraction, list[tuple[Factor, int]]]:
        """A number and factors with their powers."""
        poly = self._fewest(content)
        if len(poly) > FACTORED:
            parts = [(poly, 1)]
            number = Fraction(1)
        else:
            c, parts = poly.factor()
            number = _fraction(c)
        factors: list[tuple[Factor, int]] = []
        for part, n in parts:
            form = self.layout(self._back(part))
            scale = _scale(form)
            number *= scale ** int(n)
            factors.append((Sum(tuple(t.scaled(1 / scale) for t in form.terms)), int(n)))
        return number, sorted(factors, key=self._key)

    def _key(self, item: tuple[Factor, int]) -> tuple[int, int, int]:
        """Single atoms in their order, then sums of parameters, cosines and sines, and other sums by length."""
        form = item[0]
        assert isinstance(form, Sum)  # noqa: S101 -- for the type checker
        if len(form.terms) > 1 or not form.terms[0].factors:
            moves = any(isinstance(x, Trig) or self.atoms.ranks[self.atoms.place[x]] == MOVING for x in leaves(form))
            return (3 if moves else 1), len(form), 0
        first = form.terms[0].factors[0][0]
        return (0, 0, self.atoms.place[first]) if isinstance(first, Expr) else (2, 0, 0)

    def _fewest(self, content: Content) -> Any:
        """The polynomial in atoms, cosines and sines with the fewest terms."""
        best = self._polynomial(content, ())
        sines: tuple[int, ...] = ()
        for i in range(len(self.angles)):
            other = self._polynomial(content, (*sines, i))
            if len(other) < len(best):
                best, sines = other, (*sines, i)
        return best

    def _polynomial(self, content: Content, sines: Sequence[int]) -> Any:
        """The polynomial without squares of cosines of the angles ``sines``, and of sines of the others."""
        place = {p: n for n, p in enumerate(self.places)}
        found: dict[tuple[int, ...], Any] = {}
        for monomial, harmonics in content.items():
            head = [0] * self.size
            for i, n in monomial:
                head[place[i]] = n
            for powers, c in polynomial_of(normal(harmonics), sines).items():
                key = (*head, *(n for both in powers for n in both))
                found[key] = found.get(key, _ZERO) + c
        return self.context.from_dict({k: to_fmpq(c) for k, c in found.items() if c})

    def _back(self, poly: Any) -> Content:
        """The harmonics of a polynomial in atoms, cosines and sines."""
        result: dict[Monomial, dict[Mode, Complex]] = {}
        for raw, c in poly.to_dict().items():
            exponents = [int(n) for n in raw]
            monomial = self._monomial(exponents[: self.size])
            pairs = [exponents[self.size + 2 * i : self.size + 2 * i + 2] for i in range(len(self.angles))]
            spread(result.setdefault(monomial, {}), [power(a, b) for a, b in pairs], _fraction(c))
        return {m: harmonics_of(z) for m, z in result.items()}

    def _monomial(self, exponents: Sequence[int]) -> Monomial:
        return tuple(sorted((p, n) for p, n in zip(self.places, exponents, strict=True) if n))


def _content(poly: Any, size: int, places: Sequence[int], halves: Sequence[int]) -> Content:
    """A polynomial in tangents over the powers ``halves`` of 1 + t^2, as harmonics."""
    result: dict[Monomial, dict[Mode, Complex]] = {}
    for raw, c in poly.to_dict().items():
        exponents = [int(n) for n in raw]
        monomial = tuple(sorted((p, n) for p, n in zip(places, exponents[:size], strict=True) if n))
        waves = [tangent(j, e) for j, e in zip(exponents[size:], halves, strict=True)]
        spread(result.setdefault(monomial, {}), waves, _fraction(c))
    found = {m: harmonics_of(z) for m, z in result.items()}
    return {m: h for m, h in found.items() if h}


def _divided(content: Content, monomial: Monomial, number: Fraction) -> Content:
    """Content over a number and a monomial."""
    return {
        times(m, monomial, -1): {k: (a / number, b / number) for k, (a, b) in h.items()} for m, h in content.items()
    }


def _scale(form: Sum) -> Fraction:
    """Sign of the first term; a power of ten where coefficients are no simple numbers, so that they are small."""
    numbers = [abs(t.coefficient) for t in form.terms]
    sign = -1 if form.terms[0].coefficient < 0 else 1
    largest = max(numbers)
    if largest < 1000 and all(is_fraction(n) for n in numbers):
        return Fraction(sign)
    return sign * Fraction(10) ** (len(str(int(largest))) - 1)


def _fraction(c: Any) -> Fraction:
    return Fraction(int(c.p), int(c.q))
