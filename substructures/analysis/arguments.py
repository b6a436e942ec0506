"""Checks of what analyses are given: finite numbers, ranges, words. The pointer of a fault is the argument's name."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from decimal import Decimal
from fractions import Fraction
from numbers import Real
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.loads.scope import Scope

#: a number or an expression (substructures.expr.parse); floats stand for their shortest decimal text
NumberOrExpression = int | float | Decimal | str
#: one dimension: a tuple, a list or an array of shape (K,)
Numbers = tuple[float, ...] | list[float] | Array


def real(value: Any, pointer: str) -> float:
    """A finite number; no text, no truth value. Raises InvalidArgument."""
    if isinstance(value, bool) or not isinstance(value, int | float | Decimal | Real):
        raise InvalidArgument.at(pointer, "number-expected", f"a number is needed, found {repr(value)[:80]}")
    try:
        number = float(value)
    except OverflowError:  # an integer of more than 308 digits
        number = math.inf
    if not math.isfinite(number):
        raise InvalidArgument.at(pointer, "number-not-finite", f"the number is not finite, found {str(value)[:80]}")
    return number


def reals(values: Any, pointer: str) -> tuple[float, ...]:
    """Finite numbers (K,). Raises InvalidArgument."""
    if isinstance(values, np.ndarray):
        if values.ndim != 1:
            raise InvalidArgument.at(pointer, "wrong-length", f"shape {values.shape} found, (K,) expected")
        values = values.tolist()
    if not isinstance(values, list | tuple):
        message = f"a list or an array of numbers is needed, found {repr(values)[:80]}"
        raise InvalidArgument.at(pointer, "number-expected", message)
    # a million numbers that were checked before take no second look one by one
    if all(type(x) is float for x in values) and np.isfinite(values).all():
        return tuple(values)
    return tuple(real(x, f"{pointer}/{i}") for i, x in enumerate(values))


def positive(value: Any, name: str) -> float:
    """A finite number above zero. Raises InvalidArgument."""
    number = real(value, f"/{name}")
    if number <= 0:
        raise InvalidArgument.at(f"/{name}", "greater-than", f"'{name}' must be greater than 0, found {number:g}")
    return number


def in_range(value: Any, name: str, least: float, most: float) -> float:
    """A finite number from ``least`` to ``most``. Raises InvalidArgument."""
    number = real(value, f"/{name}")
    if least <= number <= most:
        return number
    code = "greater-than-equal" if number < least else "less-than-equal"
    message = f"'{name}' must be between {least:g} and {most:g}, found {number:g}"
    raise InvalidArgument.at(f"/{name}", code, message)


def whole(value: Any, name: str, least: int, most: int) -> int:
    """An integer from ``least`` to ``most``. Raises InvalidArgument."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        message = f"'{name}' must be an integer, found {repr(value)[:80]}"
        raise InvalidArgument.at(f"/{name}", "int-type", message)
    in_range(value, name, least, most)
    return int(value)


def one_of(value: Any, name: str, known: Collection[str]) -> None:
    """Raises InvalidArgument unless the value is one of these words."""
    if not isinstance(value, str) or value not in known:
        words = ", ".join(f"'{word}'" for word in known)
        message = f"'{name}' must be one of {words}, found {repr(value)[:80]}"
        raise InvalidArgument.at(f"/{name}", "literal-error", message)


def by_name(given: Mapping[str, Any] | None, field: str) -> Mapping[str, Any]:
    """What is given by name, none for None. Raises InvalidArgument (``/field``)."""
    if given is not None and not isinstance(given, Mapping):
        message = f"'{field}' are given by name: {{name: value}} is needed, found {repr(given)[:80]}"
        raise InvalidArgument.at(f"/{field}", "object-expected", message)
    return given or {}


def values_of(given: Any, name: str, *classes: type) -> tuple[Any, ...]:
    """Values of these classes, of a list. Raises InvalidArgument (``/name``, ``/name/i``)."""
    wanted = " or ".join(f"{each.__name__}(...)" for each in classes)
    if not isinstance(given, list | tuple):
        raise InvalidArgument.at(f"/{name}", "list-expected", f"a list of {wanted} is needed, found {repr(given)[:80]}")
    for i, each in enumerate(given):
        if not isinstance(each, classes):
            message = f"{wanted} is needed, found {repr(each)[:80]}"
            raise InvalidArgument.at(f"/{name}/{i}", "wrong-type", message)
    return tuple(given)


def exact(value: Any, pointer: str) -> int | Decimal | str:
    """A number without rounding, or the text of an expression. Raises InvalidArgument."""
    if isinstance(value, str):
        return value
    number = real(value, pointer)
    if isinstance(value, int | Decimal):
        return value
    if isinstance(value, Fraction):
        return f"{value.numerator}/{value.denominator}"
    # a float means its shortest decimal text, as in a document: 0.1 is 1/10
    return int(value) if isinstance(value, np.integer) else Decimal(repr(number))


def require_read(scope: Scope) -> None:
    """Raises InvalidArgument with the faults of all expressions that a scope has read."""
    if scope.faults:
        raise InvalidArgument(scope.faults)
