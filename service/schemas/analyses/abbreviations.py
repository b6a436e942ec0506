"""Requests for abbreviated formulas; SI units, angles in rad."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from service.schemas.measured import RANGES, Values
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC
from substructures.export import FORMATS
from substructures.printers import FORMS


class AbbreviationRequest(DocumentPart):
    """What may be negligible, and where: every element of the quantity is wrong by at most ``simplify`` times its
    largest absolute value in the ranges.
    """

    quantity: str = Field(max_length=200, description="metric, gravity, bias, inverse_dynamics, ...")
    simplify: Annotated[float, Field(ge=0, lt=1, allow_inf_nan=False), NUMERIC] = Field(description="0.01: one percent")
    ranges: Annotated[dict[str, Any], RANGES] = Field(
        {},
        description="[lowest, highest] by name of a coordinate, velocity q', acceleration q'', input, parameter or t, "
        "numbers or texts such as -pi/2; 'coordinates', 'velocities', 'accelerations' for all others of a kind",
    )
    parameters: Values = Field({}, description="numbers in place of their defaults, of those that have no range")
    format: Literal[tuple(FORMATS)] | None = Field(None, description="of the formulas as text, beside the program")  # type: ignore[valid-type] # the words are those of the table
    form: Literal[FORMS] = Field(FORMS[0], description="of the formulas as text")  # type: ignore[valid-type] # likewise
