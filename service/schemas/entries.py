"""What a document that is submitted says beside what is derived from it: members of the same JSON object."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import ConfigDict, Field

from service.schemas.shapes import Shape
from substructures.documents import read_model
from substructures.part.definition import Definition
from substructures.tree.document import TreeSpec

Visibility = Literal["public", "private"]
VISIBILITY = "who sees the name: everybody (the default of a new name), or the keys of its owner"


class Entry(Shape):
    """What is no part of the content, and so not of its digest."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    visibility: Visibility | None = None

    @classmethod
    def parted(cls, document: Any) -> tuple[Entry, Any]:
        """The entry of a document, and the document without it. Raises InvalidDocument."""
        if not isinstance(document, Mapping):
            return cls(), document
        given = {name: document[name] for name in cls.model_fields if name in document}
        return read_model(cls, given), {name: value for name, value in document.items() if name not in given}


PLAIN = Entry()  # nothing is said


class SubmittedDefinition(Definition):
    """A definition as it is sent."""

    visibility: Visibility = Field("public", description=VISIBILITY)


class SubmittedTree(TreeSpec):
    """A tree as it is sent."""

    visibility: Visibility = Field("public", description=VISIBILITY)


class VisibilityRequest(Shape):
    """Who shall see a name."""

    visibility: Visibility


class OwnershipView(Shape):
    """Whose a name is, and who sees it."""

    name: str
    owner: str
    visibility: Visibility
