"""Sines and cosines of sums of angles by the addition theorem, where those of the angles are computed anyway.

cos(a + b) = cos a cos b - sin a sin b and its like take three operations, a sine many times as many.

>>> from substructures.expr.graph import Graph
>>> from substructures.expr.operations import Symbol
>>> from substructures.expr.program import array, program
>>> from substructures.expr.trigonometry import cos, sin
>>> g = Graph()
>>> a, b = map(g.symbol, "ab")
>>> entries = [sin(a), cos(b), sin(a + b)]
>>> before = program(g, {"y": array((3,), lambda i: entries[i])}, {x: Symbol(x, "coordinate") for x in "ab"})
>>> after = by_addition_theorem(before, ["y"])
>>> len({operation[1] for operation in after.operations if operation[0] in ("sin", "cos")})
2
"""

from __future__ import annotations

from collections.abc import Sequence

from substructures.expr.operations import Operation, Output
from substructures.expr.program import Program, renumbered


def by_addition_theorem(source: Program, names: Sequence[str]) -> Program:
    """The same functions of the named outputs, up to rounding; the program itself where there is nothing to do."""
    operations = source.operations
    turning = {operations[i][1] for i in source.reachable(names) if operations[i][0] in ("sin", "cos")}
    sums = {x for x in turning if operations[x][0] in ("add", "sub") and turning.issuperset(operations[x][1:])}
    if not sums:
        return source
    made: list[Operation] = []
    new: dict[int, int] = {}
    #: cosine and sine by angle
    pairs: dict[int, tuple[int, int]] = {}

    def write(*operation: str | int) -> int:
        """The number of a new operation."""
        made.append(operation)
        return len(made) - 1

    symbols = {k: k for k in range(len(source.symbols))}
    for i, operation in enumerate(operations):
        if operation[0] in ("sin", "cos") and operation[1] in turning:
            new[i] = pairs[operation[1]][operation[0] == "sin"]
        else:
            new[i] = write(*renumbered(operation, new, symbols))
        if i in sums:
            (c, s), (d, t) = pairs[operation[1]], pairs[operation[2]]
            other = "add" if operation[0] == "sub" else "sub"
            cosine = write(other, write("mul", c, d), write("mul", s, t))
            pairs[i] = cosine, write(operation[0], write("mul", s, d), write("mul", c, t))
        elif i in turning:
            pairs[i] = write("cos", new[i]), write("sin", new[i])
    outputs = {
        name: Output(o.shape, o.index, tuple(new[e] for e in o.entries), o.symmetry)
        for name, o in source.outputs.items()
    }
    return Program(source.symbols, tuple(made), outputs)
