"""Values of expressions over whole ranges: balls of python-flint that contain them."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import Any

import flint

from substructures.expr.direct import BALL_FUNCTIONS, ball_power
from substructures.expr.graph import Expr
from substructures.expr.rationals import to_fmpq
from substructures.expr.walk import reachable

#: bits of the arithmetic
PRECISION = 128
_STEPS: dict[str, Callable[..., Any]] = {
    **BALL_FUNCTIONS,
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
    "neg": operator.neg,
}


def exact(x: Fraction | int) -> Any:
    """A rational number as a ball."""
    return flint.arb(to_fmpq(x))


def between(low: Fraction, high: Fraction) -> Any:
    """A ball that contains everything from ``low`` to ``high``."""
    with flint.ctx.workprec(PRECISION):
        return exact(low).union(exact(high))


def enclosures(expressions: Iterable[Expr], values: Mapping[str, Any]) -> list[Any]:
    """Balls that contain the expressions for all values of their symbols in balls; not finite where none was found."""
    roots = list(expressions)
    found: dict[Expr, Any] = {}
    with flint.ctx.workprec(PRECISION):
        for node in reachable(roots):
            if node.op == "sym":
                found[node] = values[str(node.value)]
            elif node.is_number:
                found[node] = exact(node.value)
            else:
                found[node] = _STEPS[node.op](*(found[x] for x in node.args))
    return [found[root] for root in roots]


def magnitude(x: Any, power: int = 1) -> float:
    """A number that |x|^power of a ball does not exceed; infinite where there is none."""
    with flint.ctx.workprec(PRECISION):
        return above(ball_power(x, power).abs_upper()) if x.is_finite() else math.inf


def above(x: Any) -> float:
    """A float that no number of a ball exceeds."""
    if not x.is_finite():
        return math.inf
    return math.nextafter(float(x.upper()), math.inf)


def below(x: Any) -> float:
    """A float that exceeds no number of a ball."""
    return -above(-x)
