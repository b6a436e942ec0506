"""Mathematica: ``nameMetric[q, p]`` of lists; results are nested lists. Names are in camel case: _ is a pattern."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from substructures.export.languages.algebra import Algebra, camel
from substructures.export.languages.code import indented
from substructures.printers.language import Listing, Piece


class Mathematica(Algebra):
    """A package file for ``Get``."""

    media = "text/x-mathematica; charset=utf-8"
    has_steps = False
    suffix = ".wl"
    ends = ("{", "}")
    brackets = ("[[", "]]")
    functions: ClassVar[Mapping[str, str]] = {
        "asin": "ArcSin",
        "acos": "ArcCos",
        "atan": "ArcTan",
        "sin": "Sin",
        "cos": "Cos",
        "tan": "Tan",
        "exp": "Exp",
        "log": "Log",
        "sqrt": "Sqrt",
        "abs": "Abs",
        "sign": "Sign",
    }

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A variable."""
        return f"{camel(name)} = {place};"

    def pi(self) -> Piece:
        """The constant pi."""
        return Piece("Pi")

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function in brackets; ArcTan[x, y] is atan2(y, x)."""
        if op == "atan2":
            return Piece(f"ArcTan[{args[1].text}, {args[0].text}]")
        return Piece(f"{self.functions[op]}[{', '.join(a.text for a in args)}]")

    @classmethod
    def commented(cls, lines: Iterable[str]) -> list[str]:
        """Lines as comments."""
        return [f"(* {line.replace('(*', '( *').replace('*)', '* )')} *)" for line in lines]

    def define(self, listing: Listing) -> list[str]:
        """A definition that holds for lists of the right lengths."""
        names = ", ".join(f"t{n}" for n, _ in listing.temporaries)
        body = [f"t{n} = {text};" for n, text in listing.temporaries]
        arguments = [f"{v.symbol}_" if v.symbol == "t" else f"{v.symbol}_List" for v in self.vectors()]
        lengths = [f"Length[{v.symbol}] == {len(v)}" for v in self.vectors() if v.symbol != "t"]
        condition = f" /; {' && '.join(lengths)}" if lengths else ""
        opening = f"{camel(self.called)}[{', '.join(arguments)}] := Module[{{{names}}},"
        return [opening, *indented([*body, self.result(listing)]), f"]{condition}"]
