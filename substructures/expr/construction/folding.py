"""Sums, products and quotients in their simple form: what is done where no node has the fingerprint of the result.

Numbers fold, like terms are collected, signs move outwards and numbers to the front: the structures that
``Expr.__add__`` and its like build. ``fp`` is the fingerprint of the result, for which there is no node, or one that
may not stand for it (:mod:`substructures.expr.construction.equivalent_nodes`).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any, Protocol, TypeVar

from substructures.expr.construction.fingerprint import PRIME
from substructures.expr.construction.patterns import Node, coefficient, constant, has_number, square_of_root


class Term(Node, Protocol):
    """What is needed of an expression."""

    @property
    def negative(self) -> bool:
        """A negative number, or a node of the form -x."""

    def __add__(self, other: Any) -> Any: ...
    def __truediv__(self, other: Any) -> Any: ...


T = TypeVar("T", bound=Term)


class Nodes(Protocol[T]):
    """What is needed of a graph."""

    table: dict[int, T]

    @property
    def one(self) -> T:
        """The number 1."""

    def number(self, value: int | Fraction) -> T:
        """An exact number."""

    def serves(self, found: T, op: str, *args: T) -> bool:
        """Whether a node of the fingerprint of op(args) may stand for it."""

    def node(self, op: str, args: tuple[T, ...], fp: int) -> T:
        """The node of exactly this structure."""


def folded_sum(graph: Nodes[T], a: T, b: T, fp: int) -> T:
    """a + b."""
    found = graph.table.get(PRIME - fp)
    if found is not None and (not found.args or graph.serves(found, "add", a, b)):
        return -found
    if a.is_number or b.is_number:
        # x + 0 is x, also where another node serves best for its fingerprint
        if a.fp == 0 or b.fp == 0:
            return b if a.fp == 0 else a
        if a.is_number and b.is_number:
            return graph.number(a.value + b.value)
    collected = _collected(graph, a, b)
    if collected is not None:
        return collected
    if b.negative:
        if a.negative:
            return -graph.node("add", (-a, -b), PRIME - fp)
        return graph.node("sub", (a, -b), fp)
    if a.negative:
        return graph.node("sub", (b, -a), fp)
    return graph.node("add", (a, b), fp)


def _collected(graph: Nodes[T], a: T, b: T) -> T | None:
    """c x + d x = (c + d) x and (x + c) + (y + d) = (x + y) + (c + d) for exact numbers c, d."""
    if a is b:
        return graph.number(2) * a
    if not (has_number(a) and has_number(b)):
        return None
    (c, x), (d, y) = coefficient(a), coefficient(b)
    if x is y:
        return graph.number(c + d) * x
    (x, c), (y, d) = constant(a), constant(b)
    return (x + y) + graph.number(c + d) if c and d else None


def folded_difference(graph: Nodes[T], a: T, b: T, fp: int) -> T:
    """a - b."""
    if b.negative or a.negative or has_number(a) or has_number(b):
        return folded_sum(graph, a, -b, fp)
    found = graph.table.get(PRIME - fp)
    if found is not None and (not found.args or graph.serves(found, "sub", a, b)):
        return -found
    left = _without_common_term(a, b)
    return graph.node("sub", (a, b), fp) if left is None else left


def _without_common_term(a: T, b: T) -> T | None:
    """(x + y) - (x + z) = y - z."""
    if a.op != "add" or b.op != "add":
        return None
    (x, y), (u, z) = a.args, b.args
    if u is not x:
        x, y, u, z = (y, x, u, z) if u is y else (x, y, z, u) if z is x else (y, x, z, u)
    return y - z if u is x else None


def folded_product(graph: Nodes[T], a: T, b: T, fp: int) -> T:
    """a b."""
    found = graph.table.get(PRIME - fp)
    if found is not None and (not found.args or graph.serves(found, "mul", a, b)):
        return -found
    if a.is_number or b.is_number:
        known = _product_with_number(graph, a, b)
        if known is not None:
            return known
    if a.negative or b.negative:
        positive = _without_sign(a) * _without_sign(b)
        return positive if a.negative == b.negative else -positive
    if b.is_number:
        a, b = b, a
    folded = _number_outside(a, b) if a.op == "mul" or b.op == "mul" else None
    if folded is None and (a.op == "sqrt" or b.op == "sqrt"):
        folded = square_of_root(a, b)
    return graph.node("mul", (a, b), fp) if folded is None else folded


def _product_with_number(graph: Nodes[T], a: T, b: T) -> T | None:
    """1 x = x, and the product of two numbers."""
    if a is graph.one or b is graph.one:
        return b if a is graph.one else a
    return graph.number(a.value * b.value) if a.is_number and b.is_number else None


def _without_sign(x: T) -> T:
    found: T = -x if x.negative else x
    return found


def _number_outside(a: T, b: T) -> T | None:
    """a (2 x) = 2 (a x), the number of products in front; numbers of both as one."""
    if b.op == "mul" and b.args[0].is_number:
        return (a * b.args[0]) * b.args[1] if a.is_number else b.args[0] * (a * b.args[1])
    if a.op == "mul" and a.args[0].is_number:
        return a.args[0] * (a.args[1] * b)
    return None


def folded_quotient(graph: Nodes[T], a: T, b: T) -> T:
    """a / b. Raises ZeroDivisionError."""
    if b.fp == 0:
        raise ZeroDivisionError("division by zero")
    if b.is_number:
        return a * graph.number(Fraction(1) / b.value)
    fp = a.fp * pow(b.fp, -1, PRIME) % PRIME
    found = graph.table.get(fp)
    if found is not None and (not found.args or graph.serves(found, "div", a, b)):
        return found
    if a.negative or b.negative:
        positive = _without_sign(a) / _without_sign(b)
        return positive if a.negative == b.negative else -positive
    return graph.node("div", (a, b), fp)
