"""FriCAS: ``nameMetric(q, p)`` of lists of expressions; names are in camel case, since _ is an escape there.

Matrices are ``Matrix``, other arrays nested lists; every output has a function, ``nameKinematicsPosition``.
"""

from __future__ import annotations

from substructures.export.languages.algebra import Algebra, camel
from substructures.export.languages.code import indented, nested
from substructures.printers.language import Listing, Piece

_SCALAR = "Expression Integer"


class Fricas(Algebra):
    """An input file for ``)read``."""

    media = "text/x-fricas; charset=utf-8"
    mark = "--"
    has_steps = False
    suffix = ".input"
    executed = "FriCAS"
    brackets = ("(", ")")

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A variable."""
        return f"{camel(name)} := {place}"

    def pi(self) -> Piece:
        """The constant pi."""
        return Piece("%pi")

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function; what expressions do not have, by others."""
        if op == "atan2":  # 2 atan(y / (sqrt(x^2 + y^2) + x))
            y, x = (self.parentheses(a.text) for a in args)
            return Piece(f"(2*atan({y}/(sqrt({x}^2 + {y}^2) + {x})))")
        if op == "sign":
            return Piece(f"({self.parentheses(args[0].text)}/abs({args[0].text}))")
        return super().call(op, args)

    def define(self, listing: Listing) -> list[str]:
        """A function for each output."""
        lines: list[str] = []
        given = ", ".join(f"{v} : {_SCALAR}" if v == "t" else f"{v} : List {_SCALAR}" for v in self.function.arguments)
        many = len(self.program.outputs) > 1
        for name, array in self.program.outputs.items():
            axes = len(array.shape)
            type_ = f"Matrix {_SCALAR}" if axes == 2 else "List " * axes + _SCALAR
            called = camel(f"{self.called}_{self.variables[name]}" if many else self.called)
            value = nested(array, listing.entries[name], self.ends, "0")
            body = [
                f'if #{v.symbol} ~= {len(v)} then error "{called}: {v.symbol} needs {len(v)} elements"'
                for v in self.vectors()
                if v.symbol != "t"
            ]
            body += [f"t{n} := {text}" for n, text in listing.temporaries]
            body.append(f"matrix {value}" if axes == 2 else value)
            lines += [f"{called}({given}) : {type_} ==", *indented(body, "  "), ""]
        return lines
