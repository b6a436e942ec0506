"""Outputs of all coordinates along the motions of fewer, q' = N y': x*_i = N_ai x_a along every axis of coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas

Index = tuple[int, ...]
Entries = dict[Index, Any]
Terms = Iterable[tuple[Index, Any]]
#: by coordinate
Column = Mapping[int, Expr]
#: of single joints, whose coordinates are left
OWN = frozenset(("limits", "friction", "friction_load"))
SYMMETRIES = {"metric": "symmetric", "christoffel": "connection"}


class Projection:
    """``columns``: those of N; ``left``: the coordinates y, by their numbers."""

    def __init__(self, graph: Graph, columns: Sequence[Column], left: Sequence[int]) -> None:
        self.graph, self.columns = graph, columns
        self.place = {a: i for i, a in enumerate(left)}

    def along(self, name: str, each: Formulas, axes: Sequence[int], entries: Entries, more: Terms = ()) -> Formulas:
        """An output with these ``entries`` along its ``axes`` of coordinates, and what is ``more`` in the result."""
        if name in OWN:
            # laws of the joint itself: N^T would add the limits of others to them
            own: Entries = {(self.place[a], *rest): x for (a, *rest), x in entries.items() if a in self.place}
            return Formulas((len(self.place), *each.shape[1:]), own, each.symmetry)
        for axis in axes:
            entries = self.contracted(entries, axis)
        if more:
            entries = self.sums([*entries.items(), *more])
        if name in SYMMETRIES:
            # Gamma* keeps the symmetry in its last two indices alone: Gamma_abc = -Gamma_cba is of single joints
            entries = {i: x for i, x in entries.items() if i[-2] <= i[-1]}
        shape = tuple(len(self.place) if axis in axes else size for axis, size in enumerate(each.shape))
        return Formulas(shape, entries, SYMMETRIES.get(name, each.symmetry))

    def contracted(self, entries: Entries, axis: int) -> Entries:
        """N_ai x_..a.."""
        by: dict[int, list[tuple[int, Expr]]] = {}
        for i, column in enumerate(self.columns):
            for a, x in column.items():
                by.setdefault(a, []).append((i, x))
        return self.sums(
            ((*index[:axis], i, *index[axis + 1 :]), x * y)
            for index, x in entries.items()
            for i, y in by.get(index[axis], ())
        )

    def sums(self, terms: Terms) -> Entries:
        """Of all terms with one index, zeros left out."""
        found: dict[Index, list[Any]] = {}
        for index, x in terms:
            found.setdefault(index, []).append(x)
        sums = {index: self.graph.sum(some) for index, some in found.items()}
        return {index: x for index, x in sums.items() if not x.is_zero}


def changed(
    graph: Graph, outputs: Mapping[str, Formulas], change: Callable[[list[Expr]], Iterable[Expr]]
) -> dict[str, Formulas]:
    """Outputs whose elements are what ``change`` makes of them, of all together."""
    found = iter(change([graph.lift(x) for each in outputs.values() for x in each.entries.values()]))
    return {
        name: Formulas(each.shape, {i: next(found) for i in each.entries}, each.symmetry)
        for name, each in outputs.items()
    }
