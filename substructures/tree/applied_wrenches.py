"""What acts on the bodies of a tree, as wrenches: forces and torques of parts, what acts between frames of parts, loads
of the tree and the forces of closures. What acts on coordinates alone (joint laws, actuators, joint loads, friction,
potentials in coordinates) is in the joints, and not among them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.expr.program import Program
from substructures.loads.pairs import Acting, Pair, Place, axes_in_world
from substructures.mechanics.linear3 import ZERO, Vector, scale
from substructures.mechanics.newton_euler import Wrench
from substructures.tree.assembly import Assembly, tree_name
from substructures.tree.closures import PLACE, ClosureEnd, Cut, closure_formulas
from substructures.tree.frame_points import place
from substructures.tree.loads import load_formulas
from substructures.tree.mounted_part import PlacedPart
from substructures.tree.part_loads import loads_of_parts


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
        *loads_of_parts(assembly, placed, rates),
        *_loads(assembly, placed, rates),
        *_closures(assembly, placed, rates),
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
