"""Sets of states that a few words describe, as items of jobs give them: a grid, or a random sample."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, RootModel, Tag, model_validator

from service.schemas.shapes import Shape, refused

MAX_AXIS = 10_000
MAX_COUNT, MAX_SEED = 2**53, 2**64 - 1


def _finite(given: Any) -> float:
    try:
        value = math.nan if isinstance(given, bool | str) else float(given)
    except (TypeError, ValueError, OverflowError):
        value = math.nan
    if not math.isfinite(value):
        raise refused("number-expected", "a number is needed")
    return value


def _count(limit: int) -> BeforeValidator:
    def check(given: Any) -> Any:
        """The number, if it is within the limit."""
        if isinstance(given, bool) or not isinstance(given, int) or not 0 < given <= limit:
            raise refused("count", f"a whole number from 1 to {limit:,} is needed")
        return given

    return BeforeValidator(check)


def _seed(given: Any) -> Any:
    if isinstance(given, bool) or not isinstance(given, int) or not 0 <= given <= MAX_SEED:
        raise refused("seed", "a seed is a whole number from 0 to 2^64 - 1")
    return given


def _listed(given: Any) -> Any:
    if not 0 < len(given) <= MAX_AXIS:
        raise refused("axis", f"an axis has 1 to {MAX_AXIS:,} values")
    return given


def _pair(given: Any) -> Any:
    if not isinstance(given, list) or len(given) != 2:
        raise refused("range", "a range has two numbers")
    return given


def _ordered(given: tuple[float, float]) -> tuple[float, float]:
    if given[0] > given[1]:
        raise refused("range", f"{given[0]:g} is above {given[1]:g}")
    _near(*given)
    return given


def _near(low: float, high: float) -> None:
    if not math.isfinite(high - low):
        raise refused("range", f"{low:g} and {high:g} are further apart than the largest number")


def _object(given: Any) -> Any:
    if not isinstance(given, Mapping):
        raise refused("object-expected", "an object of ranges by name is needed")
    return given


FiniteNumber = Annotated[float, BeforeValidator(_finite)]
Range = Annotated[tuple[FiniteNumber, FiniteNumber], BeforeValidator(_pair), AfterValidator(_ordered)]


class AxisSpan(Shape):
    """``count`` values of an axis at equal distances, both ends included."""

    start: FiniteNumber = Field(alias="from")
    stop: FiniteNumber = Field(alias="to")
    count: Annotated[int, _count(MAX_AXIS)]

    def values(self) -> list[float]:
        """All of them."""
        return [float(x) for x in np.linspace(self.start, self.stop, self.count)]

    @model_validator(mode="before")
    @classmethod
    def _has_all(cls, given: Any) -> Any:
        if given.keys() != {"from", "to", "count"}:
            raise refused("axis", "an axis has 'from', 'to' and 'count'")
        return given

    @model_validator(mode="after")
    def _is_finite(self) -> Self:
        _near(self.start, self.stop)
        return self


def _kind(given: Any) -> str:
    return "span" if isinstance(given, Mapping) else "values" if isinstance(given, list) else "value"


Axis = Annotated[
    Annotated[AxisSpan, Tag("span")]
    | Annotated[list[FiniteNumber], BeforeValidator(_listed), Tag("values")]
    | Annotated[FiniteNumber, Tag("value")],
    Discriminator(_kind),
]


class Grid(RootModel[dict[str, Axis]]):
    """All combinations of the values of axes, by the name of a coordinate, velocity, parameter or input."""

    def axes(self) -> list[tuple[str, list[float]]]:
        """Name and values of every axis, in the order given."""
        return [(name, _values(axis)) for name, axis in self.root.items()]


def _values(axis: AxisSpan | list[float] | float) -> list[float]:
    if isinstance(axis, AxisSpan):
        return axis.values()
    return axis if isinstance(axis, list) else [axis]


class Sample(Shape):
    """``count`` states, uniform in ranges by name."""

    count: Annotated[int, _count(MAX_COUNT)]
    seed: Annotated[int, BeforeValidator(_seed)] = 0
    ranges: Annotated[dict[str, Range], BeforeValidator(_object)] = Field(default_factory=dict)

    @model_validator(mode="before")
    @classmethod
    def _has_no_more(cls, given: Any) -> Any:
        if not given.keys() <= {"count", "seed", "ranges"}:
            raise refused("sample", "a sample has 'count', 'seed' and 'ranges'")
        return given
