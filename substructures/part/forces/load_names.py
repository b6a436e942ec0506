"""What expressions of loads and of joint laws may name: parameters, coordinates, velocities, inputs and the time."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from substructures.expr.calculus.integrate import symbols_of
from substructures.expr.graph import Expr
from substructures.expr.operations import Symbol
from substructures.loads.scope import Lookup, Scope


def load_names(
    scope: Scope,
    inputs: Mapping[str, str],
    coordinates: Mapping[str, int],
    moved: Mapping[str, tuple[Expr, Expr, str]],
    rates: Collection[str] = (),
) -> Lookup:
    """The lookup of names in loads; a symbol is described in the scope when it is first used.

    ``inputs``: their SI units by name; ``coordinates``: 1 of prismatic ones, else 0; ``rates``: those without position;
    ``moved``: of joints that move with another one, position, multiplier and what moves them. None is a constant.
    """
    positions = [name for name in coordinates if name not in rates]
    scope.more = (*positions, *moved, *(f"{name}'" for name in (*coordinates, *moved)), *inputs)

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
        if name in inputs:
            return described(name, "input", inputs[name])
        if name in positions:
            return scope.graph.symbol(name)
        if name.endswith("'") and name[:-1] in coordinates:
            return described(name, "velocity", "m/s" if coordinates[name[:-1]] else "rad/s")
        if name in moved:
            return moved[name][0]
        if name.endswith("'") and name[:-1] in moved:
            _, multiplier, of = moved[name[:-1]]
            return multiplier * described(f"{of}'", "velocity", "m/s" if coordinates[of] else "rad/s")
        return None

    return lookup


def depends_on_state(coordinates: Collection[str], *exprs: Expr) -> bool:
    """Whether one of the expressions contains a coordinate or a velocity."""
    return any(name.removesuffix("'") in coordinates for name in symbols_of(exprs))


def velocity_in(coordinates: Collection[str], exprs: Iterable[Expr]) -> str | None:
    """A velocity that occurs in one of the expressions, if there is one."""
    return min(symbols_of(exprs) & {f"{name}'" for name in coordinates}, default=None)
