"""Derivatives of powers u^y, as laws make them, with values also where u is 0: y u^(y-1), not u^y y/u = 0/0.

>>> from substructures.expr.graph import Graph
>>> x = Graph().symbol("x")
>>> power_slope(x * x.graph.sqrt(x)).slope is x.graph.sqrt(x) * Fraction(3, 2)
True
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import NamedTuple

from substructures.expr.graph import Expr


class PowerSlope(NamedTuple):
    """The base u of a power, its derivative by u, and the factors of its exponent."""

    base: Expr
    slope: Expr
    exponent: tuple[Expr, ...]


def power_slope(node: Expr) -> PowerSlope | None:
    """Of exp(y log u), and of u^k sqrt(u), which is u^(k + 1/2); None of anything else."""
    if node.op == "exp":
        return _of_exponential(node.args[0])
    if node.op != "mul":
        return None
    roots = [i for i in (0, 1) if node.args[i].op == "sqrt"]
    return None if len(roots) != 1 else _of_root(node.args[roots[0]], node.args[1 - roots[0]])


def _of_exponential(product: Expr) -> PowerSlope | None:
    factors = list(_factors(product, None))
    logs = [x for x in factors if x.op == "log"]
    if len(logs) != 1:
        return None
    others = tuple(x for x in factors if x is not logs[0])
    y = product.graph.one
    for factor in others:
        y = y * factor
    return PowerSlope(logs[0].args[0], y * product.graph.function("exp", (y - 1) * logs[0]), others)


def _of_root(root: Expr, others: Expr) -> PowerSlope | None:
    """sqrt(c u) u^k with a number c."""
    u = root.args[0]
    if u.op == "mul" and u.args[0].is_number:
        u = u.args[1]
    factors = list(_factors(others, u))
    if any(x is not u for x in factors):
        return None
    return PowerSlope(u, (len(factors) + Fraction(1, 2)) * (root * u ** (len(factors) - 1)), ())


def _factors(product: Expr, last: Expr | None) -> Iterator[Expr]:
    """The factors of a product, of which one is not looked into."""
    waiting = [product]
    while waiting:
        x = waiting.pop()
        if x.op == "mul" and x is not last:
            waiting += x.args
        else:
            yield x
