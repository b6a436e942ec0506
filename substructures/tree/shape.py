"""Shapes of trees: what their formulas are made of. Trees of one shape have one program and one certificate of it.

g, Gamma, Q and all other outputs are identities in the symbols and are compared with the documents at random values of
all symbols, so that neither depends on the values of parameters (notation.md, section 6). What does, plausibility and
warnings, is found for every tree.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from substructures.documents import read_json, write_json
from substructures.expr.program import Program
from substructures.expr.units.unit_check import Notice
from substructures.part.part import Part
from substructures.part.shape import without_descriptions
from substructures.tree.document import TreeSpec


@dataclass(frozen=True)
class CertifiedProgram:
    """The program of a shape, what its certificate says of the formulas, and what is to be told of them."""

    program: Program
    certificate: Mapping[str, Any]
    notices: Sequence[Notice] = ()


class KnownShapes(Protocol):
    """Programs of shapes that were coupled and certified before, by :func:`shape_digest`."""

    def get(self, key: str, /) -> CertifiedProgram | None:
        """What is known of a shape, or None."""

    def put(self, key: str, value: CertifiedProgram, /) -> None:
        """Remember a shape."""


def shape_digest(spec: TreeSpec, parts: Mapping[str, Part], group: bool = False) -> str:
    """The digest of the shape of a tree: mounts, placements, bindings, loads and closures, the shapes of its ``parts``
    (by instance) with the digests of their programs; ``group``: see :func:`substructures.tree.model.couple`.

    Words, and the values of the parts' parameters, are not in it. Numbers that parameters of instances are bound to
    are: they stand in the formulas. So are the tree's own defaults: the order of operations depends on them.
    """
    plain: dict[str, Any] = read_json(spec.canonical())
    instances = [
        {name: x for name, x in each.items() if name not in ("substructure", "definition")}
        | {"part": parts[each["name"]].shape}
        for each in plain.get("instances", ())
    ]
    left = {name: x for name, x in plain.items() if name != "name"} | {"instances": instances}
    return hashlib.sha256(write_json([without_descriptions(left), group])).hexdigest()
