"""Symbols that stand for formulas in others: what they are is printed before the formulas that they occur in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from substructures.errors import TooLarge
from substructures.expr.operations import Operation, Symbol
from substructures.expr.program import Program
from substructures.printers.language import Language
from substructures.printers.listing import inlined
from substructures.printers.textbook import at_once, textbook_inlined


@dataclass(frozen=True)
class Definitions:
    """``program``: an output for every symbol, by its name; ``notes``: what is said about some of them in words."""

    program: Program
    notes: Mapping[str, str]

    def of(self, program: Program) -> Definitions:
        """Those of the symbols that occur in a program."""
        used = {s.name for s in program.symbols}
        return Definitions(self.program.select([name for name in self.program.outputs if name in used]), self.notes)


def joined(program: Program, definitions: Program) -> tuple[Program, Program]:
    """Both programs with the symbols of both, so that these have the same numbers."""
    symbols = sorted({s.name: s for s in (*program.symbols, *definitions.symbols)}.items())
    number = {name: n for n, (name, _) in enumerate(symbols)}
    both = tuple(symbol for _, symbol in symbols)
    return _renumbered(program, both, number), _renumbered(definitions, both, number)


def _renumbered(program: Program, symbols: tuple[Symbol, ...], number: Mapping[str, int]) -> Program:
    place = [number[s.name] for s in program.symbols]
    operations: list[Operation] = [(op[0], place[op[1]]) if op[0] == "sym" else op for op in program.operations]
    return replace(program, symbols=symbols, operations=tuple(operations))


def defined(definitions: Program, names: Mapping[str, str], language: Language, limit: int) -> list[tuple[str, str]]:
    """Name and formula of every output of a program of definitions, in its textbook form where it has one.

    ``names``: the symbol in the program of the language, by that of the output. Raises TooLarge.
    """
    number = {s.name: n for n, s in enumerate(language.program.symbols)}
    try:
        found = textbook_inlined(definitions, language, limit, at_once(definitions))
    except (TooLarge, ZeroDivisionError):
        found = inlined(definitions, language, limit)
    zero = language.number(Fraction(0)).text
    return [
        (language.symbol(number[names[name]]).text, found.entries[name][0] if output.entries else zero)
        for name, output in definitions.outputs.items()
    ]
