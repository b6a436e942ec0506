"""The mass of bodies, straight from the text of their definition."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

import flint

from substructures.documents.fields import in_si
from substructures.expr.direct import ball
from substructures.expr.syntax import ExpressionError
from substructures.part.definition import Definition

PRECISION = 128  # bits


def sum_of(masses: Iterable[tuple[Any, Mapping[str, Any]]]) -> float | None:
    """The sum of numbers or expressions in kg, each with the values of its names; the same double on every machine.

    None where a name has no value, and where the sum is no finite number.
    """
    try:
        with flint.ctx.workprec(PRECISION):
            total = float(sum((ball(in_si(mass), names, PRECISION) for mass, names in masses), flint.arb(0)))
    except (ExpressionError, ArithmeticError, ValueError):
        return None
    return total if isfinite(total) else None


def mass_at_defaults(definition: Definition) -> float | None:
    """The mass of all bodies in kg; None where that of one depends on a parameter without a value."""
    given = {name: in_si(each.value) for name, each in definition.parameters.items() if each.value is not None}
    names = {name: ball(x, precision=PRECISION) for name, x in given.items()}
    return sum_of((body.mass, names) for body in definition.bodies)
