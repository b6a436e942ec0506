"""Formulas of a part as it stands alone, with nothing mounted on it."""

from __future__ import annotations

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Program
from substructures.expr.program import program as collect
from substructures.expr.replay import replay
from substructures.part.outputs import Stored
from substructures.part.part import Part


def lean(part: Part, program: Program) -> Program:
    """A program of stored formulas with the part's own masses and moments in place of the inertia symbols.

    The symbols stand for the inertia of every body with whatever is mounted on it; the own values alone fold the
    program to its lean form (mathematics.md, section 6).
    """
    graph = Graph()
    own = Stored(replay(part.program, graph, {}, ("inertia.m", "inertia.s", "inertia.J")))
    bindings: dict[str, Expr] = {}
    for carrier, symbols in part.inertia_symbols.items():
        inertia = own.inertia("inertia", carrier)
        values = (inertia.m, *inertia.s, *inertia.J)
        bindings.update(zip(symbols, map(graph.lift, values), strict=True))
    known = {symbol.name: symbol for symbol in part.program.symbols}
    return collect(graph, replay(program, graph, bindings), known)
