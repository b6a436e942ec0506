"""The JSON form of a tree of substructures (the HTTP contract, section 3)."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from decimal import Decimal
from typing import Annotated, Any, Literal, Protocol

from pydantic import Discriminator, Field, Tag, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import DocumentPart, read_model
from substructures.documents.fields import LibraryName, Name, Number, NumberVector, PlainNumber
from substructures.documents.patterns import NAME, PATTERNS
from substructures.errors import Fault, InvalidDocument, among, listed, meant
from substructures.expr.steps import RESERVED
from substructures.loads.document import AT
from substructures.loads.kinds import LoadOfTree
from substructures.part.definition import Definition, Input, Parameter, PartClosure, Placement, WithTables
from substructures.tree.given.ties import MAX_CONTACTS, ConstraintOfTree, ContactOfTree
from substructures.tree.given.ties import plain_number as _plain

REFERENCE = r"^[a-z0-9][a-z0-9-]{0,63}(@[A-Za-z0-9][A-Za-z0-9:_.-]{0,80})?$"
FRAME = r"^[A-Za-z][A-Za-z0-9_]{0,63}\.[A-Za-z][A-Za-z0-9_]{0,63}$"
MAX_INSTANCES = 500

PLACE = "a place is 'instance.port', 'instance.body' or 'world'"
#: a place, or a name alone, which is refused where it is known what ports there are
MOUNT = r"^[A-Za-z][A-Za-z0-9_]{0,63}(\.[A-Za-z][A-Za-z0-9_]{0,63})?$"

PATTERNS[AT] = lambda text: f"{PLACE}{_example(text)}"
PATTERNS[MOUNT] = PATTERNS[AT]
#: the same text as that of coordinates of loads
PATTERNS[FRAME] = lambda text: (
    f"a name with its instance is needed, as 'instance.name'{_example(text)}"
    if text != "world"
    else "a frame of an instance is needed, as 'instance.port'; of closures 'to' may be the 'world'"
)
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
    level: Literal["full", "reduced"] | None = Field(
        None,
        description="coordinates: all, or those that its definition names `independent` (its own choice if it can)",
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
    each point, ``monotone`` ones rise and fall where the values do, and begin and end flat as beside a point of rest.
    Whatever else there is jumps, or is no formula.
    """

    times: tuple[PlainNumber, ...] = Field(min_length=2, max_length=1000, description="rising, s")
    values: tuple[PlainNumber, ...] = Field(min_length=2, max_length=1000, description="rad or m")
    interpolation: Literal["smooth", "monotone"] = "smooth"

    @model_validator(mode="after")
    def _pairs(self) -> DrivenTable:
        if len(self.times) != len(self.values):
            message = f"{len(self.values)} values for {len(self.times)} times"
            raise PydanticCustomError("wrong-length", "{message}", {"message": message})
        for x in (*self.times, *self.values):
            if isinstance(x, str) and not re.fullmatch(r"-?\d+(\.\d+)?", x, re.ASCII):
                message = f"the points of a table are numbers, and '{x[:40]}' is none"
                raise PydanticCustomError("number-expected", "{message}", {"message": message})
        return self

    def __str__(self) -> str:
        """As an expression."""
        times, values = list(map(_plain, self.times)), list(map(_plain, self.values))
        if self.interpolation == "monotone":
            # beside equal values a monotone cubic is flat: with one more on each side it begins and ends at rest
            rest = [_plain(Decimal(times[0]) - 1), _plain(Decimal(times[-1]) + 1)]
            times, values = [rest[0], *times, rest[1]], [values[0], *values, values[-1]]
        knots = ", ".join(f"{t}:{x}" for t, x in zip(times, values, strict=True))
        return f"table(t; {knots}; {self.interpolation})"


def _kind(given: Any) -> str:
    """Of a motion, by its fields."""
    if isinstance(given, (DrivenInput, DrivenTable)):
        return "input" if isinstance(given, DrivenInput) else "table"
    # by its fields, so that faults are told of the kind that was meant, not of all three
    fields = given if isinstance(given, Mapping) else ()
    return "table" if {"times", "values"} & {*fields} else "input" if {"input"} & {*fields} else "number"


Driven = Annotated[
    Annotated[Number, Tag("number")] | Annotated[DrivenInput, Tag("input")] | Annotated[DrivenTable, Tag("table")],
    Discriminator(_kind),
]


class TreeSpec(WithTables):
    """Gravity, parameters and instances; hosts may be given in any order. ``closures`` make loops of the tree, and
    ``loads`` act between its frames, with ``inputs`` of their own. ``driven`` coordinates move as is given,
    those that are ``ignored`` at constant momenta; ``velocity_constraints`` and ``contacts`` hold along motions.
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
    ignored: dict[Annotated[str, Field(pattern=FRAME)], Number] = Field(
        {}, max_length=5000, description="constant momenta of cyclic coordinates (kg m^2/s or kg m/s), by Routh"
    )
    velocity_constraints: tuple[ConstraintOfTree, ...] = Field(
        (), max_length=100, description="of motions of the tree; formulas are those of the tree without them"
    )
    contacts: tuple[ContactOfTree, ...] = Field(
        (), max_length=MAX_CONTACTS, description="points that do not pass through planes, in simulations"
    )

    def plain(self) -> dict[str, Any]:
        """Gravity that was given as zero stays: it was not forgotten."""
        is_given = "gravity" in self.model_fields_set
        return super().plain() | (self.model_dump(include={"gravity"}) if is_given else {})

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
        loops += f"; ignored {', '.join(self.ignored)}" if self.ignored else ""
        tied = ", ".join(c.name for c in self.velocity_constraints)
        loops += f"; velocity constraints {tied}" if tied else ""
        loops += f"; contacts {', '.join(c.name for c in self.contacts)}" if self.contacts else ""
        hosts = ", ".join(f"{i.name} at {i.at}" for i in self.instances)
        return f"TreeSpec '{self.name}', {len(self.instances)} instances\n{hosts or 'empty'}{loops}"

    __str__ = __repr__


class Given(Protocol):
    """A tree or its model: some of its coordinates are given."""

    @property
    def driven(self) -> Collection[str]:
        """Those whose motion is given."""

    @property
    def ignored(self) -> Collection[str]:
        """Those whose momentum is given."""


def require_undriven(driven: Collection[str], instead: str) -> None:
    """Raises InvalidDocument (``has-driven``) where given motions would be left out; ``instead``: what takes them."""
    if driven:
        names = ", ".join(f"'{name}'" for name in driven)
        message = f"the motion of {names} is given ('driven'), which is not taken into account here: {instead}"
        raise InvalidDocument.at("", "has-driven", message)


def require_unignored(ignored: Collection[str]) -> None:
    """Raises InvalidDocument (``has-ignored``) for what does not take Routh's reduced systems."""
    if ignored:
        names = ", ".join(f"'{name}'" for name in ignored)
        given = f"the momentum of {names} is given ('ignored'), which is not taken into account here"
        raise InvalidDocument.at("", "has-ignored", f"{given}: take the tree without 'ignored'")


def with_levels(spec: TreeSpec, definitions: Mapping[str, Definition], reduced: Collection[str] = ()) -> TreeSpec:
    """The tree, in which every instance whose definition names independent coordinates says its level: those that are
    ``reduced``, and the others all coordinates, as documents that were stored before there was another level mean.
    """
    unsaid = {each.name for each in spec.instances if each.level is None and definitions[each.name].independent}
    if not unsaid:
        return spec
    level = {name: "reduced" if name in reduced else "full" for name in unsaid}
    said = (each.model_copy(update={"level": level.get(each.name, each.level)}) for each in spec.instances)
    return spec.model_copy(update={"instances": tuple(said)})


def require_full(reduced: Collection[str], instead: str) -> None:
    """Raises InvalidDocument (``has-reduced``) for what takes all coordinates of parts with loops; ``instead``: what to
    ask then.
    """
    if reduced:
        names = ", ".join(f"'{name}'" for name in reduced)
        message = f"the loops of {names} are in the formulas (reduced level), which is not taken into account here"
        raise InvalidDocument.at("", "has-reduced", f'{message}: give these instances "level": "full" and {instead}')


def require_ungiven(given: Given, instead: str) -> None:
    """Raises InvalidDocument as :func:`require_undriven` and :func:`require_unignored`."""
    require_undriven(given.driven, instead)
    require_unignored(given.ignored)


def read_instance(data: Any) -> Instance:
    """One instance from plain data. Raises InvalidDocument."""
    return read_model(Instance, data)
