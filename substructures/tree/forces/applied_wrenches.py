"""What acts on the bodies of a tree, as wrenches: forces and torques of parts, what acts between frames of parts, loads
of the tree, and the forces of closures, of rolling contacts and of knife edges. What acts on coordinates alone (joint
laws, actuators, joint loads, friction, potentials in coordinates) is in the joints, and not among them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.expr.program import Program
from substructures.loads.pairs import Acting, Pair, Place, axes_in_world
from substructures.mechanics.cut_joints import PLACE
from substructures.mechanics.linear3 import ZERO, Vector, apply, cross, dot, scale, sub, transpose
from substructures.mechanics.wrench import Wrench
from substructures.part.frames import axis_rotation
from substructures.tree.assembly import Assembly
from substructures.tree.closures import closure_formulas
from substructures.tree.cuts import ClosureEnd
from substructures.tree.forces.loads import load_formulas
from substructures.tree.forces.part_loads import loads_of_parts
from substructures.tree.given.ties import KnifeEdgeConstraint, RollingConstraint
from substructures.tree.mounted_part import WORLD, PlacedPart, place
from substructures.tree.reading import tree_name

#: rows of a rolling contact: along both directions of the plane, and along its normal
ROLLING = ("slip_1", "slip_2", "contact")


def applied_wrenches(
    assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]
) -> Iterator[tuple[int, int, Wrench]]:
    """(part, carrier, wrench about its body frame origin in its axes), over formulas; ``rates``: q'^a.

    Closures act by the symbols ``lambda.<closure>.<row>`` [N, N m] of their multipliers, velocity constraints by
    ``lambda.<constraint>`` or ``lambda.<constraint>.<row>`` [N] of B^T lambda in
    substructures.analysis.equations.nonholonomic: rolling contacts and knife edges. A linear one says nothing of
    bodies: B_a lambda acts in the joints of its coordinates.
    """
    for i, here in enumerate(placed):
        yield from ((i, carrier, wrench) for carrier, wrench in here.applied_wrenches())
    # by identity: placed parts are dataclasses with dictionaries, which have no hash
    index = {id(here): i for i, here in enumerate(placed)}
    for each in (
        *loads_of_parts(assembly, placed, rates),
        *_loads(assembly, placed, rates),
        *_closures(assembly, placed, rates),
        *_contacts(assembly, placed),
    ):
        yield from ((index[id(part)], carrier, wrench) for part, carrier, wrench in each.wrenches())


def _loads(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> Sequence[Acting]:
    """The loads of the tree."""
    return load_formulas(assembly, placed, rates).forces.acting if assembly.reading.spec.loads else ()


def part_symbols(assembly: Assembly, here: PlacedPart, instance: str, known: Program) -> dict[str, Expr]:
    """What the symbols of formulas of a part are in the tree, also of those that its stored ones do without."""
    graph, result = assembly.scope.graph, dict[str, Expr]()
    for symbol in known.symbols:
        bound = here.mounted.bindings.get(symbol.name)
        if bound is None:
            name = tree_name(instance, symbol.name)
            assembly.scope.symbols.setdefault(name, Symbol(name, symbol.kind, symbol.unit))
            parameter = assembly.reading.parameter(name) if symbol.kind == "parameter" else None
            bound = graph.symbol(name) if parameter is None else parameter
        result[symbol.name] = graph.lift(bound)
    return result


def _closures(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> Iterator[Acting]:
    """What the rows of closures exert on ``to``, and the opposite on ``from`` at the same place."""
    if not assembly.cuts:
        return
    # its rows, numbered by k, are those of the cuts one after the other
    direction = closure_formulas(placed, assembly.cuts, rates)["closure.direction"].entries
    k = 0
    for cut in assembly.cuts:
        pair = Pair(assembly.scope.graph, _end(placed, cut.start), _end(placed, cut.end))
        for row in cut.rows.rows:
            unit: Vector = (direction.get((k, 0), 0), direction.get((k, 1), 0), direction.get((k, 2), 0))
            name, kind = f"{cut.rows.name}.{row}", "N" if row in (*PLACE, "length") else "N m"
            load = scale(_multiplier(assembly, name, kind), axes_in_world(pair.A, unit))
            yield Acting(pair, load, ZERO) if row in (*PLACE, "length") else Acting(pair, ZERO, load)
            k += 1


def _end(placed: Sequence[PlacedPart], end: ClosureEnd) -> Place:
    """The origin of an end of a closure, with the axes of the frame that it is given in."""
    return place(placed, end.part, end.frame, end.position)


def _multiplier(assembly: Assembly, label: str, unit: str) -> Expr:
    name = f"lambda.{label}"
    assembly.scope.symbols.setdefault(name, Symbol(name, "input", unit))
    found: Expr = assembly.scope.graph.symbol(name)
    return found


def _contacts(assembly: Assembly, placed: Sequence[PlacedPart]) -> Iterator[Acting]:
    """Forces from the world on bodies that roll, P^T lambda at the point of contact, P to the axes of the plane, and
    on knife edges, lambda along the second axis of the frame at its origin. Raises InvalidDocument for their faults.
    """
    for i, each in enumerate(assembly.reading.spec.velocity_constraints):
        if not isinstance(each, KnifeEdgeConstraint | RollingConstraint):
            continue
        pointer = f"/velocity_constraints/{i}"
        at = place(placed, *assembly.reading.frame(each.frame, f"{pointer}/frame"))
        pair = Pair(assembly.scope.graph, place(placed, WORLD, 0), at)
        if isinstance(each, KnifeEdgeConstraint):
            across = axes_in_world(at, (0, 1, 0))
            yield Acting(pair, scale(_multiplier(assembly, each.name, "N"), across), ZERO)
        else:
            force, arm = _rolling(assembly, each, at, pointer)
            # the point of contact moves in the body: its force at the frame's origin, and the moment rho x F
            yield Acting(pair, force, cross(arm, force))
    assembly.scope.finish()


def _rolling(assembly: Assembly, given: RollingConstraint, at: Place, pointer: str) -> tuple[Vector, Vector]:
    """The force, and rho from the origin of the frame to the point of contact; in the axes of the world."""
    scope, reading = assembly.scope, assembly.reading
    radius = scope.read(given.radius, f"{pointer}/radius", reading.bound.lookup)
    x, y, z = given.normal
    plane = axis_rotation(scope, (x, y, z), f"{pointer}/normal")
    a, b, c = (_multiplier(assembly, f"{given.name}.{row}", "N") for row in ROLLING)
    force, normal = apply(transpose(plane), (a, b, c)), plane[2]
    if given.shape == "sphere":
        return force, scale(-radius, normal)
    # rho = -r (N - (N.e) e) / |N - (N.e) e|, e the axis of the disc
    axis = axes_in_world(at, (0, 0, 1))
    down = sub(normal, scale(dot(normal, axis), axis))
    width = scope.graph.sqrt(scope.graph.lift(dot(down, down)))
    return force, scale(scope.graph.lift(-radius) / width, down)
