"""Python code that builds SymPy expressions: ``name_metric(q, p)`` of any scalars, by default of real symbols.

Numbers stay exact. Roots and logarithms of what may be negative, and arcs of what may be beyond 1, are nan there, not
complex.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import ClassVar

from substructures.export.exported import Exported
from substructures.export.languages.code import REAL, Code, head, indented
from substructures.export.languages.named import described
from substructures.printers.language import NEGATION, Language, Listing, Piece

_CLASSES = "Abs, ImmutableDenseNDimArray, Integer, MutableDenseNDimArray, Piecewise, Rational, Symbol"
_FUNCTIONS = "acos, asin, atan, atan2, cos, exp, log, nan, pi, sign, sin, sqrt, tan"
_LENGTH = """
def _require(name, value, length):
    if len(value) != length:
        raise ValueError(f"{name} has {len(value)} elements, {length} are needed")
"""


class SymPy(Code):
    """SymPy; a function gives a scalar or an immutable array, of several outputs a dictionary."""

    media = "text/x-python; charset=utf-8"
    suffix, stem = ".py", "_sympy"
    powers = True
    power_sign = "**"
    executed = "SymPy"
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

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A module: lists of symbols by vector, then the functions."""
        lines = ['"""', *head(exported, cls.first, software, cls.executed), '"""', ""]
        lines += [f"from sympy import {_CLASSES}, {_FUNCTIONS}", ""]
        for f in REAL:
            lines += [f"def real_{f}(x):", f"    return Piecewise(({f}(x), {REAL[f]}), (nan, True))", ""]
        lines += _LENGTH.split("\n")
        for symbol in exported.symbols:
            vector = exported.interface.vectors[symbol]
            if symbol == "t":
                lines.append("t = Symbol('t', real=True)")
            else:
                told = (
                    f"    Symbol({name!a}, real=True),  # {described(vector, i)}" for i, name in enumerate(vector.names)
                )
                lines += [f"{symbol} = [", *told, "]"]
        for each in functions:
            lines += ["", *each, ""]
        return "\n".join(lines)

    def define(self, listing: Listing) -> list[str]:
        """A function whose arguments are symbols where nothing else is given."""
        arguments, before = [], []
        for vector in self.vectors():
            v = vector.symbol
            arguments.append(f"{v}={self.called}_x" if v == "x" else f"{v}={v}")
            if v == "x":
                names = ", ".join(f"Symbol({name!a}, real=True)" for name in vector.names)
                before = [f"{self.called}_x = [{names}]", ""]
        body = [f"_require({v.symbol!r}, {v.symbol}, {len(v)})" for v in self.vectors() if v.symbol != "t"]
        body += [f"t{n} = {text}" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            v = self.variables[output]
            if array.shape:
                body.append(f"{v} = MutableDenseNDimArray.zeros({', '.join(map(str, array.shape))})")
            pairs = self.pairs(output, listing) or ([] if array.shape else [(v, "Integer(0)")])
            body += [f"{element} = {text}" for element, text in pairs]
            # the immutable arrays of SymPy can be substituted into, differentiated and compared
            body += [f"{v} = ImmutableDenseNDimArray({v})"] if array.shape else []
        variables = list(self.variables.items())
        pairs_of_names = ", ".join(f"{n!a}: {v}" for n, v in variables)
        body.append(f"return {variables[0][1]}" if len(variables) == 1 else f"return {{{pairs_of_names}}}")
        return [*before, f"def {self.called}({', '.join(arguments)}):", *indented(body)]
