"""One expression as it is printed."""

from __future__ import annotations

from substructures.expr.graph import Graph
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import Formulas
from substructures.expr.program import program as collect
from substructures.printers import entries


def formula(text: str, language: str = "text", form: str = "textbook", **units: str) -> str:
    """A form of an expression; ``units`` of its parameters, coordinates are q1 ... q9, inputs tau_1 ..."""
    graph = Graph()
    expr = parse(graph, text, graph.symbol)
    kinds = {"q": "coordinate", "t": "input"}
    symbols = {
        name: Symbol(name, "velocity" if name[-1] == "'" else kinds.get(name[0], "parameter"), units.get(name, "m"))
        for name in graph.symbols
    }
    (entry,) = entries(collect(graph, {"f": Formulas((), {(): expr})}, symbols), "f", language, form)
    return str(entry["formula"])
