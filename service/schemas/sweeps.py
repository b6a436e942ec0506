"""Shapes of the tables of sweeps, for OpenAPI."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from service.schemas.shapes import Links, Shape
from substructures.documents.fields import LibraryName


class RefusedRows(Shape):
    """Rows without numbers."""

    rows: int
    example: dict[str, Any] = Field(description="`row` and `message` of the first of them")


class TablePage(Shape):
    """Rows of a sweep that fit, and how far it is."""

    columns: list[str] = Field(description="names, in order: `row`, instances with a choice, samples, columns")
    items: list[dict[str, Any]] = Field(description="values by column, in SI")
    count: int = Field(description="rows of the whole table")
    rows: int = Field(description="rows of the sweep")
    done: int = Field(description="rows that were computed")
    finite: int = Field(description="rows that have numbers")
    kept: int = Field(description="rows that fit and are kept")
    proven: int = Field(description="rows that agree with their trees made the slow way")
    refused: dict[str, RefusedRows] = Field(description="rows without numbers by the code of the reason")
    state: str = Field(description="of the job")
    next_page_token: str | None
    links: Links


class Histogram(Shape):
    """How many rows are in each interval."""

    edges: list[float]
    counts: list[int]


class ColumnView(Shape):
    """How the values of a column are distributed."""

    column: str
    count: int
    mean: float | None
    deviation: float | None = Field(description="of a sample, by n - 1; null of one row")
    quantiles: dict[str, float]
    histogram: Histogram | None


class RowTree(Shape):
    """How the tree of a row is to be stored."""

    name: LibraryName | None = Field(None, description="default: the name of the template with the number of the row")
    visibility: Literal["public", "private"] | None = None
