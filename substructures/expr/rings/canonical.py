"""Evaluation of expressions in the ring of the canonical form, and reading of its elements."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from operator import itemgetter
from typing import Any

from substructures.errors import TooLarge
from substructures.expr.construction.exact import MAX_BITS
from substructures.expr.graph import Expr
from substructures.expr.rationals import fraction
from substructures.expr.rings.generators import Angle, Basis, Generators, Product, Sum, is_function, turned
from substructures.expr.rings.laurent import Laurent, Quotient, Ring

Terms = tuple[tuple[Basis, Fraction], ...]


class RingEvaluator:
    """Values of a list of nodes (operands first), in a ring made for them. ``generators`` must know their functions.

    A node that is too large by itself, whatever was formed before it, is added to ``large``.
    """

    def __init__(self, generators: Generators, nodes: list[Expr], limit: int, large: set[Expr] | None = None) -> None:
        self.generators, self.limit = generators, limit
        self.graph = nodes[0].graph
        forms = [generators.forms[n] for n in nodes if is_function(n)]
        self.units = generators.units(f for f in forms if isinstance(f, Angle))
        self.angles = sorted(self.units, key=lambda i: generators.order[i])
        plain = self._plain(nodes)
        self.place = {i: n for n, i in enumerate(plain)}
        self.plain = plain
        self.ring = Ring(len(plain) + 1, len(self.angles), limit)
        self._relate()
        self._multiples: dict[tuple[int, int], Fraction] = {}
        self.values: dict[Expr, Quotient] = {}
        for node in nodes:
            try:
                self.values[node] = self._value(node)
            except TooLarge:
                if large is not None and not self.ring.is_spent:
                    large.add(node)
                raise

    def _plain(self, nodes: list[Expr]) -> list[int]:
        """Numbers of all generators but the angles, roots first (a root of a sum before what is in it)."""
        g = self.generators
        used = g.plain(nodes)
        sums = sorted((i for i in used if isinstance(g.squares.get(i), Sum)), reverse=True)
        numbers = sorted(i for i in used if isinstance(g.squares.get(i), int))
        return [*sums, *numbers, *sorted(used - set(sums) - set(numbers), key=lambda i: g.order[i])]

    def _relate(self) -> None:
        ring, squares = self.ring, self.generators.squares
        ring.unit = len(self.plain)
        ring.relate(ring.unit, ring.context.constant(-1))
        ring.roots = tuple(n for i, n in self.place.items() if i in squares)
        ring.numeric_roots = frozenset(n for i, n in self.place.items() if isinstance(squares.get(i), int))
        for i, n in self.place.items():
            square = squares.get(i)
            if isinstance(square, int):
                ring.relate(n, ring.context.constant(square))
            elif square is not None:
                ring.relate(n, sum((self._monomial(b, c) for b, c in square.terms), ring.context.constant(0)))

    def _monomial(self, basis: Basis, value: Fraction) -> Any:
        exponents = [0] * (self.ring.size + self.ring.angles)
        for i, power in basis.monomial:
            exponents[self.place[i]] = power
        return self.ring.monomial(exponents, value)

    def _value(self, node: Expr) -> Quotient:
        ring, args = self.ring, node.args
        op = node.op
        if op == "sym":
            return ring.generator(self.place[self.generators.symbol(node)])
        if op in ("int", "rat"):
            return ring.constant(Fraction(node.value))
        if is_function(node):
            return self._function(node)
        a = self.values[args[0]]
        if op == "neg":
            return ring.negative(a)
        b = self.values[args[1]]
        if op == "sub":
            return ring.add(a, ring.negative(b))
        return {"add": ring.add, "mul": ring.mul, "div": ring.div}[op](a, b)

    def _function(self, node: Expr) -> Quotient:
        form = self.generators.forms[node]
        if isinstance(form, Product):
            result = self.ring.constant(form.factor)
            for i in form.ids:
                result = self.ring.mul(result, self.ring.generator(self.place[i]))
            return result
        multiples = [int(form.atoms.get(i, 0) / self.units[i]) for i in self.angles]
        cosine, sine = self.ring.cosine_sine(turned(form.turns, self.ring.context.constant, self._root), multiples)
        if node.op == "tan":
            return self.ring.div(sine, cosine)
        return cosine if node.op == "cos" else sine

    def _root(self, n: int) -> Any:
        return self.ring.context.gen(self.place[self.generators.keys["root", n]])

    def read(self, expr: Expr) -> Sum:
        """The canonical form of one of the nodes."""
        value = self.values[expr]
        denominator = self._terms(value.d)
        first, c = denominator[0]
        is_monomial = len(denominator) == 1 and not first.trig
        terms = self._terms(value.n, first.monomial if is_monomial else ())
        if len(terms) + len(denominator) > self.limit + 1:
            raise TooLarge("an expanded formula (in terms)", len(terms) + len(denominator) - 1, self.limit)
        if is_monomial:
            return Sum(terms if c == 1 else tuple((b, x / c) for b, x in terms))
        # integers without common factor, first one positive
        scale = Fraction(lcm(*(x.denominator for _, x in denominator)), gcd(*(x.numerator for _, x in denominator)))
        scale = -scale if c < 0 else scale
        return Sum(tuple((b, x * scale) for b, x in terms), tuple((b, x * scale) for b, x in denominator))

    @cached_property
    def _ranks(self) -> dict[int, int]:
        """The places of all generators in the order of display; equal ones have the same."""
        keys = {i: self.generators.order[i] for i in (*self.place, *self.angles)}
        numbers = {key: k for k, key in enumerate(sorted(set(keys.values())))}
        return {i: numbers[key] for i, key in keys.items()}

    @cached_property
    def _in_order(self) -> list[tuple[int, int]]:
        """All generators but the angles, with their places in exponents."""
        return sorted(self.place.items(), key=lambda item: self._ranks[item[0]])

    def _multiple(self, i: int, n: int) -> Fraction:
        """n times the unit of an angle."""
        found = self._multiples.get((i, n))
        if found is None:
            found = self._multiples[i, n] = n * self.units[i]
        return found

    def _terms(self, a: Laurent, under: tuple[tuple[int, int], ...] = ()) -> Terms:
        """Over the powers ``under``, for display: by degree, terms without angle first, then by names.

        c z^k + conj(c) z^-k = 2 Re(c) cos(k . angles) - 2 Im(c) sin(k . angles)
        """
        size, less, found = self.ring.size, dict(under), []
        for raw, c in a.poly.to_dict().items():
            exponents = [int(n) for n in raw]
            k = [n - m for n, m in zip(exponents[size:], a.shift, strict=True)]
            if next((n for n in k if n), 0) < 0:
                continue
            bits = max(c.p.bit_length(), c.q.bit_length())
            if bits > MAX_BITS:
                raise TooLarge("a coefficient of the expanded form (in bits)", bits, MAX_BITS)
            powers = [(i, e) for i, n in self._in_order if (e := exponents[n] - less.get(i, 0))]
            turns = [(i, n) for i, n in zip(self.angles, k, strict=True) if n]
            found.append((*self._shown(powers, turns, exponents[self.ring.unit] > 0), c))
        found.sort(key=itemgetter(0))
        double = {"": 1, "cos": 2, "sin": -2}
        return tuple((basis, fraction(c * double[basis.trig])) for _, basis, c in found)

    def _shown(
        self, powers: list[tuple[int, int]], turns: list[tuple[int, int]], imaginary: bool
    ) -> tuple[tuple[Any, ...], Basis]:
        """A basis function and its place among others."""
        ranks, order = self._ranks, self.generators.order
        trig = ("sin" if imaginary else "cos") if turns else ""
        degree = sum(e for i, e in powers if order[i][0] > 0)
        names, angle = [(ranks[i], -e) for i, e in powers], [(ranks[i], n) for i, n in turns]
        basis = Basis(tuple(powers), trig, tuple((i, self._multiple(i, n)) for i, n in turns))
        return (degree, bool(trig), names, angle, trig), basis
