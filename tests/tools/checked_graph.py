"""A test mode in which every constructor of formulas is checked: what it returns has the value of what was asked for.

``pytest --checked`` replaces the operators of :class:`substructures.expr.graph.Expr`, roots, functions, sines and
cosines by ones that compare the result with the operation on the values of its operands, in ball arithmetic at fixed
points, and see that it has a value wherever the operation has one.
"""

from __future__ import annotations

import operator
import random
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import flint

from substructures.expr import trigonometry
from substructures.expr.graph import Expr, Graph

POINTS, PRECISION = 3, 250
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
_OPERATORS = {"__add__": "add", "__radd__": "add", "__sub__": "sub", "__mul__": "mul", "__rmul__": "mul"}


def applied(op: str, args: tuple[Any, ...]) -> Any:
    """An operation on balls."""
    function = _OPERATIONS.get(op)
    return function(*args) if function else getattr(args[0], op)()


def values(node: Expr) -> list[Any]:
    """The values of a node at the points, kept with its graph."""
    known = node.graph.__dict__.setdefault("_checked", {})
    stack = [node]
    while stack:
        top = stack[-1]
        missing = [a for a in top.args if a not in known]
        stack += missing
        if not missing:
            known[stack.pop()] = [_value(top, [known[a][k] for a in top.args], k) for k in range(POINTS)]
    return list(known[node])


def _value(node: Expr, args: list[Any], point: int) -> Any:
    if node.args:
        return applied(node.op, tuple(args))
    if node.is_number:
        x = Fraction(node.value)
    else:
        rng = random.Random(f"{node.value} {point}")  # noqa: S311 -- test data
        x = Fraction(rng.randrange(1, 10**9), 10**9) * (1, -3, 1000)[point] * rng.choice((1, 1, -1))
    return flint.arb(flint.fmpq(x.numerator, x.denominator))


def verify(op: str, args: tuple[Any, ...], result: Expr) -> None:
    """Raises AssertionError for a result that is not op(args)."""
    with flint.ctx.workprec(PRECISION):
        operands = [values(a if isinstance(a, Expr) else result.graph.number(a)) for a in args]
        for k, found in enumerate(values(result)):
            expected = applied(op, tuple(v[k] for v in operands))
            if expected.is_finite():
                assert found.is_finite(), f"{op} of {args} is {result}, which has no value where it should"
                assert found.overlaps(expected), f"{op} of {args} is {result}: {found} for {expected}"


def _watched(function: Callable[..., Any], op: str, swapped: bool = False) -> Callable[..., Any]:
    def call(*args: Any) -> Any:
        """The constructor, and the check of what it gives."""
        result = function(*args)
        verify(op, args[::-1] if swapped else args, result)
        return result

    return call


def install() -> None:
    """Check every constructor from now on, in this process."""
    for name, op in _OPERATORS.items():
        setattr(Expr, name, _watched(getattr(Expr, name), op))
    Expr.__rsub__ = _watched(Expr.__rsub__, "sub", swapped=True)  # type: ignore[method-assign]
    Expr.__truediv__ = _watched(Expr.__truediv__, "div")  # type: ignore[method-assign]
    Expr.__rtruediv__ = _watched(Expr.__rtruediv__, "div", swapped=True)  # type: ignore[method-assign]
    Expr.__neg__ = _watched(Expr.__neg__, "neg")  # type: ignore[method-assign]
    sqrt, function, cos_sin = Graph.sqrt, Graph.function, trigonometry.cos_sin

    def checked_sqrt(graph: Graph, x: Expr) -> Expr:
        """Graph.sqrt"""
        result = sqrt(graph, x)
        verify("sqrt", (x,), result)
        return result

    def checked_function(graph: Graph, op: str, *args: Expr) -> Expr:
        """Graph.function"""
        result = function(graph, op, *args)
        verify(op, args, result)
        return result

    def checked_cos_sin(x: Expr) -> tuple[Expr, Expr]:
        """trigonometry.cos_sin"""
        cosine, sine = cos_sin(x)
        verify("cos", (x,), cosine)
        verify("sin", (x,), sine)
        return cosine, sine

    Graph.sqrt, Graph.function = checked_sqrt, checked_function  # type: ignore[method-assign]
    trigonometry.cos_sin = checked_cos_sin
