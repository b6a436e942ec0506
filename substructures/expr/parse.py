"""Expressions as written (:mod:`substructures.expr.syntax`) built in a graph."""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction

from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.laws import formulas as laws
from substructures.expr.steps import LEAVES, ExpressionError, Knots, Step
from substructures.expr.syntax import read
from substructures.expr.trigonometry import cos, sin, tan

_ARITHMETIC: dict[str, Callable[[Expr, Expr], Expr]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
}
_FUNCTIONS: dict[str, Callable[..., Expr]] = {
    "sin": sin,
    "cos": cos,
    "tan": tan,
    "sqrt": lambda x: x.graph.sqrt(x),
    **laws.FUNCTIONS,
}


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


#: terms of a sum, and whether they name what is to be told apart
_Terms = list[tuple[Expr, bool]]


def parse_terms(graph: Graph, text: str, lookup: Callable[[str], Expr | None], apart: str) -> list[Expr]:
    """The terms of an expression as it is written: what ``+`` and ``-`` join, whose sum it is. Raises as :func:`parse`.

    Products, quotients and powers of sums are multiplied out as far as it takes to tell what names the symbol ``apart``
    from what does not: ``2*(x + sin(t))`` has the terms ``2*x`` and ``2*sin(t)`` for the time t.

    >>> graph = Graph()
    >>> parse_terms(graph, "2*(x + t)*(1 + x) - (x - 2)", lambda name: graph.symbol(name), "t")[0]
    2*x*(1 + x)
    """
    stack: list[_Terms] = []
    for step in read(text):
        if step.op in ("add", "sub"):
            last = stack.pop()
            stack[-1] = stack[-1] + (last if step.op == "add" else [(-x, named) for x, named in last])
        elif step.op == "neg":
            stack[-1] = [(-x, named) for x, named in stack[-1]]
        elif step.op in LEAVES:
            stack.append([(_leaf(graph, step, lookup), step.op == "name" and step.value == apart)])
        else:
            count = step.operands
            operands = stack[len(stack) - count :]
            stack[len(stack) - count :] = [_told_apart(graph, step, operands)]
    return [x for x, _ in stack.pop()]


def _told_apart(graph: Graph, step: Step, operands: list[_Terms]) -> _Terms:
    """The terms of a product, quotient, power or function of sums: what does not name the symbol, and the rest."""

    def carried_out(some: list[_Terms]) -> Expr:
        """The step on the sums of some terms."""
        stack = [graph.sum(x for x, _ in terms) for terms in some]
        _carry_out(graph, step, lambda _: None, stack)
        return stack.pop()

    whole = carried_out(operands)
    if not any(named for terms in operands for _, named in terms):
        return [(whole, False)]
    without: list[_Terms] = [[(x, named) for x, named in terms if not named] for terms in operands]
    splits = step.op in ("mul", "pow") or (step.op == "div" and without[1] == operands[1])
    if not splits or not all(without) or (step.op == "pow" and step.exponent < 1):
        return [(whole, True)]
    pure = carried_out(without)
    return [(pure, False), (whole - pure, True)]


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
    args = stack[len(stack) - step.operands :]
    del stack[len(stack) - step.operands :]
    last = args[-1]
    if step.op == "call":
        return _FUNCTIONS[str(step.value)](*args)
    if isinstance(step.value, Knots):
        return laws.table(last, step.value)
    if step.op == "power":
        return laws.power(*args)
    if isinstance(step.value, int):
        if step.value < 0 and last.is_zero:
            raise ZeroDivisionError("division by zero")
        return last**step.value
    return -last if step.op == "neg" else _ARITHMETIC[step.op](*args)
