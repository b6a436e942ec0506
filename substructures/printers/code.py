"""What the generated programs have in common: inputs ``x``, temporaries ``t1, t2, ...``, doubles, comments."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from substructures.expr.interpret import constant
from substructures.expr.program import Program
from substructures.printers.language import NEGATION, Language, Piece
from substructures.printers.names import comment, identifier
from substructures.printers.symmetry import symmetry_rule

_WORDS = (
    "x t pi i j e np math model sign auto break case char const continue default do double else enum extern float for",
    "goto if inline int long register restrict return short signed sizeof static struct switch typedef union unsigned",
    "void volatile while and as assert async await class def del elif except false finally from global import in is",
    "lambda none nonlocal not or pass raise true try with yield match type function end otherwise parfor persistent",
    "spmd classdef catch let local macro module quote using baremodule begin export abstract mutable primitive where",
    "outer nan inf zeros ones sin cos tan asin acos atan atan2 exp log sqrt abs fabs pow batch inputs outputs sign_of",
    "integer rational symbol mutabledensendimarray immutabledensendimarray main list len dict isinstance valueerror",
    "size_t",
)
_RESERVED = frozenset(word for line in _WORDS for word in line.split())


#: conditions under which functions are real, in terms of x
REAL = {"sqrt": "x >= 0", "log": "x >= 0", "asin": "abs(x) <= 1", "acos": "abs(x) <= 1"}


class Code(Language):
    """Base of the programming languages; ``mark`` begins a comment line."""

    width = 100
    powers = False
    mark = "#"
    infinity = "inf"

    def __init__(self, program: Program) -> None:
        super().__init__(program)
        # capitals are macros, a letter with digits is a temporary or a Bessel function
        plain = [n if len(n) == 1 or not (n.isupper() or n[1:].isdigit()) else "" for n in program.outputs]
        names = [identifier(n, _RESERVED, "") for n in plain]
        #: variables of the outputs: their own names where these are harmless
        self.variables = {n: v or f"y{k}" for k, (n, v) in enumerate(zip(program.outputs, names, strict=True))}

    def number(self, value: Fraction) -> Piece:
        """The nearest double."""
        if value < 0:
            return Piece("-" + self.number(-value).text, NEGATION)
        double = constant(("rat", str(value.numerator), str(value.denominator)))
        return Piece(self.infinity if double == float("inf") else repr(double))

    def function_name(self, name: str) -> str:
        """The wanted name of the generated function if it can be one, else ``model``."""
        return identifier(name, _RESERVED | {v.lower() for v in self.variables.values()}, "model")

    def partial(self) -> list[str]:
        """The functions that the program calls outside of constants, and that are not real everywhere."""
        ops = self.program.operations
        called = {op[0] for op in ops if op[0] in REAL and ops[op[1]][0] not in ("int", "rat")}
        return [name for name in REAL if name in called]

    def real_call(self, op: str, args: list[Piece]) -> Piece:
        """A function, with ``real_`` before its name where it is partial and the argument no constant."""
        plain = Language.call(self, op, args)
        return Piece(f"real_{plain.text}") if op in REAL and not args[0].text[0].isdigit() else plain

    def comments(self, name: str, indent: str = "") -> list[str]:
        """Inputs and outputs, in words."""
        lines = [f"{comment(name)}", "inputs:"]
        for n, s in enumerate(self.program.symbols):
            lines.append(f"  {self.symbol(n).text}  {comment(s.name)}, {s.kind} [{comment(s.unit)}]")
        lines.append("outputs:")
        for output, array in self.program.outputs.items():
            shape = " x ".join(map(str, array.shape)) or "scalar"
            rule = "; " + symmetry_rule(array.symmetry) if array.shape else ""
            lines.append(f"  {self.variables[output]}  {comment(output)}: {shape}{rule}")
        return [f"{indent}{self.mark} {line}" for line in lines]


def indented(lines: Iterable[str], by: str = "    ") -> list[str]:
    """Lines with indentation."""
    return [by + line for line in lines]
