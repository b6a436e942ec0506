"""Expressions in coordinates, velocities, parameters, inputs and t, read into one program."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from substructures.analysis.arguments import exact, require_read
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, Symbol, program
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


def names(model: Model, scope: Scope, inputs: bool) -> Callable[[str], Expr | None]:
    """The lookup of names; a symbol is declared when it is first used."""
    kinds: dict[str, Symbol] = {"t": Symbol("t", "time", "s")}
    kinds |= {name: Symbol(name, "coordinate") for name in model.positions}
    kinds |= {f"{name}'": Symbol(f"{name}'", "velocity") for name in model.coordinates}
    kinds |= {name: Symbol(name, "parameter", str(p.get("unit", ""))) for name, p in model.parameters.items()}
    if inputs:
        kinds |= {name: Symbol(name, "input", str(given.get("unit", ""))) for name, given in model.inputs.items()}
        kinds |= {s.name: s for s in model.program.symbols if s.kind == "input"}

    scope.more = tuple(kinds)

    def lookup(name: str) -> Expr | None:
        """The symbol of a name, declared when it is first used."""
        if name not in kinds:
            return None
        symbol = kinds[name]
        return scope.declare(name, symbol.kind, symbol.unit)

    return lookup
