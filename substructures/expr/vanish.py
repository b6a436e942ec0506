"""Whether a formula is the zero function, decided at a random point in ball arithmetic of 90 digits.

Fingerprints do not know that sqrt(11)^2 = 11 or atan2(0, 1) = 0; the value at a point does. A ball without zero proves
that the formula is not zero; one with zero means that it is, but for a random point within 1e-80 of a root.

>>> graph = Graph()
>>> x = graph.symbol("x")
>>> vanish = Vanishing(graph)
>>> root = graph.function("sqrt", x + 1)
>>> vanish(graph.function("sqrt", (x + 1) ** 2) - x - 1), vanish(root - x)
(True, False)
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction
from secrets import SystemRandom
from typing import Any

import flint

from substructures.expr.graph import Expr, Graph

PRECISION = 300  # bits
_SIZE = 10**9

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
    """The test for the formulas of one graph; values of nodes are kept."""

    def __init__(self, graph: Graph) -> None:
        self.graph, self.random = graph, SystemRandom()
        self.values: dict[Expr, Any] = {}

    def __call__(self, expr: Expr) -> bool:
        """True for the zero function; False where the formula has no value at the point."""
        if expr.is_zero:
            return True
        with flint.ctx.workprec(PRECISION):
            value = self._value(expr)
        return bool(value.is_finite() and value.contains(0))

    def _value(self, expr: Expr) -> Any:
        stack = [expr]
        while stack:
            node = stack[-1]
            missing = [a for a in node.args if a not in self.values]
            if missing:
                stack.extend(missing)
                continue
            stack.pop()
            if node not in self.values:
                self.values[node] = self._operation(node)
        return self.values[expr]

    def _operation(self, node: Expr) -> Any:
        if node.is_number:
            value = Fraction(node.value)
            return flint.arb(flint.fmpq(value.numerator, value.denominator))
        if node.op == "sym":
            return flint.arb(flint.fmpq(self.random.randrange(1, _SIZE), _SIZE))
        args = [self.values[a] for a in node.args]
        function = _OPERATIONS.get(node.op)
        return function(*args) if function else getattr(args[0], node.op)()
