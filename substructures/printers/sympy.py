"""Python code that builds SymPy expressions from real symbols; numbers stay exact.

Roots and logarithms of what may be negative, and arcs of what may be beyond 1, are nan there, not complex.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import ClassVar

from substructures.expr.program import Output
from substructures.printers.code import REAL, Code
from substructures.printers.language import NEGATION, Language, Listing, Piece
from substructures.printers.symmetry import assignments

_CLASSES = "Abs, ImmutableDenseNDimArray, Integer, MutableDenseNDimArray, Rational, Symbol"
_FUNCTIONS = "acos, asin, atan, atan2, cos, exp, log, pi, sign, sin, sqrt, tan"


class SymPy(Code):
    """SymPy; the result is the dictionary ``outputs``: immutable arrays by name."""

    media = "text/x-python; charset=utf-8"
    powers = True
    power_sign = "**"
    functions: ClassVar[Mapping[str, str]] = {"abs": "Abs"}

    def number(self, value: Fraction) -> Piece:
        """An exact number: a plain integer, or a Rational."""
        if value < 0:
            return Piece("-" + self.number(-value).text, NEGATION)
        if value.denominator == 1:
            return Piece(str(value.numerator))
        return Piece(f"Rational({value.numerator}, {value.denominator})")

    def div(self, a: Piece, b: Piece) -> Piece:
        """a / b, exact also for two integers."""
        # two plain integers would make a float
        return Language.div(self, Piece(f"Integer({a.text})") if a.text.isdigit() else a, b)

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function; by its real branch where the argument is no constant."""
        return self.real_call(op, args)

    def render(self, listing: Listing, name: str) -> str:
        """A module that builds immutable arrays of expressions."""
        lines = [
            '"""Generated code: formulas of a mechanism."""',
            "",
            f"from sympy import {_CLASSES}, {_FUNCTIONS}",
            "",
        ]
        if self.partial():
            lines[2] += ", Piecewise, nan"
        for f in self.partial():
            lines += [f"def real_{f}(x):", f"    return Piecewise(({f}(x), {REAL[f]}), (nan, True))", ""]
        lines += [*self.comments(name), "", "x = ["]
        lines += [f"    Symbol({s.name!a}, real=True)," for s in self.program.symbols]
        lines += ["]", *(f"t{n} = {text}" for n, text in listing.temporaries)]
        for output, array in self.program.outputs.items():
            lines += self._fill(self.variables[output], array, listing.entries[output])
        # the immutable arrays of SymPy can be substituted into, differentiated and compared
        pairs = ", ".join(
            f"{n!a}: ImmutableDenseNDimArray({v})" if self.program.outputs[n].shape else f"{n!a}: {v}"
            for n, v in self.variables.items()
        )
        return "\n".join([*lines, f"outputs = {{{pairs}}}"]) + "\n"

    def _fill(self, v: str, array: Output, texts: tuple[str, ...]) -> list[str]:
        if not array.shape:
            return [f"{v} = {texts[0] if texts else 'Integer(0)'}"]
        lines = [f"{v} = MutableDenseNDimArray.zeros({', '.join(map(str, array.shape))})"]
        pairs = assignments(array, texts, lambda index: f"{v}[{', '.join(map(str, index))}]")
        lines += [f"{element} = {text}" for element, text in pairs]
        return lines
