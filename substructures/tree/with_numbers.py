"""Numbers put in where the formulas of a shape have their symbols."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from substructures.expr.bind import bind
from substructures.expr.garbage import without_collections
from substructures.expr.hoist import hoisted
from substructures.expr.program import Program


@without_collections
def with_numbers(program: Program, values: Mapping[str, Fraction]) -> Program:
    """The program of a shape with numbers in the places of symbols, exactly. Raises as
    :func:`substructures.expr.bind.bind`.
    """
    own = {symbol.name: values[symbol.name] for symbol in program.symbols if symbol.name in values}
    return hoisted(bind(program, own)).marked(program.not_judged) if own else program
