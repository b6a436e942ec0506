"""Expressions in coordinates, velocities, parameters, inputs and t, read into one program."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from substructures.analysis.arguments import exact, require_read
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.expr.replay import replay
from substructures.loads.scope import Scope
from substructures.tree.model import Model

#: (value, pointer) of expressions
Given = Iterable[tuple[Any, str]]


def read_expressions(model: Model, groups: Mapping[str, Given], inputs: bool = False) -> Program:
    """A program with one output (k,) for every group. ``inputs``: whether inputs may be named, too.

    Raises InvalidArgument with a pointer to every fault.
    """
    scope = Scope(Graph())
    lookup = names(model, scope, inputs)
    read = {
        name: [scope.read(exact(x, pointer), pointer, lookup) for x, pointer in given] for name, given in groups.items()
    }
    require_read(scope)
    outputs = {name: vector(some) for name, some in read.items()}
    return program(scope.graph, outputs, scope.symbols)


def vector(entries: Sequence[Expr]) -> Formulas:
    """An output of shape (k,)."""
    return Formulas((len(entries),), {(i,): x for i, x in enumerate(entries)})


def _dependent(model: Model, scope: Scope) -> Callable[[str], Expr | None]:
    """The lookup of dependent coordinates, z(y), and of their rates, d z/d y y' + d z/dt (reduced level)."""

    def lookup(name: str) -> Expr | None:
        """z or its rate; None of all other names."""
        z = name.removesuffix("'")
        if z not in model.dependent:
            return None
        symbols = {symbol.name: symbol for symbol in model.program.symbols}
        needed = [symbols[x] for x in model.program.needs(["dependent"])]
        known = {symbol.name: scope.declare(symbol.name, symbol.kind, symbol.unit) for symbol in needed}
        found = replay(model.program, scope.graph, known, ["dependent"])["dependent"].entries[model.dependent.index(z),]
        if z == name:
            return found
        moving = {x: scope.declare(f"{x}'", "velocity", "") for x in known if symbols[x].kind == "coordinate"}
        moving |= {"t": scope.graph.one} if "t" in known else {}
        slopes = gradient([found], list(moving))[0]
        return scope.graph.sum(x * v for x, v in zip(slopes, moving.values(), strict=True))

    return lookup


def names(model: Model, scope: Scope, inputs: bool) -> Callable[[str], Expr | None]:
    """The lookup of names; a symbol is declared when it is first used."""
    own = _dependent(model, scope)
    kinds: dict[str, Symbol] = {"t": Symbol("t", "time", "s")}
    kinds |= {name: Symbol(name, "coordinate") for name in model.positions}
    kinds |= {f"{name}'": Symbol(f"{name}'", "velocity") for name in model.coordinates}
    kinds |= {name: Symbol(name, "parameter", str(p.get("unit", ""))) for name, p in model.parameters.items()}
    if inputs:
        kinds |= {name: Symbol(name, "input", str(given.get("unit", ""))) for name, given in model.inputs.items()}
        kinds |= {s.name: s for s in model.program.symbols if s.kind == "input"}

    scope.more = (*kinds, *(f"{name}{prime}" for name in model.dependent for prime in ("", "'")))

    def lookup(name: str) -> Expr | None:
        """The symbol of a name, declared when it is first used."""
        if name not in kinds:
            return own(name)
        symbol = kinds[name]
        return scope.declare(name, symbol.kind, symbol.unit)

    return lookup
