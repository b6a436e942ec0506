"""States and measured motions as they are sent to analyses; SI units, angles in rad."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, Field, model_validator

from service.schemas.measured import ACCELERATIONS, BY_NAME, COORDINATES, EFFORTS_OF_ACTUATORS, VELOCITIES
from service.schemas.shapes import refused
from substructures.analysis.identification.fit import ERROR_LIMIT
from substructures.documents import DocumentPart
from substructures.documents.schema import read_model
from substructures.errors import InvalidDocument, InvalidInput
from substructures.formats.logs import MEASURED, motion_of

UNPACKED = 2**26  # bytes of a log


class CurvatureRequest(DocumentPart):
    """States."""

    q: Annotated[Any, COORDINATES] = Field(description="(n,), (N, n) or columns by name; rad, m")
    parameters: Annotated[dict[str, Any], BY_NAME] = Field({}, description="in place of their defaults")


Drive = Literal["armature", "viscous", "coulomb", "offset"]


class Log(DocumentPart):
    """A measured motion as a file: columns ``arm.q1 [deg]``, ``arm.q1'`` (velocity), ``arm.q1''``, ``tau.arm.q1``."""

    csv: str | None = Field(None, description="a line of names, then numbers; separated by commas, semicolons or tabs")
    npz: str | None = Field(None, description="base64 of a file of numpy arrays")
    arrow: str | None = Field(None, description="base64 of an Arrow stream")
    columns: dict[str, str] = Field(
        {}, description="what columns are that are called otherwise, as ``arm.q1 [deg]``; then no others are read"
    )

    @model_validator(mode="after")
    def _one(self) -> Self:
        if sum(text is not None for text in self.files().values()) != 1:
            raise refused("one-source", "give one of 'csv', 'npz', 'arrow'")
        return self

    def files(self) -> dict[str, str | None]:
        """What there is, by its form."""
        return {"csv": self.csv, "npz": self.npz, "arrow": self.arrow}

    def motion(self) -> dict[str, Any]:
        """The columns as members of a request. Raises InvalidDocument, TooLarge."""
        form, text = next((form, text) for form, text in self.files().items() if text is not None)
        return motion_of(form, text, self.columns, UNPACKED)


def without_log(schema: type[BaseModel], body: Mapping[str, Any]) -> Mapping[str, Any]:
    """A request of a schema, whose members are what stands in its log, if it has one; a log may tell more.

    Raises InvalidDocument, TooLarge.
    """
    if body.get("log") is None:
        return body
    twice = [name for name in MEASURED if body.get(name) is not None]
    if twice:
        raise InvalidDocument.at(f"/{twice[0]}", "given-twice", f"'{twice[0]}' is given, and a log, too")
    try:
        found = read_model(Log, body["log"]).motion()
    except InvalidInput as error:
        raise error.below("/log") from None
    members = {name: x for name, x in found.items() if name in schema.model_fields}
    return {**{name: x for name, x in body.items() if name != "log"}, **members}


class ExcitationRequest(DocumentPart):
    """A motion: how well does it show the base parameters?"""

    log: Log | None = Field(None, description="the motion as a file, in place of ``q, qd, qdd, tau``")
    q: Annotated[Any, COORDINATES] = Field(None, description="(N, n) or columns by name; rad, m")
    qd: Annotated[Any, VELOCITIES] = Field(None, description="rad/s, m/s")
    qdd: Annotated[Any, ACCELERATIONS] = Field(None, description="rad/s^2, m/s^2")
    parameters: Annotated[dict[str, Any], BY_NAME] = Field({}, description="kinematic ones, in place of their defaults")
    drives: tuple[Drive, ...] = Field((), description="columns of drives that are taken along")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        needed = [name for name in MEASURED if name in type(self).model_fields and name != "qd"]
        missing = [name for name in needed if getattr(self, name) is None]
        if missing:
            raise refused("no-motion", f"'{missing[0]}' is needed, here or as columns of 'log'", f"/{missing[0]}")
        return self


class IdentificationRequest(ExcitationRequest):
    """A measured motion."""

    tau: Annotated[Any, EFFORTS_OF_ACTUATORS] = Field(None, description="forces of the actuators, as q; N m, N")
    known: bool = Field(True, description="the tree's springs, dampers, loads and armatures act and are known")
    held_out: float = Field(
        0, ge=0, lt=1, description="part of the samples, the last, that is predicted and not fitted"
    )
    consistent: bool = Field(
        False, description="also inertia of every body that a mass distribution has, and new parts"
    )
    prior_deviation: float = Field(
        1,
        gt=0,
        allow_inf_nan=False,
        description="relative deviation of the inertia that the tree has, where consistent",
    )
    error_limit: float = Field(
        ERROR_LIMIT,
        gt=0,
        allow_inf_nan=False,
        description="part of the force of a joint that may be unexplained or uncertain in a right result",
    )
