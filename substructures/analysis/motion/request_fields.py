"""Parts that requests of the analysis share: finite numbers, functions of time, events; faults have pointers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import Decimal
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, Tag, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import DocumentPart
from substructures.documents.fields import Name, Number


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


def _listed(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


def require_increasing(times: tuple[float, ...]) -> None:
    """Raises the fault ``not-increasing``."""
    if any(b <= a for a, b in pairwise(times)):
        raise PydanticCustomError("not-increasing", "'times' must increase")


Real = Annotated[float, BeforeValidator(_real), WithJsonSchema({"type": "number"})]
Positive = Annotated[Real, Field(gt=0)]
#: numbers in a tuple, a list or a numpy array
Reals = Annotated[tuple[Real, ...], BeforeValidator(_listed)]
Span = Annotated[tuple[Real, Real], BeforeValidator(_listed)]
_Column = Annotated[Reals, Field(min_length=2, max_length=100_000)]


class Table(DocumentPart):
    """Values over time [s]. Inputs: piecewise constant, linear, or a cubic spline; prescribed motions: a spline of
    degree five.
    """

    times: _Column
    values: _Column
    interpolation: Literal["hold", "linear", "cubic"] = "linear"

    @model_validator(mode="after")
    def _ordered(self) -> Table:
        if len(self.times) != len(self.values):
            raise PydanticCustomError("wrong-length", "as many 'values' as 'times' are needed")
        require_increasing(self.times)
        return self


def _kind(value: Any) -> str:
    return "table" if isinstance(value, (Mapping, Table)) else "number"


#: a number, an expression, or a table
Signal = Annotated[Annotated[Number, Tag("number")] | Annotated[Table, Tag("table")], Discriminator(_kind)]


class Event(DocumentPart):
    """``quantity`` (an expression in coordinates, velocities, parameters and t) crosses ``level``."""

    name: Name
    quantity: Number
    level: Real = 0.0
    direction: Literal["rising", "falling", "both"] = "both"
    action: Literal["stop", "record"] = "stop"


class FixedStep(DocumentPart):
    """Real-time mode: every step takes the same, known time. Semi-implicit Euler, or Runge-Kutta of fourth order."""

    step: Positive = Field(description="s")
    method: Literal["semi-implicit-euler", "rk4"] = "rk4"
