"""What a load is: a document, and the law that is read of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Protocol

from pydantic import ConfigDict

from substructures.documents import DocumentPart
from substructures.documents.units import Dimension
from substructures.expr.graph import Expr
from substructures.expr.unit_check import Place
from substructures.loads.names import End, Names
from substructures.loads.pairs import Reach
from substructures.loads.units import LENGTH, fields_of, vector


@dataclass
class LoadFormulas:
    """What loads do: ``forces`` Q_a by coordinate, ``potential`` V with -d_a V a part of them.

    ``forces.acting``: the forces and moments between frames that they are of; Q_a q'^a is the power of the loads.
    """

    forces: Reach
    potential: Expr

    def add(self, reach: Reach, factor: Expr | None = None) -> None:
        """The forces w_a of a reach, or factor w_a."""
        for a, w in reach.items():
            if factor is None or not w.is_zero:
                Q = w if factor is None else factor * w
                self.forces[a] = self.forces[a] + Q if a in self.forces else Q
        self.forces.acting += reach.acting if factor is None else reach.times(factor)

    def keep(self, energy: Expr) -> None:
        """A part of the potential."""
        self.potential = self.potential + energy


class Law(Protocol):
    """A load whose numbers are read."""

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """Adds its forces and its potential, where the frames have their places; notes faults in the scope of names."""


class Load(DocumentPart):
    """A load of a part or of a tree.

    ``frames``: the fields that name frames, each one or a list, a name or an object with the field ``frame``;
    ``dimensions``: those of its numbers, by field; ``is_elastic``: whether pictures show it, as a spring.
    """

    frames: ClassVar[tuple[str, ...]] = ()
    dimensions: ClassVar[Mapping[str, Dimension]] = {}
    is_elastic: ClassVar[bool] = False

    model_config = ConfigDict(frozen=True, extra="forbid", serialize_by_alias=True)

    @property
    def called(self) -> str:
        """As messages call it: by its type, and in a tree by its name."""
        found = str(self.__dict__["type"])
        return f"{found} '{self.__dict__['name']}'" if "name" in self.__dict__ else found

    def ends(self, pointer: str) -> tuple[End, ...]:
        """The frames that it acts between, with the points in them; ``pointer``: to the load."""
        del pointer
        return ()

    def law(self, names: Names, pointer: str) -> Law | None:
        """The law, read; None after a fault, and of what acts otherwise. ``pointer``: to the load."""
        del names, pointer
        return None

    def places(self, pointer: str, kinds: Mapping[str, int]) -> Iterator[Place]:
        """Its numbers with their dimensions; ``kinds``: 1 of prismatic and 0 of revolute coordinates, by name."""
        del kinds
        yield from fields_of(pointer, self, self.dimensions)
        for end in self.ends(pointer):
            yield from vector(end.at_pointer, end.at, LENGTH)

    def line(self) -> tuple[str, ...]:
        """The frames along which pictures show it."""
        return tuple(end.frame for end in self.ends("")) if self.is_elastic else ()
