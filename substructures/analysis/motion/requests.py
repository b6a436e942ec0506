"""Requests about motions of trees, closed loops and rolling bodies as plain data; every fault has a pointer.

All simulations have the fields of SpanRequest: state, parameters, inputs, times, events, series, tolerances.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from substructures.analysis.equations.velocity_constraints import VelocityConstraints
from substructures.analysis.motion.request_fields import (
    Event,
    FixedStep,
    Positive,
    Real,
    Reals,
    Signal,
    Span,
    require_increasing,
)
from substructures.documents import DocumentPart, read_model
from substructures.documents.fields import Name, Number

MAX_OUTPUTS = 1_000_000
MAX_EVENTS = 100
TAYLOR = "Taylor"
R = TypeVar("R", bound="StateRequest")


class StateRequest(DocumentPart):
    """A state, parameters and inputs."""

    q: Any = Field(None, description="coordinates: a list, or an object by name; rad, m")
    qd: Any = Field(None, description="velocities, 0 by default; rad/s, m/s")
    parameters: dict[str, Real] = Field({}, description="in place of their defaults")
    inputs: dict[str, Signal] = Field({}, description="number, expression in q, q' and t, or table; N m or N")

    @classmethod
    def read(cls: type[R], data: Any) -> R:
        """From plain data, or with numpy arrays. Raises InvalidDocument with a pointer to every fault."""
        return read_model(cls, data)


class SpanRequest(StateRequest):
    """A motion from a start over a span of time.

    At most one of ``times``, ``step`` and ``count`` says where results are wanted (default: 101 of equal distance).
    """

    span: Span = Field(description="s")
    times: Annotated[Reals, Field(max_length=MAX_OUTPUTS)] | None = Field(None, description="s")
    step: Positive | None = Field(None, description="s")
    count: Annotated[int, Field(ge=2, le=MAX_OUTPUTS)] | None = None
    events: Annotated[tuple[Event, ...], Field(max_length=MAX_EVENTS)] = ()
    series: dict[Name, Number] = Field({}, max_length=MAX_EVENTS, description="expressions to be followed")
    relative_tolerance: Annotated[Real, Field(ge=1e-14, le=1e-1)] = 1e-10
    absolute_tolerance: Annotated[Real, Field(ge=0, le=1e-1)] = 1e-12
    max_step: Positive | None = Field(None, description="s")
    max_steps: Annotated[int, Field(ge=1, le=100_000_000)] = 1_000_000
    drift_limit: Positive = Field(1e-7, description="largest relative drift of first integrals of a right result")

    @model_validator(mode="after")
    def _one_grid(self) -> SpanRequest:
        if sum(x is not None for x in (self.times, self.step, self.count)) > 1:
            raise PydanticCustomError("one-grid", "give one of 'times', 'step' and 'count'")
        if self.span[1] <= self.span[0]:
            raise PydanticCustomError("empty-span", "the span must end after it begins")
        if self.step is not None and (self.span[1] - self.span[0]) / self.step > MAX_OUTPUTS:
            raise PydanticCustomError("too-many-outputs", "more than a million results; take a larger 'step'")
        return self

    @model_validator(mode="after")
    def _inside(self) -> SpanRequest:
        times = self.times or ()
        require_increasing(times)
        if times and not self.span[0] <= times[0] <= times[-1] <= self.span[1]:
            raise PydanticCustomError("outside", "'times' must lie in the span")
        return self

    def outputs(self) -> NDArray[np.float64]:
        """The times where results are wanted."""
        start, end = self.span
        if self.times is not None:
            return np.array(self.times, dtype=np.float64)
        if self.step is not None:
            whole = math.floor((end - start) / self.step * (1 + 1e-12))
            grid = start + self.step * np.arange(whole + 1)
            return np.minimum(grid, end) if end - grid[-1] < 1e-9 * self.step else np.append(grid, end)
        return np.linspace(start, end, self.count or 101)


class SimulationRequest(SpanRequest):
    """q'' = g^-1 (Q - Gamma q' q') of a tree without closures."""

    method: Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA", "Taylor"] = "DOP853"
    fixed_step: FixedStep | None = None


class LoopRequest(StateRequest):
    """Loops at a state. ``fixed`` coordinates keep their values while the loops are closed; ``prescribed`` coordinates
    move as given: a number, an expression in t, or a table.
    """

    t: Real = 0.0
    fixed: tuple[str, ...] = Field((), max_length=500)
    prescribed: dict[str, Signal] = Field({}, description="by coordinate; rad or m")


class ClosedRequest(SpanRequest):
    """A motion with closures from the closed state nearest to ``q``, ``qd``; see LoopRequest.

    ``reduction``: the state is projected onto the closures after every step, or independent coordinates are integrated.
    """

    fixed: tuple[str, ...] = Field((), max_length=500)
    prescribed: dict[str, Signal] = Field({}, description="by coordinate; rad or m")
    method: Literal["DOP853", "RK45", "RK23"] = "DOP853"
    reduction: Literal["projection", "partitioning"] = "projection"


class RollingRequest(SpanRequest, VelocityConstraints):
    """A motion with velocity constraints from ``q`` and quasi-velocities ``v``, or velocities ``qd`` that meet them."""

    v: Any = Field(None, description="quasi-velocities: a list, or an object by name; 0 by default")
    method: Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA"] = "DOP853"
    form: Literal["voronets", "boltzmann-hamel"] = "voronets"
