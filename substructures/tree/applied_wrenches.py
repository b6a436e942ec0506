"""What acts on the bodies of a tree, as wrenches: forces and torques of parts, springs of parts, loads of the tree and
the forces of closures. What acts on coordinates alone (joint laws, actuators, joint loads, potentials in coordinates)
is in the joints, and not among them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay
from substructures.mechanics.kinematics import fixed_link
from substructures.mechanics.linear3 import ZERO, Rotation, Vector, scale
from substructures.mechanics.newton_euler import Wrench
from substructures.part.definition import SpringLoad
from substructures.part.loads import Spring, read_loads
from substructures.part.mechanism import Mechanism, mechanism
from substructures.tree.assembly import Assembly, tree_name
from substructures.tree.closures import PLACE, ClosureEnd, Cut, closure_formulas
from substructures.tree.loads import load_formulas, spring_forces
from substructures.tree.mounted_part import PlacedPart
from substructures.tree.places import Acting, Pair, Place, axes_in_world, place


def applied_wrenches(
    assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]
) -> Iterator[tuple[int, int, Wrench]]:
    """(part, carrier, wrench about its body frame origin in its axes), over formulas; ``rates``: q'^a.

    Closures act by the symbols ``lambda.<closure>.<row>`` [N, N m] of their multipliers.
    """
    for i, here in enumerate(placed):
        yield from ((i, carrier, wrench) for carrier, wrench in here.applied_wrenches())
    index = {id(here): i for i, here in enumerate(placed)}
    for each in (
        *_springs(assembly, placed, rates),
        *_loads(assembly, placed, rates),
        *_closures(assembly, placed, rates),
    ):
        yield from ((index[id(part)], carrier, wrench) for part, carrier, wrench in each.wrenches())


def _loads(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> Sequence[Acting]:
    """The loads of the tree."""
    return load_formulas(assembly, placed, rates).forces.acting if assembly.reading.spec.loads else ()


def _springs(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> Iterator[Acting]:
    """The springs of the parts, which store the generalised forces alone: read again from their definitions."""
    for instance, here in zip(assembly.instances, placed, strict=True):
        if not any(isinstance(load, SpringLoad) for load in here.part.definition.loads):
            continue
        m = mechanism(here.part.definition)
        for spring in read_loads(m).springs:
            yield from _spring(assembly, here, instance.name, _formulas(m, spring), rates)


def _formulas(m: Mechanism, spring: Spring) -> Program:
    """Ends (carriers, points in their body frames) and law of a spring as a program."""
    named = {"k": spring.stiffness, "c": spring.damping, "l": spring.length}
    for end, (carrier, at) in zip("AB", spring.ends, strict=True):
        named |= {f"{end}{i}": m.graph.lift(x) for i, x in enumerate(at)}
        named[f"{end}.carrier"] = m.graph.number(carrier)
    return program(m.graph, {name: Formulas((), {(): x}) for name, x in named.items()}, m.scope.symbols)


def _spring(
    assembly: Assembly, here: PlacedPart, instance: str, spring: Program, rates: Sequence[Expr]
) -> Sequence[Acting]:
    graph = assembly.scope.graph
    found = replay(spring, graph, part_symbols(assembly, here, instance, spring))
    value = {name: graph.lift(each.entries.get((), 0)) for name, each in found.items()}
    A, B = (
        _point(here, int(value[f"{end}.carrier"].value), (value[f"{end}0"], value[f"{end}1"], value[f"{end}2"]))
        for end in "AB"
    )
    pair = Pair(graph, A, B)
    return spring_forces(pair, pair.length2(), (value["k"], value["c"], value["l"]), rates)[0].acting


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


def _point(here: PlacedPart, carrier: int, at: Vector) -> Place:
    """A point that is given in the body frame of a carrier."""
    return Place(here, carrier, at, here.pose(carrier).beyond(fixed_link(here.links, carrier, Rotation(), at)))


def _closures(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> Iterator[Acting]:
    """What the rows of closures exert on ``to``, and the opposite on ``from`` at the same place."""
    if not assembly.cuts:
        return
    direction = closure_formulas(placed, assembly.cuts, rates)["closure.direction"].entries
    k = 0
    for cut in assembly.cuts:
        pair = Pair(assembly.scope.graph, _end(placed, cut.start), _end(placed, cut.end))
        for row in cut.rows.rows:
            unit: Vector = (direction.get((k, 0), 0), direction.get((k, 1), 0), direction.get((k, 2), 0))
            load = scale(_multiplier(assembly, cut, row), axes_in_world(pair.A, unit))
            yield Acting(pair, load, ZERO) if row in (*PLACE, "length") else Acting(pair, ZERO, load)
            k += 1


def _end(placed: Sequence[PlacedPart], end: ClosureEnd) -> Place:
    """The origin of an end of a closure, with the axes of the frame that it is given in."""
    return place(placed, end.part, end.frame, end.position)


def _multiplier(assembly: Assembly, cut: Cut, row: str) -> Expr:
    name, unit = f"lambda.{cut.rows.name}.{row}", "N" if row in (*PLACE, "length") else "N m"
    assembly.scope.symbols.setdefault(name, Symbol(name, "input", unit))
    found: Expr = assembly.scope.graph.symbol(name)
    return found
