"""Shape of the request that makes a part of a tree."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from service.schemas.entries import DERIVED_FROM, NOTE, VISIBILITY, Visibility
from service.schemas.resources import VersionView
from service.schemas.shapes import Shape
from substructures.documents.fields import LibraryName, Name, Number, TagName, Words
from substructures.loads.document import FrameOfTree
from substructures.tree.document import REFERENCE

ParameterOfTree = Annotated[str, Field(max_length=129)]


class PublishRequest(Shape):
    """What the part is to be; nothing has to be said."""

    name: LibraryName | None = Field(None, description="of the part (default: that of the tree)")
    title: Words = Field("", max_length=200)
    description: Words = Field("", max_length=20_000)
    tags: list[TagName] = Field([], max_length=32)
    license: Words = Field("", max_length=200)
    source: Words = Field("", max_length=4000)
    ports: dict[Name, FrameOfTree] | None = Field(
        None, description="by name of the port instance.port or instance.body (default: all ports of all instances)"
    )
    free: list[ParameterOfTree] = Field(
        [], max_length=5000, description="parameters that are bound to a number or have none, and shall be free"
    )
    defaults: dict[ParameterOfTree, Number] = Field({}, max_length=5000, description="new defaults of free parameters")
    visibility: Visibility | None = Field(None, description=f"{VISIBILITY}; of a private tree those of its owner")
    note: Words = Field("", max_length=2000, description=NOTE)
    derived_from: str | None = Field(None, pattern=REFERENCE, description=DERIVED_FROM)

    def about(self) -> dict[str, Any]:
        """What is said of the part, in its definition."""
        names = ("title", "description", "tags", "license", "source")
        return {name: value for name in names if (value := getattr(self, name))}


class PublishedView(VersionView):
    """The version that a tree became."""

    names: dict[str, str] = Field(description="what things are called in the tree, and in the part")
