"""Two stages: ``NAME_prepare(p, w)`` does once for each set of parameters what depends on parameters alone.

What a function needs of that it then takes from ``w``: in every program the operations without states are cut out where
others use them, and all cuts, equal ones once, are the outputs of one program.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from substructures.export.exported import Exported, Function
from substructures.export.interface import PREPARE, WORK, Interface, Vector
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import operands
from substructures.expr.program import Formulas, Output, Program, Symbol, program
from substructures.expr.replay import replay

_TRIVIAL = ("sym", "int", "rat", "pi")


def staged(exported: Exported) -> Exported:
    """The functions with what is prepared as their last argument, and before them the one that prepares it."""
    graph, place = Graph(), dict[Expr, int]()
    cuts = [_cuts(each.program, exported.interface) for each in exported.functions]
    names: list[dict[int, str]] = []
    for function, some in zip(exported.functions, cuts, strict=True):
        own = replace(function.program, outputs={"w": _list(some)})
        values = replay(own, graph, {})["w"].entries if some else {}
        names.append({cut: _name(place.setdefault(values[(k,)], len(place))) for k, cut in enumerate(some)})
    symbols = {s.name: s for each in exported.functions for s in each.program.symbols}
    prepared = program(graph, {"w": Formulas((len(place),), {(k,): x for x, k in place.items()})}, symbols)
    work = Vector(WORK, tuple(map(_name, range(len(place)))), ("",) * len(place))
    interface = replace(exported.interface, vectors={**exported.interface.vectors, WORK: work})
    functions = [Function(PREPARE, prepared, interface, glossary=exported.functions[0].glossary)]
    for function, known in zip(exported.functions, names, strict=True):
        functions.append(replace(function, program=_without(function.program, known), interface=interface))
    return replace(exported, interface=interface, functions=tuple(functions))


def _name(k: int) -> str:
    return f"w {k}"


def _list(entries: list[int]) -> Output:
    return Output((len(entries),), tuple((k,) for k in range(len(entries))), tuple(entries))


def _cuts(given: Program, interface: Interface) -> list[int]:
    """Operations of parameters alone that others, or outputs, use."""
    own = frozenset(interface.vectors["p"].names)
    steady: dict[int, bool] = {}
    found: dict[int, None] = {}
    for i in given.reachable():
        operation = given.operations[i]
        if operation[0] == "sym":
            steady[i] = given.symbols[operation[1]].name in own
            continue
        uses = operands(operation)
        steady[i] = all(steady[k] for k in uses)
        if not steady[i]:
            found |= dict.fromkeys(k for k in uses if steady[k])
    found |= {k: None for output in given.outputs.values() for k in output.entries if steady[k]}
    return sorted(k for k in found if given.operations[k][0] not in _TRIVIAL)


def _without(given: Program, known: Mapping[int, str]) -> Program:
    """The program with symbols in place of operations."""
    numbers = {name: len(given.symbols) + k for k, name in enumerate(dict.fromkeys(known.values()))}
    symbols = (*given.symbols, *(Symbol(name, "parameter") for name in numbers))
    operations = tuple(
        ("sym", numbers[known[i]]) if i in known else operation for i, operation in enumerate(given.operations)
    )
    return Program(symbols, operations, given.outputs).select(list(given.outputs))
