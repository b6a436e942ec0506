"""Reports as they are answered in JSON; indices count from 0 in lists, from 1 in sentences."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, Field


class ReportFigure(BaseModel):
    """A number that carries a sentence."""

    name: str
    value: float
    unit: str


class ReportStatement(BaseModel):
    """A sentence about the formulas, what it is about, and the numbers that carry it."""

    about: Literal["metric", "christoffel", "forces", "symmetries", "rest", "parameters", "omissions", "singular"]
    code: str = Field(
        description="constant, zero, coordinate, equal, blocks; independent, no-velocity-forces, "
        "no-centrifugal-forces, not-stored; acting; cyclic, energy, symmetry, linear_momentum, angular_momentum, none, "
        "not-searched; searched, held, asymptotically-stable, stable, undecided, unstable, failed; "
        "lowest-frequency, largest-element, potential-range, not-ranked; may-be-zero, not-looked-for; singular, regular"
    )
    text: str
    entries: list[list[int]] = Field(description="elements of the array, from 0")
    coordinates: list[str]
    figures: list[ReportFigure]
    request: str = Field(description="method and path that tell more; empty for a part alone")


class ReportTerm(BaseModel):
    """A term of the textbook form of an element."""

    formula: str
    largest_share: float = Field(description="of the sum of the absolute values of all terms, over the states")
    is_small: bool = Field(description="below the threshold in all states")


class ReportElement(BaseModel):
    """An element of the metric with several terms, the largest first."""

    entry: list[int]
    terms: list[ReportTerm]


class ReportSizes(BaseModel):
    """How large the terms of the metric are at the default values of the parameters."""

    threshold: float
    states: int
    ranges: dict[str, list[float]] = Field(
        description="in which coordinates were sampled: limits, or [-pi, pi], [-1, 1]"
    )
    entries: list[ReportElement]
    reason: str | None = Field(description="why there are none")


class ReportCoordinate(BaseModel):
    """A coordinate; `called`: its name in formulas for people."""

    name: str
    called: str
    joint: str
    unit: str
    low: float | None
    high: float | None


class ReportSymbol(BaseModel):
    """A symbol of the formulas with its default value in SI."""

    name: str
    called: str
    kind: str
    unit: str
    value: float | None
    description: str


class ReportSource(BaseModel):
    """Where a part comes from."""

    instance: str
    name: str
    title: str
    source: str
    license: str


class ReportView(BaseModel):
    """What can be said of a part or a tree."""

    name: str
    title: str
    description: str
    digest: str
    notes: list[str] = Field(description="what was assumed")
    dof: int
    indices_from: Literal[0]
    coordinates: list[ReportCoordinate]
    symbols: list[ReportSymbol]
    statements: list[ReportStatement]
    sizes: ReportSizes
    sources: list[ReportSource]
