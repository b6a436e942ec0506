"""The JSON form of a sweep (the HTTP contract, section on sweeps)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import DocumentPart
from substructures.documents.fields import NAME, unit_of

#: rows of one sweep
MOST_ROWS = 10**8
#: rows that a table may keep where ``keep`` does not say fewer
MOST_KEPT = 10**7
MOST_COLUMNS = 100

Values = Annotated[list[float], Field(min_length=1, max_length=1_000_000)]
ColumnName = Annotated[str, Field(pattern=NAME)]
Take = Literal["value", "largest", "smallest", "largest_absolute", "mean", "rms"]
OfModes = Literal["lowest_frequency", "highest_frequency", "least_damping", "largest_real_part", "is_stable"]


class Distribution(DocumentPart):
    """What values a parameter takes: ``values``, or ``uniform`` between two, or ``normal`` (mean, deviation).

    ``count``: of a grid, points from end to end of ``uniform``, or quantiles of ``normal``; ``unit``: of the numbers,
    SI if left out.
    """

    values: Values | None = None
    uniform: tuple[float, float] | None = None
    normal: tuple[float, Annotated[float, Field(ge=0)]] | None = None
    count: Annotated[int, Field(ge=1, le=MOST_ROWS)] | None = None
    unit: Annotated[str, Field(max_length=64)] = ""

    @field_validator("unit")
    @classmethod
    def _known(cls, unit: str) -> str:
        if unit:
            unit_of(unit)
        return unit

    @property
    def factor(self) -> float:
        """What its numbers are multiplied by in SI."""
        return unit_of(self.unit).scale if self.unit else 1.0

    @model_validator(mode="after")
    def _one(self) -> Distribution:
        if sum(each is not None for each in (self.values, self.uniform, self.normal)) != 1:
            raise PydanticCustomError("one-distribution", "give one of 'values', 'uniform' and 'normal'")
        if self.values is not None and self.count is not None:
            raise PydanticCustomError("counted-twice", "'values' are as many as they are: leave 'count' out")
        return self


class Samples(DocumentPart):
    """Numbers of parameters for each combination of parts.

    ``grid``: all values of each with all of the others; ``list``: the first of each together, then the second, ...;
    the others draw ``count`` rows from the distributions, the same ones for the same ``seed``.
    """

    method: Literal["grid", "list", "random", "sobol", "latin-hypercube"] = "grid"
    count: Annotated[int, Field(ge=1, le=MOST_ROWS)] | None = None
    seed: Annotated[int, Field(ge=0, lt=2**53)] = 0
    of: dict[str, Distribution] = Field(min_length=1, max_length=1000)

    @model_validator(mode="after")
    def _has_counts(self) -> Samples:
        drawn = self.method not in ("grid", "list")
        if drawn and self.count is None:
            raise PydanticCustomError("missing-count", f"samples by '{self.method}' need a 'count'")
        if not drawn and self.count is not None:
            raise PydanticCustomError("counted-twice", f"a {self.method} has the counts of its values: no 'count' here")
        for name, each in self.of.items():
            if drawn and each.count is not None:
                raise PydanticCustomError("counted-twice", f"'{name}': 'count' stands beside 'method'")
            if self.method == "grid" and each.values is None and each.count is None:
                raise PydanticCustomError("missing-count", f"'{name}' needs a 'count' in a grid")
            if self.method == "list" and each.values is None:
                raise PydanticCustomError("missing-values", f"'{name}' needs 'values' in a list")
        if self.method == "list" and len({len(each.values or ()) for each in self.of.values()}) > 1:
            raise PydanticCustomError("lengths", "the lists of values differ in length")
        return self


class QuantityColumn(DocumentPart):
    """A number of a quantity (``inverse_dynamics``, ``mass_centre.position``) at states ``over``, for each row.

    ``of``: which element, by the names of its axes; left out: all of them. ``over``: arguments of an evaluation (``q``,
    ``qd``, ``qdd``, ``inputs``, ``t``), for one state or many. ``take``: what becomes of several numbers.
    """

    quantity: str
    of: str | list[str] | None = None
    over: dict[str, Any] = Field(default_factory=dict)
    take: Take | None = None


class LinearColumn(DocumentPart):
    """What the linearisation about an equilibrium tells: frequencies [rad/s], damping ratio, whether it is stable.

    ``held``: constant forces of the joints make the state one; without them rows in which it is none have no number.
    """

    analysis: Literal["linearisation"]
    at: dict[str, Any] = Field(default_factory=dict)
    held: bool = False
    take: OfModes = "lowest_frequency"


Column = str | LinearColumn | QuantityColumn


class Pareto(DocumentPart):
    """The columns to be minimised and maximised: rows that no other beats in all of them are on the front."""

    minimise: tuple[ColumnName, ...] = ()
    maximise: tuple[ColumnName, ...] = ()

    @model_validator(mode="after")
    def _some(self) -> Pareto:
        if not self.minimise and not self.maximise:
            raise PydanticCustomError("no-columns", "name columns to 'minimise' or to 'maximise'")
        return self


class Query(DocumentPart):
    """Parts of the catalogue: those that a search with these filters finds."""

    q: str = ""
    tag: str | None = None
    dof: int | None = None
    joints: str | None = None


class Choice(DocumentPart):
    """What stands in the place of an instance: fields of an instance of a tree that replace those of the template."""

    substructure: str | None = None
    query: Query | None = None
    at: str | None = None
    placement: dict[str, Any] | None = None
    parameters: dict[str, Any] | None = None

    @model_validator(mode="after")
    def _one(self) -> Choice:
        if self.substructure is not None and self.query is not None:
            raise PydanticCustomError("one-source", "give either 'substructure' or 'query'")
        return self


class SweepDocument(DocumentPart):
    """A sweep: a tree with choices of parts and samples of parameters, and the columns of its table."""

    template: dict[str, Any]
    choices: dict[str, list[str | Choice] | Choice] = Field(default_factory=dict)
    samples: Samples | None = None
    columns: dict[ColumnName, Column] = Field(min_length=1, max_length=MOST_COLUMNS)
    where: Annotated[str, Field(max_length=2000)] = ""
    pareto: Pareto | None = None
    keep: Annotated[int, Field(ge=1, le=MOST_KEPT)] | None = None
    proof: Annotated[int, Field(ge=0, le=10_000)] = 0
