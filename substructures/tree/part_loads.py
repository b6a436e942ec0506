"""What acts between two frames of one part, in the places that its bodies have in a tree: springs, bushings, forces and
torques, potentials of measures. Parts store the generalised forces of these alone, so that the laws are read again from
their definitions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from substructures.expr.graph import Expr, Graph
from substructures.expr.syntax import measured
from substructures.mechanics.linear3 import ZERO, Vector
from substructures.part.definition import (
    BushingLoad,
    ForceBetween,
    PotentialLoad,
    SpringLoad,
    TorqueBetween,
)
from substructures.part.load_names import names_in
from substructures.part.pair_laws import BushingLaw, Measures, bushing_forces, potential_forces, spring_forces
from substructures.part.pairs import Acting, Pair, Place, Reach, axes_in_world
from substructures.part.scope import ExprVector
from substructures.tree.assembly import Assembly
from substructures.tree.frame_points import place_of
from substructures.tree.load_names import LoadNames
from substructures.tree.mounted_part import PlacedPart


def loads_of_parts(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> Iterator[Acting]:
    """Of all parts; ``rates``: q'^a."""
    names = LoadNames(assembly, placed, rates)
    for instance, here in zip(assembly.instances, placed, strict=True):
        inside = _Inside(names, here, instance.name)
        for load in here.part.definition.loads:
            reader = _READERS.get(type(load))
            if reader is not None:
                yield from reader(inside, load).acting


class _Inside:
    """The names of one part in a tree."""

    def __init__(self, names: LoadNames, here: PlacedPart, instance: str) -> None:
        self.names, self.here, self.instance = names, here, instance
        self.graph: Graph = names.graph
        self.measures = Measures(names.assembly.scope, lambda at, _: self.place(at), self.plain, lambda: names.rates)

    def plain(self, name: str) -> Expr | None:
        """What a name of the definition stands for in the tree."""
        return self.names.plain(name if name == "t" else f"{self.instance}.{name}")

    def place(self, frame: str, at: Vector = ZERO) -> Place:
        """A point of a body or port."""
        return place_of(self.here, self.here.part.frames.index(frame), at)

    def read(self, value: Any) -> Expr:
        """A number or an expression."""
        return self.names.assembly.scope.read(value, "", self.measures.at(""))

    def vector(self, values: Sequence[Any]) -> ExprVector:
        """Three of them."""
        x, y, z = map(self.read, values)
        return x, y, z

    def pair(self, A: Place, B: Place) -> Pair:
        """Two places."""
        return Pair(self.graph, A, B)


def _spring(inside: _Inside, load: SpringLoad) -> Reach:
    A, B = (inside.place(end.body, inside.vector(end.at)) for end in (load.from_, load.to))
    pair = inside.pair(A, B)
    law = inside.read(load.stiffness), inside.read(load.damping), inside.read(load.length)
    return spring_forces(pair, pair.length2(), law, inside.names.rates)[0]


def _bushing(inside: _Inside, load: BushingLoad) -> Reach:
    fields = load.stiffness, load.damping, load.angular_stiffness, load.angular_damping
    pair = inside.pair(inside.place(load.from_), inside.place(load.to))
    return bushing_forces(pair, BushingLaw(*map(inside.vector, fields)), inside.names.rates)[0]


def _between(inside: _Inside, load: ForceBetween | TorqueBetween) -> Reach:
    """In the axes of one of the frames; in those of the world it is a wrench on either body."""
    if load.axes == "world":
        return Reach({})
    at = inside.vector(load.at) if isinstance(load, ForceBetween) else ZERO
    pair = inside.pair(inside.place(load.from_), inside.place(load.to, at))
    vector = axes_in_world(pair.A if load.axes == "from" else pair.B, inside.vector(load.vector))
    return pair.reach(F=vector) if isinstance(load, ForceBetween) else pair.reach(N=vector)


def _potential(inside: _Inside, load: PotentialLoad) -> Reach:
    """What it does through measures of frames; the rest is in the joints."""
    used = [name for name in sorted(names_in(load.potential)) if measured(name) is not None]
    energy = inside.names.assembly.scope.read(load.potential, "", inside.measures.standing_in)
    found = {name: inside.measures.measure(name, "") for name in used}
    known = {name: each for name, each in found.items() if each is not None}
    return potential_forces(inside.graph, energy, used, {}, known)[0]


_READERS: dict[type, Callable[[_Inside, Any], Reach]] = {
    SpringLoad: _spring,
    BushingLoad: _bushing,
    ForceBetween: _between,
    TorqueBetween: _between,
    PotentialLoad: _potential,
}
