"""Vectors, tensors, inertias and rotations out of replayed (or evaluated) outputs of a stored program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from substructures.expr.program import Formulas
from substructures.mechanics.inertia import Inertia
from substructures.mechanics.linear3 import Matrix, Planar, Rotation, Scalar, Turn, Vector, packed


@dataclass(frozen=True)
class Stored:
    """Access by output name and index; entries that are structurally zero are the integer 0."""

    outputs: Mapping[str, Formulas]

    def scalar(self, name: str, *index: int) -> Scalar:
        """One element."""
        return self.outputs[name].entries.get(index, 0)

    def vector(self, name: str, *index: int) -> Vector:
        """The last axis at an index."""
        get = self.outputs[name].entries.get
        return get((*index, 0), 0), get((*index, 1), 0), get((*index, 2), 0)

    def matrix(self, name: str, *index: int) -> Matrix:
        """The last two axes at an index."""
        return self.vector(name, *index, 0), self.vector(name, *index, 1), self.vector(name, *index, 2)

    def inertia(self, name: str, *index: int) -> Inertia:
        """m, s and J."""
        tensor = packed(self.matrix(f"{name}.J", *index))
        return Inertia(self.scalar(f"{name}.m", *index), self.vector(f"{name}.s", *index), tensor)

    def rotation(self, c: int) -> Rotation:
        """E_c by its factors."""
        full = self.outputs["E.full"].entries
        if any((c, i, j) in full for i in range(3) for j in range(3)):
            return Rotation((Turn(self.matrix("E.full", c)),))
        factors = []
        for axis, name in ((0, "E.tilt"), (2, "E.turn")):
            cosine, sine = self.scalar(name, c, 0), self.scalar(name, c, 1)
            if (c, 0) in self.outputs[name].entries or (c, 1) in self.outputs[name].entries:
                factors.append(Planar(axis, cosine, sine))
        return Rotation(tuple(factors))
