"""What expressions of the loads of a tree may name: parameters, coordinates, velocities, inputs, the time, and measures
of two frames (the HTTP contract, section 3).

===================  ==========================================================================================
distance(A, B)       l = sqrt(d . d) of the origins [m]; dl/dq^a = d . (u_Ba - u_Aa) / l
angle(A, B)          about the common third axis e3, from the first axis of A to that of B, above -pi and up to pi
                     [rad]: atan2(m_1 . e_2, m_1 . e_1) with the axes m_j of B in A; its derivative is
                     (Omega_Ba - Omega_Aa) . e3
distance', angle'    their rates
===================  ==========================================================================================
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
from substructures.part.parameters import si_unit
from substructures.part.scope import Lookup
from substructures.tree.assembly import Assembly
from substructures.tree.mounted_part import PlacedPart
from substructures.tree.places import Pair, Place, Reach, place, rate, scaled

#: of a revolute and of a prismatic coordinate
UNITS = ("rad", "m")


@dataclass(frozen=True)
class Measure:
    """Value of a measure of two frames, and its derivatives by the coordinates that change it."""

    value: Expr
    slopes: Reach


@dataclass
class LoadNames:
    """The names of a tree at their places; ``placed``: its parts over formulas; ``rates``: q'^a."""

    assembly: Assembly
    placed: Sequence[PlacedPart]
    rates: Sequence[Expr]
    coordinates: dict[str, int] = field(init=False)
    _measures: dict[str, Measure] = field(default_factory=dict, init=False)

    def __post_init__(self) -> None:
        pairs = zip(self.assembly.instances, self.assembly.mounted, strict=True)
        names = [f"{i.name}.{joint.coordinate}" for i, m in pairs for joint in m.part.topology.joints]
        self.coordinates = {name: a for a, name in enumerate(names)}
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

    def at(self, pointer: str) -> Lookup:
        """The lookup of names of the expression at a pointer."""

        def lookup(name: str) -> Any:
            """Parameters first."""
            measure = measured(name)
            if measure is None:
                return self._plain(name)
            found = self.measure(name, pointer)
            if found is None:
                # a fault that is noted
                return self.graph.zero
            return rate(self.graph, found.slopes, self.rates) if measure[0].endswith("'") else found.value

        return lookup

    def standing_in(self, name: str) -> Expr | None:
        """The same lookup, with symbols of their names in the place of measures."""
        symbol: Expr | None = self._plain(name) if measured(name) is None else self.graph.symbol(name)
        return symbol

    @property
    def graph(self) -> Any:
        """Where formulas are made."""
        return self.assembly.scope.graph

    def measure(self, name: str, pointer: str) -> Measure | None:
        """A measure by its name, without the mark of a rate; a fault, and None, where there is none."""
        parts = measured(name.replace("'", ""))
        if parts is None:
            return None
        kind, start, end = parts
        key = f"{kind}({start}, {end})"
        if key not in self._measures:
            pair = Pair(self.graph, self.place(start, pointer), self.place(end, pointer))
            found = self._distance(pair, key, pointer) if kind == "distance" else self._angle(pair, key, pointer)
            if found is None:
                return None
            self._measures[key] = found
        return self._measures[key]

    def _distance(self, pair: Pair, key: str, pointer: str) -> Measure | None:
        length2 = pair.length2()
        if length2.is_zero:
            self._fault(pointer, "coincident-ends", f"{key}: one and the same point")
            return None
        length = self.graph.sqrt(length2)
        return Measure(length, scaled(pair.reach(F=pair.d), 1 / length))

    def _angle(self, pair: Pair, key: str, pointer: str) -> Measure | None:
        first, _, third = pair.axes
        if not (common := self.graph.lift(third[2])).is_number or common.value != 1:
            message = f"{key}: the third axes of the frames are not one and the same at all times"
            self._fault(pointer, "no-common-axis", message)
            return None
        value = self.graph.function("atan2", self.graph.lift(first[1]), self.graph.lift(first[0]))
        return Measure(value, pair.about(2))

    def _fault(self, pointer: str, code: str, message: str) -> None:
        self.assembly.scope.fault(pointer, code, message)

    def _plain(self, name: str) -> Expr | None:
        """Of anything but a measure."""
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
