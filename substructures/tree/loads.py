"""The loads of a tree as formulas, from the poses and columns of the frames between which they act (notation.md,
section 7): nothing of the parts is derived again.

Springs, bushings, measures and potentials of these are laws between two places (:mod:`substructures.part.pair_laws`);
the others, with A (``from``) and B (``to``):

=========  ================================================================  ====================================
load       Q_a                                                               V
=========  ================================================================  ====================================
force      F . (u_Ba - u_Aa) at the place of the point of B                  -F . x, constant in the world alone
torque     M . (Omega_Ba - Omega_Aa)
joint      as given
friction   -(F_c + (F_s - F_c) exp(-(q'/v_s)^2)) tanh(q'/v_0)
potential  -dV/dq^a - dV/ds ds/dq^a of coordinates and measures s            as given
=========  ================================================================  ====================================

A spring or bushing whose stiffness or length names what moves is a force without potential, as are joint loads.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from substructures.errors import listed, meant
from substructures.expr.graph import Expr, Graph
from substructures.expr.syntax import measured
from substructures.mechanics.linear3 import Vector, dot
from substructures.part.load_names import names_in
from substructures.part.mechanism import read_friction
from substructures.part.pair_laws import BushingLaw, bushing_forces, kept, potential_forces, spring_forces
from substructures.part.pairs import Pair, Reach, added, axes_in_world
from substructures.tree.assembly import Assembly
from substructures.tree.load_document import (
    Bushing,
    TreeForce,
    TreeFriction,
    TreeJointLoad,
    TreePotential,
    TreeSpring,
    TreeTorque,
)
from substructures.tree.load_names import LoadNames
from substructures.tree.mounted_part import PlacedPart


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
    faults = len(names.assembly.scope.faults)
    A = names.place(load.from_, f"{pointer}/from", _point(names, load.from_at, f"{pointer}/from_at"))
    B = names.place(load.to, f"{pointer}/to", _point(names, load.to_at, f"{pointer}/to_at"))
    k, c, l0 = (_read(names, getattr(load, x), f"{pointer}/{x}") for x in ("stiffness", "damping", "length"))
    graph: Graph = names.graph
    pair = Pair(graph, A, B)
    length2 = pair.length2()
    if length2.is_zero and len(names.assembly.scope.faults) > faults:
        return LoadFormulas(Reach({}), graph.zero)  # an end of it is not known
    if length2.is_zero:
        message = f"the ends of the spring '{load.name}' are one and the same point"
        names.assembly.scope.fault(pointer, "coincident-ends", message)
        return LoadFormulas(Reach({}), graph.zero)
    forces, energy = spring_forces(pair, length2, (k, c, l0), names.rates)
    return LoadFormulas(forces, _kept(names, energy, pointer, load.stiffness, load.length))


def _kept(names: LoadNames, energy: Expr, pointer: str, *values: object) -> Expr:
    """The potential of springs, if what it is made of does not move."""
    return kept(energy, names.is_steady(*values), names.assembly.scope, pointer)


def _bushing(names: LoadNames, load: Bushing, pointer: str) -> LoadFormulas:
    pair = Pair(names.graph, names.place(load.from_, f"{pointer}/from"), names.place(load.to, f"{pointer}/to"))
    fields = ("stiffness", "damping", "angular_stiffness", "angular_damping")
    law = BushingLaw(*(_vector(names, getattr(load, name), f"{pointer}/{name}") for name in fields))
    forces, along, about = bushing_forces(pair, law, names.rates)
    energy = _kept(names, along, f"{pointer}/stiffness", *load.stiffness)
    energy = energy + _kept(names, about, f"{pointer}/angular_stiffness", *load.angular_stiffness)
    return LoadFormulas(forces, energy)


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


def _coordinate(names: LoadNames, load: TreeJointLoad | TreeFriction, pointer: str) -> int | None:
    a = names.coordinates.get(load.coordinate)
    if a is None:
        known = f"there are {listed(names.coordinates) or 'none'}{meant(load.coordinate, names.coordinates)}"
        message = f"unknown coordinate '{load.coordinate}'; {known}"
        names.assembly.scope.fault(f"{pointer}/coordinate", "unknown-coordinate", message)
    return a


def _joint_force(names: LoadNames, load: TreeJointLoad, pointer: str) -> LoadFormulas:
    a = _coordinate(names, load, pointer)
    forces = {} if a is None else {a: _read(names, load.force, f"{pointer}/force")}
    return LoadFormulas(Reach(forces), names.graph.zero)


def _friction(names: LoadNames, load: TreeFriction, pointer: str) -> LoadFormulas:
    """The smooth law; its numbers are an output besides (:attr:`Assembly.friction`)."""
    a = _coordinate(names, load, pointer)
    law = read_friction(names.assembly.scope, load, pointer, names.assembly.reading.parameter)
    forces = {} if a is None or law is None else {a: -law.force(names.rates[a])}
    return LoadFormulas(Reach(forces), names.graph.zero)


def _potential(names: LoadNames, load: TreePotential, pointer: str) -> LoadFormulas:
    """Q_a = -dV/dq^a, where V depends on measures s, too: -dV/ds ds/dq^a."""
    place, scope, graph = f"{pointer}/potential", names.assembly.scope, names.graph
    energy = scope.read(load.potential, place, names.measures.standing_in)
    used = sorted(name for name in names_in(load.potential) if names.moves(name)) if not scope.faults else []
    for name in used:
        if "'" in name:
            message = f"a potential depends on coordinates, not on velocities: '{name}' is one"
            scope.fault(place, "velocity-in-potential", message)
    found = {name: names.measures.measure(name, place) for name in used if measured(name) is not None}
    if scope.faults:
        return LoadFormulas(Reach({}), graph.zero)
    measures = {name: each for name, each in found.items() if each is not None}
    try:
        return LoadFormulas(*potential_forces(graph, energy, used, names.coordinates, measures))
    except ZeroDivisionError:
        scope.fault(place, "division-by-zero", "the derivative of this potential has no value anywhere")
        return LoadFormulas(Reach({}), graph.zero)


_READERS: dict[type, Callable[[LoadNames, Any, str], LoadFormulas]] = {
    TreeSpring: _spring,
    Bushing: _bushing,
    TreeForce: _force,
    TreeTorque: _torque,
    TreeJointLoad: _joint_force,
    TreeFriction: _friction,
    TreePotential: _potential,
}
