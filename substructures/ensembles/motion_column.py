"""The document of a column of an ensemble: what is taken of a motion."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import DocumentPart
from substructures.documents.fields import PlainNumber

MOST_COLUMNS = 100
#: what becomes of the values at all times; the integral is one over the time of the motion
Take = Literal["end", "largest", "smallest", "largest_absolute", "mean", "rms", "integral"]


class MotionColumn(DocumentPart):
    """A number of a motion: an ``expression`` in coordinates, velocities, parameters, inputs and t, or a ``quantity``
    (and which element of it, ``of``), and what to ``take`` of its values at all times, or its ``integral`` over the
    time, with the tolerances of the motion.
    """

    expression: PlainNumber | None = None
    quantity: str | None = None
    of: str | list[str] | None = None
    take: Annotated[Take, Field(description="of the values at all times")] = "end"

    @model_validator(mode="after")
    def _one(self) -> MotionColumn:
        if (self.expression is None) == (self.quantity is None):
            raise PydanticCustomError("one-source", "give either 'expression' or 'quantity'")
        if self.take == "integral" and self.expression is None:
            raise PydanticCustomError("no-integrand", "an 'integral' is one of an 'expression'")
        return self
