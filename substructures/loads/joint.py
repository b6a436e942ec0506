"""A generalised force on a coordinate, as it is given: Q_a."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from substructures.documents.fields import Name, Number
from substructures.expr.graph import Expr
from substructures.expr.units.unit_check import Place
from substructures.loads.document import CoordinateOfTree, Load, LoadFormulas, OfTree
from substructures.loads.names import Names
from substructures.loads.pairs import Reach
from substructures.loads.units import EFFORT


class JointLoad(Load):
    """A generalised force on a coordinate."""

    type: Literal["joint"]
    coordinate: Name
    force: Number = Field(description="N m or N")

    def law(self, names: Names, pointer: str) -> JointForce | None:
        """Its coordinate and force."""
        a = names.coordinate(self.coordinate, f"{pointer}/coordinate")
        return None if a is None else JointForce(a, *names.formula(self.force, f"{pointer}/force"))

    def places(self, pointer: str, kinds: Mapping[str, int]) -> Iterator[Place]:
        """By the coordinate."""
        if self.coordinate in kinds:
            yield f"{pointer}/force", self.force, EFFORT[kinds[self.coordinate]]


class TreeJointLoad(OfTree, JointLoad):
    """A generalised force on a coordinate of an instance."""

    coordinate: CoordinateOfTree


@dataclass(frozen=True)
class JointForce:
    """The coordinate by index, the force, and its terms as they are written, if a potential of them is looked for."""

    a: int
    force: Expr
    terms: list[Expr]

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """The force."""
        del names
        found.add(Reach({self.a: self.force}))
