"""What expressions of loads and of joint laws may name: parameters, coordinates, velocities, inputs and the time."""

from __future__ import annotations

from collections.abc import Iterable

from substructures.expr.graph import Expr
from substructures.expr.integrate import symbols_of
from substructures.expr.operations import Symbol
from substructures.loads.scope import Lookup, Scope
from substructures.part.definition import Definition
from substructures.part.parameters import si_unit
from substructures.part.topology import Topology


def load_names(scope: Scope, definition: Definition, topology: Topology) -> Lookup:
    """The lookup of names in loads; a symbol is described in the scope when it is first used.

    It becomes no name of the scope, so that what has to be constant cannot name it.
    """
    coordinates = topology.coordinates
    scope.more = (*coordinates, *(f"{name}'" for name in coordinates), *definition.inputs)

    def described(name: str, kind: str, unit: str) -> Expr:
        """The symbol of a name, with its description."""
        scope.symbols[name] = Symbol(name, kind, unit)
        return scope.graph.symbol(name)

    def lookup(name: str) -> Expr | None:
        """Parameters, then the time, inputs, coordinates and velocities."""
        if name in scope.names:
            return scope.names[name]
        if name == "t":
            return described("t", "time", "s")
        if name in definition.inputs:
            return described(name, "input", si_unit(definition.inputs[name].unit))
        if name in coordinates:
            return scope.graph.symbol(name)
        if name.endswith("'") and name[:-1] in coordinates:
            joint = topology.joints[coordinates.index(name[:-1])]
            return described(name, "velocity", "m/s" if joint.s else "rad/s")
        return None

    return lookup


def velocities(topology: Topology) -> frozenset[str]:
    """The names of all velocities q'^a."""
    return frozenset(f"{name}'" for name in topology.coordinates)


def depends_on_state(topology: Topology, *exprs: Expr) -> bool:
    """Whether one of the expressions contains a coordinate or a velocity."""
    return any(name.removesuffix("'") in topology.coordinates for name in symbols_of(exprs))


def velocity_in(topology: Topology, exprs: Iterable[Expr]) -> str | None:
    """A velocity that occurs in one of the expressions, if there is one."""
    return min(symbols_of(exprs) & velocities(topology), default=None)
