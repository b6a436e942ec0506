"""Measures of two frames that the laws of loads may name, with their derivatives (notation.md, section 7).

With d from the origin of A to that of B, e_i the axes of A, m_j those of B:

===================  ==========================================================================================
distance(A, B)       l = sqrt(d . d) of the origins [m]; dl/dq^a = d . (u_Ba - u_Aa) / l
angle(A, B)          about the common third axis e3, from the first axis of A to that of B, above -pi and up to pi
                     [rad]: atan2(m_1 . e_2, m_1 . e_1); its derivative is (Omega_Ba - Omega_Aa) . e3
distance', angle'    their rates
===================  ==========================================================================================
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from substructures.expr.graph import Expr
from substructures.expr.syntax import measured
from substructures.loads.pairs import Pair, Place, Reach, rate, scaled
from substructures.loads.scope import Lookup, Scope


@dataclass(frozen=True)
class Measure:
    """Value of a measure of two frames, and its derivatives by the coordinates that change it."""

    value: Expr
    slopes: Reach


@dataclass
class Measures:
    """The measures of the frames of a part or of a tree; each is formed once.

    ``place``: the origin of a frame by its name and the place of the expression, None with a fault where there is none;
    ``plain``: what names that are no measures stand for.
    """

    scope: Scope
    place: Callable[[str, str], Place | None]
    plain: Lookup
    rates: Callable[[], Sequence[Expr]]
    _known: dict[str, Measure] = field(default_factory=dict, init=False)

    def at(self, pointer: str) -> Lookup:
        """The lookup of names of the expression at a pointer."""

        def lookup(name: str) -> Expr | None:
            """Measures, or what is plain."""
            measure = measured(name)
            if measure is None:
                return self.plain(name)
            found, graph = self.measure(name, pointer), self.scope.graph
            if found is None:
                # a fault that is noted
                return graph.zero
            return rate(graph, found.slopes, self.rates()) if measure[0].endswith("'") else found.value

        return lookup

    def standing_in(self, name: str) -> Expr | None:
        """The same lookup, with symbols of their names in the place of measures."""
        return self.plain(name) if measured(name) is None else self.scope.graph.symbol(name)

    def measure(self, name: str, pointer: str) -> Measure | None:
        """A measure by its name, without the mark of a rate; a fault, and None, where there is none."""
        parts = measured(name.replace("'", ""))
        if parts is None:
            return None
        kind, start, end = parts
        key = f"{kind}({start}, {end})"
        if key not in self._known:
            faults = len(self.scope.faults)
            A, B = self.place(start, pointer), self.place(end, pointer)
            if A is None or B is None or len(self.scope.faults) > faults:
                return None
            pair = Pair(self.scope.graph, A, B)
            found = self._distance(pair, key, pointer) if kind == "distance" else self._angle(pair, key, pointer)
            if found is None:
                return None
            self._known[key] = found
        return self._known[key]

    def _distance(self, pair: Pair, key: str, pointer: str) -> Measure | None:
        length2 = pair.length2()
        if length2.is_zero:
            self.scope.fault(pointer, "coincident-ends", f"{key}: one and the same point")
            return None
        length = pair.graph.sqrt(length2)
        return Measure(length, scaled(pair.reach(F=pair.d), 1 / length))

    def _angle(self, pair: Pair, key: str, pointer: str) -> Measure | None:
        first, _, third = pair.axes
        if not (common := pair.graph.lift(third[2])).is_number or common.value != 1:
            message = f"{key}: the third axes of the frames are not one and the same at all times"
            self.scope.fault(pointer, "no-common-axis", message)
            return None
        value = pair.graph.function("atan2", pair.graph.lift(first[1]), pair.graph.lift(first[0]))
        return Measure(value, pair.about(2))
