"""Forces by their potential V in coordinates and measures s of frames: Q_a = -dV/dq^a - dV/ds ds/dq^a."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import Field

from substructures.documents.fields import Number
from substructures.documents.units import Dimension
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr
from substructures.expr.steps import measured
from substructures.expr.walk import transfer
from substructures.loads.document import Load, LoadFormulas, OfTree
from substructures.loads.measures import Measure
from substructures.loads.names import Names, names_in
from substructures.loads.pairs import Reach
from substructures.loads.units import ENERGY


class PotentialLoad(Load):
    """Forces by their potential V in coordinates, parameters, inputs and t: Q_a = -dV/dq^a."""

    dimensions: ClassVar[Mapping[str, Dimension]] = {"potential": ENERGY}

    type: Literal["potential"]
    potential: Number = Field(description="J")

    def law(self, names: Names, pointer: str) -> PotentialLaw | None:
        """V(q, s, u, t); a velocity in it is a fault, since then -d_a V would not be the force."""
        place, before = f"{pointer}/potential", len(names.scope.faults)
        energy = names.scope.read(self.potential, place, names.standing_in)
        if len(names.scope.faults) > before:
            return None
        used = sorted(name for name in names_in(self.potential) if names.moves(name))
        for name in used:
            if "'" in name:
                message = f"a potential depends on coordinates, not on velocities: '{name}' is one"
                names.scope.fault(place, "velocity-in-potential", message)
        found = {name: names.measure(name, place) for name in used if measured(name) is not None}
        measures = {name: each for name, each in found.items() if each is not None}
        # d/dq of a joint that moves with another one is that by the other's coordinate
        movers = sorted({names.moved[name][0] if name in names.moved else name for name in used})
        return None if len(names.scope.faults) > before else PotentialLaw(place, energy, movers, measures)


class TreePotential(OfTree, PotentialLoad):
    """Forces by their potential V in coordinates, measures of frames, parameters, inputs and t: Q_a = -dV/dq^a."""


@dataclass(frozen=True)
class PotentialLaw:
    """The energy with symbols in the place of ``measures``, and the coordinates and measures that it names."""

    pointer: str
    energy: Expr
    used: list[str]
    measures: Mapping[str, Measure]

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """Forces, and the potential in coordinates."""
        graph, bound = names.graph, {name: each.value for name, each in self.measures.items()}
        try:
            *slopes, energy = transfer([*(derivative(self.energy, q) for q in self.used), self.energy], graph, bound)
        except ZeroDivisionError:
            message = "the derivative of this potential has no value anywhere"
            names.scope.fault(self.pointer, "division-by-zero", message)
            return
        for name, slope in zip(self.used, slopes, strict=True):
            if name in self.measures:
                found.add(self.measures[name].slopes, -slope)
            else:
                found.add(Reach({names.coordinates[name]: -slope}))
        found.keep(energy)
