"""The names of a tree where its loads are read and act: parameters, coordinates, velocities, inputs, the time, measures
of two frames (the HTTP contract, section 3), and all frames with their places.
"""

from __future__ import annotations

from collections.abc import Sequence

from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.loads.names import End, Names
from substructures.loads.pairs import Place
from substructures.mechanics.linear3 import Vector
from substructures.part.parameters import si_unit
from substructures.tree.assembly import Assembly
from substructures.tree.mounted_part import PlacedPart
from substructures.tree.places import place

#: of a revolute and of a prismatic coordinate
UNITS = ("rad", "m")


class LoadNames(Names):
    """Of a tree; ``placed``: its parts over formulas; ``rates``: q'^a."""

    def __init__(self, assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> None:
        self.assembly, self.placed, self._rates = assembly, placed, rates
        pairs = zip(assembly.instances, assembly.mounted, strict=True)
        names = [f"{i.name}.{joint.coordinate}" for i, m in pairs for joint in m.part.topology.joints]
        self.coordinates = {name: a for a, name in enumerate(names)}
        self.units = [UNITS[j.s] for m in assembly.mounted for j in m.part.topology.joints]
        assembly.scope.more = (*names, *(f"{name}'" for name in names), *assembly.inputs)
        super().__init__(assembly.scope)

    @property
    def rates(self) -> Sequence[Expr]:
        """q'^a."""
        return self._rates

    def constant(self, name: str) -> Expr | None:
        """A parameter of the tree or of an instance."""
        return self.assembly.reading.parameter(name)

    def anchor(self, end: End, point: Vector) -> Place | None:
        """A point of a frame of the document."""
        faults = len(self.scope.faults)
        frame = self.assembly.reading.frame(end.frame, end.pointer)
        return None if len(self.scope.faults) > faults else place(self.placed, *frame, point)

    def place(self, anchor: Place) -> Place:
        """The anchor itself."""
        return anchor

    def plain(self, name: str) -> Expr | None:
        """What a name stands for that is no measure."""
        found = self.constant(name)
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
        self.scope.symbols.setdefault(name, Symbol(name, kind, unit))
        return self.graph.symbol(name)
