"""Directional derivatives of accelerations and outputs, from the formulas: forward mode on their graph.

Directions are symbols of their own, in the vector ``x`` of the C functions; accelerations are among the arguments of
derivatives of outputs, whose direction follows from that of the state.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from substructures.export.exported import Function
from substructures.export.interface import Interface
from substructures.expr.differentiate import directional
from substructures.expr.graph import Graph
from substructures.expr.program import Formulas, Symbol, program
from substructures.expr.replay import replay

_MARK = "direction of "
#: what accelerations and outputs are differentiated by
OF_STATE, OF_ALL = ("t", "q", "qd", "u", "p"), ("t", "q", "qd", "qdd", "u", "p")


def tangent(
    name: str, functions: Sequence[Function], interface: Interface, by: Sequence[str], further: Sequence[str] = ()
) -> Function:
    """The directional derivatives of all outputs of some functions, in their order, as one function; ``further``:
    symbols beside those of the vectors ``by``.
    """
    graph = Graph()
    varied = {n: Symbol(n, "parameter") for symbol in by for n in interface.vectors[symbol].names}
    varied |= {n: Symbol(n, "parameter") for n in further}
    seeds = {n: graph.symbol(_MARK + n) for n in varied}
    outputs: dict[str, Formulas] = {}
    symbols: dict[str, Symbol] = {_MARK + n: replace(s, name=_MARK + n) for n, s in varied.items()}
    for function in functions:
        symbols |= {s.name: s for s in function.program.symbols}
        for array in replay(function.program, graph, {}).values():
            roots = [graph.lift(x) for x in array.entries.values()]
            found = dict(zip(array.entries, directional(roots, seeds), strict=True)) if roots else {}
            outputs[f"d{len(outputs)}"] = Formulas(array.shape, found, array.symmetry)
    made = program(graph, outputs, symbols).select(list(outputs))
    return Function(name, made, interface)


def directions(function: Function, places: Mapping[str, int]) -> dict[str, int | None]:
    """Where in the values of an instance the direction of each element of ``x`` stands; None of what is none."""
    names = function.further.names
    return {name: places[name.removeprefix(_MARK)] if name.startswith(_MARK) else None for name in names}
