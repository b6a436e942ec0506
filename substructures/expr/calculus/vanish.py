"""Whether a formula is the zero function, decided at random points in ball arithmetic: yes, no, or unknown.

Fingerprints tell it of formulas that are :mod:`plain <.plain>`. They do not know that sqrt(11)^2 = 11 or
atan2(0, 1) = 0; the value at a point does. A ball without zero proves that the formula is not zero. Balls with zero are
evidence that it is, where they are small against the terms that make them up, at points of both signs and of all
magnitudes, and stay so with many more digits; less than that is unknown, unless the canonical form
(:mod:`substructures.expr.rings.expand`) proves it.

>>> graph = Graph()
>>> x = graph.symbol("x")
>>> vanish = Vanishing(graph)
>>> root, square = graph.function("sqrt", x + 1), graph.function("sqrt", (x + 1) ** 2)
>>> vanish(root - x), vanish(square - x - 1), vanish(square - graph.function("abs", x + 1))
(False, False, True)
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from random import Random
from typing import Any

import flint

from substructures.errors import TooLarge
from substructures.expr.calculus.plain import PlainFormulas
from substructures.expr.graph import Expr, Graph
from substructures.expr.rationals import to_fmpq
from substructures.expr.rings.expand import is_zero
from substructures.expr.walk import reachable

#: points, and at how many of them a formula must have a value to be called zero
POINTS, ENOUGH = 12, 6
#: powers of ten that the magnitudes of symbols span, both ways
DECADES = 6
#: bits of the first look; the second one has a multiple of the bits of all numbers in the formula more
PRECISION, MORE, MOST = 300, 2000, 100_000
#: a radius is small against the terms below 2^-(precision - GUARD)
GUARD = 120
#: terms of the canonical form that is tried where points leave it open
TERMS = 200

_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
    "abs": abs,
    "sign": lambda x: x.sgn(),
    "atan2": lambda y, x: flint.arb.atan2(y, x),
}


class Vanishing:
    """The test for the formulas of one graph; values of nodes at its points are kept."""

    def __init__(self, graph: Graph) -> None:
        self.graph, self.random = graph, Random()  # noqa: S311 -- seeded by the system; no point is told
        self.plain = PlainFormulas()
        self.symbols: list[dict[Expr, flint.fmpq]] = [{} for _ in range(POINTS)]
        self.values: dict[tuple[int, int], dict[Expr, Any]] = {}
        self.sizes: dict[tuple[int, int], dict[Expr, Any]] = {}
        self.moved: dict[frozenset[str], dict[Expr, Any]] = {}

    def __call__(self, expr: Expr) -> bool | None:
        """True for the zero function, False for another one, None where neither is known."""
        if expr.is_zero or self.plain.has(expr):
            return expr.is_zero
        seen: list[dict[Expr, flint.fmpq]] = []
        looks = [PRECISION]
        for point in range(POINTS):
            verdict = self._at(expr, point, looks)
            if verdict is False:
                return False
            if verdict:
                seen.append(self.symbols[point])
        names = [node for node in reachable([expr]) if node.op == "sym"]
        both = all(len({point[name] > 0 for point in seen}) == 2 for name in names)
        if both and len(seen) >= ENOUGH:
            return True
        return True if _is_proven(expr) else None

    def varies(self, expr: Expr, names: frozenset[str]) -> bool:
        """Whether some symbols are proven to change the value: it differs at two points that differ in them alone."""
        if self.plain.has(expr):
            return self.plain.varies(expr, names)
        with flint.ctx.workprec(PRECISION):
            first = self._value(expr, self.values.setdefault((0, PRECISION), {}), self.symbols[0])
            there = {x: self.symbols[1 if str(x.value) in names else 0][x] for x in self.symbols[0]}
            second = self._value(expr, self.moved.setdefault(names, {}), there)
            return not (first - second).contains(0)

    def _at(self, expr: Expr, point: int, looks: list[int]) -> bool | None:
        """Whether the value at a point is zero, as far as digits tell; ``looks``: their precisions."""
        for second in (False, True):
            if second and len(looks) == 1:
                bits = sum(_bits(node) for node in reachable([expr]) if node.is_number)
                looks.append(min(MORE + 8 * bits, MOST))
            precision = looks[second]
            with flint.ctx.workprec(precision):
                known = self.values.setdefault((point, precision), {})
                value = self._value(expr, known, self.symbols[point])
                if not value.is_finite():
                    return None
                if not value.contains(0):
                    return False
                size = _size(expr, self.sizes.setdefault((point, precision), {}), known)
                if not size.is_finite():
                    return None
                small = bool(value.rad() < size * flint.arb(2) ** (GUARD - precision))
        return True if small else None

    def _value(self, expr: Expr, known: dict[Expr, Any], symbols: dict[Expr, flint.fmpq]) -> Any:
        """The value; what is ``known`` below it is not looked at."""
        for node in reachable([expr], known.__contains__):
            if node not in known:
                known[node] = self._operation(node, known, symbols)
        return known[expr]

    def _operation(self, node: Expr, known: dict[Expr, Any], symbols: dict[Expr, flint.fmpq]) -> Any:
        if node.is_number or node.op == "sym":
            if node.op == "sym" and node not in symbols:
                for point, x in zip(self.symbols, self._drawn(), strict=True):
                    point[node] = x
            x = to_fmpq(node.value) if node.is_number else symbols[node]
            return flint.arb(x)
        args = [known[a] for a in node.args]
        function = _OPERATIONS.get(node.op)
        return function(*args) if function else getattr(args[0], node.op)()

    def _drawn(self) -> list[flint.fmpq]:
        """A random number for every point: of every two decades between 10^-6 and 10^6 one of either sign.

        Left to chance, one in thirty times no point would lie at x < -1, say, where sqrt((x + 1)^2) is not x + 1.
        """
        half = POINTS // 2
        signs = self.random.choices((-1, 1), k=half)
        orders = [(k, sign * signs[k]) for sign in (1, -1) for k in self.random.sample(range(half), half)]
        return [sign * self._magnitude(2 * k - DECADES + self.random.randrange(2)) for k, sign in orders]

    def _magnitude(self, power: int) -> flint.fmpq:
        return flint.fmpq(self.random.randrange(10**9, 10**10), 10**9) * flint.fmpq(10) ** power


def _size(expr: Expr, sizes: dict[Expr, Any], known: dict[Expr, Any]) -> Any:
    """The sum of the absolute values of the terms of a formula; ``known``: the values of its nodes."""
    for node in reachable([expr], sizes.__contains__):
        if node in sizes:
            continue
        if node.op in ("add", "sub"):
            sizes[node] = sizes[node.args[0]] + sizes[node.args[1]]
        elif node.op == "mul":
            sizes[node] = sizes[node.args[0]] * sizes[node.args[1]]
        else:
            sizes[node] = sizes[node.args[0]] if node.op == "neg" else abs(known[node])
    return sizes[expr]


def _bits(number: Expr) -> int:
    return int(number.value.numerator.bit_length() + number.value.denominator.bit_length())


def _is_proven(expr: Expr) -> bool:
    try:
        return is_zero(expr, TERMS)
    except (TooLarge, ZeroDivisionError):
        return False
