"""The JSON form of a tree of substructures (the HTTP contract, section 3)."""

from __future__ import annotations

import hashlib
from functools import cached_property
from typing import Annotated, Any

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from substructures.definition import (
    Definition,
    LibraryName,
    Model,
    Name,
    Number,
    Parameter,
    Placement,
    Vector,
    read_model,
)
from substructures.documents import write_json

REFERENCE = r"^[a-z0-9][a-z0-9-]{0,63}(@[A-Za-z0-9][A-Za-z0-9:_.-]{0,80})?$"
MAX_INSTANCES = 500


class Instance(Model):
    """A substructure mounted on the world, or on a port or body of another instance."""

    name: Name
    substructure: Annotated[str, Field(pattern=REFERENCE)] | None = Field(
        None, description="reference into the library"
    )
    definition: Definition | None = Field(None, description="instead of a reference: a definition of its own")
    at: Annotated[str, Field(pattern=r"^(world|[A-Za-z][A-Za-z0-9_]{0,63}\.[A-Za-z][A-Za-z0-9_]{0,63})$")] = "world"
    placement: Placement = Placement()
    parameters: dict[Name, Number] = Field(
        {}, max_length=5000, description="numbers, or expressions in other parameters"
    )

    @model_validator(mode="after")
    def _one_source(self) -> Instance:
        if (self.substructure is None) == (self.definition is None):
            raise PydanticCustomError("one-source", "give either 'substructure' or 'definition'")
        return self


class TreeSpec(Model):
    """Gravity, parameters and instances; hosts may be given in any order."""

    name: LibraryName
    gravity: Vector = Field((0, 0, 0), description="gravity acceleration in world axes, m/s^2")
    parameters: dict[Name, Parameter] = Field({}, max_length=5000)
    instances: tuple[Instance, ...] = Field((), max_length=MAX_INSTANCES)

    @classmethod
    def read(cls, data: Any) -> TreeSpec:
        """A tree from plain data. Raises InvalidDocument with a pointer to every fault."""
        return read_model(cls, data)

    @cached_property
    def _canonical(self) -> bytes:
        return write_json(self.model_dump(exclude_defaults=True, by_alias=True))

    def canonical(self) -> bytes:
        """Canonical bytes of what was given: RFC 8785, numbers as their decimal text, defaults left out."""
        return self._canonical

    @property
    def digest(self) -> str:
        """``sha256:`` and 64 hex digits of the canonical bytes (references should be pinned before)."""
        return "sha256:" + hashlib.sha256(self._canonical).hexdigest()


def read_instance(data: Any) -> Instance:
    """One instance from plain data. Raises InvalidDocument."""
    return read_model(Instance, data)
