"""The loads of a tree as formulas, from the poses and columns of the frames between which they act: the laws of
:mod:`substructures.loads`, nothing of the parts is derived again.

A spring or bushing whose stiffness or length names what moves is a force without potential, as are joint loads.
"""

from __future__ import annotations

from collections.abc import Sequence

from substructures.expr.graph import Expr
from substructures.loads.document import LoadFormulas
from substructures.loads.pairs import Reach
from substructures.tree.assembly import Assembly
from substructures.tree.load_names import LoadNames
from substructures.tree.mounted_part import PlacedPart


def load_formulas(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> LoadFormulas:
    """All loads of a tree together; ``placed``: its parts over formulas. Raises InvalidDocument."""
    total = LoadFormulas(Reach({}), assembly.scope.graph.zero)
    for each in loads_apart(assembly, placed, rates):
        total.add(each.forces)
        total.keep(each.potential)
    return total


def loads_apart(assembly: Assembly, placed: Sequence[PlacedPart], rates: Sequence[Expr]) -> list[LoadFormulas]:
    """Every load of a tree alone, in their order. Raises InvalidDocument."""
    names, found = LoadNames(assembly, placed, rates), list[LoadFormulas]()
    for i, load in enumerate(assembly.reading.spec.loads):
        law = load.law(names, f"/loads/{i}")
        found.append(LoadFormulas(Reach({}), names.graph.zero))
        if law is not None:
            law.acts(names, found[-1])
    assembly.scope.finish()
    return found
