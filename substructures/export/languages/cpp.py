"""C++17, a header: ``auto metric = name::metric(q, p)``, over ``double`` or any scalar with these functions.

Lengths are part of the types; ``p`` has its defaults. Arrays are ``std::array``, row-major. Constants are of the
precision of ``float`` or ``double``, and doubles for scalars of other kinds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import isnan, prod
from typing import ClassVar

from substructures.export.exported import KEYWORDS, Exported, Function
from substructures.export.languages.c import C
from substructures.export.languages.code import head, indented
from substructures.export.reference import Reference
from substructures.expr.operations import Output, flat
from substructures.printers.language import Listing, Piece

_USING = ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "sqrt", "abs")

_CONSTANTS = "using constant_of = std::conditional_t<std::is_floating_point_v<T>, T, double>;"
#: what a header needs before its functions; unused ones are left out
_HELPERS = {
    "sign_of": (
        "template <class T>",
        "T sign_of(const T& v) {",
        "    return v > T(0) ? T(1) : v < T(0) ? T(-1) : v;",
        "}",
    ),
    "power_of": (
        "template <class T>",
        "T power_of(const T& v, int n) {",
        "    using std::pow;",
        "    if constexpr (std::is_floating_point_v<T>) return pow(v, T(n));",
        "    else return pow(v, n);",
        "}",
    ),
}


class Cpp(C):
    """Function templates without dependencies."""

    media = "text/x-c++; charset=utf-8"
    suffix = ".hpp"
    executed = "g++"
    functions: ClassVar[Mapping[str, str]] = {"sign": "sign_of"}

    def __init__(self, function: Function, exported: Exported) -> None:
        super().__init__(function, exported)
        self.called = _in_namespace(exported, function)

    @classmethod
    def opening(cls, exported: Exported) -> str:  # noqa: ARG003 -- of the base
        """Nothing."""
        return ""

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A constant of the namespace."""
        return f"inline constexpr std::size_t {name} = {place};"

    def number(self, value: Fraction) -> Piece:
        """The nearest number of the precision."""
        found = super().number(value)
        return found if value < 0 else Piece(f"real({found.text})")

    def pi(self) -> Piece:
        """pi as a number: C++17 has no constant for it."""
        return Piece(f"real({super().pi().text})")

    def power(self, a: Piece, n: int) -> Piece:
        """An integer power."""
        return Piece(f"power_of({a.text}, {n})")

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A header."""
        name, p = exported.name, exported.interface.vectors["p"]
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed, called)), "#pragma once", ""]
        lines += [f"#include <{header}>" for header in ("array", "cmath", "cstddef", "limits", "type_traits")] + [""]
        lines += [f"namespace {name} {{", "", *cls.constants(exported)]
        values = ("std::numeric_limits<double>::quiet_NaN()" if isnan(x) else repr(x) for x in p.defaults)
        lines += ["// the default values of the parameters", "template <class T = double>"]
        lines += [
            f"std::array<T, {len(p)}> defaults() {{",
            f"    return {{{', '.join(f'T({x})' for x in values)}}};",
        ]
        lines += ["}", ""]
        body = [line for each in functions for line in (*each, "")]
        lines += ["// what constants are beside a scalar", "template <class T>", _CONSTANTS, ""]
        for needed, helper in _HELPERS.items():
            if any(f"{needed}(" in line for line in body):
                lines += [*helper, ""]
        return "\n".join([*lines, *body, "}", ""])

    def define(self, listing: Listing) -> list[str]:
        """A function template, with a structure for several outputs."""
        arrays = [(self.variables[n], o) for n, o in self.program.outputs.items()]
        types = [f"std::array<T, {prod(o.shape)}>" if o.shape else "T" for _, o in arrays]
        lines, result, many = [], types[0], len(arrays) > 1
        if many:
            members = [f"{type_} {v};" for type_, (v, _) in zip(types, arrays, strict=True)]
            lines = ["template <class T>", f"struct {self.called}_result {{", *indented(members), "};"]
            result = f"{self.called}_result<T>"
        arguments = [
            f"const T& {v.symbol}" if v.symbol == "t" else f"const std::array<T, {len(v)}>& {v.symbol}"
            for v in self.vectors()
        ]
        if self.function.arguments[-1] == "p":
            arguments[-1] += " = defaults<T>()"
        body = ["using real [[maybe_unused]] = constant_of<T>;", *(f"using std::{f};" for f in _USING)]
        body += [f"(void){v};" for v in self.function.arguments]
        body.append(f"{result} result{{}};")
        body += [f"[[maybe_unused]] auto& {v} = result{f'.{v}' if many else ''};" for v, _ in arrays]
        body += [f"const T& {name} = {element};" for name, element in self.named(self.texts(listing))]
        body += [f"const T t{n} = {text};" for n, text in listing.temporaries]
        for output in self.program.outputs:
            body += [f"{element} = {text};" for element, text in self.pairs(output, listing)]
        opening = f"{result} {self.called}({', '.join(arguments)})"
        return [*lines, "template <class T = double>", opening, "{", *indented([*body, "return result;"]), "}"]

    def place(self, variable: str, array: Output, index: tuple[int, ...]) -> str:
        """An element of a flat array, or the number itself."""
        return super().place(variable, array, index) if index else variable

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A program that ends with 1 where a value is not the reference's."""
        lines = [
            f'#include "{exported.name}.hpp"',
            "",
            "#include <cstdio>",
            "",
            *_CHECK,
            "int main() {",
            "    bool wrong = false;",
        ]
        for each in reference:
            body, function = list[str](), exported.functions[each.number]
            for symbol, values in each.arguments.items():
                list_ = f"std::array<double, {len(values)}> {symbol}{{{', '.join(map(repr, values))}}}"
                body.append(f"const double t = {values[0]!r};" if symbol == "t" else f"const {list_};")
            unused = "" if each.checks else "[[maybe_unused]] "
            body.append(f"{unused}const auto y = {called(exported, function)}({', '.join(each.arguments)});")
            variables = list(cls(function, exported).variables.values())
            for check in each.checks:
                shape = each.shapes[check.output]
                y = f"y.{variables[check.output]}" if len(variables) > 1 else "y"
                found = f"sum({y})" if check.is_sum else f"{y}[{flat(check.index, shape)}]" if shape else y
                body.append(f'wrong |= differs({found}, {check.value!r}, {check.limit!r}, "{each.called}");')
            lines += ["    {", *indented(body, " " * 8), "    }"]
        lines += ['    if (!wrong) std::puts("ok");', "    return wrong;", "}", ""]
        return {f"{exported.name}_selftest.cpp": "\n".join(lines)}


def _in_namespace(exported: Exported, function: Function) -> str:
    name = exported.called(function).removeprefix(f"{exported.name}_")
    return f"{name}_" if name in KEYWORDS else name


def called(exported: Exported, function: Function) -> str:
    """Of a function, with its namespace."""
    return f"{exported.name}::{_in_namespace(exported, function)}"


_CHECK = (
    "inline bool differs(double found, double expected, double limit, const char* what) {",
    "    if (std::abs(found - expected) <= limit) return false;",
    '    std::printf("%s: %.17g for %.17g\\n", what, found, expected);',
    "    return true;",
    "}",
    "",
    "template <class A>",
    "double sum(const A& values) {",
    "    double total = 0;",
    "    for (double x : values) total += x;",
    "    return total;",
    "}",
    "",
)
