"""Run a program again over other scalars: into a graph (binding symbols), or over numbers and numpy arrays."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import Any

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program
from substructures.expr.walk import build


def replay(
    program: Program,
    graph: Graph,
    bindings: Mapping[str, Expr],
    names: Iterable[str] | None = None,
    known: dict[int, Any] | None = None,
) -> dict[str, Formulas]:
    """The program's outputs as expressions in ``graph``, with symbols replaced by ``bindings`` (others by themselves).

    Every operation passes the graph's simplification, so binding numbers folds the program to its lean form.
    ``known``: what operations became in this graph with these bindings, with all that they need; they are not replayed,
    and others are added. Raises ZeroDivisionError when a divisor becomes zero.
    """
    names = list(program.outputs if names is None else names)
    values: dict[int, Any] = {} if known is None else known
    symbols = [s.name for s in program.symbols]
    operations = program.operations
    needed = program.reachable(names)
    for i in [i for i in needed if i not in values] if values else needed:
        operation = operations[i]
        op = operation[0]
        if op == "mul":
            values[i] = values[operation[1]] * values[operation[2]]
        elif op == "add":
            values[i] = values[operation[1]] + values[operation[2]]
        elif op == "sub":
            values[i] = values[operation[1]] - values[operation[2]]
        elif op == "sym":
            name = symbols[operation[1]]
            values[i] = bindings.get(name) or graph.symbol(name)
        elif op == "int":
            values[i] = graph.number(int(operation[1]))
        elif op == "rat":
            values[i] = graph.number(Fraction(int(operation[1]), int(operation[2])))
        elif op == "powi":
            values[i] = values[operation[1]] ** operation[2]
        else:
            values[i] = build(graph, op, [values[x] for x in operation[1:]])
    return {name: _formulas(program, name, values) for name in names}


def _formulas(program: Program, name: str, values: Mapping[int, Expr]) -> Formulas:
    output = program.outputs[name]
    entries = {i: values[e] for i, e in zip(output.index, output.entries, strict=True)}
    return Formulas(output.shape, entries, output.symmetry)
