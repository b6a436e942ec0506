"""Fortran 2018: a module of pure subroutines ``call name_metric(q, p, metric)``; arrays have the axes of the formulas.

Lengths of arguments are checked at run time (``error stop``).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import isnan
from typing import ClassVar

from substructures.export.exported import Exported
from substructures.export.languages.code import LONGEST, Code, head, indented
from substructures.export.reference import Reference
from substructures.printers.language import Listing, Piece

#: columns that are written before a line is continued; the standard has 132
_COLUMNS = 120
_SIGN = (
    "pure function sign_of(v) result(s)",
    "    real(dp), intent(in) :: v",
    "    real(dp) :: s",
    "    s = v",
    "    if (v > 0.0_dp) s = 1.0_dp",
    "    if (v < 0.0_dp) s = -1.0_dp",
    "end function",
    "",
)


class Fortran(Code):
    """Double precision, no dependencies."""

    media = "text/x-fortran; charset=utf-8"
    mark = "!"
    suffix = ".f90"
    first = 1
    brackets = ("(", ")")
    infinity = "ieee_value(1.0_dp, ieee_positive_inf)"
    executed = "gfortran"
    has_names = True
    power_sign = "**"
    functions: ClassVar[Mapping[str, str]] = {"sign": "sign_of"}

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A public constant; none where the name is too long."""
        return f"integer, parameter, public :: {name} = {place}" if len(name) <= LONGEST else ""

    @classmethod
    def alike(cls, name: str) -> str:
        """Capitals do not count."""
        return name.lower()

    def number(self, value: Fraction) -> Piece:
        """A double."""
        plain = super().number(value)
        return Piece(f"{plain.text}_dp", plain.precedence) if plain.text[-1].isdigit() else plain

    def pi(self) -> Piece:
        """pi as a double."""
        return Piece("3.141592653589793_dp")

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A module, with the defaults of the parameters."""
        name, p = exported.name, exported.interface.vectors["p"]
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed)), f"module {name}"]
        lines += ["    use, intrinsic :: ieee_arithmetic", "    implicit none", "    private"]
        lines += ["    integer, parameter :: dp = kind(1.0d0)", f"    public :: {name}_defaults"]
        lines += [f"    public :: {exported.called(each)}" for each in exported.functions]
        lines += [
            *indented(cls.constants(exported)),
            "contains",
            "",
            f"pure subroutine {name}_defaults(p)",
            f"    real(dp), intent(out) :: p({len(p)})",
        ]
        for i, x in enumerate(p.defaults):
            value = "ieee_value(1.0_dp, ieee_quiet_nan)" if isnan(x) else f"{x!r}_dp"
            lines.append(f"    p({i + 1}) = {value}")
        lines += ["end subroutine", ""]
        body = [line for each in functions for line in (*each, "")]
        lines += [*_SIGN, *body] if any("sign_of(" in line for line in body) else body
        return "\n".join(_continued([*lines, "end module", ""]))

    def define(self, listing: Listing) -> list[str]:
        """A subroutine with its checks."""
        names = [*self.function.arguments, *self.variables.values()]
        declared, checks = [], []
        for vector in self.vectors():
            v = vector.symbol
            declared.append(f"real(dp), intent(in) :: {v}" if v == "t" else f"real(dp), intent(in) :: {v}(:)")
            if v != "t":
                message = f"'{self.called}: {v} needs {len(vector)} elements'"
                checks.append(f"if (size({v}) /= {len(vector)}) error stop {message}")
        body = []
        for output, array in self.program.outputs.items():
            v = self.variables[output]
            shape = f"({', '.join(map(str, array.shape))})" if array.shape else ""
            declared.append(f"real(dp), intent(out) :: {v}{shape}")
            body.append(f"{v} = 0.0_dp")
        named = self.named(self.texts(listing))
        declared += [f"real(dp) :: {name}" for name, _ in named]
        body += [f"{name} = {element}" for name, element in named]
        declared += [f"real(dp) :: t{n}" for n, _ in listing.temporaries]
        body += [f"t{n} = {text}" for n, text in listing.temporaries]
        for output in self.program.outputs:
            body += [f"{element} = {text}" for element, text in self.pairs(output, listing)]
        opening = f"pure subroutine {self.called}({', '.join(names)})"
        return [opening, *indented([*declared, *checks, *body]), "end subroutine"]

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A program that stops with an error where a value is not the reference's."""
        reference = list(reference)
        lines = ["program selftest", f"    use {exported.name}", "    implicit none"]
        lines += ["    integer, parameter :: dp = kind(1.0d0)", "    logical :: failed = .false."]
        lines += [f"    call test_{each.number}()" for each in reference]
        lines += ["    if (failed) error stop 1", "    print '(a)', 'ok'", "contains"]
        for each in reference:
            lines += indented(_test(each))
        lines += indented(_CHECK)
        return {f"{exported.name}_selftest.f90": "\n".join(_continued([*lines, "end program", ""]))}


_CHECK = (
    "subroutine check(found, expected, limit, what)",
    "    real(dp), intent(in) :: found, expected, limit",
    "    character(*), intent(in) :: what",
    "    if (abs(found - expected) <= limit) return",
    "    print '(a, 2es25.17)', what, found, expected",
    "    failed = .true.",
    "end subroutine",
)


def _test(each: Reference) -> list[str]:
    declared, body, results = [], [], []
    for symbol, values in each.arguments.items():
        declared.append(f"real(dp) :: {symbol}" + ("" if symbol == "t" else f"({len(values)})"))
        body += [f"{symbol}{'' if symbol == 't' else f'({i + 1})'} = {x!r}_dp" for i, x in enumerate(values)]
    for k, shape in enumerate(each.shapes):
        declared.append(f"real(dp) :: y{k}" + (f"({', '.join(map(str, shape))})" if shape else ""))
        results.append(f"y{k}")
    body.append(f"call {each.called}({', '.join([*each.arguments, *results])})")
    for check in each.checks:
        index = ", ".join(str(i + 1) for i in check.index)
        scalar = f"y{check.output}({index})" if index else f"y{check.output}"
        found = f"sum(y{check.output})" if check.is_sum else scalar
        body.append(
            f"call check({found}, {check.value!r}_dp, {check.limit!r}_dp, '{each.called} {check.output} {index}')"
        )
    return [f"subroutine test_{each.number}()", *indented([*declared, *body]), "end subroutine"]


def _continued(lines: Iterable[str]) -> Iterable[str]:
    """Lines of at most 132 columns; comments are not continued."""
    for line in lines:
        rest = line
        while len(rest) > _COLUMNS and not line.startswith("!"):
            yield rest[:_COLUMNS] + "&"
            rest = "&" + rest[_COLUMNS:]
        yield rest
