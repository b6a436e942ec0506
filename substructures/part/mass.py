"""The mass of bodies, straight from the text of their definition."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

import flint

from substructures.documents.fields import in_si
from substructures.expr.direct import ball, value
from substructures.expr.steps import ExpressionError
from substructures.part.definition import Definition

PRECISION = 128  # bits


def sum_of(masses: Iterable[tuple[Any, Mapping[str, Any]]]) -> float | None:
    """The sum of numbers or expressions in kg, each with the values of its names; the same double on every machine.

    None where a name has no value, and where the sum is no finite number.
    """
    total = ball_sum(masses)
    return None if total is None else rounded(total)


def ball_sum(masses: Iterable[tuple[Any, Mapping[str, Any]]]) -> Any:
    """The same as a ball; None where a name has no value."""
    try:
        # with more bits than a double has, so that neither the order nor the machine shows in the double
        with flint.ctx.workprec(PRECISION):
            return sum((ball(in_si(mass), names, PRECISION) for mass, names in masses), flint.arb(0))
    except (ExpressionError, ArithmeticError, ValueError):
        return None


def rounded(total: Any) -> float | None:
    """A ball as a double; None of one that is not finite."""
    return float(total) if isfinite(float(total)) else None


def mass_at_defaults(definition: Definition) -> float | None:
    """The mass of all bodies in kg; None where that of one depends on a parameter without a value."""
    given = {name: in_si(each.value) for name, each in definition.parameters.items() if each.value is not None}
    names = {name: ball(x, precision=PRECISION) for name, x in given.items()}
    return sum_of((body.mass, names) for body in definition.bodies)


def number_of(given: Any, names: Mapping[str, Any]) -> Any:
    """The value, None of what is not given or names a parameter without one."""
    try:
        return None if given is None else value(in_si(given), names)
    except ExpressionError:
        return None
