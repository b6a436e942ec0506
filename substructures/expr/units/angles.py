"""Plain numbers in the place of angles that are more than a turn: who writes 90 means degrees."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal, InvalidOperation
from typing import Any

from substructures.documents.units import NUMBER
from substructures.expr.units.unit_check import Notice, Place

TURNS = 10  # rad
#: the SI unit of angles, and a field that is a number but no angle
RAD, COEFFICIENT = "rad", "coefficient"


def angle_warnings(places: Iterable[Place], parameters: Mapping[str, Any]) -> list[Notice]:
    """Warnings about places of angles, and about parameters that are angles by their unit or stand in such a place."""
    angles = {at: value for at, value, dimension in places if dimension == NUMBER and _field(at) != COEFFICIENT}
    named = {value for value in angles.values() if isinstance(value, str)}
    for name, each in parameters.items():
        if each.unit == RAD or (name in named and not each.unit):
            angles[f"/parameters/{name}/value"] = each.value
    return list(_warnings(angles))


def _warnings(angles: Mapping[str, Any]) -> Iterator[Notice]:
    for pointer, value in angles.items():
        number = _number(value)
        if number is not None and abs(float(number)) >= TURNS:
            text = f"{_field(pointer)} = {value} rad is {abs(float(number)) / (2 * math.pi):.1f} turns"
            message = f'{text}; degrees are written {{"value": {value}, "unit": "deg"}}'
            yield {"pointer": pointer, "code": "angle-in-degrees", "message": message}


def _field(pointer: str) -> str:
    """The name of the field that a number stands in, or of the parameter."""
    steps = pointer.removesuffix("/value").split("/")
    return str(next(step for step in reversed(steps) if not step.isdigit()))


def _number(value: Any) -> Decimal | int | None:
    """A number, also as a text; None of an expression, and of what has a unit."""
    if isinstance(value, int | Decimal):
        return value
    try:
        number = Decimal(value.strip()) if isinstance(value, str) else None
    except InvalidOperation:
        return None
    return number if number is not None and number.is_finite() else None
