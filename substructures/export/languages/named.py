"""Names for the elements of arguments: ``demo_P_arm_m2``, which an element keeps whatever stands beside it.

A name is that of the symbol with _ for dots. Two symbols that would have the same one have none, so that code that
uses it fails to compile rather than mean another.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from math import isnan
from typing import NamedTuple

from substructures.export.exported import Exported, identifier_of
from substructures.export.interface import Vector
from substructures.printers.names import comment

#: vectors whose elements are named; velocities and accelerations stand as the coordinates
NAMED = ("q", "u", "p")
#: what a structure of all elements of a vector is called
STRUCTURES: Mapping[str, str] = {"q": "Coordinates", "u": "Inputs", "p": "Parameters"}


class Named(NamedTuple):
    """An element of an argument: ``name`` is an identifier, or empty; ``place`` counts from 0; ``told``: what it is."""

    vector: str
    name: str
    place: int
    told: str
    value: float


def described(vector: Vector, i: int) -> str:
    """``arm.m2 [kg], default 1.5`` of element i, from 0; harmless in comments."""
    value = ""
    if vector.defaults:
        value = ", no default" if isnan(vector.defaults[i]) else f", default {vector.defaults[i]!r}"
    return f"{comment(vector.names[i])} [{comment(vector.units[i])}]{value}"


def elements(vector: Vector, alike: Callable[[str], str] = str) -> list[Named]:
    """All elements; names that ``alike`` makes equal are left empty."""
    plain = [identifier_of(name) for name in vector.names]
    count = Counter(map(alike, plain))
    names = [name if count[alike(name)] == 1 else "" for name in plain]
    defaults = vector.defaults or (0.0,) * len(vector)
    return [
        Named(vector.symbol, name, i, described(vector, i), value)
        for i, (name, value) in enumerate(zip(names, defaults, strict=True))
    ]


def constants(exported: Exported, alike: Callable[[str], str] = str) -> list[Named]:
    """The elements that have a name, of all named vectors."""
    vectors = (exported.interface.vectors[symbol] for symbol in NAMED)
    return [each for vector in vectors for each in elements(vector, alike) if each.name]


def members(vector: Vector, reserved: Callable[[str], bool], first: int) -> list[Named]:
    """All elements with names for the members of a structure: ``lambda_`` for a word of the language, ``p_3_`` for what
    has no name."""
    found = []
    for each in elements(vector, lambda name: name.lower().rstrip("_")):
        name = f"{each.name}_" if reserved(each.name) else each.name
        found.append(Named(each.vector, name or f"{each.vector}_{each.place + first}_", *each[2:]))
    return found
