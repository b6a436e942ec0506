"""Dimensions of the numbers of documents, with their places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from substructures.documents.fields import DocumentPart
from substructures.documents.units import NUMBER, Dimension, read_unit
from substructures.expr.units.unit_check import Place


def dimension(text: str) -> Dimension:
    """Of a unit."""
    return read_unit(text).dimension


ANGLE = NUMBER
LENGTH, FORCE, TORQUE, ENERGY = dimension("m"), dimension("N"), dimension("N m"), dimension("J")
STIFFNESS, DAMPING = dimension("N/m"), dimension("N s/m")
ANGULAR_STIFFNESS, ANGULAR_DAMPING = dimension("N m/rad"), dimension("N m s/rad")
#: of a revolute and of a prismatic coordinate
COORDINATE = (ANGLE, LENGTH)
RATE = (dimension("rad/s"), dimension("m/s"))
EFFORT = (TORQUE, FORCE)


def vector(pointer: str, values: Sequence[Any], dimension: Dimension | None) -> Iterator[Place]:
    """The elements of a vector."""
    for i, value in enumerate(values):
        yield f"{pointer}/{i}", value, dimension


def of_kind(fields: Mapping[str, tuple[Dimension, Dimension]], kind: int) -> dict[str, Dimension]:
    """Dimensions by field, of a revolute (0) or prismatic (1) coordinate."""
    return {name: dimensions[kind] for name, dimensions in fields.items()}


def fields_of(pointer: str, given: DocumentPart, fields: Mapping[str, Dimension]) -> Iterator[Place]:
    """The numbers and vectors of a part of a document that have one dimension each."""
    for name, expected in fields.items():
        value = getattr(given, name)
        if isinstance(value, tuple):
            yield from vector(f"{pointer}/{name}", value, expected)
        elif value is not None:
            yield f"{pointer}/{name}", value, expected
