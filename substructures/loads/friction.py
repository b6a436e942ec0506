"""Dry friction of a coordinate: Q_a = -(F_c + (F_s - F_c) exp(-(q'/v_s)^2)) tanh(q'/v_0).

Of a part it is a law of the joint, as the field ``friction`` of it (:mod:`substructures.part.mechanism`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from substructures.documents.fields import DocumentPart, Name, Number
from substructures.documents.units import Dimension
from substructures.expr.graph import Expr
from substructures.expr.laws.formulas import tanh
from substructures.expr.units.unit_check import Place
from substructures.loads.document import CoordinateOfTree, Load, LoadFormulas, OfTree
from substructures.loads.names import Names
from substructures.loads.pairs import Reach
from substructures.loads.scope import Lookup, Scope
from substructures.loads.units import EFFORT, RATE, fields_of, of_kind

#: dimensions of its numbers, of a revolute and of a prismatic coordinate
FRICTION: dict[str, tuple[Dimension, Dimension]] = {
    **dict.fromkeys(("coulomb", "static"), EFFORT),
    **dict.fromkeys(("stribeck", "velocity"), RATE),
}


class FrictionLaw(DocumentPart):
    """Dry friction of a coordinate, against its rate v: (F_c + (F_s - F_c) exp(-(v/v_s)^2)) tanh(v/v_0).

    Without ``stribeck`` it is F_c tanh(v/v_0), and ``static`` is that of rest alone, in simulations that stick exactly.
    """

    coulomb: Number = Field(description="F_c; N m or N")
    static: Number | None = Field(None, description="F_s, at rest, default as coulomb; N m or N")
    stribeck: Number | None = Field(None, description="v_s, over which it falls from static to coulomb; rad/s or m/s")
    velocity: Number = Field(description="v_0, over which the direction changes; rad/s or m/s")


class FrictionLoad(FrictionLaw, Load):
    """Dry friction of a coordinate, as the field ``friction`` of its joint; a coordinate has one."""

    type: Literal["friction"]
    coordinate: Name

    def places(self, pointer: str, kinds: Mapping[str, int]) -> Iterator[Place]:
        """By the coordinate."""
        if self.coordinate in kinds:
            yield from fields_of(pointer, self, of_kind(FRICTION, kinds[self.coordinate]))


class TreeFriction(OfTree, FrictionLoad):
    """Dry friction of a coordinate of an instance, as the field ``friction`` of its joint; a coordinate has one."""

    coordinate: CoordinateOfTree

    def law(self, names: Names, pointer: str) -> FrictionForce | None:
        """The smooth law; its numbers are an output besides (:attr:`substructures.tree.assembly.Assembly.friction`)."""
        a = names.coordinate(self.coordinate, f"{pointer}/coordinate")
        friction = read_friction(names.scope, self, pointer, names.constant)
        return None if a is None or friction is None else FrictionForce(a, friction)


@dataclass(frozen=True)
class Friction:
    """Dry friction of a coordinate; expressions in parameters. ``stribeck``: None where it does not fall with speed."""

    coulomb: Expr
    static: Expr
    stribeck: Expr | None
    velocity: Expr

    def force(self, rate: Expr) -> Expr:
        """(F_c + (F_s - F_c) exp(-(q'/v_s)^2)) tanh(q'/v_0), which changes its direction over some v_0.

        The first factor: B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, Automatica 30, 1994.
        """
        size = self.coulomb
        if self.stribeck is not None:
            size = size + (self.static - self.coulomb) * rate.graph.function("exp", -((rate / self.stribeck) ** 2))
        return size * tanh(rate / self.velocity)

    def row(self) -> tuple[Expr, Expr, Expr, Expr]:
        """F_c, F_s, v_s (0 where there is none) and v_0."""
        return self.coulomb, self.static, self.stribeck or self.coulomb.graph.zero, self.velocity


@dataclass(frozen=True)
class FrictionForce:
    """The coordinate by index, and its friction."""

    a: int
    friction: Friction

    def acts(self, names: Names, found: LoadFormulas) -> None:
        """The force."""
        found.add(Reach({self.a: -self.friction.force(names.rates[self.a])}))


def read_friction(scope: Scope, given: FrictionLaw, place: str, lookup: Lookup | None = None) -> Friction | None:
    """The numbers of dry friction; None after a fault."""
    read = {
        name: scope.read(value, f"{place}/{name}", lookup)
        for name in ("coulomb", "static", "stribeck", "velocity")
        if (value := getattr(given, name)) is not None
    }
    for name, x in read.items():
        is_speed = name in ("stribeck", "velocity")
        if x.is_number and (x.negative or (is_speed and x.is_zero)) and not scope.faults:
            what = "positive" if is_speed else "not negative"
            scope.fault(f"{place}/{name}", "bad-friction", f"{name} of friction is {what}")
            return None
    if scope.faults:
        return None
    return Friction(read["coulomb"], read.get("static", read["coulomb"]), read.get("stribeck"), read["velocity"])
