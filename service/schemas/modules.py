"""Shapes of what browsers compute with, and of what entries of formulas come from."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from service.schemas.shapes import Digest, Shape


class ProgramView(Shape):
    """The layout of a module of WebAssembly, beside the fields of the target ``interface``."""

    format: Literal["substructures.program"]
    version: int
    name: str
    made_from: dict[str, str]
    order: str
    call: dict[str, Any]
    vectors: dict[str, dict[str, Any]] = Field(
        description="by symbol: names, SI units, defaults and 'at', the address in bytes; t is a number of its own"
    )
    frames: list[str]
    functions: list[dict[str, Any]] = Field(
        description="name, quantity, arguments in their order, outputs with shape and 'at'"
    )
    warnings: list[dict[str, str]]
    heap: int = Field(description="first free address in bytes")
    pages: int = Field(description="of 64 KiB, that the memory has to have")


class OriginOfEntry(Shape):
    """What an independent entry that is not zero comes from: numbers into the lists ``bodies`` and ``symbols``."""

    index: list[int]
    bodies: list[int]
    symbols: list[int]


class OriginsOfQuantity(Shape):
    """The independent entries of a quantity; all others follow from the symmetry or are zero."""

    shape: list[int]
    symmetry: str
    entries: list[OriginOfEntry]


class OriginsView(Shape):
    """What entries of formulas come from. An entry that is not listed is zero: because no body is moved by all
    coordinates of its index, or because its formula vanishes in every pose."""

    digest: Digest
    bodies: list[str]
    moved: list[list[int]] = Field(description="of every coordinate: the bodies that it moves")
    symbols: list[str]
    quantities: dict[str, OriginsOfQuantity]
