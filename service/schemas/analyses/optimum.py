"""Best parameters as they are asked for: SI units, angles in rad."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from service.schemas.measured import BY_NAME
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC, Name, Real
from substructures.ensembles.motion_column import MOST_COLUMNS
from substructures.sweeps.document import Column


class OptimalParametersRequest(DocumentPart):
    """The least of ``minimise``, an expression in ``columns`` (as of a sweep) and in what varies, within bounds."""

    vary: Annotated[dict[str, tuple[Real, Real]], BY_NAME] = Field(
        min_length=1, max_length=50, description="lowest and highest value by parameter"
    )
    minimise: str = Field(max_length=2000, description="an expression in columns and in parameters that vary")
    columns: dict[Name, Column] = Field({}, max_length=MOST_COLUMNS, description="as of a sweep, by name")
    where: str = Field("", max_length=2000, description="comparisons that have to hold, joined by `and`")
    parameters: Annotated[dict[str, Real], BY_NAME] = Field({}, description="the others, in place of their defaults")
    starts: Annotated[int, Field(ge=1, le=64), NUMERIC] = 8
    seed: Annotated[int, Field(ge=0, lt=2**53), NUMERIC] = 0
