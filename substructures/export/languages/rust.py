"""Rust without its standard library: ``name_metric(&q, &p, &mut metric)``; lengths are part of the types.

``sin`` and the other functions are those of the C library (``libm``), which ``no_std`` programs link.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isnan
from typing import ClassVar

from substructures.export.exported import Exported
from substructures.export.languages.code import Code, head, indented
from substructures.export.reference import Reference
from substructures.printers.language import Listing, Piece

_BINARY = ("atan2", "pow")
_ALLOW = "#[allow(unused_variables, unused_parens, unused_mut, non_snake_case, clippy::all)]"
_SIGN = (
    "#[allow(dead_code)]",
    "fn sign_of(v: f64) -> f64 {",
    "    if v > 0.0 { 1.0 } else if v < 0.0 { -1.0 } else { v }",
    "}",
    "",
)


class Rust(Code):
    """A module for ``no_std`` crates. Arrays are nested, row by row."""

    media = "text/x-rust; charset=utf-8"
    mark = "//"
    suffix = ".rs"
    infinity = "f64::INFINITY"
    executed = "rustc"
    has_names = True
    functions: ClassVar[Mapping[str, str]] = {"abs": "fabs", "sign": "sign_of"}

    @classmethod
    def opening(cls, exported: Exported) -> str:  # noqa: ARG003 -- of the base
        """Nothing."""
        return ""

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A constant of the module ``at``."""
        return f"pub const {name.upper()}: usize = {place};"

    @classmethod
    def alike(cls, name: str) -> str:
        """Constants are in capitals."""
        return name.upper()

    def pi(self) -> Piece:
        """pi as a double."""
        return Piece("core::f64::consts::PI")

    def power(self, a: Piece, n: int) -> Piece:
        """An integer power."""
        return Piece(f"pow({a.text}, {float(n)!r})")

    def place(self, variable: str, array: object, index: tuple[int, ...]) -> str:  # noqa: ARG002 - of the interface
        """An element of nested arrays, or what a reference to a number refers to."""
        return variable + "".join(f"[{i}]" for i in index) if index else f"*{variable}"

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A module."""
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed)), "", *_mathematics()]
        p = exported.interface.vectors["p"]
        lines += ["/// Places of elements in arguments, with units and defaults."]
        lines += ["#[allow(dead_code)]", "pub mod at {", *indented(cls.constants(exported)), "}", ""]
        values = ["f64::NAN" if isnan(x) else repr(x) for x in p.defaults]
        lines += ["#[allow(dead_code)]", f"pub const P: [f64; {len(p)}] = [", *(f"    {x}," for x in values), "];", ""]
        body = [line for each in functions for line in (*each, "")]
        return "\n".join([*lines, *_SIGN, *body])

    def define(self, listing: Listing) -> list[str]:
        """A function."""
        arguments = [f"{v.symbol}: " + ("f64" if v.symbol == "t" else f"&[f64; {len(v)}]") for v in self.vectors()]
        body = [f"let {name} = {element};" for name, element in self.named(self.texts(listing))]
        body += [f"let t{n}: f64 = {text};" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            v = self.variables[output]
            arguments.append(f"{v}: &mut {_type(array.shape)}")
            body.append(f"*{v} = {zeros(array.shape)};")
            # copies of elements are read through the reference
            body += [f"{element} = {text};" for element, text in self.pairs(output, listing)]
        return [_ALLOW, f"pub fn {self.called}({', '.join(arguments)}) {{", *indented(body), "}"]

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A program (with the standard library) that ends with an error where a value is not the reference's."""
        lines = [
            f"mod {exported.name};",
            f"use {exported.name}::*;",
            "",
            *_CHECK,
            "fn main() {",
            "    let mut failed = false;",
        ]
        for each in reference:
            body = []
            for symbol, values in each.arguments.items():
                one = (
                    f"let t = {values[0]!r};" if symbol == "t" else f"let {symbol} = [{', '.join(map(repr, values))}];"
                )
                body.append(one.replace("= []", "= [0.0_f64; 0]"))
            given = [symbol if symbol == "t" else f"&{symbol}" for symbol in each.arguments]
            for k, shape in enumerate(each.shapes):
                body.append(f"let mut y{k} = {zeros(shape)};")
                given.append(f"&mut y{k}")
            body.append(f"{each.called}({', '.join(given)});")
            for check in each.checks:
                y, shape = f"y{check.output}", each.shapes[check.output]
                found = (
                    f"{_flattened(y, len(shape))}.sum::<f64>()"
                    if check.is_sum
                    else y + "".join(f"[{i}]" for i in check.index)
                )
                body.append(f'failed |= wrong({found}, {check.value!r}, {check.limit!r}, "{each.called}");')
            lines += ["    {", *indented(body, " " * 8), "    }"]
        lines += ["    if failed { std::process::exit(1); }", '    println!("ok");', "}", ""]
        return {f"{exported.name}_selftest.rs": "\n".join(lines)}


_CHECK = (
    "fn wrong(found: f64, expected: f64, limit: f64, what: &str) -> bool {",
    "    let bad = !((found - expected).abs() <= limit);",
    '    if bad { println!("{}: {:e} for {:e}", what, found, expected); }',
    "    bad",
    "}",
    "",
)


def _flattened(y: str, axes: int) -> str:
    return f"{y}.iter()" + ".flatten()" * (axes - 1)


def _mathematics() -> list[str]:
    names = ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "fabs", "atan2", "pow")
    lines = ["mod libm {", '    #[link(name = "m")]', '    unsafe extern "C" {']
    for name in names:
        arguments = "x: f64, y: f64" if name in _BINARY else "x: f64"
        lines.append(f"        pub fn {name}({arguments}) -> f64;")
    lines += ["    }", "}"]
    for name in names:
        arguments, given = ("x: f64, y: f64", "x, y") if name in _BINARY else ("x: f64", "x")
        lines += ["#[allow(dead_code)]", "#[inline]", f"fn {name}({arguments}) -> f64 {{"]
        lines += [f"    unsafe {{ libm::{name}({given}) }}", "}"]
    return lines


def _type(shape: tuple[int, ...]) -> str:
    result = "f64"
    for size in reversed(shape):
        result = f"[{result}; {size}]"
    return result


def zeros(shape: tuple[int, ...]) -> str:
    """An array of zeros."""
    result = "0.0_f64"
    for size in reversed(shape):
        result = f"[{result}; {size}]"
    return result
