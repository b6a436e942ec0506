"""Laws between two places, as formulas of their poses and columns (notation.md, section 7): of parts and of trees.

With d, l = |d| from the place A to the place B, d_i its components in the axes e_i of A, m_j the axes of B, and w_a
what a unit force or moment does for q'^a = 1 (:mod:`substructures.part.pairs`):

===================  ==========================================================================================
spring               Q_a = -(k (1 - l0/l) + c l'/l) d . (u_Ba - u_Aa),   V = k/2 (l - l0)^2
bushing              Q_a = -(k_i d_i + c_i d_i') d(d_i)/dq^a + (h_j (m_j x e_j)_i - c_i w_i) w_ia,
                     V = k_i/2 d_i^2 + h_j (1 - m_j . e_j),   h_j = (k_1 + k_2 + k_3)/2 - k_j of angles
distance(A, B)       l = sqrt(d . d) of the origins [m]; dl/dq^a = d . (u_Ba - u_Aa) / l
angle(A, B)          about the common third axis e3, from the first axis of A to that of B, above -pi and up to pi
                     [rad]: atan2(m_1 . e_2, m_1 . e_1); its derivative is (Omega_Ba - Omega_Aa) . e3
distance', angle'    their rates
potential            Q_a = -dV/dq^a - dV/ds ds/dq^a of coordinates and measures s
===================  ==========================================================================================
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction

from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.syntax import measured
from substructures.expr.walk import transfer
from substructures.mechanics.linear3 import IDENTITY, add, cross, scale
from substructures.part.pairs import Pair, Place, Reach, added, rate, scaled
from substructures.part.scope import ExprVector, Lookup, Scope

HALF = Fraction(1, 2)
LEFT_OUT = "the potential energy is without it, and energy balances count its work"


def spring_forces(pair: Pair, length2: Expr, law: ExprVector, rates: Sequence[Expr]) -> tuple[Reach, Expr]:
    """Q_a and k/2 (l - l0)^2 of a spring between two places, l^2 apart; ``law``: stiffness, damping, rest length."""
    (k, c, l0), graph = law, pair.graph
    # w_a = d . (u_Ba - u_Aa),   l l' = w_a q'^a
    reach = pair.reach(F=pair.d)
    factor, energy = k, k * length2 * HALF
    if not l0.is_zero:
        length = graph.sqrt(length2)
        factor, energy = k - k * l0 / length, k * (length - l0) ** 2 * HALF
    if not c.is_zero:
        factor = factor + c * rate(graph, reach, rates) / length2
    return scaled(reach, -factor), energy


@dataclass(frozen=True)
class BushingLaw:
    """Of a bushing: stiffness and damping along and about the three axes of A."""

    stiffness: ExprVector
    damping: ExprVector
    angular_stiffness: ExprVector
    angular_damping: ExprVector


def bushing_forces(pair: Pair, law: BushingLaw, rates: Sequence[Expr]) -> tuple[Reach, Expr, Expr]:
    """Q_a of a bushing, and its energies along and about the axes."""
    graph = pair.graph
    k, ka = law.stiffness, law.angular_stiffness
    d, m = tuple(map(graph.lift, pair.d_A)), pair.axes
    # h_j of the angular springs; their moment h_j m_j x e_j in the axes of A
    h = [(ka[0] + ka[1] + ka[2]) * HALF - ka[j] for j in range(3)]
    moments = [scale(h[j], cross(m[j], IDENTITY[j])) for j in range(3)]
    turning = [graph.lift(x) for x in add(add(moments[0], moments[1]), moments[2])]
    pushing = tuple(-k[i] * d[i] for i in range(3))
    forces: list[Reach] = []
    for push, damping, way in ((pushing, law.damping, pair.along), (turning, law.angular_damping, pair.about)):
        for i in range(3):
            if push[i].is_zero and damping[i].is_zero:
                continue
            reach = way(i)
            forces.append(scaled(reach, push[i] - damping[i] * rate(graph, reach, rates)))
    along = graph.sum(k[i] * d[i] ** 2 * HALF for i in range(3))
    about = graph.sum(h[j] * (1 - graph.lift(m[j][j])) for j in range(3))
    return added(forces), along, about


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


def potential_forces(
    graph: Graph, energy: Expr, names: Sequence[str], coordinates: Mapping[str, int], measures: Mapping[str, Measure]
) -> tuple[Reach, Expr]:
    """Q_a of a potential that depends on ``names``, with symbols in the place of ``measures``, and the potential in
    coordinates. Raises ZeroDivisionError where it has no derivative anywhere.
    """
    slopes = [derivative(energy, name) for name in names]
    bound = {name: each.value for name, each in measures.items()}
    forces: list[Mapping[int, Expr]] = []
    for name, slope in zip(names, transfer(slopes, graph, bound), strict=True):
        measure = measures.get(name)
        forces.append({coordinates[name]: -slope} if measure is None else scaled(measure.slopes, -slope))
    return added(forces), transfer([energy], graph, bound)[0]


def kept(energy: Expr, is_steady: bool, scope: Scope, pointer: str) -> Expr:
    """The potential of a spring, if what it is made of does not move; else zero, with a notice."""
    if is_steady:
        return energy
    message = f"the stiffness or length of this load depends on what moves: {LEFT_OUT}"
    scope.notices.append({"pointer": pointer, "code": "no-potential", "message": message})
    return scope.graph.zero
