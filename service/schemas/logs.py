"""Measured motions as files in requests: what stands in them is the members of the request."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

from pydantic import Field, model_validator

from service.schemas.shapes import refused
from substructures.documents import DocumentPart
from substructures.documents.schema import read_model
from substructures.errors import Fault, InvalidDocument, InvalidInput
from substructures.formats.logs import MEASURED, motion_of

UNPACKED = 2**26  # bytes of a log


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


class Logged(DocumentPart):
    """A request about a measured motion."""

    log: Log | None = Field(None, description="the motion as a file, in place of ``q, qd, qdd, tau``")

    @classmethod
    def unfolded(cls, body: Mapping[str, Any]) -> Mapping[str, Any]:
        """The body of a request, whose members are what stands in its log, if it has one; a log may tell more.

        Raises InvalidDocument, TooLarge.
        """
        if body.get("log") is None:
            found, rest = {}, dict(body)
        else:
            found, rest = _motion(body), {name: x for name, x in body.items() if name != "log"}
        return rest | {name: x for name, x in found.items() if name in cls.model_fields}

    def require_motion(self) -> None:
        """Raises InvalidDocument where a member that is needed stood nowhere."""
        needed = [name for name in MEASURED if name in type(self).model_fields and name != "qd"]
        missing = [name for name in needed if getattr(self, name) is None]
        message = "is needed, here or as columns of 'log'"
        if missing:
            raise InvalidDocument(Fault(f"/{name}", "missing", f"'{name}' {message}") for name in missing)


def _motion(body: Mapping[str, Any]) -> dict[str, Any]:
    """The members in the log of a request. Raises InvalidDocument, TooLarge."""
    twice = [name for name in MEASURED if body.get(name) is not None]
    if twice:
        raise InvalidDocument.at(f"/{twice[0]}", "given-twice", f"'{twice[0]}' is given, and a log, too")
    try:
        return read_model(Log, body["log"]).motion()
    except InvalidInput as error:
        raise error.below("/log") from None
