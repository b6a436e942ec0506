"""The JSON form of a tree of substructures (the HTTP contract, section 3)."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from typing import Annotated, Any

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import DocumentPart, read_model
from substructures.documents.faults import PATTERNS
from substructures.documents.fields import NAME, LibraryName, Name, Number, NumberVector
from substructures.errors import among, listed, meant
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


class TreeSpec(WithTables):
    """Gravity, parameters and instances; hosts may be given in any order. ``closures`` make loops of the tree, and
    ``loads`` act between its frames, with ``inputs`` of their own.
    """

    name: LibraryName
    gravity: NumberVector = Field((0, 0, 0), description="gravity acceleration in world axes, m/s^2")
    parameters: dict[Name, Parameter] = Field({}, max_length=5000)
    instances: tuple[Instance, ...] = Field((), max_length=MAX_INSTANCES)
    closures: tuple[Closure, ...] = Field((), max_length=MAX_INSTANCES)
    inputs: dict[Name, Input] = Field({}, max_length=500, description="of the loads of the tree")
    loads: tuple[LoadOfTree, ...] = Field((), max_length=1000)

    def _given(self) -> dict[str, Any]:
        """Gravity that was given as zero stays: it was not forgotten."""
        is_given = "gravity" in self.model_fields_set
        return super()._given() | (self.model_dump(include={"gravity"}) if is_given else {})

    def __repr__(self) -> str:
        """Two lines: its name, and what hangs on what."""
        loops = f"; closures {', '.join(c.name for c in self.closures)}" if self.closures else ""
        loops += f"; loads {', '.join(load.name for load in self.loads)}" if self.loads else ""
        hosts = ", ".join(f"{i.name} at {i.at}" for i in self.instances)
        return f"TreeSpec '{self.name}', {len(self.instances)} instances\n{hosts or 'empty'}{loops}"

    __str__ = __repr__


def read_instance(data: Any) -> Instance:
    """One instance from plain data. Raises InvalidDocument."""
    return read_model(Instance, data)
