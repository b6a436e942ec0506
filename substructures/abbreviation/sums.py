"""The difference of two programs, element by element, as trigonometric sums with exact coefficients.

Both programs are written into one graph and their difference in its canonical form
(:mod:`substructures.expr.rings.expand`), so that all that they have in common is gone before anything is estimated. A
variable x that is in no angle is written as middle + half * xi with xi from -1 to 1. What is left of an element is

    sum over m of  (product m of variables)  *  Re sum over k of C_mk exp(i k . q)

with q the angles that vary. The weights below are C_mk times the largest absolute value of product m.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from substructures.abbreviation.balls import PRECISION, above, between, enclosures, exact, magnitude
from substructures.abbreviation.ranges import Box, Interval, is_constant
from substructures.array import Array, ComplexArray
from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Program
from substructures.expr.replay import replay
from substructures.expr.rings.expand import Expanded, Expander, Term
from substructures.expr.rings.generators import is_function
from substructures.expr.walk import reachable

#: terms of the canonical form of one element
TERMS = 20_000
_NONE = Fraction(0)
#: an element by its index
Index = tuple[int, ...]
#: a product of variables: their powers
_Product = tuple[tuple[Expr, int], ...]


@dataclass(frozen=True)
class AngleSums:
    """An element: ``products`` in words, each with the terms from its entry of ``starts`` to the next one.

    ``multiples`` (T, D): k, exact as fractions; ``weights`` (T,): C times the largest value of the product, complex;
    ``rest``: what all terms together cannot exceed that have no place here.
    """

    products: tuple[str, ...]
    starts: tuple[int, ...]
    multiples: tuple[tuple[Fraction, ...], ...]
    weights: ComplexArray
    rest: float = 0.0

    @property
    def sizes(self) -> Array:
        """By product: the sum of the absolute weights."""
        return np.add.reduceat(np.abs(self.weights), self.starts) if self.starts else np.zeros(0)

    def product(self, m: int) -> AngleSums:
        """One product alone, without the rest."""
        some = slice(self.starts[m], [*self.starts, len(self.multiples)][m + 1])
        return AngleSums(self.products[m : m + 1], (0,), self.multiples[some], self.weights[some])


#: nothing
ZERO = AngleSums((), (), (), np.zeros(0, dtype=np.complex128))
#: nothing is known
UNKNOWN = AngleSums((), (), (), np.zeros(0, dtype=np.complex128), math.inf)


def _constants(form: Expanded) -> dict[Expr, Any]:
    """The values of its generators and angles that depend on no symbol."""
    found = [x for x in {atom for term in form.terms for atom in term.atoms()} if is_constant([x])]
    return dict(zip(found, enclosures(found, {}), strict=True))


def angles_of(program: Program) -> frozenset[str]:
    """The symbols below functions of a program, which stay as they are."""
    found = replay(program, Graph(), {})
    nodes = reachable(x for f in found.values() for x in f.entries.values())
    functions = [x for x in nodes if x.args and is_function(x)]
    below = reachable(arg for x in functions for arg in x.args)
    return frozenset(str(x.value) for x in below if x.op == "sym")


class Differences:
    """Differences of programs from a full one, over a box. ``angles``: the variables q, in the order of k."""

    def __init__(self, full: Program, box: Box) -> None:
        self.full, self.box = full, box
        kept = angles_of(full)
        self.angles = tuple(sorted(name for name in kept if name in box))
        self._moved = {name: x for name, x in box.items() if name not in kept}
        one = Interval(Fraction(-1), Fraction(1))
        self._balls = {name: between(x.low, x.high) for name, x in {**box, **dict.fromkeys(self._moved, one)}.items()}
        self._known: dict[str, dict[Index, AngleSums]] = {}

    def of(self, other: Program) -> dict[Index, AngleSums]:
        """full - other by element; elements in which they are equal are left out."""
        if other.digest not in self._known:
            self._known[other.digest] = self._of(other)
        return self._known[other.digest]

    def _of(self, other: Program) -> dict[Index, AngleSums]:
        graph = Graph()
        bindings = {n: graph.number(x.middle) + graph.number(x.half) * graph.symbol(n) for n, x in self._moved.items()}
        (ours,), (others,) = (replay(p, graph, bindings).values() for p in (self.full, other))
        names = {**ours.entries, **others.entries}
        found = {i: ours.entries.get(i, graph.zero) - others.entries.get(i, graph.zero) for i in names}
        return self._expanded({i: x for i, x in found.items() if not x.is_zero})

    def _expanded(self, elements: Mapping[Index, Expr]) -> dict[Index, AngleSums]:
        if not elements:
            return {}
        try:
            expander = Expander(list(elements.values()), TERMS)
        except (TooLarge, ZeroDivisionError):
            return dict.fromkeys(elements, UNKNOWN)
        found = {i: self._sums(expander, x) for i, x in elements.items()}
        return {i: x for i, x in found.items() if x is not ZERO}

    def _sums(self, expander: Expander, element: Expr) -> AngleSums:
        try:
            form = expander.expand(element)
        except (TooLarge, ZeroDivisionError):
            return UNKNOWN
        return ZERO if form.is_zero else self._read(form)

    def _read(self, form: Expanded) -> AngleSums:
        scale = self._inverse(form.denominator)
        if not math.isfinite(scale):
            return UNKNOWN
        by_product: dict[_Product, dict[tuple[Fraction, ...], Any]] = {}
        rest, constants = 0.0, _constants(form)
        with flint.ctx.workprec(PRECISION):
            for term in form.terms:
                product, constant = self._split(term.powers, constants)
                phase, multiples, is_loose = self._angle(term, constants)
                value = constant * exact(term.coefficient) * phase
                if is_loose:
                    rest += magnitude(abs(value)) * self._largest(product)
                    continue
                terms = by_product.setdefault(product, {})
                terms[multiples] = terms[multiples] + value if multiples in terms else value
        return self._collected(by_product, scale, rest)

    def _collected(
        self, by_product: Mapping[_Product, Mapping[tuple[Fraction, ...], Any]], scale: float, rest: float
    ) -> AngleSums:
        products, starts = list[str](), list[int]()
        multiples, weights = list[tuple[Fraction, ...]](), list[complex]()
        for product, terms in by_product.items():
            largest = self._largest(product) * scale
            if not math.isfinite(largest):
                return UNKNOWN
            products.append(self._words(product))
            starts.append(len(weights))
            multiples += terms
            weights += [complex(float(x.real.mid()), float(x.imag.mid())) * largest for x in terms.values()]
            rest += sum(above(x.real.rad() + x.imag.rad()) for x in terms.values()) * self._largest(product)
        # sums and products of doubles are rounded up together
        found = np.array(weights, dtype=np.complex128)
        return AngleSums(tuple(products), tuple(starts), tuple(multiples), found, rest * scale * (1 + 2**-40))

    def _split(self, powers: Iterable[tuple[Expr, int]], constants: Mapping[Expr, Any]) -> tuple[_Product, Any]:
        """What varies of a product, and the value of what does not."""
        varying = list[tuple[Expr, int]]()
        constant = flint.acb(1)
        for x, n in powers:
            if x in constants:
                constant = constant * flint.acb(constants[x]) ** n
            else:
                varying.append((x, n))
        return tuple(varying), constant

    def _angle(self, term: Term, constants: Mapping[Expr, Any]) -> tuple[Any, tuple[Fraction, ...], bool]:
        """cos or sin of a sum of angles as Re(phase exp(i k . q)), and whether it has another angle than these."""
        k = dict.fromkeys(self.angles, _NONE)
        is_loose = False
        phase = flint.acb(0, -1) if term.trig == "sin" else flint.acb(1)
        for x, factor in term.angle:
            if x.op == "sym" and (name := str(x.value)) in k:
                k[name] = k[name] + factor if k[name] else factor
            elif x in constants:
                phase = phase * flint.acb(0, constants[x] * exact(factor)).exp()
            else:
                is_loose = True
        first = next((x for x in k.values() if x), Fraction(1))
        if first < 0:  # Re(C exp(i k . q)) = Re(C* exp(-i k . q))
            return phase.conjugate(), tuple(-x for x in k.values()), is_loose
        return phase, tuple(k.values()), is_loose

    def _largest(self, product: _Product) -> float:
        """What the absolute value of a product does not exceed."""
        result = 1.0
        for x, n in product:
            result = math.nextafter(result * magnitude(enclosures([x], self._balls)[0], n), math.inf)
        return result

    def _inverse(self, denominator: Sequence[Term]) -> float:
        """What 1 over a denominator does not exceed."""
        if not denominator:
            return 1.0
        graph = Graph()
        form = Expanded(tuple(denominator)).to_expr(graph)
        return magnitude(enclosures([form], self._balls)[0], -1)

    def _words(self, product: _Product) -> str:
        """A product as a person writes it, of the variables as they were."""
        return "*".join(self._factor(x) + (f"^{n}" if n != 1 else "") for x, n in product) or "1"

    def _factor(self, x: Expr) -> str:
        if x.op != "sym":
            return f"{x.op}(...)"
        name = str(x.value)
        moved = self._moved.get(name)
        return name if moved is None or not moved.middle else f"({name} - {float(moved.middle):.6g})"
