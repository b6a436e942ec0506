"""The JSON form of a sweep (the HTTP contract, section on sweeps)."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from substructures.analysis.motion.problems.output_times import MAX_OUTPUTS
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC, Real
from substructures.documents.patterns import NAME
from substructures.ensembles.motion_column import MOST_COLUMNS, MotionColumn
from substructures.ensembles.quantity_columns import QuantityColumn
from substructures.ensembles.samples import Samples

#: rows that a table may keep where ``keep`` does not say fewer
MOST_KEPT = 10**7
#: the origin of the tree
WORLD = "world"

ColumnName = Annotated[str, Field(pattern=NAME)]
OfModes = Literal["lowest_frequency", "highest_frequency", "least_damping", "largest_real_part", "is_stable"]


class LinearColumn(DocumentPart):
    """What the linearisation about an equilibrium tells: frequencies [rad/s], damping ratio, whether it is stable.

    ``held``: constant forces of the joints make the state ``at`` one; ``settle``: it is the one that Newton's method
    finds from there. Without them rows in which it is none have no number.
    """

    analysis: Literal["linearisation"]
    at: dict[str, Any] = Field(default_factory=dict)
    held: bool = False
    settle: bool = False
    take: OfModes = "lowest_frequency"

    @model_validator(mode="after")
    def _one(self) -> LinearColumn:
        if self.held and self.settle:
            raise PydanticCustomError("held-and-settled", "what is 'held' need not 'settle': give one of them")
        return self


class EquilibriumColumn(DocumentPart):
    """A coordinate ``of`` the equilibrium that Newton's method finds from the state ``at`` [rad, m]."""

    analysis: Literal["equilibrium"]
    at: dict[str, Any] = Field(default_factory=dict)
    of: str


class ReachColumn(DocumentPart):
    """How far a frame ``of`` the tree gets from another one (the origin), within the limits of joints [m]."""

    analysis: Literal["reach"]
    of: str
    about: str = WORLD


class SimulationColumn(MotionColumn):
    """A number of the motion from the state ``at`` (``q``, ``qd``, ``inputs``) over a ``span`` [s], as of an ensemble:
    of its values at ``count`` times. ``absolute_tolerance`` [rad, m; per s]: None is a hundredth of the relative one.
    """

    analysis: Literal["simulation"]
    at: dict[str, Any] = Field(default_factory=dict)
    span: tuple[Real, Real]
    count: Annotated[int, Field(ge=2, le=MAX_OUTPUTS), NUMERIC] = 101
    relative_tolerance: Annotated[Real, Field(ge=1e-14, le=1e-1)] = 1e-8
    absolute_tolerance: Annotated[Real, Field(ge=0, le=1e-1)] | None = None


#: no field of a column is called so: pointers to faults pass it over
OF_QUANTITY = "column of a quantity"


def _kind(given: Any) -> str | None:
    if isinstance(given, str):
        return "text"
    if isinstance(given, dict):
        return str(given["analysis"])[:80] if "analysis" in given else OF_QUANTITY
    return OF_QUANTITY if isinstance(given, QuantityColumn) else getattr(given, "analysis", None)


KINDS = (
    "a column is 'mass', 'dof', 'operations', an expression, an object with a 'quantity', or one with the 'analysis' "
    "linearisation, equilibrium, reach or simulation"
)
AnalysisColumn = LinearColumn | EquilibriumColumn | ReachColumn | SimulationColumn
Column = Annotated[
    Annotated[str, Tag("text")]
    | Annotated[LinearColumn, Tag("linearisation")]
    | Annotated[EquilibriumColumn, Tag("equilibrium")]
    | Annotated[ReachColumn, Tag("reach")]
    | Annotated[SimulationColumn, Tag("simulation")]
    | Annotated[QuantityColumn, Tag(OF_QUANTITY)],
    Discriminator(_kind, custom_error_type="unknown-column", custom_error_message=KINDS),
]


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
    dof: Annotated[int, NUMERIC] | None = None
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
    keep: Annotated[int, Field(ge=1, le=MOST_KEPT), NUMERIC] | None = None
    proof: Annotated[int, Field(ge=0, le=10_000), NUMERIC] = 0
