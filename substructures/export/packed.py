"""Packed outputs: the independent elements of the metric and of the Christoffel symbols, as evaluations have them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import images
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay
from substructures.formats.packing import RANKS, packed_indices

#: the index in the complete array of every packed element, by output
Indices = Mapping[str, Sequence[tuple[int, ...]]]
#: of the table in the head of a file
WIDTH = 100


def packed(given: Program) -> tuple[Program, Indices]:
    """The program with packed outputs in the place of ``metric`` (n, n) and ``christoffel`` (n, n, n), and what stands
    where in these."""
    graph = Graph()
    tables = {
        name: packed_indices(name, array.shape[0], array.symmetry)
        for name, array in given.outputs.items()
        if name in RANKS and len(array.shape) == RANKS[name]
    }
    if not tables:
        return given, {}
    outputs = {
        name: _independent(array, tables[name]) if name in tables else array
        for name, array in replay(given, graph, {}).items()
    }
    made = program(graph, outputs, {s.name: s for s in given.symbols})
    return made.select(list(given.outputs)), tables


def _independent(array: Formulas, indices: Sequence[tuple[int, ...]]) -> Formulas:
    """A vector of the elements at these indices."""
    elements: dict[tuple[int, ...], Expr] = {}
    for index, expr in array.entries.items():
        for image, sign in images(index, array.symmetry):
            elements[image] = expr if sign > 0 else -expr
    found: dict[tuple[int, ...], Expr] = {(k,): elements[index] for k, index in enumerate(indices) if index in elements}
    return Formulas((len(indices),), found)


def table(indices: Sequence[tuple[int, ...]], first: int) -> Iterator[str]:
    """Lines ``from k: 0 0, 1 0, 1 1, ...``: the indices of the elements from k on, counted from ``first``."""
    line = ""
    for k, index in enumerate(indices):
        text = " ".join(str(i + first) for i in index)
        if line and len(line) + len(text) > WIDTH:
            yield line
            line = ""
        line = f"{line}, {text}" if line else f"from {k + first}: {text}"
    if line:
        yield line
