"""Requests about closed loops and velocity constraints as plain data; every fault has a pointer into them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import Decimal
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Discriminator, Field, Tag, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from substructures.analysis.velocity_constraints import VelocityConstraints
from substructures.definition import Model as Document
from substructures.definition import Name, Number, read_model

Array = NDArray[np.float64]
MAX_OUTPUTS = 1_000_000
MAX_EVENTS = 100


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


Real = Annotated[float, BeforeValidator(_real), WithJsonSchema({"type": "number"})]
Positive = Annotated[Real, Field(gt=0)]
Column = Annotated[tuple[Real, ...], BeforeValidator(_listed), Field(min_length=2, max_length=100_000)]


class Table(Document):
    """Values over time [s]. Inputs: piecewise constant, linear or cubic, held before and after; prescribed motions: a
    spline of degree five within its times.
    """

    times: Column
    values: Column
    interpolation: Literal["hold", "linear", "cubic"] = "linear"

    @model_validator(mode="after")
    def _ordered(self) -> Table:
        if len(self.times) != len(self.values):
            raise PydanticCustomError("wrong-length", "as many 'values' as 'times' are needed")
        if any(b <= a for a, b in pairwise(self.times)):
            raise PydanticCustomError("not-increasing", "'times' must increase")
        return self


def _kind(value: Any) -> str:
    return "table" if isinstance(value, (Mapping, Table)) else "number"


#: a number, an expression in t, or a table
Signal = Annotated[Annotated[Number, Tag("number")] | Annotated[Table, Tag("table")], Discriminator(_kind)]


class Event(Document):
    """``quantity`` (an expression in coordinates, velocities, parameters and t) crosses ``level``."""

    name: Name
    quantity: str
    level: Real = 0.0
    direction: Literal["rising", "falling", "both"] = "both"
    action: Literal["stop", "record"] = "stop"


class StateRequest(Document):
    """A state, parameters and inputs."""

    q: Any = Field(None, description="coordinates: a list, or an object by name; rad, m")
    qd: Any = Field(None, description="velocities, 0 by default; rad/s, m/s")
    parameters: dict[str, Real] = Field({}, description="in place of their defaults")
    inputs: dict[str, Signal] = Field({}, description="number, expression in t, or table; N m or N")


class LoopRequest(StateRequest):
    """Loops at a state. ``fixed`` coordinates keep their values while the loops are closed; ``prescribed`` coordinates
    move as given: a number, an expression in t, or a table.
    """

    t: Real = 0.0
    fixed: tuple[str, ...] = Field((), max_length=500)
    prescribed: dict[str, Signal] = Field({}, description="by coordinate; rad or m")

    @classmethod
    def read(cls, data: Any) -> LoopRequest:
        """From plain data. Raises InvalidDocument with a pointer to every fault."""
        return read_model(cls, data)


class SpanRequest(StateRequest):
    """A span of time. At most one of ``times``, ``step`` and ``count`` says where results are wanted (101 times)."""

    span: tuple[Real, Real] = Field(description="s")
    times: Annotated[tuple[Real, ...], BeforeValidator(_listed), Field(max_length=MAX_OUTPUTS)] | None = None
    step: Positive | None = Field(None, description="s")
    count: Annotated[int, Field(ge=2, le=MAX_OUTPUTS)] | None = None
    relative_tolerance: Annotated[Real, Field(ge=1e-13, le=1e-1)] = 1e-10
    absolute_tolerance: Annotated[Real, Field(gt=0, le=1e-1)] = 1e-12
    max_step: Positive | None = Field(None, description="s")
    max_steps: Annotated[int, Field(ge=1, le=100_000_000)] = 1_000_000

    @model_validator(mode="after")
    def _one_grid(self) -> SpanRequest:
        if sum(x is not None for x in (self.times, self.step, self.count)) > 1:
            raise PydanticCustomError("one-grid", "give one of 'times', 'step' and 'count'")
        start, end = self.span
        if end <= start:
            raise PydanticCustomError("empty-span", "the span must end after it begins")
        if self.step is not None and (end - start) / self.step > MAX_OUTPUTS:
            raise PydanticCustomError("too-many-outputs", "more than a million results; take a larger 'step'")
        times = self.times or ()
        if any(b <= a for a, b in pairwise(times)):
            raise PydanticCustomError("not-increasing", "'times' must increase")
        if times and not start <= times[0] <= times[-1] <= end:
            raise PydanticCustomError("outside", "'times' must lie in the span")
        return self

    def outputs(self) -> Array:
        """The times where results are wanted."""
        start, end = self.span
        if self.times is not None:
            return np.array(self.times, dtype=np.float64)
        if self.step is not None:
            return np.append(np.arange(start, end - 1e-9 * self.step, self.step), end)
        return np.linspace(start, end, self.count or 101)

    def options(self) -> dict[str, float]:
        """Of the integrator."""
        most = np.inf if self.max_step is None else self.max_step
        return {"rtol": self.relative_tolerance, "atol": self.absolute_tolerance, "max_step": most}


class ClosedRequest(SpanRequest):
    """A motion with closures from the closed state nearest to ``q``, ``qd``; see LoopRequest.

    ``method``: the state is projected onto the closures after every step, or independent coordinates are integrated.
    """

    fixed: tuple[str, ...] = Field((), max_length=500)
    prescribed: dict[str, Signal] = Field({}, description="by coordinate; rad or m")
    method: Literal["projection", "partitioning"] = "projection"
    events: Annotated[tuple[Event, ...], Field(max_length=MAX_EVENTS)] = ()

    @classmethod
    def read(cls, data: Any) -> ClosedRequest:
        """From plain data. Raises InvalidDocument with a pointer to every fault."""
        return read_model(cls, data)


class RollingRequest(SpanRequest, VelocityConstraints):
    """A motion with velocity constraints from ``q`` and quasi-velocities ``v``, or velocities ``qd`` that meet them."""

    v: Any = Field(None, description="quasi-velocities: a list, or an object by name; 0 by default")
    form: Literal["voronets", "boltzmann-hamel"] = "voronets"

    @classmethod
    def read(cls, data: Any) -> RollingRequest:
        """From plain data. Raises InvalidDocument with a pointer to every fault."""
        return read_model(cls, data)
