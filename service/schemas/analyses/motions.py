"""Motions as they are asked for: bodies of requests, items of jobs, documents on the command line; SI units, rad.

What a value must be beside its type (a span that ends after it begins, times that increase) the science says; here its
complaint becomes one of the document.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Discriminator, Field, RootModel, Tag, model_validator

from service.schemas.analyses.velocity_constraints import VelocityConstraints
from service.schemas.measured import (
    COORDINATE_SIGNALS,
    COORDINATES,
    EXPRESSION,
    EXPRESSIONS,
    INPUT_SIGNALS,
    METRES_PER_SECOND,
    OF_QUANTITY,
    OF_SIGNAL,
    QUASI_VELOCITIES,
    SECONDS,
    STATES,
    VELOCITIES,
    Values,
)
from service.schemas.parts import RequestPart
from service.schemas.shapes import refused
from substructures.analysis import simulate as science
from substructures.analysis.motion.problems.contacts import ROUGHEST
from substructures.analysis.motion.problems.output_times import MAX_OUTPUTS, OutputGrid, OutputTimes
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC, Name, PlainNumber, Positive, Real
from substructures.errors import InvalidArgument

MAX_EVENTS = 100
MAX_CONTACTS = 50


def _listed(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray) else value


def checked(make: Callable[[], object]) -> None:
    """What the science says against a value, as a fault of the part of the document that has it."""
    try:
        make()
    except InvalidArgument as error:
        (fault,) = error.faults
        raise refused(fault.code, fault.message, fault.pointer) from None


#: numbers in a tuple, a list or a numpy array
Reals = Annotated[tuple[Real, ...], BeforeValidator(_listed)]
Span = Annotated[tuple[Real, Real], BeforeValidator(_listed), SECONDS]
Seconds = Annotated[Positive, SECONDS]
_Column = Annotated[Reals, Field(min_length=2, max_length=100_000)]


class Table(RequestPart):
    """Values over time [s], piecewise constant (hold), linear, or splines. Where ``interpolation`` is not given inputs
    are linear and prescribed motions quintic; these must have no kink.
    """

    times: Annotated[_Column, SECONDS]
    values: Annotated[_Column, OF_SIGNAL]
    interpolation: Literal["hold", "linear", "cubic", "quintic"] | None = None

    @model_validator(mode="after")
    def _ordered(self) -> Table:
        checked(self.value)
        return self

    def value(self) -> science.Table:
        """As the science takes it."""
        return science.Table(self.times, self.values, self.interpolation)


def _kind(value: Any) -> str:
    return "table" if isinstance(value, (Mapping, Table)) else "number"


#: a number, an expression, or a table
Signal = Annotated[Annotated[PlainNumber, Tag("number")] | Annotated[Table, Tag("table")], Discriminator(_kind)]


class Event(RequestPart):
    """``quantity`` (an expression in coordinates, velocities, parameters and t) crosses ``level``. ``reset``: what
    coordinates and velocities become there, in expressions of the state before.
    """

    name: Name
    quantity: Annotated[PlainNumber, EXPRESSION]
    level: Annotated[Real, OF_QUANTITY] = 0.0
    direction: Literal["rising", "falling", "both"] = "both"
    action: Literal["stop", "record"] = "stop"
    reset: Annotated[dict[str, PlainNumber], STATES] = Field(
        {}, max_length=MAX_EVENTS, description="by coordinate or velocity (q'); the motion goes on from there"
    )

    def value(self) -> science.Event:
        """As the science takes it."""
        return science.Event(self.name, self.quantity, self.level, self.direction, self.action, self.reset)


class Contact(RequestPart):
    """The origin of the frame ``point`` does not pass through the plane z = 0 of the world, or x, y of a frame."""

    name: Name
    type: Literal["point_plane", "point_line"] = Field("point_plane", description="point_line: slides along x alone")
    point: str = Field(max_length=200, description="instance.port or instance.body")
    plane: str = Field("world", max_length=200, description="world, instance.port or instance.body; normal: its z axis")
    restitution: Annotated[Real, Field(ge=0, le=1)] = 0.0
    friction: Annotated[Real, Field(ge=0, le=ROUGHEST)] = 0.0
    when: str | None = Field(None, max_length=10_000, description="one comparison: else the point passes the plane")
    rest_velocity: Annotated[Positive, METRES_PER_SECOND] = Field(1e-4, description="m/s; slower ones do not rebound")

    def value(self) -> science.Contact:
        """As the science takes it."""
        return science.Contact(**dict(self))


class FixedStep(RequestPart):
    """Real-time mode: every step takes the same, known time. Semi-implicit Euler, or Runge-Kutta of fourth order."""

    step: Seconds = Field(description="s")
    method: Literal["semi-implicit-euler", "rk4"] = "rk4"

    def value(self) -> science.FixedStep:
        """As the science takes it."""
        return science.FixedStep(self.step, self.method)


class StateRequest(DocumentPart):
    """A state, parameters and inputs."""

    q: Annotated[Any, COORDINATES] = Field(None, description="coordinates: a list, or an object by name; rad, m")
    qd: Annotated[Any, VELOCITIES] = Field(None, description="velocities, 0 by default; rad/s, m/s")
    parameters: Values = Field({}, description="in place of their defaults")
    inputs: Annotated[dict[str, Signal], INPUT_SIGNALS] = Field(
        {}, description="number, expression in q, q' and t, or table; N m or N"
    )


class SpanRequest(StateRequest):
    """A motion from a start over a span of time.

    At most one of ``times``, ``step`` and ``count`` says where results are wanted (default: 101 of equal distance).
    """

    span: Span = Field(description="s")
    times: Annotated[Annotated[Reals, Field(max_length=MAX_OUTPUTS)] | None, SECONDS] = Field(None, description="s")
    step: Seconds | None = Field(None, description="s")
    count: Annotated[int, Field(ge=2, le=MAX_OUTPUTS), NUMERIC] | None = None
    events: Annotated[tuple[Event, ...], Field(max_length=MAX_EVENTS)] = ()
    series: Annotated[dict[Name, PlainNumber], EXPRESSIONS] = Field(
        {}, max_length=MAX_EVENTS, description="expressions to be followed"
    )
    relative_tolerance: Annotated[Real, Field(ge=1e-14, le=1e-1)] = 1e-10
    absolute_tolerance: Annotated[Real, Field(ge=0, le=1e-1)] = 1e-12
    max_step: Seconds | None = Field(None, description="s")
    max_steps: Annotated[int, Field(ge=1, le=100_000_000), NUMERIC] = 1_000_000
    drift_limit: Positive = Field(1e-7, description="largest relative drift of first integrals of a right result")

    @model_validator(mode="after")
    def _inside(self) -> SpanRequest:
        checked(self.output_times)
        return self

    def output_times(self) -> OutputTimes:
        """The times where results are wanted."""
        return OutputTimes(self.span, OutputGrid(self.times, self.step, self.count))


class WithReactions(SpanRequest):
    """``reactions``: those of all joints, or of some, by coordinates and ``instance.base``."""

    reactions: bool | Annotated[tuple[str, ...], Field(min_length=1)] = Field(
        False, description="force and moment that joints transmit: of all, or of these"
    )


class WithPowers(WithReactions):
    """Also the ``powers`` of all."""

    powers: bool = Field(False, description="the power of every load and joint, and whether they add up to dT/dt")


class SimulationRequest(WithPowers):
    """q'' = g^-1 (Q - Gamma q' q') of a tree without closures."""

    method: Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA"] = "DOP853"
    fixed_step: FixedStep | None = None
    friction: Literal["regularised", "exact", "loaded"] = Field(
        "regularised",
        description="of joints: by the smooth law of the formulas, set-valued at rest, or smooth with their load",
    )
    geodesic: bool = Field(False, description="of the metric: a motion on which no force acts")
    contacts: Annotated[tuple[Contact, ...], Field(max_length=MAX_CONTACTS)] = Field(
        (), description="points that do not pass through planes, with impacts and Coulomb's friction"
    )


class LoopRequest(StateRequest):
    """Loops at a state. ``fixed`` coordinates keep their values while the loops are closed; ``prescribed`` coordinates
    move as given: a number, an expression in t, or a table.
    """

    t: Annotated[Real, SECONDS] = 0.0
    fixed: tuple[str, ...] = Field((), max_length=500)
    prescribed: Annotated[dict[str, Signal], COORDINATE_SIGNALS] = Field({}, description="by coordinate; rad or m")


Way = Annotated[list[Real], Field(max_length=10_000)]


class ReducedRequest(StateRequest):
    """Equations in independent coordinates: ``q`` and ``qd`` of these by name, numbers or lists of K. ``start``: near a
    closed position, from which it is followed; by default what the definitions say, as are ``independent`` and ranges.
    """

    t: Annotated[Real, SECONDS] = 0.0
    q: Annotated[dict[str, Real | Way], COORDINATES] = Field({}, description="independent coordinates; rad, m")
    qd: Annotated[dict[str, Real | Way], VELOCITIES] = Field({}, description="of these, 0 by default; rad/s, m/s")
    independent: tuple[str, ...] | None = Field(None, max_length=500, description="default: as the parts say")
    start: Annotated[dict[str, Real], COORDINATES] = Field({}, description="coordinates by name; rad, m")


class ClosedRequest(WithPowers):
    """A motion with closures from the closed state nearest to ``q``, ``qd``; see LoopRequest.

    ``reduction``: the state is projected onto the closures after every step, or independent coordinates are integrated.
    """

    fixed: tuple[str, ...] = Field((), max_length=500)
    prescribed: Annotated[dict[str, Signal], COORDINATE_SIGNALS] = Field({}, description="by coordinate; rad or m")
    method: Literal["DOP853", "RK45", "RK23", "Radau", "BDF"] = "DOP853"
    reduction: Literal["projection", "partitioning"] = "projection"
    friction: Literal["regularised", "exact"] = Field(
        "regularised", description="of joints: by the smooth law of the formulas, or set-valued at rest"
    )


class RollingRequest(WithReactions, VelocityConstraints):
    """A motion with velocity constraints from ``q`` and quasi-velocities ``v``, or velocities ``qd`` that meet them."""

    v: Annotated[Any, QUASI_VELOCITIES] = Field(
        None, description="quasi-velocities: a list, or an object by name; 0 by default"
    )
    method: Literal["DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA"] = "DOP853"
    form: Literal["voronets", "boltzmann-hamel"] = "voronets"


class AnySimulationRequest(RootModel[SimulationRequest | ClosedRequest | RollingRequest]):
    """With ``constraints``: velocity constraints; else of a tree with closures, or with ``prescribed`` coordinates;
    else of an open tree.
    """


class WithQuasiVelocities(VelocityConstraints):
    """Constraints with ``v`` at the start; those of the tree, and its closures, are there without being named."""

    v: Annotated[Any, QUASI_VELOCITIES] = Field(
        None, description="quasi-velocities, with constraints: a list, or an object by name; 0 by default"
    )


class SensitivityRequest(SimulationRequest, WithQuasiVelocities):
    """A simulation, and the parameters by which its motion is differentiated; with constraints in quasi-velocities."""

    by: tuple[str, ...] = Field((), description="parameters")
    of_start: bool = Field(False, description="also by coordinates and velocities at the start")
