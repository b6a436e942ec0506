"""What can be left out of a program: one operand of a sum, or whatever varies little, for which a number is put.

A program in which something is left out is written anew, so that what only that needed, and what becomes simpler by it,
is gone, too.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from substructures.array import Array
from substructures.expr.graph import Expr, Graph
from substructures.expr.hoist import hoisted, uses_of
from substructures.expr.program import ARITHMETIC, Formulas, Operation, Program, operands, program
from substructures.expr.walk import build

#: significant digits of the numbers that are put for what varies
DIGITS = 5
#: half of what a value varies by, in units of its middle, from which on zero is put for it
WIDE = 2.0


@dataclass(frozen=True)
class Change:
    """At operation ``place``: ``kept`` is the operand (0 or 1) of a sum that is left, or ``number`` what is put for it.

    ``saved``: operations that it saves, about.
    """

    place: int
    saved: int
    kept: int | None = None
    number: Fraction = Fraction(0)

    def difference(self, source: Program, values: Mapping[int, Array]) -> Array:
        """What is added to the operation by the change."""
        operation = source.operations[self.place]
        if self.kept is None:
            return np.float64(float(self.number)) - values[self.place]
        dropped = values[operation[2 - self.kept]]
        return dropped if operation[0] == "sub" and self.kept == 0 else -dropped


def changed(source: Program, changes: Iterable[Change]) -> Program:
    """The program with changes. Raises ZeroDivisionError, and ValueError for what is undefined then."""
    by_place = {change.place: change for change in changes}
    graph = Graph()
    found: list[Expr] = []
    for i, operation in enumerate(source.operations):
        change = by_place.get(i)
        found.append(
            _built(source, graph, operation, found) if change is None else _replaced(graph, operation, found, change)
        )
    outputs = {
        name: Formulas(o.shape, {i: found[e] for i, e in zip(o.index, o.entries, strict=True)}, o.symmetry)
        for name, o in source.outputs.items()
    }
    return hoisted(program(graph, outputs, {s.name: s for s in source.symbols}))


def _replaced(graph: Graph, operation: Operation, found: Sequence[Expr], change: Change) -> Expr:
    if change.kept is None:
        return graph.number(change.number)
    left = found[operation[1 + change.kept]]
    return -left if operation[0] == "sub" and change.kept == 1 else left


def _built(source: Program, graph: Graph, operation: Operation, found: Sequence[Expr]) -> Expr:
    op = operation[0]
    if op == "sym":
        return graph.symbol(source.symbols[operation[1]].name)
    if op in ("int", "rat"):
        return graph.number(Fraction(*map(int, operation[1:])))
    if op == "powi":
        return found[operation[1]] ** operation[2]
    return build(graph, op, [found[x] for x in operation[1:]])


def possible(source: Program, values: Mapping[int, Array]) -> Iterator[Change]:
    """All changes that save operations; ``values``: of the operations at some states."""
    uses = uses_of(source)
    for i, operation in enumerate(source.operations):
        op = operation[0]
        if i not in values or op in ("int", "rat", "sym"):
            continue
        if op in ("add", "sub"):
            for kept in (0, 1):
                yield Change(i, 1 + _freed(source, uses, [operation[2 - kept]]), kept)
        saved = (op in ARITHMETIC) + _freed(source, uses, operands(operation))
        if saved and np.ndim(values[i]):
            yield Change(i, saved, None, _middle(values[i]))


def _middle(x: Array) -> Fraction:
    """A short number in the middle of values, zero for those on both sides of zero."""
    low, high = float(np.min(x)), float(np.max(x))
    middle = (low + high) / 2
    if not np.isfinite(middle) or high - low > 2 * WIDE * abs(middle):
        return Fraction(0)
    return Fraction(f"{middle:.{DIGITS}g}")


def _freed(source: Program, uses: Sequence[int], unused: Iterable[int]) -> int:
    """Arithmetic operations that nothing needs once these are used one time less."""
    left: dict[int, int] = {}
    stack, count = list(unused), 0
    while stack:
        i = stack.pop()
        left[i] = left.get(i, uses[i]) - 1
        if not left[i]:
            count += source.operations[i][0] in ARITHMETIC
            stack.extend(operands(source.operations[i]))
    return count
