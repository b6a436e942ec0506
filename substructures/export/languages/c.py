"""C99: ``void name_metric(const double *q, const double *p, double *metric)``, complete arrays in row-major order.

No globals, no allocation. Long functions are split into pieces that compile in linear time (:mod:`.pieces`); the stack
that they need is stated. On request C89: comments ``/* */``, and declarations before statements.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import isfinite, isnan, prod
from typing import ClassVar

from substructures.export.exported import Exported, Function
from substructures.export.interface import ORDER, WORK
from substructures.export.languages.c_selftest import selftest
from substructures.export.languages.code import Code, head, indented
from substructures.export.languages.named import constants
from substructures.export.languages.pieces import Pieces, split
from substructures.export.reference import Reference
from substructures.export.rounding import STATED, bounds
from substructures.expr.operations import Output, flat
from substructures.printers.language import NEGATION, Listing, Piece
from substructures.printers.names import comment

#: elements of arrays whose dependent ones are copied by loops
TABLES = 200
_CALL = re.compile(r"\w\(", re.ASCII)
#: what the source needs before its functions; unused ones are left out
_HELPERS = {
    "sign_of": ("static REAL sign_of(REAL v)", "{", "    return v > 0 ? 1 : v < 0 ? -1 : v;", "}", ""),
}


class C(Code):
    """C99, needs the mathematical library only."""

    media = "text/x-c; charset=utf-8"
    mark = "//"
    suffix = ".c"
    infinity = "HUGE_VAL"
    executed = "gcc and clang"
    has_names = True
    functions: ClassVar[Mapping[str, str]] = {"abs": "fabs", "sign": "sign_of"}

    @property
    def f(self) -> str:
        """What constants and functions of single precision end with."""
        return "f" if self.exported.precision == "single" else ""

    def number(self, value: Fraction) -> Piece:
        """The nearest number of the precision."""
        if value < 0:
            return Piece("-" + self.number(-value).text, NEGATION)
        text = super().number(value).text
        return Piece(text if text == self.infinity else f"{text}{self.f}")

    def pi(self) -> Piece:
        """pi as a number: C99 has no constant for it."""
        return Piece(f"3.141592653589793{self.f}")

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function of the mathematical library, or one of ours."""
        found = super().call(op, args)
        name, bracket, rest = found.text.partition("(")
        return found if name in _HELPERS else Piece(f"{name}{self.f}{bracket}{rest}")

    def power(self, a: Piece, n: int) -> Piece:
        """``pow``, which is exact for integer exponents of small numbers."""
        return Piece(f"pow{self.f}({a.text}, {float(n)!r}{self.f})")

    @property
    def real(self) -> str:
        """The type of numbers."""
        return self.exported.real

    def place(self, variable: str, array: Output, index: tuple[int, ...]) -> str:
        """An element of a flat array."""
        return f"{variable}[{flat(index, array.shape)}]"

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """Declarations and definitions in one file."""
        given = list(functions)
        lines = [
            *cls.commented(head(exported, cls.first, software, cls.executed)),
            "",
            *declarations(exported, given),
            "",
        ]
        return "\n".join([*lines, *source(exported, given)]) + "\n"

    def define(self, listing: Listing) -> list[str]:
        """A comment that states operations and stack, and a function, of several pieces where it is long."""
        empty = [self.variables[name] for name, array in self.program.outputs.items() if not prod(array.shape)]
        unused = [f"(void){v};" for v in (*self.function.arguments, *empty)]
        zeros: list[str] = []
        copies: list[str] = []
        assigned: list[tuple[str, str]] = []
        for output, array in self.program.outputs.items():
            pairs = self.pairs(output, listing)
            v, size = self.variables[output], prod(array.shape)
            if len(pairs) < size:
                zeros += self._loop(size, f"{v}[i] = 0;")
            own, copied = self._apart(v, pairs)
            assigned += own
            copies += copied
        pieces = split(listing.temporaries, assigned)
        head_ = [signature(self.function, self.called, self.variables, self.real), "{"]
        if len(pieces.bodies) == 1:
            declared, stated = self._statements(pieces, 0)
            before = []
        else:
            declared, stated = self._calls(pieces)
            before = self._pieces(pieces)
        inner = [*declared, *unused, *zeros, *stated] if self.is_old else [*unused, *zeros, *declared, *stated]
        return [self._stated(pieces), *before, *head_, *indented([*inner, *copies]), "}"]

    @property
    def is_old(self) -> bool:
        """Whether declarations stand before statements, as in C89."""
        return self.exported.standard == "c89"

    def _loop(self, size: int, statement: str) -> list[str]:
        if self.is_old:
            return ["{", "    size_t i;", f"    for (i = 0; i < {size}; ++i) {statement}", "}"]
        return [f"for (size_t i = 0; i < {size}; ++i) {statement}"]

    def _stated(self, pieces: Pieces) -> str:
        """Operations, and the most that a compiler needs on the stack: all that has a name, each operand that waits
        for a call, and what calls save."""
        count = self.program.count()["total"]
        waiting = [sum(len(_CALL.findall(text)) for _, text, _ in body.statements) for body in pieces.bodies]
        named = [len(self.named(text for _, text, _ in body.statements)) for body in pieces.bodies]
        numbers = pieces.stack + max(map(sum, zip(waiting, named, strict=True)))
        pointers = 2 * (len(self.function.arguments) + len(self.variables) + 1)
        return f"// {count} operations, at most {(4 if self.f else 8) * numbers + 8 * pointers + 256} bytes of stack"

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A program that ends with 1 where a value is not the reference's."""
        return {f"{exported.name}_selftest.c": "\n".join(selftest(exported, f"{exported.name}.h", list(reference)))}

    def _statements(self, pieces: Pieces, k: int) -> tuple[list[str], list[str]]:
        """Declarations that begin a piece, and what follows: in C89 all declarations, and the rest."""
        body = pieces.bodies[k]
        texts = [text for _, text, _ in body.statements]
        declared = [f"const {self.real} {name} = {element};" for name, element in self.named(texts)]
        declared += [f"const {self.real} t{n} = work[{slot}];" for n, slot in body.taken]
        new = [f"const {self.real} {n} = {text};" for n, text, is_new in body.statements if is_new and self.is_old]
        stated = [
            f"const {self.real} {n} = {text};" if is_new else f"{n} = {text};"
            for n, text, is_new in body.statements
            if not (is_new and self.is_old)
        ]
        return declared + new, stated + [f"work[{slot}] = t{n};" for n, slot in body.given]

    def _pieces(self, pieces: Pieces) -> list[str]:
        lines = []
        for k in range(len(pieces.bodies)):
            arguments = [argument(v, self.real) for v in self.function.arguments]
            arguments += [f"{self.real} *{v}" for v in self.variables.values()] + [f"{self.real} *work"]
            lines += [f"static void {self.called}_{k + 1}({', '.join(arguments)})", "{"]
            unused = [f"(void){v};" for v in (*self.function.arguments, *self.variables.values(), "work")]
            declared, stated = self._statements(pieces, k)
            inner = [*declared, *unused, *stated] if self.is_old else [*unused, *declared, *stated]
            lines += [*indented(inner), "}", ""]
        return lines

    def _calls(self, pieces: Pieces) -> tuple[list[str], list[str]]:
        names = ", ".join([*self.function.arguments, *self.variables.values(), "work"])
        calls = [f"{self.called}_{k + 1}({names});" for k in range(len(pieces.bodies))]
        return [f"{self.real} work[{max(1, pieces.slots)}];"], calls

    def _apart(self, v: str, pairs: list[tuple[str, str]]) -> tuple[list[tuple[str, str]], list[str]]:
        """Elements to be computed, and loops over tables that copy the others of a large array from these."""
        if len(pairs) < TABLES:
            return pairs, []
        copy = re.compile(rf"(-?){v}\[(\d+)\]")
        matches = [(element, copy.fullmatch(text)) for element, text in pairs]
        own = [pair for pair, (_, match) in zip(pairs, matches, strict=True) if match is None]
        lines: list[str] = []
        for sign in ("", "-"):
            some = [(element[len(v) + 1 : -1], m[2]) for element, m in matches if m is not None and m[1] == sign]
            if some:
                table = ", ".join(f"{{{to}, {source}}}" for to, source in some)
                lines += ["{", f"    static const unsigned int copies[][2] = {{{table}}};"]
                lines += [*indented(self._loop(len(some), f"{v}[copies[i][0]] = {sign}{v}[copies[i][1]];")), "}"]
        return own, lines


def argument(symbol: str, real: str = "double") -> str:
    """The declaration of an argument."""
    return f"{real} t" if symbol == "t" else f"const {real} *{symbol}"


def signature(function: Function, called: str, variables: Mapping[str, str], real: str) -> str:
    """The head of a function."""
    arguments = [argument(symbol, real) for symbol in function.arguments]
    return f"void {called}({', '.join([*arguments, *(f'{real} *{v}' for v in variables.values())])})"


def indices(exported: Exported) -> list[str]:
    """Lengths of arguments, and places of their elements by name, with units and defaults."""
    name, vectors = exported.name, exported.interface.vectors
    lengths = [symbol for symbol in (*ORDER, WORK) if symbol in vectors and symbol not in ("t", "x")]
    lines = [
        f"    {name}_{each.vector.upper()}_{each.name} = {each.place}, // {each.told}" for each in constants(exported)
    ]
    lines += [f"    {name}_N{symbol.upper()} = {len(vectors[symbol])}," for symbol in lengths]
    return ["enum {", *lines, f"    {name}_FUNCTIONS = {len(exported.functions)}", "};", ""]


def declarations(exported: Exported, functions: Iterable[list[str]]) -> list[str]:
    """Sizes and indices as constants, and the functions with what their definitions state."""
    name = exported.name
    lines = [
        *indices(exported),
        "// the default values of the parameters, NaN where there are none",
        f"void {name}_defaults({exported.real} *p);",
    ]
    for each, defined in zip(exported.functions, functions, strict=True):
        code = C(each, exported)
        lines.append(defined[0])
        lines += _errors(exported, each) if code.f else []
        lines.append(f"{signature(each, code.called, code.variables, exported.real)};")
    inputs = "&t, q, qd, qdd, u, x, p" + (f", {WORK}" if WORK in exported.interface.vectors else "")
    lines += [f"// any of them by its number from 0: in = {{{inputs}}}, out: its outputs; 0, or 1 for no such"]
    real = exported.real
    return [*lines, f"int {name}_call(int function, const {real} *const *in, {real} *const *out);"]


def _errors(exported: Exported, function: Function) -> list[str]:
    """What the rounding of single precision may make of the outputs."""
    lines = []
    for name, (error, size) in bounds(function, exported.ranges).items():
        told = (
            f"at most {error:.2g}, elements at most {size:.3g}"
            if isfinite(error)
            else "without a bound here: take narrower ranges"
        )
        lines.append(f"// rounding of {comment(name)}: {told}")
    given = ", ".join(f"{comment(name)} {low:g} to {high:g}" for name, (low, high) in exported.ranges.items())
    return [*lines, f"// for {given + '; else ' if given else ''}{STATED}"]


def source(exported: Exported, functions: Iterable[list[str]]) -> list[str]:
    """The definitions."""
    body = [line for each in functions for line in (*each, "")]
    text = "\n".join(body)
    lines = ["#include <math.h>", "#include <stddef.h>", ""]
    for name, helper in _HELPERS.items():
        if f"{name}(" in text:
            lines += [line.replace("REAL", exported.real) for line in helper]
    values = enumerate(exported.interface.vectors["p"].defaults)
    real, f = exported.real, "f" if exported.precision == "single" else ""
    lines += [f"void {exported.name}_defaults({real} *p)", "{", "    (void)p;"]
    nan = "HUGE_VAL - HUGE_VAL" if exported.standard == "c89" else "NAN"
    lines += [f"    p[{i}] = {nan if isnan(x) else repr(x) + f};" for i, x in values]
    return [*lines, "}", "", *body, *_call(exported)]


def _call(exported: Exported) -> list[str]:
    position = {symbol: i for i, symbol in enumerate((*ORDER, WORK))}
    cases = []
    for k, each in enumerate(exported.functions):
        inputs = ["*in[0]" if v == "t" else f"in[{position[v]}]" for v in each.arguments]
        outputs = [f"out[{i}]" for i in range(len(each.program.outputs))]
        cases += [
            f"    case {k}:",
            f"        {exported.called(each)}({', '.join(inputs + outputs)});",
            "        return 0;",
        ]
    real = exported.real
    head_ = [f"int {exported.name}_call(int function, const {real} *const *in, {real} *const *out)", "{"]
    return [
        *head_,
        "    (void)in;",
        "    (void)out;",
        "    switch (function) {",
        *cases,
        "    default:",
        "        return 1;",
        "    }",
        "}",
    ]


def as_standard(exported: Exported, lines: Iterable[str]) -> str:
    """The text of a file, whose comments are those of the standard."""
    text = "\n".join(lines)
    return re.sub("//(.*)$", r"/*\1 */", text, flags=re.MULTILINE) if exported.standard == "c89" else text


def head_of(exported: Exported, software: str) -> list[str]:
    """The head as comments."""
    return C.commented(head(exported, C.first, software))
