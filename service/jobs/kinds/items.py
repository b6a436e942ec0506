"""What the items of a job are, kind by kind, as they are given: names, types, and what goes together."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import BaseModel, Field, StrictBool, model_validator

from service.models.exporting import ALL_TARGETS, FMI, NAME, PRECISIONS, STANDARDS, misplaced
from service.models.formulas import WITH_DOCUMENT
from service.models.numbers import ANALYSES
from service.schemas.shapes import one_of, refused
from substructures.documents.fields import DocumentPart
from substructures.export import FORMATS
from substructures.formats import arrays, arrow
from substructures.printers.render import FORMS

#: what the states of an evaluation can be written as
STATES = {"npz": arrays.MEDIA_TYPE, "arrow": arrow.MEDIA_TYPE}
Document = dict[str, Any]
Documents = Annotated[list[Document], Field(min_length=1)]


def members(item: BaseModel) -> Document:
    """The members of an item that say something, their values as they were given."""
    return {name: value for name, value in item if value is not None}


class Stored(DocumentPart):
    """Of ``verify`` and ``upgrade``: one part or tree, or ``*``."""

    substructure: str | None = None
    tree: str | None = None

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.substructure is None) == (self.tree is None):
            raise refused("one-source", "give either 'substructure' or 'tree'", "/substructure")
        return self


class Compared(DocumentPart):
    """Of ``compare``: two models, or one and many; each a reference or a document."""

    a: str | Document
    b: str | Document | Annotated[list[str | Document], Field(min_length=1)]
    coordinates: dict[str, str] = Field(default_factory=dict)


class Evaluated(DocumentPart):
    """Of ``evaluate``: the body of an evaluation, whose states may be described by a grid or a sample."""

    tree: str
    request: Document
    grid: Annotated[Document, Field(min_length=1)] | None = None
    sample: Document | None = None
    format: Annotated[str, one_of("format", lambda: tuple(STATES))] = "npz"

    @model_validator(mode="after")
    def _one_source_of_states(self) -> Self:
        described = (self.grid is not None) + (self.sample is not None)
        if described + ("q" in self.request) > 1 or (described and "qd" in self.request):
            raise refused("states", "states come from 'q' and 'qd', or a 'grid', or a 'sample'", "/request")
        return self


class Requested(DocumentPart):
    """Of ``simulate`` and ``optimise``: the body of an analysis, or several."""

    tree: str
    request: Document | None = None
    requests: Documents | None = None
    format: str = "json"

    @model_validator(mode="after")
    def _one(self) -> Self:
        if (self.request is None) == (self.requests is None):
            raise refused("one-source", "give either 'request' or 'requests'", "/request")
        return self


class Analysed(Requested):
    """Of ``analyse``, which names the analysis."""

    analysis: Annotated[str, one_of("analysis", lambda: tuple(ANALYSES))]


class Written(DocumentPart):
    """Of ``export``: a quantity of a tree as text."""

    tree: str
    quantity: str
    format: Annotated[str, one_of("format", lambda: tuple(FORMATS))]
    form: Annotated[str, one_of("form", lambda: FORMS)] = FORMS[0]
    bind: str = ""
    options: dict[str, list[str]] = Field(default_factory=dict)
    name: str = NAME
    group: StrictBool = False
    request: Document | None = None

    @model_validator(mode="after")
    def _fits(self) -> Self:
        takes = self.quantity in tuple(WITH_DOCUMENT)
        if takes and self.request is None:
            raise refused("no-request", "'request' is needed", "/request")
        if self.request is not None and not takes:
            raise refused("unknown-field", f"'{self.quantity[:80]}' takes no 'request'", "/request")
        return self


class Packed(DocumentPart):
    """Of ``export``: a tree or a part as the files of a target."""

    tree: str | None = None
    substructure: str | None = None
    target: Annotated[str, one_of("target", lambda: ALL_TARGETS)]
    quantities: list[str] = Field(default_factory=list)
    name: str = ""
    bind: str = ""
    together: StrictBool = False
    packed: StrictBool = False
    fmi: Annotated[str, one_of("value", lambda: FMI)] = FMI[0]
    precision: Annotated[str, one_of("value", lambda: PRECISIONS)] = PRECISIONS[0]
    ranges: str = ""
    stages: StrictBool = False
    standard: Annotated[str, one_of("value", lambda: STANDARDS)] = STANDARDS[0]
    independent: list[str] = Field(default_factory=list)

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if (self.substructure is None) == (self.tree is None):
            raise refused("one-source", "give either 'tree' or 'substructure'", "/tree")
        field = misplaced(self.target, members(self))
        if field is not None:
            raise refused("not-of-target", f"target={self.target} does not take '{field}'", f"/{field}")
        return self


class Mirrored(DocumentPart):
    """Of ``mirror``: the address of another instance."""

    source: str
