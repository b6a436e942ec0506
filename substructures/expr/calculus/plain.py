"""Formulas whose fingerprints tell all: rational functions of symbols, and of sines and cosines of sums of symbols.

Fingerprints (:mod:`substructures.expr.construction.fingerprint`) are the values of these at a random point of a field,
by a homomorphism: the zero function is zero there, so that another fingerprint proves that a formula is another one.
Not so where half of an angle stands beside the whole, or a multiple of pi, or a root, beside what it is built from.

>>> from substructures.expr.graph import Graph
>>> from substructures.expr.trigonometry import cos, sin
>>> graph, known = Graph(), PlainFormulas()
>>> x, y = graph.symbol("x"), graph.symbol("y")
>>> known.has(x * sin(x + y)), known.has(sin(x / 2)), known.has(graph.sqrt(x))
(True, False, False)
>>> known.varies(x - y * cos(x), frozenset("x")), known.varies(x - y * cos(x), frozenset("z"))
(True, False)
"""

from __future__ import annotations

from collections.abc import Mapping

from substructures.expr.construction.fingerprint import (
    PRIME,
    Point,
    added,
    circle_point,
    keyed,
    multiplied,
    square_root,
)
from substructures.expr.graph import Expr
from substructures.expr.trigonometry import linear_form
from substructures.expr.walk import reachable

RATIONAL = frozenset(("add", "sub", "neg", "mul", "div"))


class PlainFormulas:
    """What was found of the nodes of one graph."""

    def __init__(self) -> None:
        self._plain: dict[Expr, bool] = {}
        self._moved: dict[frozenset[str], dict[Expr, int]] = {}

    def has(self, expr: Expr) -> bool:
        """Whether a formula is one of these."""
        known = self._plain
        for node in reachable([expr], known.__contains__):
            if node not in known:
                args = node.args
                known[node] = not args or (known[args[0]] and known[args[-1]] and _is_plain(node))
        return known[expr]

    def varies(self, expr: Expr, names: frozenset[str]) -> bool:
        """Whether one of these changes with some symbols: its value is another one where they alone have others."""
        values = self._moved.setdefault(names, {})
        for node in reachable([expr], values.__contains__):
            if node not in values:
                values[node] = _value(node, values, names)
        return values[expr] != expr.fp


def _is_plain(node: Expr) -> bool:
    """Whether an operation on plain formulas makes one of them."""
    if node.op in RATIONAL:
        return True
    if node.op in ("cos", "sin"):
        terms, turns = linear_form(node.args[0])
        return not turns and all(atom.op == "sym" and factor.denominator == 1 for atom, factor in terms.items())
    return node.op == "sqrt" and node.args[0].op == "int" and square_root(node.args[0].value) is not None


def _value(node: Expr, values: Mapping[Expr, int], names: frozenset[str]) -> int:
    """In the field, where symbols have other values."""
    op, args = node.op, node.args
    if not args or op == "sqrt":
        return keyed("moved", node.value) if op == "sym" and node.value in names else node.fp
    if op in ("cos", "sin"):
        return _on_circle(args[0], names)[op == "sin"]
    a, b = values[args[0]], values[args[-1]]
    if op == "mul":
        return a * b % PRIME
    if op in ("add", "sub"):
        return (a + b if op == "add" else a - b) % PRIME
    return -a % PRIME if op == "neg" else a * pow(b, -1, PRIME) % PRIME


def _on_circle(x: Expr, names: frozenset[str]) -> Point:
    """(cos, sin) of a sum of symbols."""
    point = (1, 0)
    for atom, factor in linear_form(x)[0].items():
        base = circle_point(("moved", atom.value) if atom.value in names else (atom.fp, 1))
        point = added(point, multiplied(base, factor.numerator, PRIME), PRIME)
    return point
