"""Formulas with corners: |x|, written abs(x) or sqrt(x^2), and sign x are one function on each side of x = 0.

On a side |x| = s x with s = 1 or -1, and a formula without other roots is smooth there. It is the zero function when it
is zero on all sides; as a polynomial in the s, each to the first power at most since s^2 = 1, it is when it is wherever
at most d of them are -1, d its degree.

>>> graph = Graph()
>>> x = graph.symbol("x")
>>> root = graph.sqrt(x * x)
>>> vanishes = VanishingOnAllSides(graph)
>>> vanishes(root - x), vanishes(root * (root - x) + x * (root - x))
(False, True)
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations
from math import isqrt

from substructures.expr.calculus.vanish import Vanishing
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.walk import build, reachable, transfer

#: sides that are looked at, at most
MAX_SIDES = 512
#: what has no value of a negative number; powers are made of these
ROOTS = ("sqrt", "log")


def corners(exprs: Iterable[Expr]) -> list[Expr]:
    """The nodes |x| and sign x, in order."""
    return [node for node in reachable(exprs) if _inner(node) is not None]


def inner(node: Expr) -> Expr:
    """x of a node |x|, also with a number before it, or sign x."""
    x = _inner(node)
    if x is None:
        raise ValueError(f"no corner: {node!r}")
    return x


def _inner(node: Expr) -> Expr | None:
    if node.op in ("abs", "sign"):
        return node.args[0]
    square = node.args[0] if node.op == "sqrt" else None
    if square is not None and _factor(node):
        square = square.args[1]
    return square.args[0] if square is not None and square.op == "mul" and square.args[0] is square.args[1] else None


def _factor(node: Expr) -> Fraction | None:
    """r of sqrt(r^2 x^2), which the graph makes of sqrt((r x)^2); None where no such number stands there."""
    square = node.args[0]
    if node.op != "sqrt" or square.op != "mul" or not square.args[0].is_number:
        return None
    c = Fraction(square.args[0].value)
    r = Fraction(isqrt(max(0, c.numerator)), isqrt(c.denominator))
    return r if r * r == c else None


def on_side(exprs: Sequence[Expr], sides: Mapping[Expr, int | Expr], goes_on: bool = False) -> list[Expr]:
    """The formulas where x > 0 (1) or x < 0 (-1) for each corner: |x| is x or -x. Raises ZeroDivisionError.

    A side may be a symbol that is 1 or -1. ``goes_on``: roots and logarithms have values beyond their corners, too,
    those of the formulas as they are where |x|^(3/2) would be (-x)^(3/2).
    """
    new: dict[Expr, Expr] = {}
    for node in reachable(exprs):
        side = sides.get(node)
        if side is not None:
            new[node] = node.graph.lift(side) if node.op == "sign" else new[inner(node)] * side * (_factor(node) or 1)
        elif goes_on and node.op in ROOTS and new[node.args[0]] is not node.args[0]:
            new[node] = build(node.graph, node.op, [_where_positive(new[node.args[0]], node.args[0])])
        else:
            new[node] = build(node.graph, node.op, [new[a] for a in node.args]) if node.args else node
    return [new[x] for x in exprs]


def _where_positive(x: Expr, other: Expr) -> Expr:
    """x where it is positive, else another."""
    return other + (x - other) * (x.graph.function("sign", x) + 1) / 2


def rates(expr: Expr, name: str) -> tuple[Expr, Expr]:
    """First and second derivative by a symbol, with |x| = x sign x, so that no quotient is 0/0 where x = 0; of what is
    an absolute value with no derivative there, half of those of both sides.
    """
    first, second = between_corners(
        [expr], lambda smooth: [rate := derivative(smooth[0], name), derivative(rate, name)]
    )
    return first, second


def between_corners(exprs: Sequence[Expr], work: Callable[[list[Expr]], list[Expr]]) -> list[Expr]:
    """What ``work`` makes of formulas with |x| = x sign x and constant signs: so derivatives have no quotient that is
    0/0 where x = 0.
    """
    found = corners(exprs)
    if not found:
        return work(list(exprs))
    graph = found[0].graph
    sides = [graph.symbol(f"side {k}") for k in range(len(found))]
    smooth = on_side(exprs, dict(zip(found, sides, strict=True)))
    signs = {str(s.value): graph.function("sign", inner(node)) for s, node in zip(sides, found, strict=True)}
    return transfer(work(smooth), graph, signs)


def has_smooth_rate(expr: Expr, name: str) -> bool:
    """Whether it is shown that neither a formula nor its derivative by a symbol jumps at corners |a t + b|, or their
    signs: on both sides of each the two have one value at t = -b/a, whatever the sides of other corners.
    """
    graph, vanishes = expr.graph, VanishingOnAllSides(expr.graph)
    for x in dict.fromkeys(map(inner, corners([expr]))):
        a = derivative(x, name)
        if corners([x]) or _names([a], name):
            return False
        if a.is_zero:
            continue
        own = [node for node in corners([expr]) if inner(node) is x]
        one, other = (on_side([expr], dict.fromkeys(own, side))[0] for side in (1, -1))
        rate, _ = between_corners([one - other], lambda some: [derivative(some[0], name), some[0]])
        try:
            zero = -transfer([x], graph, {name: graph.zero})[0] / a
            left = transfer([one - other, rate], graph, {name: zero})
        except ZeroDivisionError:
            return False
        if not all(map(vanishes, left)):
            return False
    return True


def _names(exprs: Sequence[Expr], name: str) -> bool:
    return any(node.op == "sym" and node.value == name for node in reachable(exprs))


class VanishingOnAllSides:
    """The test of :class:`~substructures.expr.calculus.vanish.Vanishing` for formulas of one graph with corners."""

    def __init__(self, graph: Graph) -> None:
        self.smooth = Vanishing(graph)
        self._plain = set[Expr]()  # nodes without corners below

    def __call__(self, expr: Expr) -> bool:
        """True for the zero function; False where it is not, or cannot be told."""
        if expr.is_zero or self.smooth.plain.has(expr):
            return expr.is_zero
        nodes = reachable([expr], self._plain.__contains__)
        found = [node for node in nodes if _inner(node) is not None]
        if not found:
            self._plain.update(nodes)
        return all(self._on(expr, sides) for sides in _needed(expr, found)) if found else self.smooth(expr) is True

    def _on(self, expr: Expr, sides: Mapping[Expr, int] | None) -> bool:
        try:
            return sides is not None and self.smooth(on_side([expr], sides)[0]) is True
        except ZeroDivisionError:
            return False


def _needed(expr: Expr, found: Sequence[Expr]) -> Iterator[dict[Expr, int] | None]:
    """The sides that decide; None where there are too many."""
    degree = min(_degree(expr, set(found)), len(found))
    count = 0
    for flips in range(degree + 1):
        for some in combinations(found, flips):
            count += 1
            yield None if count > MAX_SIDES else {node: -1 if node in some else 1 for node in found}
            if count > MAX_SIDES:
                return


def _degree(expr: Expr, found: set[Expr]) -> int:
    """A bound of the degree in the signs; of functions and divisors any."""
    degree: dict[Expr, int] = {}
    for node in reachable([expr]):
        below = [degree[a] for a in node.args]
        if node in found:
            degree[node] = 1 if not below[0] else len(found)
        elif node.op == "mul":
            degree[node] = sum(below)
        elif node.op == "div":
            # 1/|x| = s/x
            simple = node.args[1] in found or not below[1]
            degree[node] = sum(below) if simple else len(found)
        elif node.op in ("add", "sub", "neg"):
            degree[node] = max(below)
        else:
            degree[node] = len(found) if any(below) else 0
    return degree[expr]
