"""Where loads are read and act: in a part, in a tree, or in a part that has its place in a tree."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from substructures.documents.fields import in_si
from substructures.errors import SOUGHT, listed, meant
from substructures.expr.graph import Expr, Graph
from substructures.expr.steps import ExpressionError, measured
from substructures.expr.syntax import read
from substructures.loads.measures import MEASURES, Measure
from substructures.loads.pairs import Pair, Place, Reach, rate
from substructures.loads.scope import ExprVector, Lookup, Scope
from substructures.mechanics.linear3 import ZERO, Vector

NONE: frozenset[str] = frozenset()
LEFT_OUT = "the potential energy is without it, and energy balances count its work"


def names_in(value: Any) -> frozenset[str]:
    """The names in a number or expression; none in one that cannot be read, which is told where it is evaluated."""
    text = in_si(value)
    try:
        return frozenset(str(step.value) for step in read(text) if step.op == "name") if isinstance(text, str) else NONE
    except ExpressionError:
        return NONE


@dataclass(frozen=True)
class End:
    """An end of a load as a document gives it: a frame, and a point ``at`` in it [m], with their places.

    ``is_body``: in a part, whether it has to be a body.
    """

    frame: str
    pointer: str
    at: Sequence[Any] = ()
    at_pointer: str = ""
    is_body: bool = False


@dataclass(frozen=True)
class Elastic:
    """A spring and damper along ``ends``, read; ``given``: stiffness and rest length as written."""

    pointer: str
    ends: Sequence[Any]
    given: tuple[Any, Any]
    stiffness: Expr
    damping: Expr
    length: Expr


class Names(ABC):
    """The names of expressions, the frames and the coordinates (``coordinates``: index by name)."""

    coordinates: Mapping[str, int]
    #: of joints that move with another one: the coordinate that moves them, and their index
    moved: Mapping[str, tuple[str, int]] = {}

    def __init__(self, scope: Scope) -> None:
        self.scope = scope
        self.graph: Graph = scope.graph
        #: those that are known; each is formed once
        self._measures: dict[str, Measure] = {}

    @property
    @abstractmethod
    def rates(self) -> Sequence[Expr]:
        """q'^a of all coordinates."""

    @abstractmethod
    def plain(self, name: str) -> Expr | None:
        """What a name stands for that is no measure; None of one that is not known."""

    @abstractmethod
    def constant(self, name: str) -> Expr | None:
        """What a name stands for in a number that is constant: a parameter."""

    @abstractmethod
    def anchor(self, end: End, point: Vector) -> Any:
        """The frame of an end, with a point in it, for :meth:`place`; None after a fault."""

    @abstractmethod
    def place(self, anchor: Any) -> Place:
        """Where it is."""

    def end(self, end: End) -> Any:
        """The anchor of an end, and of its point; None after a fault."""
        point = self.scope.vector(end.at, end.at_pointer, self.constant) if end.at else ZERO
        return self.anchor(end, point)

    def pair(self, ends: Sequence[Any]) -> Pair:
        """Two ends at their places."""
        A, B = map(self.place, ends)
        return Pair(self.graph, A, B)

    def stretch(self, ends: Sequence[Any]) -> tuple[Reach, Expr]:
        """l dl/dq^a = d . (u_Ba - u_Aa) of the distance l of two ends, and l^2."""
        pair = self.pair(ends)
        length2 = pair.length2()
        return pair.reach(F=pair.d), length2

    def read(self, value: Any, pointer: str) -> Expr:
        """A number, or an expression that may name measures."""
        return self.scope.read(value, pointer, self.lookup(pointer))

    def lookup(self, pointer: str) -> Lookup:
        """What the names of the expression at a pointer stand for, measures among them."""

        def found(name: str) -> Expr | None:
            """Zero after a fault of a measure."""
            if measured(name) is None:
                return self.plain(name)
            measure = self.measure(name, pointer)
            if measure is None:
                return self.graph.zero
            return rate(self.graph, measure.slopes, self.rates) if "'" in name else measure.value

        return found

    def standing_in(self, name: str) -> Expr | None:
        """The same, with symbols of their names in the place of measures."""
        return self.plain(name) if measured(name) is None else self.graph.symbol(name)

    def measure(self, name: str, pointer: str) -> Measure | None:
        """A measure by its name, without the mark of a rate; a fault, and None, where there is none."""
        kind, start, end = measured(name.replace("'", "")) or ("", "", "")
        key = f"{kind}({start}, {end})"
        if key not in self._measures:
            anchors = [self.anchor(End(frame, pointer), ZERO) for frame in (start, end)]
            if None in anchors:
                return None
            form, code, message = MEASURES[kind]
            found = form(self.pair(anchors))
            if found is None:
                self.scope.fault(pointer, code, f"{key}: {message}")
                return None
            self._measures[key] = found
        return self._measures[key]

    def vector(self, values: Sequence[Any], pointer: str) -> ExprVector:
        """Three of them."""
        x, y, z = (self.read(value, f"{pointer}/{i}") for i, value in enumerate(values))
        return x, y, z

    def coordinate(self, name: str, pointer: str) -> int | None:
        """The index of a coordinate; a fault, and None, where there is none."""
        a = self.moved[name][1] if name in self.moved else self.coordinates.get(name)
        if a is None:
            like = meant(name, self.coordinates) if len(self.scope.faults) < SOUGHT else ""
            message = f"unknown coordinate '{name}'; there are {listed(self.coordinates) or 'none'}{like}"
            self.scope.fault(pointer, "unknown-coordinate", message)
        return a

    def moves(self, name: str) -> bool:
        """Whether it is a coordinate, a velocity or a measure."""
        coordinate = name.removesuffix("'")
        return coordinate in self.coordinates or coordinate in self.moved or measured(name) is not None

    def is_steady(self, *values: Any) -> bool:
        """Whether numbers or expressions name parameters, inputs and the time alone, nothing that moves."""
        return not any(self.moves(name) for value in values for name in names_in(value))

    def measures_in(self, *values: Any) -> bool:
        """Whether they name measures of frames."""
        return any(measured(name) is not None for value in values for name in names_in(value))

    def is_constant(self, *values: Any) -> bool:
        """Whether they name parameters alone."""
        return all(self.constant(name) is not None for value in values for name in names_in(value))

    def is_world(self, frame: str) -> bool:
        """Whether a frame is the world."""
        return frame == "world"

    def kept(self, energy: Expr, is_steady: bool, pointer: str) -> Expr:
        """The potential of springs, if what it is made of does not move; else zero, with a notice."""
        if is_steady:
            return energy
        self.without_potential(f"the stiffness or length of this load depends on what moves: {LEFT_OUT}", pointer)
        return self.graph.zero

    def without_potential(self, message: str, pointer: str) -> None:
        """Tell of a force whose potential is left out."""
        self.scope.notices.append({"pointer": pointer, "code": "no-potential", "message": message})

    def elastic(self, spring: Elastic, energy: Expr, pulls: Callable[[], Mapping[int, Expr]]) -> Expr:
        """The potential of a spring: ``energy``, if what it is given by does not move.

        ``pulls``: what it does to coordinates without damping.
        """
        del pulls
        return self.kept(energy, self.is_steady(*spring.given), spring.pointer)

    def formula(self, value: Any, pointer: str) -> tuple[Expr, list[Expr]]:
        """A force that is given as a formula, and its terms, if a potential of them is looked for."""
        return self.read(value, pointer), []
