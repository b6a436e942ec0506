"""Values of numbers and expressions straight from their text: the yardstick of everything that the graph makes of them.

Nothing is built, folded or simplified; the steps of :mod:`substructures.expr.syntax` are carried out as they are
written, in floating point (:func:`value`) or in ball arithmetic (:func:`ball`), whose answers contain the exact value.
This module knows nothing of :mod:`substructures.expr.graph`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any

import flint
import numpy as np

from substructures.expr.laws import values as law_values
from substructures.expr.rationals import to_fmpq
from substructures.expr.steps import ExpressionError, Knots, Step, decimal_number
from substructures.expr.syntax import read

SHORT = 100  # characters of a decimal number
#: a number as documents give it: exact, or an expression
Given = int | Decimal | Fraction | str

_ARITHMETIC: dict[str, Callable[[Any, Any], Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
}
#: of balls, and of their power series
BALL_FUNCTIONS: dict[str, Callable[..., Any]] = {
    **{
        name: operator.methodcaller(name)
        for name in ("sin", "cos", "tan", "sqrt", "exp", "log", "asin", "acos", "atan")
    },
    **law_values.BALLS,
}
_FLOAT_FUNCTIONS: dict[str, Callable[..., Any]] = {
    "sin": np.sin,
    "cos": np.cos,
    "tan": np.tan,
    "sqrt": np.sqrt,
    "exp": np.exp,
    "log": np.log,
    "asin": np.arcsin,
    "acos": np.arccos,
    "atan": np.arctan,
    **law_values.FLOATS,
}


def value(given: Given, names: Mapping[str, Any] | None = None) -> Any:
    """The value in floating point; ``names``: numbers, or arrays of one shape, for the names of the expression.

    Outside of its domain an expression is NaN or infinite, as in IEEE arithmetic.
    Raises ExpressionError for a text that cannot be read and for unknown names, ValueError for a number of more than
    400 digits.

    >>> float(value("2*(l + 1/2)", {"l": 0.25}))
    1.5
    """
    if not isinstance(given, str):
        text = str(given)
        is_short = len(text) <= SHORT and not text.strip("-.0123456789")
        return np.float64(float(text) + 0.0) if is_short else _float(_exact(given))  # correctly rounded, -0 is 0
    steps, known = read(given), names or {}
    if len(steps) == 1 and steps[0].op == "name":
        return _floats(_lookup(steps[0], known))
    with np.errstate(all="ignore"):
        return carried_out(steps, known, _float, _floats, lambda: np.pi, _FLOAT_FUNCTIONS, _float_power)


def ball(given: Given, names: Mapping[str, Any] | None = None, precision: int = 128, complex_: bool = False) -> Any:
    """The value as an ``arb`` of python-flint (``acb`` if ``complex_``) that contains the exact one.

    ``names``: what the names stand for: floats, integers and fractions (taken as exact), or balls. ``precision``: bits
    of the arithmetic; at 53 the radius bounds what rounding may do to the expression in floating point.
    Outside of its domain an expression is not finite. Raises as :func:`value`.

    >>> ball("sqrt(2)^2 - 2", precision=200).contains(0)
    True
    """
    kind = flint.acb if complex_ else flint.arb

    def read_name(given: Any) -> Any:
        """A value of a name as a ball."""
        return _ball(kind, Fraction(given)) if isinstance(given, (int, float, Fraction)) else kind(given)

    with flint.ctx.workprec(precision):
        return _run(given, names or {}, lambda x: _ball(kind, x), read_name, kind.pi, BALL_FUNCTIONS, ball_power)


def _run(
    given: Given,
    names: Mapping[str, Any],
    number: Callable[[Fraction], Any],
    named: Callable[[Any], Any],
    pi: Callable[[], Any],
    functions: Mapping[str, Callable[..., Any]],
    power: Callable[[Any, int], Any],
) -> Any:
    """A number, or the steps of a text."""
    return carried_out(steps_of(given), names, number, named, pi, functions, power)


def steps_of(given: Given | tuple[Step, ...]) -> tuple[Step, ...]:
    """The steps of a text; of a number the one that is the number itself; steps as they are. Raises as
    :func:`value`.
    """
    if isinstance(given, str):
        return read(given)
    if isinstance(given, tuple):
        return given
    return (Step("number", _exact(given), 1),)


def _exact(given: int | Decimal | Fraction) -> Fraction:
    return decimal_number(str(given)) if isinstance(given, Decimal) else Fraction(given)


def carried_out(
    steps: Sequence[Step],
    names: Mapping[str, Any],
    number: Callable[[Any], Any],
    named: Callable[[Any], Any],
    pi: Callable[[], Any],
    functions: Mapping[str, Callable[..., Any]],
    power: Callable[[Any, int], Any],
) -> Any:
    """The steps on a stack, over any numbers that know ``+ - * /``; the other arguments say what else they are."""
    stack: list[Any] = []
    for step in steps:
        if step.op == "number":
            stack.append(number(step.value))
        elif step.op == "pi":
            stack.append(pi())
        elif step.op == "name":
            stack.append(named(_lookup(step, names)))
        elif step.op in _ARITHMETIC:
            last = stack.pop()
            stack.append(_ARITHMETIC[step.op](stack.pop(), last))
        else:
            args = stack[len(stack) - step.operands :]
            del stack[len(stack) - step.operands :]
            stack.append(_result(step, args, functions, power))
    return stack.pop()


def _result(
    step: Step, args: Sequence[Any], functions: Mapping[str, Callable[..., Any]], power: Callable[[Any, int], Any]
) -> Any:
    """A step that is no leaf and none of + - * /; powers and tables have functions of their own."""
    if step.op == "call":
        return functions[str(step.value)](*args)
    if step.op == "power":
        return functions["power"](*args)
    if isinstance(step.value, Knots):
        return functions["table"](step.value, *args)
    return power(args[0], step.value) if isinstance(step.value, int) else -args[0]


def _lookup(step: Step, names: Mapping[str, Any]) -> Any:
    name = str(step.value)
    try:
        return names[name]
    except KeyError:
        raise ExpressionError(f"unknown name '{name[:80]}'", step.column, name) from None


def _float(x: Fraction) -> np.float64:
    """Correctly rounded; infinite beyond the range of doubles."""
    try:
        return np.float64(x.numerator / x.denominator)
    except OverflowError:
        return np.float64(np.inf if x > 0 else -np.inf)


def _floats(given: Any) -> Any:
    """What a name stands for; decimal numbers and fractions, one or lists of them, correctly rounded."""
    if type(given) is np.float64:
        return given
    found = np.asarray(given)
    return found.astype(np.float64) if found.dtype == object else found


def _float_power(x: Any, n: int) -> Any:
    return np.power(x, float(n))


def _ball(kind: Callable[[Any], Any], x: Fraction) -> Any:
    return kind(to_fmpq(x))


def ball_power(x: Any, n: int) -> Any:
    """By squaring: python-flint's own power of a ball around 0 is not a number."""
    result, square, left = x * 0 + 1, x, abs(n)
    while left:
        if left & 1:
            result = result * square
        square, left = square * square, left >> 1
    return 1 / result if n < 0 else result
