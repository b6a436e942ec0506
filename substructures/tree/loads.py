"""The loads of a tree as formulas, from the poses and columns of the frames between which they act (notation.md,
section 7): nothing of the parts is derived again.

With d, l = |d| from the point of A (``from``) to that of B (``to``), d_i its components in the axes e_i of A, m_j the
axes of B, and w_a what a unit force or moment does for q'^a = 1 (:mod:`substructures.tree.places`):

=========  ================================================================  ====================================
load       Q_a                                                               V
=========  ================================================================  ====================================
spring     -(k (1 - l0/l) + c l'/l) d . (u_Ba - u_Aa)                        k/2 (l - l0)^2
bushing    -(k_i d_i + c_i d_i') d(d_i)/dq^a + (h_j (m_j x e_j)_i            k_i/2 d_i^2 + h_j (1 - m_j . e_j)
           - c_i w_i) w_ia,    h_j = (k_1 + k_2 + k_3)/2 - k_j of angles
force      F . (u_Ba - u_Aa) at the place of the point of B                  -F . x, constant in the world alone
torque     M . (Omega_Ba - Omega_Aa)
joint      as given
potential  -dV/dq^a - dV/ds ds/dq^a of coordinates and measures s            as given
=========  ================================================================  ====================================

A spring or bushing whose stiffness or length names what moves is a force without potential, as are joint loads.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.syntax import measured
from substructures.expr.walk import transfer
from substructures.mechanics.linear3 import IDENTITY, Vector, add, cross, dot, scale
from substructures.part.load_names import names_in
from substructures.tree.assembly import Assembly
from substructures.tree.load_document import (
    Bushing,
    TreeForce,
    TreeJointLoad,
    TreePotential,
    TreeSpring,
    TreeTorque,
)
from substructures.tree.load_names import LoadNames
from substructures.tree.mounted_part import PlacedPart
from substructures.tree.places import Pair, Reach, added, axes_in_world, rate, scaled

HALF = Fraction(1, 2)
LEFT_OUT = "the potential energy is without it, and energy balances count its work"


@dataclass(frozen=True)
class LoadFormulas:
    """What a load does: ``forces`` Q_a by coordinate of the tree, ``potential`` V with -d_a V a part of them.

    ``forces.acting``: the forces and moments between frames that they are of.
    """

    forces: Reach
    potential: Expr


def load_formulas(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> LoadFormulas:
    """All loads of a tree together; ``placed``: its parts over formulas. Raises InvalidDocument."""
    found = loads_apart(assembly, placed, rates)
    energy = assembly.scope.graph.sum(each.potential for each in found)
    return LoadFormulas(added(each.forces for each in found), energy)


def loads_apart(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> list[LoadFormulas]:
    """Every load of a tree alone, in their order. Raises InvalidDocument."""
    names = LoadNames(assembly, placed, rates)
    found = [_READERS[type(load)](names, load, f"/loads/{i}") for i, load in enumerate(assembly.reading.spec.loads)]
    assembly.scope.finish()
    return found


def _read(names: LoadNames, value: object, pointer: str) -> Expr:
    return names.assembly.scope.read(value, pointer, names.at(pointer))


def _vector(names: LoadNames, values: Sequence[object], pointer: str) -> tuple[Expr, Expr, Expr]:
    x, y, z = (_read(names, value, f"{pointer}/{i}") for i, value in enumerate(values))
    return x, y, z


def _point(names: LoadNames, values: Sequence[object], pointer: str) -> tuple[Expr, Expr, Expr]:
    """A constant place in a frame."""
    return names.assembly.scope.vector(values, pointer, names.assembly.reading.parameter)


def _spring(names: LoadNames, load: TreeSpring, pointer: str) -> LoadFormulas:
    A = names.place(load.from_, f"{pointer}/from", _point(names, load.from_at, f"{pointer}/from_at"))
    B = names.place(load.to, f"{pointer}/to", _point(names, load.to_at, f"{pointer}/to_at"))
    k, c, l0 = (_read(names, getattr(load, x), f"{pointer}/{x}") for x in ("stiffness", "damping", "length"))
    graph: Graph = names.graph
    pair = Pair(graph, A, B)
    length2 = pair.length2()
    if length2.is_zero:
        message = f"the ends of the spring '{load.name}' are one and the same point"
        names.assembly.scope.fault(pointer, "coincident-ends", message)
        return LoadFormulas(Reach({}), graph.zero)
    forces, energy = spring_forces(pair, length2, (k, c, l0), names.rates)
    return LoadFormulas(forces, _kept(names, energy, pointer, load.stiffness, load.length))


def spring_forces(pair: Pair, length2: Expr, law: tuple[Expr, Expr, Expr], rates: Sequence[Expr]) -> tuple[Reach, Expr]:
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


def _kept(names: LoadNames, energy: Expr, pointer: str, *values: object) -> Expr:
    """The potential of springs, if what it is made of does not move; else zero, with a notice."""
    if names.is_steady(*values):
        return energy
    message = f"the stiffness or length of this load depends on what moves: {LEFT_OUT}"
    names.assembly.scope.notices.append({"pointer": pointer, "code": "no-potential", "message": message})
    zero: Expr = names.graph.zero
    return zero


def _bushing(names: LoadNames, load: Bushing, pointer: str) -> LoadFormulas:
    graph: Graph = names.graph
    pair = Pair(graph, names.place(load.from_, f"{pointer}/from"), names.place(load.to, f"{pointer}/to"))
    fields = ("stiffness", "damping", "angular_stiffness", "angular_damping")
    k, c, ka, ca = (_vector(names, getattr(load, name), f"{pointer}/{name}") for name in fields)
    d, m = tuple(map(graph.lift, pair.d_A)), pair.axes
    # h_j of the angular springs; their moment h_j m_j x e_j in the axes of A
    h = [(ka[0] + ka[1] + ka[2]) * HALF - ka[j] for j in range(3)]
    moments = [scale(h[j], cross(m[j], IDENTITY[j])) for j in range(3)]
    turning = [graph.lift(x) for x in add(add(moments[0], moments[1]), moments[2])]
    forces: list[dict[int, Expr]] = []
    for push, damping, way in ((tuple(-k[i] * d[i] for i in range(3)), c, pair.along), (turning, ca, pair.about)):
        for i in range(3):
            if push[i].is_zero and damping[i].is_zero:
                continue
            reach = way(i)
            forces.append(scaled(reach, push[i] - damping[i] * rate(graph, reach, names.rates)))
    along = graph.sum(k[i] * d[i] ** 2 * HALF for i in range(3))
    about = graph.sum(h[j] * (1 - graph.lift(m[j][j])) for j in range(3))
    energy = _kept(names, along, f"{pointer}/stiffness", *load.stiffness)
    energy = energy + _kept(names, about, f"{pointer}/angular_stiffness", *load.angular_stiffness)
    return LoadFormulas(added(forces), energy)


def _force(names: LoadNames, load: TreeForce, pointer: str) -> LoadFormulas:
    A = names.place(load.from_, f"{pointer}/from")
    B = names.place(load.to, f"{pointer}/to", _point(names, load.at, f"{pointer}/at"))
    F = _in_world(names, load, pointer, Pair(names.graph, A, B))
    zero: Expr = names.graph.zero
    energy = zero
    if load.from_ == "world" and load.axes != "to" and B.path and names.is_constant(*load.vector):
        # V = -F . x of a force that is constant in the world
        energy = -names.graph.lift(dot(F, B.pose.r))
    return LoadFormulas(Pair(names.graph, A, B).reach(F=F), energy)


def _torque(names: LoadNames, load: TreeTorque, pointer: str) -> LoadFormulas:
    A, B = names.place(load.from_, f"{pointer}/from"), names.place(load.to, f"{pointer}/to")
    pair = Pair(names.graph, A, B)
    return LoadFormulas(pair.reach(N=_in_world(names, load, pointer, pair)), names.graph.zero)


def _in_world(names: LoadNames, load: TreeForce | TreeTorque, pointer: str, pair: Pair) -> Vector:
    """The vector of a load in the axes of the world."""
    given = _vector(names, load.vector, f"{pointer}/vector")
    if load.axes == "world":
        return given
    return axes_in_world(pair.A if load.axes == "from" else pair.B, given)


def _joint_force(names: LoadNames, load: TreeJointLoad, pointer: str) -> LoadFormulas:
    a = names.coordinates.get(load.coordinate)
    if a is None:
        known = ", ".join(names.coordinates) or "none"
        message = f"unknown coordinate '{load.coordinate}'; there are {known}"
        names.assembly.scope.fault(f"{pointer}/coordinate", "unknown-coordinate", message)
        return LoadFormulas(Reach({}), names.graph.zero)
    return LoadFormulas(Reach({a: _read(names, load.force, f"{pointer}/force")}), names.graph.zero)


def _potential(names: LoadNames, load: TreePotential, pointer: str) -> LoadFormulas:
    """Q_a = -dV/dq^a, where V depends on measures s, too: -dV/ds ds/dq^a."""
    place, scope, graph = f"{pointer}/potential", names.assembly.scope, names.graph
    energy = scope.read(load.potential, place, names.standing_in)
    used = sorted(name for name in names_in(load.potential) if names.moves(name)) if not scope.faults else []
    for name in used:
        if "'" in name:
            message = f"a potential depends on coordinates, not on velocities: '{name}' is one"
            scope.fault(place, "velocity-in-potential", message)
    measures = {name: names.measure(name, place) for name in used if measured(name) is not None}
    if scope.faults:
        return LoadFormulas(Reach({}), graph.zero)
    try:
        slopes = [derivative(energy, name) for name in used]
    except ZeroDivisionError:
        scope.fault(place, "division-by-zero", "the derivative of this potential has no value anywhere")
        return LoadFormulas(Reach({}), graph.zero)
    bound = {name: each.value for name, each in measures.items() if each is not None}
    forces: list[Mapping[int, Expr]] = []
    for name, slope in zip(used, transfer(slopes, graph, bound), strict=True):
        measure = measures.get(name)
        forces.append({names.coordinates[name]: -slope} if measure is None else scaled(measure.slopes, -slope))
    return LoadFormulas(added(forces), transfer([energy], graph, bound)[0])


_READERS: dict[type, Callable[[LoadNames, Any, str], LoadFormulas]] = {
    TreeSpring: _spring,
    Bushing: _bushing,
    TreeForce: _force,
    TreeTorque: _torque,
    TreeJointLoad: _joint_force,
    TreePotential: _potential,
}
