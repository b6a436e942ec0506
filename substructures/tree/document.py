"""The JSON form of a tree of substructures (the HTTP contract, section 3)."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from decimal import Decimal
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import DocumentPart, read_model
from substructures.documents.faults import PATTERNS
from substructures.documents.fields import BY_TYPE, NAME, LibraryName, Name, Number, NumberVector, PlainNumber, in_si
from substructures.errors import Fault, InvalidDocument, among, listed, meant
from substructures.expr.syntax import RESERVED
from substructures.loads.document import AT
from substructures.loads.kinds import LoadOfTree
from substructures.part.definition import Definition, Input, Parameter, PartClosure, Placement, WithTables

REFERENCE = r"^[a-z0-9][a-z0-9-]{0,63}(@[A-Za-z0-9][A-Za-z0-9:_.-]{0,80})?$"
FRAME = r"^[A-Za-z][A-Za-z0-9_]{0,63}\.[A-Za-z][A-Za-z0-9_]{0,63}$"
MAX_INSTANCES = 500

PLACE = "a place is 'instance.port', 'instance.body' or 'world'"
#: a place, or a name alone, which is refused where it is known what ports there are
MOUNT = r"^[A-Za-z][A-Za-z0-9_]{0,63}(\.[A-Za-z][A-Za-z0-9_]{0,63})?$"

PATTERNS[AT] = lambda text: f"{PLACE}{_example(text)}"
PATTERNS[MOUNT] = PATTERNS[AT]
#: the same text as that of coordinates of loads
PATTERNS[FRAME] = lambda text: f"a name with its instance is needed, as 'instance.name'{_example(text)}"
PATTERNS[REFERENCE] = lambda _: "a reference is a name with its version, as in arm@2, or a name alone"


def _example(text: str) -> str:
    return f"; for example 'arm.{text}', where 'arm' is the instance that has it" if re.fullmatch(NAME, text) else ""


def misplaced(at: str, frames: Mapping[str, Collection[str]]) -> tuple[str, str] | None:
    """Code and message of a place that is none; ``frames``: names of ports and bodies by instance."""
    host, dot, frame = at.partition(".")
    if at == "world" or (dot and frame in frames.get(host, ())):
        return None
    if not dot:
        places = [f"{name}.{each}" for name, some in frames.items() for each in some]
        near = [each for each in places if at in each.split(".")]
        return "place", f"'{at}' is none: {PLACE}; there are {listed(near or places) or 'no instances'}"
    if host not in frames:
        return "unknown-instance", f"unknown instance '{host}'{among(host, frames)}"
    there = f"it has {listed(frames[host])}{meant(frame, frames[host])}"
    return "unknown-port", f"'{host}' has no port or body '{frame}'; {there}"


class Instance(DocumentPart):
    """A substructure mounted on the world, or on a port or body of another instance."""

    name: Name
    substructure: Annotated[str, Field(pattern=REFERENCE)] | None = Field(
        None, description="reference into the library"
    )
    definition: Definition | None = Field(None, description="instead of a reference: a definition of its own")
    at: Annotated[str, Field(pattern=MOUNT)] = "world"
    placement: Placement = Placement()
    parameters: dict[Name, Number] = Field(
        {}, max_length=5000, description="numbers, or expressions in other parameters"
    )

    @property
    def digest(self) -> str:
        """The digest of the definition, empty where the reference is not pinned to one."""
        return self.definition.digest if self.definition else str(self.substructure).partition("@")[2]

    @model_validator(mode="after")
    def _one_source(self) -> Instance:
        if (self.substructure is None) == (self.definition is None):
            raise PydanticCustomError("one-source", "give either 'substructure' or 'definition'")
        return self


class Closure(PartClosure):
    """A loop between frames of instances, or of one and the world."""

    from_: Annotated[str, Field(pattern=FRAME)] = Field(alias="from", description="instance.port or instance.body")
    to: Annotated[str, Field(pattern=AT)] = Field("world", description="instance.port, instance.body or world")


class DrivenInput(DocumentPart):
    """A motion that is given with the numbers: the coordinate and its derivatives by time are three inputs."""

    input: Literal[True]


class DrivenTable(DocumentPart):
    """A motion through points by cubics without kinks, at rest before and after: ``smooth`` ones have one curvature at
    each point, ``monotone`` ones rise and fall where the values do. Whatever else there is jumps, or is no formula.
    """

    times: tuple[PlainNumber, ...] = Field(min_length=2, max_length=1000, description="rising, s")
    values: tuple[PlainNumber, ...] = Field(min_length=2, max_length=1000, description="rad or m")
    interpolation: Literal["smooth", "monotone"] = "smooth"

    @model_validator(mode="after")
    def _pairs(self) -> DrivenTable:
        if len(self.times) != len(self.values):
            message = f"{len(self.values)} values for {len(self.times)} times"
            raise PydanticCustomError("wrong-length", "{message}", {"message": message})
        return self

    def __str__(self) -> str:
        """As an expression."""
        knots = ", ".join(f"{_plain(t)}:{_plain(x)}" for t, x in zip(self.times, self.values, strict=True))
        return f"table(t; {knots}; {self.interpolation})"


def _plain(x: Any) -> str:
    return format(x, "f") if isinstance(x, Decimal) else str(x)


def _kind(given: Any) -> str:
    """Of a motion, by its fields."""
    if isinstance(given, (DrivenInput, DrivenTable)):
        return "input" if isinstance(given, DrivenInput) else "table"
    fields = given if isinstance(given, Mapping) else ()
    return "table" if {"times", "values"} & {*fields} else "input" if {"input"} & {*fields} else "number"


Driven = Annotated[
    Annotated[Number, Tag("number")] | Annotated[DrivenInput, Tag("input")] | Annotated[DrivenTable, Tag("table")],
    Discriminator(_kind),
]


FrameName = Annotated[str, Field(max_length=140, description="instance.port or instance.body")]


class VelocityConstraint(DocumentPart):
    """A constraint on velocities by its name; what it means: substructures.analysis.equations.nonholonomic."""

    name: Name

    def plain(self) -> dict[str, Any]:
        """What was given but defaults, numbers in SI as texts."""
        given: dict[str, Any] = {name: getattr(self, name) for name in self.model_dump(exclude_defaults=True)}
        return {
            name: [_plain(x) for x in value] if isinstance(value, tuple) else _plain(in_si(value))
            for name, value in given.items()
        }


class LinearConstraint(VelocityConstraint):
    """An expression that is zero, affine in the velocities: B(q) q' + b(q, t), b what a table or a belt gives."""

    type: Literal["linear"]
    expression: str


class KnifeEdgeConstraint(VelocityConstraint):
    """A skate: no velocity across the edge, which lies along the first axis of the frame."""

    type: Literal["knife_edge"]
    frame: FrameName


class RollingConstraint(VelocityConstraint):
    """A disc (axis: third axis of the frame) or a sphere that rolls on a plane without slip."""

    type: Literal["rolling"]
    frame: FrameName
    radius: Number = Field(description="m")
    shape: Literal["disc", "sphere"] = "disc"
    normal: tuple[PlainNumber, PlainNumber, PlainNumber] = Field(
        (0, 0, 1), description="of the plane in the world (constant)"
    )


ConstraintOfTree = Annotated[
    LinearConstraint | KnifeEdgeConstraint | RollingConstraint, Field(discriminator="type"), BY_TYPE
]


class TreeSpec(WithTables):
    """Gravity, parameters and instances; hosts may be given in any order. ``closures`` make loops of the tree, and
    ``loads`` act between its frames, with ``inputs`` of their own. ``driven`` coordinates move as is given;
    ``velocity_constraints`` hold along motions.
    """

    name: LibraryName
    gravity: NumberVector = Field((0, 0, 0), description="gravity acceleration in world axes, m/s^2")
    parameters: dict[Name, Parameter] = Field({}, max_length=5000)
    instances: tuple[Instance, ...] = Field((), max_length=MAX_INSTANCES)
    closures: tuple[Closure, ...] = Field((), max_length=MAX_INSTANCES)
    inputs: dict[Name, Input] = Field({}, max_length=500, description="of the loads of the tree")
    loads: tuple[LoadOfTree, ...] = Field((), max_length=1000)
    driven: dict[Annotated[str, Field(pattern=FRAME)], Driven] = Field(
        {}, max_length=5000, description="motions of coordinates: expressions in t and parameters (rad or m), or others"
    )
    velocity_constraints: tuple[ConstraintOfTree, ...] = Field(
        (), max_length=100, description="of motions of the tree; formulas are those of the tree without them"
    )

    def _given(self) -> dict[str, Any]:
        """Gravity that was given as zero stays: it was not forgotten."""
        is_given = "gravity" in self.model_fields_set
        return super()._given() | (self.model_dump(include={"gravity"}) if is_given else {})

    def require_free_names(self) -> None:
        """Raises InvalidDocument for parameters whose name means something else: t is the time, pi a number."""
        faults = [
            Fault(f"/parameters/{name}", "reserved-name", f"'{name}' has a fixed meaning in expressions")
            for name in self.parameters
            if name in RESERVED
        ]
        if faults:
            raise InvalidDocument(faults)

    def __repr__(self) -> str:
        """Two lines: its name, and what hangs on what."""
        loops = f"; closures {', '.join(c.name for c in self.closures)}" if self.closures else ""
        loops += f"; loads {', '.join(load.name for load in self.loads)}" if self.loads else ""
        loops += f"; driven {', '.join(self.driven)}" if self.driven else ""
        tied = ", ".join(c.name for c in self.velocity_constraints)
        loops += f"; velocity constraints {tied}" if tied else ""
        hosts = ", ".join(f"{i.name} at {i.at}" for i in self.instances)
        return f"TreeSpec '{self.name}', {len(self.instances)} instances\n{hosts or 'empty'}{loops}"

    __str__ = __repr__


def require_undriven(driven: Sequence[str], instead: str) -> None:
    """Raises InvalidDocument (``has-driven``) where given motions would be ignored; ``instead``: what takes them."""
    if driven:
        names = ", ".join(f"'{name}'" for name in driven)
        message = f"the motion of {names} is given ('driven'), which is not taken into account here: {instead}"
        raise InvalidDocument.at("", "has-driven", message)


#: what takes the velocity constraints of a tree
TAKES_CONSTRAINTS = (
    *("simulations", "linearisations", "velocity-equations", "equilibria", "steady-motions", "first_integrals"),
    *("ensembles", "sensitivities", "root-loci", "optimal-parameters", "perturbation", "parameter_sensitivity"),
    "velocity_dynamics",
)


def require_unconstrained(constraints: Iterable[str], what: str) -> None:
    """Raises InvalidDocument (``has-velocity-constraints``) where ``what`` would ignore those with these names."""
    names = ", ".join(f"'{name}'" for name in constraints)
    if names and what not in TAKES_CONSTRAINTS:
        message = (
            f"the tree has the velocity constraints {names}, which '{what}' does not take into account: take "
            f"{', '.join(TAKES_CONSTRAINTS)}, or the tree without 'velocity_constraints'"
        )
        raise InvalidDocument.at("", "has-velocity-constraints", message)


def read_instance(data: Any) -> Instance:
    """One instance from plain data. Raises InvalidDocument."""
    return read_model(Instance, data)
