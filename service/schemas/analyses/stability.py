"""Questions about stability as they are asked: bodies of requests, items of jobs, documents on the command line; SI
units, angles in rad.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from service.schemas.analyses.velocity_constraints import VelocityConstraints
from service.schemas.measured import (
    ACCELERATIONS,
    BY_NAME,
    COORDINATES,
    EXPRESSIONS,
    METRES,
    MOMENTA_OF_COORDINATES,
    OF_PARAMETER,
    OF_STEADY,
    QUASI_VELOCITIES,
    RADIANS_PER_SECOND,
    SECONDS,
    VELOCITIES,
    Values,
)
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC, Name, PlainNumber, Positive, Real

States = Annotated[Any, COORDINATES]
#: by name, one number or one for each state
Columns = Annotated[dict[str, Any], BY_NAME]
Reach = Annotated[Positive, METRES]


class LinearisationRequest(VelocityConstraints):
    """A state, or states along a trajectory; ``qdd``: default that of the motion.

    With closures one state, which is moved onto them, and no ``qdd``. With ``constraints`` one motion, in
    quasi-velocities: ``v``, or ``qd`` that meets them, and no ``qdd``.
    """

    q: States
    qd: Annotated[Any, VELOCITIES] = None
    qdd: Annotated[Any, ACCELERATIONS] = None
    t: Annotated[Any, SECONDS] = 0
    parameters: Columns = Field({}, description="in place of their defaults; numbers, or one for each state")
    inputs: Columns = Field(
        {}, description="about which is linearised, by default their own, or 0; or one for each state"
    )
    outputs: Annotated[dict[str, PlainNumber], EXPRESSIONS] = Field(
        {}, max_length=1000, description="y: expressions in q, q', inputs and t"
    )
    of_inputs: tuple[str, ...] | None = Field(None, description="columns of B and D; default all inputs")
    v: Annotated[Any, QUASI_VELOCITIES] = Field(
        None, description="quasi-velocities, with constraints: a list, or an object by name; 0 by default"
    )


class LinearSystemRequest(DocumentPart):
    """One state of a tree without closures, about which it is linearised."""

    q: Annotated[Any, COORDINATES]
    qd: Annotated[Any, VELOCITIES] = None
    t: Annotated[Real, SECONDS] = 0.0
    parameters: Values = Field({}, description="in place of their defaults")
    inputs: Values = Field({}, description="about which is linearised; by default their own, or 0")
    of_inputs: tuple[str, ...] | None = Field(None, description="that act; default all inputs")


class FrequencyResponseRequest(LinearSystemRequest):
    """A state, frequencies and outputs."""

    frequencies: Annotated[tuple[Annotated[Real, Field(ge=0)], ...] | None, RADIANS_PER_SECOND] = Field(
        None, min_length=1, max_length=100_000, description="rad/s; by default about the poles"
    )
    outputs: Annotated[dict[str, PlainNumber], EXPRESSIONS] = Field(
        {}, max_length=1000, description="y: expressions in q, q', inputs and t; by default the coordinates"
    )


class RegulatorRequest(LinearSystemRequest):
    """An equilibrium, and what deviations and efforts cost."""

    weights: dict[str, Real] | None = Field(
        None, description="of squares of coordinates and velocities; by default 1 for coordinates"
    )
    efforts: dict[str, Real] | None = Field(None, description="of squares of inputs; by default 1")


class EquilibriaRequest(DocumentPart):
    """Where to look: ``starts`` (N, n), and ``count`` random ones in +-pi for angles, +-``reach`` for distances."""

    starts: States = None
    count: Annotated[int, Field(ge=0, le=10_000), NUMERIC] = 32
    reach: Reach = Field(1.0, description="m")
    seed: Annotated[int, Field(ge=0), NUMERIC] = 0
    t: Annotated[Real, SECONDS] = 0.0
    parameters: Values = Field({}, description="in place of their defaults")
    inputs: Values = Field({}, description="constant; by default their own, or 0")


class SteadyMotionsRequest(DocumentPart):
    """Either ``rates`` or ``momenta`` of cyclic coordinates; the search is that of equilibria.

    ``held``: what keeps its values when the motion is disturbed: momenta, or rates of coordinates that are driven.
    ``vary`` and ``between``: families over a parameter, a rate or a momentum, with their bifurcations.
    """

    rates: Annotated[dict[str, Real] | None, VELOCITIES] = Field(
        None, description="rad/s, m/s by coordinate; 0 for cyclic ones not named"
    )
    momenta: Annotated[dict[str, Real] | None, MOMENTA_OF_COORDINATES] = Field(
        None, description="N m s, N s by coordinate; 0 for cyclic ones not named"
    )
    held: Literal["momenta", "rates"] = "momenta"
    starts: States = None
    count: Annotated[int, Field(ge=0, le=10_000), NUMERIC] = 32
    reach: Reach = Field(1.0, description="m")
    seed: Annotated[int, Field(ge=0), NUMERIC] = 0
    parameters: Values = Field({}, description="in place of their defaults")
    inputs: Values = Field({}, description="constant; by default their own, or 0")
    vary: str | None = Field(None, description="of families: a parameter, or a coordinate that moves")
    between: Annotated[tuple[Real, Real] | None, OF_STEADY] = Field(
        None, description="of `vary`: the first and the last"
    )
    steps: Annotated[int, Field(ge=2, le=1000), NUMERIC] = Field(50, description="of a family over the range, at least")
    velocities: dict[Name, str] | None = Field(
        None, max_length=100, description="with velocity constraints: quasi-velocities, as of `velocity-equations`"
    )
    independent: tuple[str, ...] | None = Field(
        None, max_length=500, description="with velocity constraints: or the coordinates whose velocities they are"
    )
    precession: Annotated[Real | Literal["any"] | None, RADIANS_PER_SECOND] = Field(
        None, description="with ball joints: of all about the vertical, rad/s; `any` that keeps the `starts`"
    )


class RootLocusRequest(DocumentPart):
    """``parameter`` takes the ``values`` one after the other; ``q``: where the first equilibrium is near to."""

    parameter: str
    values: Annotated[tuple[Real, ...], Field(min_length=1, max_length=10_000), OF_PARAMETER]
    q: States
    parameters: Values = Field({}, description="of all others, in place of their defaults")
    inputs: Values = Field({}, description="constant; by default their own, or 0")
