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

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from substructures.expr.graph import Expr
from substructures.loads.pairs import Pair, Reach, scaled


@dataclass(frozen=True)
class Measure:
    """Value of a measure of two frames, and its derivatives by the coordinates that change it."""

    value: Expr
    slopes: Reach


def distance(pair: Pair) -> Measure | None:
    """Of the origins; None of one and the same point."""
    length2 = pair.length2()
    if length2.is_zero:
        return None
    length = pair.graph.sqrt(length2)
    return Measure(length, scaled(pair.reach(F=pair.d), 1 / length))


def angle(pair: Pair) -> Measure | None:
    """About the common third axis; None where that is not common at all times."""
    first, _, third = pair.axes
    if not (common := pair.graph.lift(third[2])).is_number or common.value != 1:
        return None
    value = pair.graph.function("atan2", pair.graph.lift(first[1]), pair.graph.lift(first[0]))
    return Measure(value, pair.about(2))


#: by name, with what is said where there is none: code and message
MEASURES: Mapping[str, tuple[Callable[[Pair], Measure | None], str, str]] = {
    "distance": (distance, "coincident-ends", "one and the same point"),
    "angle": (angle, "no-common-axis", "the third axes of the frames are not one and the same at all times"),
}
