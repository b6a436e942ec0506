"""Rational functions of symbols, cosines and sines, cancelled: in tangents of half angles over the rationals.

With t = tan(q/2), cos q = (1 - t^2)/(1 + t^2) and sin q = 2 t/(1 + t^2), so that they are quotients of polynomials,
which have unique factors and greatest common divisors (FLINT). Every sum and product is cancelled when it is formed
(P. Henrici, 1956; D. E. Knuth, The Art of Computer Programming, volume 2, section 4.5.1), so nothing grows that need
not. Square roots are further generators, whose squares are replaced.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import comb, gcd
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from substructures.expr.graph import Expr
from substructures.expr.rationals import to_fmpq
from substructures.expr.rings.expand import classified
from substructures.expr.rings.generators import Angle, Generators, Product, Sum, is_function, turned
from substructures.expr.walk import reachable
from substructures.textbook.work import Work

#: products of terms of all products and divisors together
WORK = 3_000_000

#: numerator and denominator (fmpq_mpoly) without a common factor
Ratio = tuple[Any, Any]


class Field:
    """The values of some expressions of one graph. Raises TooLarge (size, limit), ZeroDivisionError."""

    def __init__(self, exprs: Sequence[Expr], work: Work | None = None) -> None:
        nodes, self.work = reachable(exprs, is_function), Work(WORK) if work is None else work
        self.generators: Generators = classified(exprs)
        forms = {n: self.generators.forms[n] for n in nodes if is_function(n)}
        units = self.generators.units(f for f in forms.values() if isinstance(f, Angle))
        self.units = {i: unit_of([unit]) for i, unit in units.items()}
        self.angles = sorted(self.units, key=lambda i: self.generators.order[i])
        self.plain = self._plain(nodes)
        self.context = fmpq_mpoly_ctx.get([f"g{i}" for i in range(len(self.plain) + len(self.angles))], Ordering.lex)
        self.place = {g: n for n, g in enumerate(self.plain)}
        self.one = self.context.constant(1)
        self.relations = [(n, self._square(g, n)) for n, g in enumerate(self.plain) if g in self.generators.squares]
        self.values: dict[Expr, Ratio] = {}
        for node in nodes:
            self.values[node] = self._value(node, forms)

    def _plain(self, nodes: Sequence[Expr]) -> list[int]:
        """Generators that are no angles; roots first, those of sums before those in the sums."""
        g = self.generators
        used = g.plain(nodes)
        sums = sorted((i for i in used if isinstance(g.squares.get(i), Sum)), reverse=True)
        return [*sums, *sorted(used - set(sums), key=lambda i: (i not in g.squares, g.order[i]))]

    def _square(self, generator: int, n: int) -> Any:
        square, x = self.generators.squares[generator], self.context.gen(n) ** 2
        if isinstance(square, int):
            return x - square
        for basis, c in square.terms:
            exponents = [0] * (len(self.plain) + len(self.angles))
            for i, power in basis.monomial:
                exponents[self.place[i]] = power
            x -= self.context.term(coeff=to_fmpq(c), exp_vec=tuple(exponents))
        return x

    def _value(self, node: Expr, forms: Mapping[Expr, Angle | Product]) -> Ratio:
        if node.op == "sym":
            return self.context.gen(self.place[self.generators.symbol(node)]), self.one
        if node.is_number:
            return self.context.constant(to_fmpq(Fraction(node.value))), self.one
        if node in forms:
            return self._function(node, forms[node])
        a = self.values[node.args[0]]
        if node.op == "neg":
            return -a[0], a[1]
        b = self.values[node.args[1]]
        if node.op in ("add", "sub"):
            return self.add(a, b if node.op == "add" else (-b[0], b[1]))
        if node.op == "mul":
            return self.mul(a, b)
        if not len(b[0]):
            raise ZeroDivisionError("division by an expression that is identically zero")
        return self.mul(a, self._normal(b[1], b[0]))

    def _function(self, node: Expr, form: Angle | Product) -> Ratio:
        if isinstance(form, Product):
            result = self.context.constant(to_fmpq(form.factor))
            for i in form.ids:
                result *= self.context.gen(self.place[i])
            return self._reduced(result), self.one
        re, im = turned(form.turns, self.context.constant, self._root)
        below = self.one
        for n, i in enumerate(self.angles):
            k = int(form.atoms.get(i, 0) / self.units[i])
            t = self.context.gen(len(self.plain) + n)
            up = [comb(2 * abs(k), m) * t**m for m in range(2 * abs(k) + 1)]
            # (1 + i t)^(2 k) / (1 + t^2)^k
            x = sum(((-1) ** (m // 2) * p for m, p in enumerate(up) if m % 2 == 0), self.context.constant(0))
            y = sum(((-1) ** (m // 2) * p for m, p in enumerate(up) if m % 2), self.context.constant(0))
            y = y if k >= 0 else -y
            re, im = re * x - im * y, re * y + im * x
            below *= (1 + t**2) ** abs(k)
        if node.op == "tan":
            if not len(re):
                raise ZeroDivisionError("tangent of a right angle")
            return self.lowest(im, re)
        return self.lowest(self._reduced(re if node.op == "cos" else im), below)

    def _root(self, n: int) -> Any:
        return self.context.gen(self.place[self.generators.keys["root", n]])

    def add(self, a: Ratio, b: Ratio) -> Ratio:
        """a + b."""
        if not len(a[0]) or not len(b[0]):
            return b if not len(a[0]) else a
        common = self._gcd(a[1], b[1])
        below, other = a[1] / common, b[1] / common
        above = self._times(a[0], other) + self._times(b[0], below)
        rest = self._gcd(above, common)
        return self._normal(self._reduced(above / rest), self._times(below, b[1] / rest))

    def mul(self, a: Ratio, b: Ratio) -> Ratio:
        """a * b."""
        one, two = self._gcd(a[0], b[1]), self._gcd(b[0], a[1])
        above = self._times(a[0] / one, b[0] / two)
        below = self._times(a[1] / two, b[1] / one)
        if not self.relations:
            return self._normal(above, below)
        return self.lowest(self._reduced(above), self._reduced(below))

    def lowest(self, above: Any, below: Any) -> Ratio:
        """above/below, cancelled."""
        common = self._gcd(above, below)
        return self._normal(above / common, below / common)

    def _normal(self, above: Any, below: Any) -> Ratio:
        """With leading coefficient 1 below."""
        if not len(above):
            return above, self.one
        c = below.leading_coefficient()
        return above / c, below / c

    def _gcd(self, a: Any, b: Any) -> Any:
        if a.is_constant() or b.is_constant():
            return self.one
        self.work.spend(10 * min(len(a), len(b)) + len(a) + len(b))
        return a.gcd(b)

    def _times(self, a: Any, b: Any) -> Any:
        self.work.spend(len(a) * len(b))
        return a * b

    def _reduced(self, poly: Any) -> Any:
        for n, relation in self.relations:
            if poly.degrees()[n] > 1:
                poly = poly % relation
        return poly


def unit_of(multiples: Iterable[Fraction]) -> Fraction:
    """What multiples of an angle are counted in: cos(2*q) is a polynomial in cos(q), and cos(1.8*q) none."""
    unit = common_unit(multiples)
    return Fraction(1) if unit.denominator == 1 else unit


def common_unit(multiples: Iterable[Fraction]) -> Fraction:
    """The largest number of which all are multiples."""
    result = Fraction(0)
    for c in multiples:
        common = gcd(result.numerator * c.denominator, c.numerator * result.denominator)
        result = Fraction(common, result.denominator * c.denominator)
    return result
