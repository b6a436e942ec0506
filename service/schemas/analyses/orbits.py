"""Periodic orbits, Poincare sections and Lyapunov exponents as they are asked for; SI units, angles in rad."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from service.schemas.analyses.motions import MAX_EVENTS, Event, Seconds, StateRequest
from service.schemas.measured import EXPRESSION, OF_QUANTITY, OF_VARIED, SECONDS
from service.schemas.parts import RequestPart
from substructures.analysis.orbits.orbit import Section
from substructures.documents.fields import NUMERIC, PlainNumber, Real

Relative = Annotated[Real, Field(ge=1e-14, le=1e-2)]
Absolute = Annotated[Real, Field(ge=0, le=1e-2)]


class OrbitSection(RequestPart):
    """The surface ``quantity`` = ``level`` that an orbit crosses ``count`` times in its period."""

    quantity: Annotated[PlainNumber, EXPRESSION] = Field(description="in coordinates, velocities and parameters")
    level: Annotated[Real, OF_QUANTITY] = 0.0
    direction: Literal["rising", "falling"] = "rising"
    count: Annotated[int, Field(ge=1, le=1000), NUMERIC] = Field(1, description="the return that closes the orbit")
    duration: Seconds = Field(100.0, description="s, at most, of one return")

    def value(self) -> Section:
        """As the science takes it."""
        return Section(**dict(self))


class PeriodicOrbitRequest(StateRequest):
    """A state near an orbit and about its period, or the section whose time of return that is; inputs are numbers,
    tables or expressions in t, of which it is a period.
    """

    period: Annotated[PlainNumber | None, SECONDS] = Field(
        None, description="s, or an expression in parameters (`2*pi/w`); a guess, where no input depends on the time"
    )
    section: OrbitSection | None = Field(None, description="near the start, in place of `period`, which is unknown")
    fixed: bool = Field(False, description="whether the period stays as it is")
    hold: tuple[str, ...] = Field((), max_length=500, description="coordinates and velocities that stay as given")
    turns: dict[str, Annotated[int, NUMERIC]] = Field({}, description="whole turns of revolute coordinates in a period")
    vary: str | None = Field(None, description="of a family: a parameter, or a coordinate or velocity that is held")
    values: Annotated[tuple[Real, ...], OF_VARIED] = Field((), max_length=1000, description="of `vary`")
    between: Annotated[tuple[Real, Real] | None, OF_VARIED] = Field(
        None, description="in place of `values`: a parameter's first and last, followed by arclength through folds"
    )
    steps: Annotated[int, Field(ge=2, le=1000), NUMERIC] = Field(
        50, description="of that family over the range, at least"
    )
    events: tuple[Event, ...] = Field((), max_length=MAX_EVENTS, description="that act, each with its `reset`")
    relative_tolerance: Relative = 1e-11
    absolute_tolerance: Absolute = 1e-13


class PoincareSectionRequest(StateRequest):
    """A motion, and the surface ``quantity`` = ``level`` that it crosses, as of an event."""

    quantity: Annotated[PlainNumber, EXPRESSION] = Field(description="in coordinates, velocities, parameters and t")
    level: Annotated[Real, OF_QUANTITY] = 0.0
    direction: Literal["rising", "falling", "both"] = "rising"
    count: Annotated[int, Field(ge=1, le=1_000_000), NUMERIC] = Field(1000, description="of the first crossings")
    duration: Seconds = Field(description="s, at most")
    relative_tolerance: Relative = 1e-10
    absolute_tolerance: Absolute = 1e-12


class LyapunovRequest(StateRequest):
    """A motion, and how long it is followed."""

    duration: Seconds = Field(description="s")
    transient: Annotated[Seconds | None, Field(description="s before that, which do not count")] = None
    intervals: Annotated[int, Field(ge=20, le=1_000_000), NUMERIC] = Field(
        200, description="between two factorisations"
    )
    relative_tolerance: Relative = 1e-10
    absolute_tolerance: Absolute = 1e-12
