"""Expressions of documents as steps in postfix order: their names, terms, values and slopes, in balls."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from flint import arb, arb_series, fmpq

from substructures.certificate.linear import Ball
from substructures.expr.direct import BALL_FUNCTIONS, ball_power, carried_out, steps_of
from substructures.expr.steps import Knots, Step

Steps = tuple[Step, ...]


def product(*factors: Steps) -> Steps:
    """The product of several expressions."""
    result = factors[0]
    for factor in factors[1:]:
        result = (*result, *factor, Step("mul", None, 1))
    return result


def difference(a: Steps, b: Steps) -> Steps:
    """a - b."""
    return (*a, *b, Step("sub", None, 1))


def negative(a: Steps) -> Steps:
    """-a."""
    return (*a, Step("neg", None, 1))


def names_of(steps: Sequence[Step]) -> frozenset[str]:
    """The names that occur."""
    return frozenset(str(step.value) for step in steps if step.op == "name")


def summands(steps: Steps, apart: str) -> list[Steps]:
    """The terms of a sum as it is written; products, quotients and powers of sums are multiplied out as far as it takes
    to tell what names ``apart`` from what does not.
    """
    stack: list[list[Steps]] = []
    for step in steps:
        if step.op in ("add", "sub"):
            last = stack.pop()
            stack[-1] = [*stack[-1], *(last if step.op == "add" else map(negative, last))]
        elif step.op == "neg":
            stack[-1] = [negative(term) for term in stack[-1]]
        elif step.op in ("number", "name", "pi"):
            stack.append([(step,)])
        else:
            operands = step.operands
            stack[-operands:] = [_apart(step, stack[-operands:], apart)]
    return stack.pop()


def _apart(step: Step, factors: Sequence[Sequence[Steps]], apart: str) -> list[Steps]:
    """The step on sums, in what does not name something and the rest, which is the difference to the whole."""
    whole = (*(x for terms in factors for x in _sum(terms)), step)
    free = [[term for term in terms if apart not in names_of(term)] for terms in factors]
    if apart not in names_of(whole) or not all(free):
        return [whole]
    is_power = step.op == "pow" and step.exponent >= 1
    is_quotient = step.op == "div" and len(free[1]) == len(factors[1])
    if step.op != "mul" and not is_power and not is_quotient:
        return [whole]
    part = (*(x for terms in free for x in _sum(terms)), step)
    return [part, difference(whole, part)]


def _sum(terms: Sequence[Steps]) -> Steps:
    added = [(*term, Step("add", None, 1)) for term in terms[1:]]
    return (*terms[0], *(step for term in added for step in term))


def slope(
    given: Any, names: Mapping[str, Ball], along: str, functions: Mapping[str, Callable[..., Any]] = BALL_FUNCTIONS
) -> Ball:
    """The derivative of a number, of an expression or of steps by a name; not finite where there is none."""
    steps = given if isinstance(given, tuple) else steps_of(given)
    if along not in names_of(steps):
        return arb(0)
    # x + h: the coefficient of h
    used = {name: names[name] for name in names_of(steps)}
    return _series(steps, {**used, along: arb_series([names[along], 1])}, functions)[1]


def depends_on(given: Any, names: Mapping[str, Ball], along: str) -> bool:
    """Whether an expression changes with a name anywhere: a function that may be flat here, and not elsewhere, counts
    as sum + sum^2 of its operands with weights.
    """
    found = slope(given, names, along, _NOWHERE_FLAT)
    return not (found.is_finite() and found.contains(0))


def with_rates(given: Any, names: Mapping[str, Ball], along: str) -> tuple[Ball, Ball, Ball]:
    """The value of a number or of an expression, and its first two derivatives by a name."""
    steps = steps_of(given)
    used = {name: names[name] for name in names_of(steps)}
    # x + h: the coefficients of 1, h and h^2
    x = _series(steps, {**used, along: arb_series([names[along], 1])})
    return x[0], x[1], 2 * x[2]


def value(steps: Steps, names: Mapping[str, Ball]) -> Ball:
    """The value of steps; not finite where there is none."""
    return _series(steps, names)[0]


def _series(
    steps: Steps, names: Mapping[str, Any], functions: Mapping[str, Callable[..., Any]] = BALL_FUNCTIONS
) -> Any:
    """The power series of an expression."""
    nowhere = arb_series([arb("nan"), arb("nan")])
    try:
        found = carried_out(steps, names, _number, _named, _pi, functions, ball_power)
    except (ZeroDivisionError, ValueError):
        # of python-flint for series whose leading term may be zero
        return nowhere
    # a series that is zero hides that the other factor has no value
    is_hidden = functions is BALL_FUNCTIONS and {"call", "power"} & {step.op for step in steps}
    return nowhere if is_hidden and not _plain_value(steps, names).is_finite() else found


def _plain_value(steps: Steps, names: Mapping[str, Any]) -> Ball:
    values = {name: x[0] if isinstance(x, arb_series) else x for name, x in names.items()}
    return carried_out(steps, values, lambda x: _number(x)[0], lambda x: x, arb.pi, BALL_FUNCTIONS, ball_power)


def _weighted(*operands: Any) -> Any:
    total = sum(operands[1:], operands[0] * arb(fmpq(3, 7)))
    return total + total * total


def _weighted_table(knots: Knots, x: Any) -> Any:
    """Of a table of one value alone: nothing."""
    rise = sum((abs(b - a) for a, b in pairwise(knots.y)), Fraction(0))
    return _weighted(x) * arb(fmpq(rise.numerator, rise.denominator))


_FLAT = ("abs", "sign", "sqrt", "tanh", "min", "max", "atan2", "step")
_NOWHERE_FLAT: Mapping[str, Callable[..., Any]] = {
    **BALL_FUNCTIONS,
    **dict.fromkeys(_FLAT, _weighted),
    "table": _weighted_table,
}


def _number(x: Fraction) -> Any:
    return arb_series([arb(fmpq(x.numerator, x.denominator))])


def _named(x: Any) -> Any:
    return x if isinstance(x, arb_series) else arb_series([x])


def _pi() -> Any:
    return arb_series([arb.pi()])
