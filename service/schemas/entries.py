"""What a document that is submitted says beside what is derived from it: members of the same JSON object."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field

from service.schemas.shapes import Shape
from substructures.documents import read_model
from substructures.documents.fields import Name, Number, NumberVector, Words
from substructures.part.definition import Definition, Input, Parameter, Placement
from substructures.tree.document import FRAME, MOUNT, REFERENCE, Driven, TreeSpec
from substructures.tree.given.ties import MAX_CONTACTS, ConstraintOfTree, ContactOfTree

Visibility = Literal["public", "private"]
VISIBILITY = "who sees the name: everybody (the default of a new name), or the keys of its owner"
NOTE = "why it is submitted, in words; kept with the version or revision that it becomes"
DERIVED_FROM = "reference to the version that it was made from"


#: a coordinate of a tree
Place = Annotated[str, Field(pattern=FRAME)]


class Entry(Shape):
    """What is no part of the content, and so not of its digest."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    visibility: Visibility | None = None
    note: Words | None = Field(None, max_length=2000)

    @classmethod
    def parted(cls, document: Any) -> tuple[Self, Any]:
        """The entry of a document, and the document without it. Raises InvalidDocument."""
        if not isinstance(document, Mapping):
            return cls(), document
        given = {name: document[name] for name in cls.model_fields if name in document}
        return read_model(cls, given), {name: value for name, value in document.items() if name not in given}


class PartEntry(Entry):
    """Of a definition."""

    derived_from: str | None = Field(None, pattern=REFERENCE)


PLAIN = PartEntry()  # nothing is said


class SubmittedDefinition(Definition):
    """A definition as it is sent."""

    visibility: Visibility = Field("public", description=VISIBILITY)
    note: Words = Field("", max_length=2000, description=NOTE)
    derived_from: str | None = Field(None, pattern=REFERENCE, description=DERIVED_FROM)


class SubmittedTree(TreeSpec):
    """A tree as it is sent."""

    visibility: Visibility = Field("public", description=VISIBILITY)
    note: Words = Field("", max_length=2000, description=NOTE)


class ChangedInstance(Shape):
    """Members of an instance that take the place of its own; null leaves one out."""

    substructure: Annotated[str, Field(pattern=REFERENCE)] | None = None
    definition: Definition | None = None
    at: str | None = Field(None, pattern=MOUNT)
    placement: Placement | None = None
    parameters: dict[Name, Number] | None = Field(None, max_length=5000)
    level: Literal["full", "reduced"] | None = None


class ChangedTree(Shape):
    """Members of a tree that take the place of its own; null leaves one out."""

    gravity: NumberVector | None = Field(None, description="gravity acceleration in world axes, m/s^2")
    parameters: dict[Name, Parameter] | None = Field(None, max_length=5000)
    inputs: dict[Name, Input] | None = Field(None, max_length=500)
    driven: dict[Place, Driven] | None = Field(None, max_length=5000)
    ignored: dict[Place, Number] | None = Field(None, max_length=5000)
    velocity_constraints: tuple[ConstraintOfTree, ...] | None = Field(None, max_length=100)
    contacts: tuple[ContactOfTree, ...] | None = Field(None, max_length=MAX_CONTACTS)


class VisibilityRequest(Shape):
    """Who shall see a name."""

    visibility: Visibility


class OwnershipView(Shape):
    """Whose a name is, and who sees it."""

    name: str
    owner: str
    visibility: Visibility
