"""Shapes of imported files, for OpenAPI."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from service.schemas.shapes import Shape


class RemarkView(Shape):
    """What became of something in the file."""

    place: str = Field(description="line and element")
    line: int = Field(description="from 1; 0 where the remark is about no line")
    element: str
    level: Literal["ignored", "merged", "warning"]
    check: Literal["schema", "topology", "physics"]
    message: str


class CheckView(Shape):
    """A tier of checks."""

    passed: bool
    warnings: int


class BindingView(Shape):
    """A binding that is no relation of a part: both are free here, coordinate = multiplier * of + offset."""

    coordinate: str
    of: str
    multiplier: float
    offset: float
    constraint: dict[str, str] = Field(description="velocity constraint; in a tree, with `instance.` before names")


class StoredView(Shape):
    """What was stored."""

    name: str
    version: int = Field(description="of the substructure, or revision of the tree")
    digest: str
    href: str


class PreviewView(Shape):
    """What would be stored."""

    picture: str = Field(description="SVG, at home")
    dof: int
    joints: str
    mass: float | None = Field(description="kg, at the default values of parameters")
    warnings: list[dict[str, Any]]


class ImportView(Shape):
    """A robot file, read: a definition, or a tree where the file has loops or is cut."""

    kind: str
    definition: dict[str, Any] | None = None
    tree: dict[str, Any] | None = None
    report: list[RemarkView]
    checks: dict[str, CheckView]
    names: dict[str, str] = Field(
        description="names in the file (of joints: 'joint NAME', with all their coordinates) and here"
    )
    bindings: list[BindingView]
    gravity: list[float] | None = Field(None, description="m/s^2; of the file, for the tree: a part has none")
    preview: PreviewView | None = None
    stored: StoredView | None = None
