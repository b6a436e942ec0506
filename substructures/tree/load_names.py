"""What expressions of the loads of a tree may name: parameters, coordinates, velocities, inputs, the time, and measures
of two frames (the HTTP contract, section 3; :mod:`substructures.part.pair_laws`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.expr.syntax import measured
from substructures.mechanics.linear3 import Vector
from substructures.part.load_names import names_in
from substructures.part.pair_laws import Measures
from substructures.part.pairs import Place
from substructures.part.parameters import si_unit
from substructures.part.scope import Lookup
from substructures.tree.assembly import Assembly
from substructures.tree.frame_points import place
from substructures.tree.mounted_part import PlacedPart

#: of a revolute and of a prismatic coordinate
UNITS = ("rad", "m")


@dataclass
class LoadNames:
    """The names of a tree at their places; ``placed``: its parts over formulas; ``rates``: q'^a."""

    assembly: Assembly
    placed: Sequence[PlacedPart]
    rates: Sequence[Expr]
    coordinates: dict[str, int] = field(init=False)
    measures: Measures = field(init=False)

    def __post_init__(self) -> None:
        pairs = zip(self.assembly.instances, self.assembly.mounted, strict=True)
        names = [f"{i.name}.{joint.coordinate}" for i, m in pairs for joint in m.part.topology.joints]
        self.coordinates = {name: a for a, name in enumerate(names)}
        self.assembly.scope.more = (*names, *(f"{name}'" for name in names), *self.assembly.inputs)
        self.measures = Measures(self.assembly.scope, self.place, self.plain, lambda: self.rates)
        self.units = [UNITS[j.s] for m in self.assembly.mounted for j in m.part.topology.joints]

    def is_steady(self, *values: Any) -> bool:
        """Whether numbers or expressions name parameters, inputs and the time alone, nothing that moves."""
        return not any(self.moves(name) for value in values for name in names_in(value))

    def is_constant(self, *values: Any) -> bool:
        """Whether they name parameters alone."""
        return all(self.assembly.reading.parameter(name) is not None for value in values for name in names_in(value))

    def moves(self, name: str) -> bool:
        """Whether it is a coordinate, a velocity or a measure."""
        return name.removesuffix("'") in self.coordinates or measured(name) is not None

    def place(self, at: str, pointer: str, point: Vector = (0, 0, 0)) -> Place:
        """A point of a frame of the document; of the world after a fault."""
        return place(self.placed, *self.assembly.reading.frame(at, pointer), point)

    @property
    def graph(self) -> Any:
        """Where formulas are made."""
        return self.assembly.scope.graph

    def at(self, pointer: str) -> Lookup:
        """The lookup of names of the expression at a pointer."""
        return self.measures.at(pointer)

    def plain(self, name: str) -> Expr | None:
        """What a name stands for that is no measure."""
        found = self.assembly.reading.parameter(name)
        if found is not None:
            return found
        if name == "t":
            return self._symbol("t", "time", "s")
        if name in self.assembly.inputs:
            return self._symbol(name, "input", si_unit(str(self.assembly.inputs[name]["unit"])))
        a = self.coordinates.get(name.removesuffix("'"))
        if a is None or name.endswith("''"):
            return None
        return self.rates[a] if name.endswith("'") else self._symbol(name, "coordinate", self.units[a])

    def _symbol(self, name: str, kind: str, unit: str) -> Expr:
        self.assembly.scope.symbols.setdefault(name, Symbol(name, kind, unit))
        symbol: Expr = self.graph.symbol(name)
        return symbol
