"""Ensembles as they are asked for: many motions of one tree."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, SkipValidation, model_validator

from service.schemas.analyses.motions import (
    MAX_CONTACTS,
    MAX_EVENTS,
    Contact,
    Event,
    Reals,
    Seconds,
    Span,
    WithQuasiVelocities,
    checked,
)
from service.schemas.measured import SECONDS, WithUnits
from service.schemas.numbers import StateColumns, ValueColumns
from substructures.analysis.motion.problems.output_times import MAX_OUTPUTS, OutputGrid, OutputTimes
from substructures.documents.fields import NUMERIC, Name, Positive, Real
from substructures.ensembles.motion_column import MOST_COLUMNS, MotionColumn
from substructures.ensembles.samples import Samples

InputColumns = Annotated[dict[str, float | list[float] | str], SkipValidation, WithUnits()]


class EnsembleRequest(WithQuasiVelocities):
    """Motions from many starts, with many parameters: lists of M, or ``samples`` of any of them. Each has its own steps
    and its own verdict. With constraints they are in quasi-velocities ``v``, (p,) or (M, p), or by name.

    ``columns``: what a motion is worth; without them the states are in the answer. At most one of ``times``, ``step``
    and ``count`` says at which times the columns and states are (default: 101 of equal distance).
    """

    q: StateColumns = Field(None, description="(n,) for all, (M, n), or columns by name; rad, m")
    qd: StateColumns = Field(None, description="velocities, 0 by default; rad/s, m/s")
    parameters: ValueColumns = Field(default_factory=dict, description="one, or one for every member")
    inputs: InputColumns = Field(
        default_factory=dict, description="one, one for every member, or an expression in q, q' and t; N m or N"
    )
    samples: Samples | None = Field(None, description="coordinates, velocities (`arm.q1'`), parameters, inputs by name")
    span: Span = Field(description="s")
    times: Annotated[Annotated[Reals, Field(max_length=MAX_OUTPUTS)] | None, SECONDS] = Field(None, description="s")
    step: Seconds | None = Field(None, description="s")
    count: Annotated[int, Field(ge=2, le=MAX_OUTPUTS), NUMERIC] | None = None
    columns: dict[Name, MotionColumn] = Field(default_factory=dict, max_length=MOST_COLUMNS)
    events: Annotated[tuple[Event, ...], Field(max_length=MAX_EVENTS)] = Field(
        (), description="of every member, which is computed by itself then, as with contacts"
    )
    contacts: Annotated[tuple[Contact, ...], Field(max_length=MAX_CONTACTS)] = Field(
        (), description="points that do not pass through planes, with impacts and Coulomb's friction"
    )
    states: bool | None = Field(None, description="whether q and qd are in the answer (default: without columns)")
    method: Literal["DOP853", "RK45", "RK23"] = "DOP853"
    relative_tolerance: Annotated[Real, Field(ge=1e-14, le=1e-1)] = 1e-8
    absolute_tolerance: Annotated[Real, Field(ge=0, le=1e-1)] = 1e-10
    max_step: Seconds | None = Field(None, description="s")
    max_steps: Annotated[int, Field(ge=1, le=100_000_000), NUMERIC] = 1_000_000
    drift_limit: Positive = Field(1e-6, description="largest relative drift of first integrals of a right motion")

    @model_validator(mode="after")
    def _inside(self) -> EnsembleRequest:
        checked(lambda: OutputTimes(self.span, self.grid()))
        return self

    def grid(self) -> OutputGrid:
        """Where columns and states are wanted."""
        return OutputGrid(self.times, self.step, self.count)

    def members(self) -> dict[str, Any]:
        """Arguments that may be one for every member."""
        return {name: getattr(self, name) for name in ("q", "qd", "v", "parameters", "inputs")}
