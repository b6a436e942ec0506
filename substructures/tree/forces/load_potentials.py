"""The potential of forces and torques on bodies that depend on coordinates alone (notation.md, section 7).

A force that is constant in the world has one in closed form (:mod:`substructures.tree.coupling`). Of the others each is
tried by itself: V with d_a V = -Q_a exactly, Q_a = F . u_a or M . w_a as a function of the coordinates, found by
integration, V = 0 where all coordinates are 0. A torque of constant vector has one where all its Q_a are constant: with
w_a the axes, d_b Q_a - d_a Q_b = M . (w_b x w_a), which is also what Q_a changes by.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from substructures.expr.calculus.integrate import from_zero, needed, potential
from substructures.expr.graph import Expr, Graph
from substructures.loads.pairs import wrench_forces
from substructures.part.outputs import Run, links_of, over_formulas
from substructures.tree.coupling import place
from substructures.tree.mounted_part import EvaluatedPart, MountedPart, PlacedPart, balls_in, ratios_of

#: terms of a generalised force that is integrated
LIMIT = 50
#: outputs of parts that poses, columns and loads are made of
PLACED = (
    *("E.tilt", "E.turn", "E.full", "Z", "tau", "U", "Omega"),
    *("frame.E", "frame.position", "load.at", "load.vector"),
)


def placed_parts(run: Run, mounted: Sequence[MountedPart]) -> list[PlacedPart]:
    """Poses and columns of all parts, without inertias and gravity."""
    placed: list[PlacedPart] = []
    for m in mounted:
        outputs = run(m.part, m.bindings, PLACED)
        placed.append(place(EvaluatedPart(m, outputs, outputs, links_of(m.part, outputs)), placed, (0, 0, 0)))
    return placed


def has_steady_loads(mounted: Sequence[MountedPart]) -> bool:
    """Whether there is anything to be tried."""
    return any(any(m.part.steady_loads) for m in mounted)


def found_potential(graph: Graph, placed: Sequence[PlacedPart], coordinates: Sequence[str]) -> Expr:
    """The potential of all forces and torques on bodies that have one which is found; over formulas."""
    return graph.sum(_potentials(graph, placed, coordinates))


def _potentials(graph: Graph, placed: Sequence[PlacedPart], coordinates: Sequence[str]) -> Iterator[Expr]:
    for forces in _steady_forces(graph, placed):
        used = frozenset().union(*(needed(x, LIMIT) for x in forces.values()))
        # a force that names q^b has a part in the curl, d_b Q_a - d_a Q_b, also where none acts on q^b
        some = [a for a, name in enumerate(coordinates) if a in forces or name in used]
        names = [coordinates[a] for a in some]
        found = potential([forces.get(a, graph.zero) for a in some], names, LIMIT) if some else None
        if found is not None:
            yield from_zero(found, coordinates)


def _steady_forces(graph: Graph, placed: Sequence[PlacedPart]) -> Iterator[dict[int, Expr]]:
    """By coordinate the forces of each load that may have a potential; what turns a ball joint is not looked at."""
    mounted = [here.mounted for here in placed]
    ratios = ratios_of(over_formulas(graph), mounted)
    turned = {a for ball in balls_in(placed) for a in ball.joints}
    for here in placed:
        if not any(here.part.steady_loads):
            continue
        for is_steady, (carrier, wrench) in zip(here.part.steady_loads, here.applied_wrenches(), strict=True):
            on_joints = wrench_forces(here, carrier, wrench) if is_steady else {}
            if turned.isdisjoint(on_joints):
                reduced = ratios.reduced({(a,): x for a, x in on_joints.items()}, (0,))
                yield {a: graph.lift(x) for (a,), x in reduced.items()}
