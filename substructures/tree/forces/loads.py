"""The loads of a tree as formulas, from the poses and columns of the frames between which they act: the laws of
:mod:`substructures.loads`, nothing of the parts is derived again.

A spring or bushing whose stiffness or length names what moves is a force without potential, as are joint loads.
"""

from __future__ import annotations

from collections.abc import Sequence

from substructures.documents.units import si_unit
from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.loads.document import LoadFormulas
from substructures.loads.names import End, Names
from substructures.loads.pairs import Place, Reach
from substructures.mechanics.linear3 import Vector
from substructures.tree.assembly import Assembly
from substructures.tree.mounted_part import PlacedPart, place

#: of a revolute and of a prismatic coordinate
UNITS = ("rad", "m")


def load_formulas(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> LoadFormulas:
    """All loads of a tree together; ``placed``: its parts over formulas. Raises InvalidDocument."""
    total = LoadFormulas(Reach({}), assembly.scope.graph.zero)
    for each in loads_apart(assembly, placed, rates):
        total.add(each.forces)
        total.keep(each.potential)
    return total


def loads_apart(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> list[LoadFormulas]:
    """Every load of a tree alone, in their order. Raises InvalidDocument."""
    names, found = LoadNames(assembly, placed, rates), list[LoadFormulas]()
    for i, load in enumerate(assembly.reading.spec.loads):
        law = load.law(names, f"/loads/{i}")
        found.append(LoadFormulas(Reach({}), names.graph.zero))
        if law is not None:
            law.acts(names, found[-1])
    assembly.scope.finish()
    return found


class LoadNames(Names):
    """Of a tree; ``placed``: its parts over formulas; ``rates``: of all joints."""

    def __init__(self, assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> None:
        self.assembly, self.placed, self._rates = assembly, placed, rates
        pairs = zip(assembly.instances, assembly.mounted, strict=True)
        joints = [(i.name, m, c) for i, m in pairs for c in m.part.topology.movers]
        names = [f"{name}.{m.part.topology.joints[c].coordinate}" for name, m, c in joints]
        self.coordinates = {name: m.first + c for name, (_, m, c) in zip(names, joints, strict=True)}
        self.units = {m.first + c: UNITS[m.part.topology.joints[c].s] for _, m, c in joints}
        #: those that are rates of ball joints, and have no positions
        self.without_positions = {a for ball in assembly.balls for a in ball.joints}
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
        if a is None or name.endswith("''") or (name in self.coordinates and a in self.without_positions):
            return None
        return self.rates[a] if name.endswith("'") else self._symbol(name, "coordinate", self.units[a])

    def _symbol(self, name: str, kind: str, unit: str) -> Expr:
        self.scope.symbols.setdefault(name, Symbol(name, kind, unit))
        return self.graph.symbol(name)
