"""Expressions as written (:mod:`substructures.expr.syntax`) built in a graph."""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction

from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.syntax import LEAVES, ExpressionError, Step, read
from substructures.expr.trigonometry import cos, sin, tan

_ARITHMETIC: dict[str, Callable[[Expr, Expr], Expr]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
}
_FUNCTIONS: dict[str, Callable[[Expr], Expr]] = {"sin": sin, "cos": cos, "tan": tan, "sqrt": lambda x: x.graph.sqrt(x)}


def parse(graph: Graph, text: str, lookup: Callable[[str], Expr | None]) -> Expr:
    """The formula of an expression. ``lookup`` returns the expression of a name, or None for an unknown one.

    Raises ExpressionError with the column.

    >>> graph = Graph()
    >>> parse(graph, "2*(l + 1/2) - 2*l", {"l": graph.symbol("l")}.get)
    1
    """
    stack: list[Expr] = []
    for step in read(text):
        _carry_out(graph, step, lookup, stack)
    return stack.pop()


def parse_terms(graph: Graph, text: str, lookup: Callable[[str], Expr | None]) -> list[Expr]:
    """The terms of an expression as it is written: what ``+`` and ``-`` join, whose sum it is. Raises as :func:`parse`.

    >>> graph = Graph()
    >>> len(parse_terms(graph, "x*(1 + x) - (x - 2)", {"x": graph.symbol("x")}.get))
    3
    """
    stack: list[list[Expr]] = []
    for step in read(text):
        if step.op in ("add", "sub"):
            last = stack.pop()
            stack[-1] = stack[-1] + (last if step.op == "add" else [-term for term in last])
        elif step.op == "neg":
            stack[-1] = [-term for term in stack[-1]]
        else:
            count = 0 if step.op in LEAVES else 2 if step.op in _ARITHMETIC else 1
            operands = [graph.sum(terms) for terms in stack[len(stack) - count :]]
            del stack[len(stack) - count :]
            _carry_out(graph, step, lookup, operands)
            stack.append(operands)
    return stack.pop()


def _carry_out(graph: Graph, step: Step, lookup: Callable[[str], Expr | None], stack: list[Expr]) -> None:
    """A step on the stack."""
    if step.op in LEAVES:
        stack.append(_leaf(graph, step, lookup))
        return
    try:
        stack.append(_node(step, stack))
    except (TooLarge, ValueError, ZeroDivisionError) as error:
        raise ExpressionError(str(error), step.column) from None


def _leaf(graph: Graph, step: Step, lookup: Callable[[str], Expr | None]) -> Expr:
    if isinstance(step.value, Fraction):
        return graph.number(step.value)
    if step.op == "pi":
        return graph.pi
    name = str(step.value)
    found = lookup(name)
    if found is None:
        raise ExpressionError(f"unknown name '{name[:80]}'", step.column, name)
    return found


def _node(step: Step, stack: list[Expr]) -> Expr:
    """The node of a step; its operands are taken from the stack."""
    last = stack.pop()
    if step.op == "call":
        return _FUNCTIONS[str(step.value)](last)
    if isinstance(step.value, int):
        if step.value < 0 and last.is_zero:
            raise ZeroDivisionError("division by zero")
        return last**step.value
    return -last if step.op == "neg" else _ARITHMETIC[step.op](stack.pop(), last)
