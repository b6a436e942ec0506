"""Shapes of comparisons, for OpenAPI."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from service.schemas.shapes import Shape

Compared = str | dict[str, Any]


class EquivalenceRequest(Shape):
    """Two models: a reference, a definition, a tree, or ``{"file": text of a robot file, "kind": ...}``."""

    model_config = ConfigDict(extra="forbid")

    a: Compared
    b: Compared
    coordinates: dict[str, str] = Field({}, max_length=1000, description="names in a to names in b, where they differ")


class ComparedView(Shape):
    """A quantity of both."""

    formulas: bool | None = Field(None, description="the same functions of all parameters; null: not comparable")
    error: float = Field(description="relative difference of the numbers at random states")


class FirstDifferenceView(Shape):
    """Where numbers differ first; of coordinates their names."""

    quantity: str
    index: list[str] = Field(default_factory=list)
    a: Any
    b: Any
    at: dict[str, list[float]] = Field(default_factory=dict, description="the state")


class CulpritView(Shape):
    """A number of a body, or a law of a coordinate, that is not the same."""

    body: str
    parameter: str
    a: float | list[float]
    b: float | list[float]


class EquivalenceView(Shape):
    """Whether two models are the same."""

    equal: bool
    level: Literal["formulas", "values"]
    quantities: dict[str, ComparedView]
    first_difference: FirstDifferenceView | None
    culprits: list[CulpritView]
