"""C99: ``void name_metric(const double *q, const double *p, double *metric)``, complete arrays in row-major order.

No globals, no allocation. Long functions are split into pieces that compile in linear time (:mod:`.pieces`); the stack
that they need is stated.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from math import isfinite, isnan, prod
from typing import ClassVar

from substructures.export.exported import Exported, Function, identifier_of
from substructures.export.interface import ORDER, WORK
from substructures.export.languages.code import Code, head, indented
from substructures.export.languages.pieces import Pieces, split
from substructures.export.reference import Reference
from substructures.export.rounding import STATED, bounds
from substructures.expr.operations import Output, flat
from substructures.printers.language import NEGATION, Listing, Piece
from substructures.printers.names import comment

#: elements of arrays whose dependent ones are copied by loops
TABLES = 200
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
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed)), "", *declarations(exported), ""]
        return "\n".join([*lines, *source(exported, functions)]) + "\n"

    def define(self, listing: Listing) -> list[str]:
        """A function, of several pieces where it is long."""
        unused = [f"(void){v};" for v in self.function.arguments]
        zeros: list[str] = []
        copies: list[str] = []
        assigned: list[tuple[str, str]] = []
        for output, array in self.program.outputs.items():
            pairs = self.pairs(output, listing)
            v, size = self.variables[output], prod(array.shape)
            if len(pairs) < size:
                zeros.append(f"for (size_t i = 0; i < {size}; ++i) {v}[i] = 0;")
            own, copied = _apart(v, pairs)
            assigned += own
            copies += copied
        pieces = split(listing.temporaries, assigned)
        opening = [signature(self.function, self.called, self.variables, self.real), "{", *indented(unused + zeros)]
        if len(pieces.bodies) == 1:
            return [*opening, *indented([*self._statements(pieces, 0), *copies]), "}"]
        return [*self._pieces(pieces), *opening, *indented([*self._calls(pieces), *copies]), "}"]

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A program that ends with 1 where a value is not the reference's."""
        return {f"{exported.name}_selftest.c": "\n".join(selftest(exported, list(reference)))}

    def _statements(self, pieces: Pieces, k: int) -> list[str]:
        body = pieces.bodies[k]
        lines = [f"const {self.real} t{n} = work[{slot}];" for n, slot in body.taken]
        lines += [
            f"const {self.real} {n} = {text};" if is_new else f"{n} = {text};" for n, text, is_new in body.statements
        ]
        return lines + [f"work[{slot}] = t{n};" for n, slot in body.given]

    def _pieces(self, pieces: Pieces) -> list[str]:
        lines = []
        for k in range(len(pieces.bodies)):
            arguments = [argument(v, self.real) for v in self.function.arguments]
            arguments += [f"{self.real} *{v}" for v in self.variables.values()] + [f"{self.real} *work"]
            lines += [f"static void {self.called}_{k + 1}({', '.join(arguments)})", "{"]
            names = [*self.function.arguments, *self.variables.values(), "work"]
            lines += [*indented([*(f"(void){v};" for v in names), *self._statements(pieces, k)]), "}", ""]
        return lines

    def _calls(self, pieces: Pieces) -> list[str]:
        names = ", ".join([*self.function.arguments, *self.variables.values(), "work"])
        calls = [f"{self.called}_{k + 1}({names});" for k in range(len(pieces.bodies))]
        size = (4 if self.f else 8) * pieces.stack
        return [f"{self.real} work[{max(1, pieces.slots)}]; // the stack: {size} bytes at most", *calls]


def _apart(v: str, pairs: list[tuple[str, str]]) -> tuple[list[tuple[str, str]], list[str]]:
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
            lines += [f"    for (size_t i = 0; i < {len(some)}; ++i)"]
            lines += [f"        {v}[copies[i][0]] = {sign}{v}[copies[i][1]];", "}"]
    return own, lines


def argument(symbol: str, real: str = "double") -> str:
    """The declaration of an argument."""
    return f"{real} t" if symbol == "t" else f"const {real} *{symbol}"


def signature(function: Function, called: str, variables: Mapping[str, str], real: str) -> str:
    """The head of a function."""
    arguments = [argument(symbol, real) for symbol in function.arguments]
    return f"void {called}({', '.join([*arguments, *(f'{real} *{v}' for v in variables.values())])})"


def declarations(exported: Exported) -> list[str]:
    """Sizes and indices as constants, and the functions."""
    name, constants = exported.name, [f"{exported.name}_FUNCTIONS = {len(exported.functions)}"]
    for symbol in (*ORDER, WORK):
        if symbol not in exported.interface.vectors or symbol in ("t", "x"):
            continue
        vector = exported.interface.vectors[symbol]
        constants.append(f"{name}_N{symbol.upper()} = {len(vector)}")
        if symbol in ("q", "u", "p"):
            constants += _indices(name, symbol, vector.names)
    lines = ["enum {", *(f"    {constant}," for constant in constants[:-1]), f"    {constants[-1]}", "};", ""]
    lines += [
        "// the default values of the parameters, NaN where there are none",
        f"void {name}_defaults({exported.real} *p);",
    ]
    for each in exported.functions:
        code = C(each, exported)
        lines.append(f"// {each.program.count()['total']} operations")
        lines += _errors(each) if code.f else []
        lines.append(f"{signature(each, code.called, code.variables, exported.real)};")
    inputs = "&t, q, qd, qdd, u, x, p" + (f", {WORK}" if WORK in exported.interface.vectors else "")
    lines += [f"// any of them by its number from 0: in = {{{inputs}}}, out: its outputs; 0, or 1 for no such"]
    real = exported.real
    return [*lines, f"int {name}_call(int function, const {real} *const *in, {real} *const *out);"]


def _errors(function: Function) -> list[str]:
    """What the rounding of single precision may make of the outputs."""
    lines = []
    for name, (error, size) in bounds(function).items():
        told = f"at most {error:.2g}, elements at most {size:.3g}" if isfinite(error) else "without a bound"
        lines.append(f"// rounding of {comment(name)}: {told}")
    return [*lines, f"// for {STATED}"]


def _indices(prefix: str, symbol: str, names: Iterable[str]) -> list[str]:
    """``prefix_Q_arm_q1 = 0`` for names that make different identifiers."""
    found: dict[str, int] = {}
    seen: set[str] = set()
    for i, name in enumerate(names):
        plain = identifier_of(name)
        if plain and plain not in seen:
            found[plain] = i
        else:
            found.pop(plain, None)
        seen.add(plain)
    return [f"{prefix}_{symbol.upper()}_{plain} = {i}" for plain, i in found.items()]


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
    lines += [f"    p[{i}] = {'NAN' if isnan(x) else repr(x) + f};" for i, x in values]
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


def selftest(exported: Exported, reference: Sequence[Reference]) -> list[str]:
    """A program that ends with 1 where a value is not the reference's."""
    real, f, wider = exported.real, "", 1.0
    if exported.precision == "single":
        f, wider = "f", 1e5
    lines = [
        f'#include "{exported.name}.h"',
        "",
        "#include <math.h>",
        "#include <stddef.h>",
        "#include <stdio.h>",
        "",
        *(line.replace("REAL", real) for line in _CHECK),
    ]
    for each in reference:
        lines += ["", f"static int test_{each.number}(void)", "{", "    int wrong = 0;"]
        names = []
        for symbol, values in each.arguments.items():
            plain = ", ".join(f"{x!r}{f}" for x in values) or "0"
            one = (
                f"const {real} t = {values[0]!r}{f};"
                if symbol == "t"
                else f"static const {real} {symbol}[] = {{{plain}}};"
            )
            lines.append(f"    {one}")
            names.append(symbol)
        for k, shape in enumerate(each.shapes):
            lines.append(f"    static {real} y{k}[{max(1, prod(shape))}];")
            names.append(f"y{k}")
        lines.append(f"    {each.called}({', '.join(names)});")
        for check in each.checks:
            y, size = f"y{check.output}", prod(each.shapes[check.output])
            found = f"sum({y}, {size})" if check.is_sum else f"{y}[{flat(check.index, each.shapes[check.output])}]"
            lines.append(f'    wrong |= differs({found}, {check.value!r}, {wider * check.limit!r}, "{each.called}");')
        lines += ["    return wrong;", "}"]
    lines += ["", "int main(void)", "{", "    int wrong = 0;"]
    lines += [f"    wrong |= test_{each.number}();" for each in reference]
    return [*lines, '    if (!wrong) puts("ok");', "    return wrong;", "}", ""]


_CHECK = (
    "static int differs(double found, double expected, double limit, const char *what)",
    "{",
    "    if (fabs(found - expected) <= limit) return 0;",
    '    printf("%s: %.17g for %.17g\\n", what, found, expected);',
    "    return 1;",
    "}",
    "",
    "static double sum(const REAL *values, size_t count)",
    "{",
    "    double total = 0.0;",
    "    for (size_t i = 0; i < count; ++i) total += values[i];",
    "    return total;",
    "}",
)


def head_of(exported: Exported, software: str) -> list[str]:
    """The head as comments."""
    return C.commented(head(exported, C.first, software))
