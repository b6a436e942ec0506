"""The ten inertial parameters (m, s, J) of a body as symbols, to which values are bound when the part is coupled."""

from __future__ import annotations

from substructures.expr.operations import Symbol
from substructures.loads.scope import Scope
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.state_names import inertia_names
from substructures.part.topology import Topology


def inertia_symbols(scope: Scope, topology: Topology) -> tuple[Inertia, ...]:
    """Ten symbols for every carrier of a named body; nothing for the massless bodies inside compound joints."""
    graph, name = scope.graph, topology.body_of
    result = []
    for k in range(len(topology.joints)):
        # a link inside a compound joint has neither mass nor moments
        if k not in name:
            result.append(Inertia(graph.zero, (graph.zero,) * 3, (graph.zero,) * 6))
            continue
        for symbol, unit in inertia_names(name[k]):
            scope.symbols[symbol] = Symbol(symbol, "inertia", unit)
        mass, sx, sy, sz, xx, yy, zz, xy, xz, yz = (graph.symbol(symbol) for symbol, _ in inertia_names(name[k]))
        result.append(Inertia(mass, (sx, sy, sz), (xx, yy, zz, xy, xz, yz)))
    return tuple(result)
