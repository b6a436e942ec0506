"""Types of fields that documents share: names, exact and finite numbers, vectors."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

NAME = r"^[A-Za-z][A-Za-z0-9_]{0,63}$"
LIBRARY_NAME = r"^[a-z0-9][a-z0-9-]{0,63}$"


def _number(value: Any) -> Any:
    """Exact number or expression text; floats are taken by their shortest decimal text."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Decimal, str)):
        raise PydanticCustomError("number-expected", "expected a number or an expression")
    if isinstance(value, float):
        value = Decimal(repr(float(value)))
    if isinstance(value, Decimal) and not value.is_finite():
        raise PydanticCustomError("number-not-finite", "the number is not finite")
    return value


def _real(value: Any) -> float:
    """A finite number; no text, no truth value."""
    if isinstance(value, bool) or not isinstance(value, (int, float, Decimal, np.floating, np.integer)):
        raise PydanticCustomError("number-expected", "a number is needed")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise PydanticCustomError("number-not-finite", "the number is not finite")
    return number


Number = Annotated[
    int | Decimal | str,
    BeforeValidator(_number),
    WithJsonSchema({"anyOf": [{"type": "number"}, {"type": "string", "maxLength": 10000}]}),
]
Real = Annotated[float, BeforeValidator(_real), WithJsonSchema({"type": "number"})]
Positive = Annotated[Real, Field(gt=0)]
NumberVector = tuple[Number, Number, Number]
Name = Annotated[str, Field(pattern=NAME)]
LibraryName = Annotated[str, Field(pattern=LIBRARY_NAME)]
