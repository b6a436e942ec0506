"""The request of a simulation as plain data; every fault has a pointer into it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from decimal import Decimal
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError

from substructures.definition import Model, Name, Number, read_model

MAX_OUTPUTS = 1_000_000
MAX_EVENTS = 100


def _real(value: Any) -> Any:
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


Real = Annotated[float, BeforeValidator(_real), WithJsonSchema({"type": "number"})]
Positive = Annotated[Real, Field(gt=0)]
TAYLOR = "Taylor"
Method = Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "Taylor"]


class Table(Model):
    """An input by a table of values over time [s]: piecewise constant, linear, or a cubic spline."""

    times: Annotated[tuple[Real, ...], Field(min_length=2, max_length=100_000)]
    values: Annotated[tuple[Real, ...], Field(min_length=2, max_length=100_000)]
    interpolation: Literal["hold", "linear", "cubic"] = "linear"

    @model_validator(mode="after")
    def _ordered(self) -> Table:
        if len(self.times) != len(self.values):
            raise PydanticCustomError("wrong-length", "as many 'values' as 'times' are needed")
        if any(b <= a for a, b in pairwise(self.times)):
            raise PydanticCustomError("not-increasing", "'times' must increase")
        return self


class Event(Model):
    """``quantity`` (an expression in coordinates, velocities, parameters and t) crosses ``level``."""

    name: Name
    quantity: Number
    level: Real = 0.0
    direction: Literal["rising", "falling", "both"] = "both"
    action: Literal["stop", "record"] = "stop"


class FixedStep(Model):
    """Real-time mode: every step takes the same, known time. Semi-implicit Euler, or Runge-Kutta of fourth order."""

    step: Positive = Field(description="s")
    method: Literal["semi-implicit-euler", "rk4"] = "rk4"


class SimulationRequest(Model):
    """q'' = g^-1 (Q - Gamma q' q') from a start, over a span of time.

    At most one of ``times``, ``step`` and ``count`` says where results are wanted (default: 101 of equal distance).
    """

    q: Any = Field(description="coordinates at the start: a list, or an object by name; rad, m")
    qd: Any = Field(None, description="velocities at the start, 0 by default; rad/s, m/s")
    span: tuple[Real, Real] = Field(description="s")
    times: Annotated[tuple[Real, ...], Field(max_length=MAX_OUTPUTS)] | None = Field(None, description="s")
    step: Positive | None = Field(None, description="s")
    count: Annotated[int, Field(ge=2, le=MAX_OUTPUTS)] | None = None
    parameters: dict[str, Real] = Field({}, description="in place of their defaults")
    inputs: dict[str, Number | Table] = Field({}, description="number, expression in q, q' and t, or table")
    events: Annotated[tuple[Event, ...], Field(max_length=MAX_EVENTS)] = ()
    series: dict[Name, Number] = Field({}, max_length=MAX_EVENTS, description="expressions to be followed")
    method: Method = "DOP853"
    relative_tolerance: Annotated[Real, Field(ge=1e-14, le=1e-1)] = 1e-9
    absolute_tolerance: Annotated[Real, Field(ge=0, le=1e-1)] = 1e-12
    max_steps: Annotated[int, Field(ge=1, le=100_000_000)] = 1_000_000
    drift_limit: Positive = Field(1e-6, description="largest relative drift of first integrals of a right result")
    fixed_step: FixedStep | None = None

    @model_validator(mode="after")
    def _one_grid(self) -> SimulationRequest:
        if sum(x is not None for x in (self.times, self.step, self.count)) > 1:
            raise PydanticCustomError("one-grid", "give one of 'times', 'step' and 'count'")
        if self.span[1] <= self.span[0]:
            raise PydanticCustomError("empty-span", "the span must end after it begins")
        if self.step is not None and (self.span[1] - self.span[0]) / self.step > MAX_OUTPUTS:
            raise PydanticCustomError("too-many-outputs", "more than a million results; take a larger 'step'")
        return self

    @model_validator(mode="after")
    def _inside(self) -> SimulationRequest:
        times = self.times or ()
        if any(b <= a for a, b in pairwise(times)):
            raise PydanticCustomError("not-increasing", "'times' must increase")
        if times and not self.span[0] <= times[0] <= times[-1] <= self.span[1]:
            raise PydanticCustomError("outside", "'times' must lie in the span")
        return self

    def outputs(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The times where results are wanted."""
        start, end = self.span
        if self.times is not None:
            return np.array(self.times, dtype=np.float64)
        if self.step is not None:
            whole = math.floor((end - start) / self.step * (1 + 1e-12))
            grid = start + self.step * np.arange(whole + 1)
            return np.minimum(grid, end) if end - grid[-1] < 1e-9 * self.step else np.append(grid, end)
        return np.linspace(start, end, self.count or 101)

    @classmethod
    def read(cls, data: Mapping[str, Any]) -> SimulationRequest:
        """A request from plain data, or with numpy arrays. Raises InvalidDocument with a pointer to every fault."""
        plain = data if not isinstance(data, Mapping) else {k: _listed(v, k) for k, v in data.items()}
        return read_model(cls, plain)


def _listed(value: Any, key: str) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) and key in ("span", "times") else value
