"""Base parameters for people: each a symbol, with its formula and with what was grouped into it."""

from __future__ import annotations

from collections.abc import Mapping

from substructures.analysis.identification.base_parameters import BaseParameters, with_short_numbers
from substructures.analysis.identification.grouped import cut, sum_of
from substructures.expr.graph import Graph
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay


def base_symbols(base: BaseParameters) -> tuple[Program, tuple[Symbol, ...], dict[str, str]]:
    """An output for every base parameter, ``arm.Jxx_link2`` of ``arm.link2.Jxx``, over the parameters of the tree and
    those of drives; these as symbols with their units, in the order of ``base.names``; and by its name what was grouped
    into it, as a sum of standard parameters.

    Raises TooLarge for coefficients that are too long.
    """
    graph, outputs = Graph(), dict[str, Formulas]()
    symbols = {s.name: s for s in base.program.symbols}
    found = replay(with_short_numbers(base.program.select(["base_parameters", "grouping"])), graph, {})
    beta, grouping = found["base_parameters"].entries, found["grouping"].entries
    units = dict(zip(base.standard, base.units, strict=True))
    called = {name: symbol_name(name) for name in base.standard}
    combinations = base.combinations()
    for k, name in enumerate(base.names):
        value = graph.lift(beta.get((k,), 0))
        for i, standard in enumerate(base.standard):
            if standard.rpartition(".")[2] in base.drives and (k, i) in grouping:
                symbols[called[standard]] = Symbol(called[standard], "parameter", units[standard])
                value = value + graph.lift(grouping[k, i]) * graph.symbol(called[standard])
        outputs[_free(called[name], symbols)] = Formulas((), {(): value})
    # a program has its outputs in the order of their names
    own = tuple(
        Symbol(name, "base parameter", units[standard]) for name, standard in zip(outputs, base.names, strict=True)
    )
    return program(graph, outputs, symbols), own, _notes(outputs, base, combinations)


def symbol_name(standard: str) -> str:
    """``arm.Jxx_link2`` of ``arm.link2.Jxx``."""
    instance, *middle, entry = standard.split(".")
    return f"{instance}.{'_'.join([entry, *middle])}"


def _free(name: str, symbols: Mapping[str, Symbol]) -> str:
    """A name that no symbol has."""
    while name in symbols:
        name += "_b"
    return name


def _notes(
    outputs: Mapping[str, Formulas], base: BaseParameters, combinations: Mapping[str, Mapping[str, str]]
) -> dict[str, str]:
    return {name: cut(sum_of(combinations[standard])) for name, standard in zip(outputs, base.names, strict=True)}
