"""Julia: ``name_metric(q, p)``. Roots and logarithms of negative numbers raise DomainError."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isnan
from typing import ClassVar

from substructures.export.exported import Exported
from substructures.export.languages.code import Code, indented
from substructures.export.reference import Reference
from substructures.printers.language import Listing

_CHECK = (
    "function check(found, expected, limit, what)",
    '    abs(found - expected) <= limit || error("$what: $found for $expected")',
    "end",
)


class Julia(Code):
    """Functions of vectors; they need no packages. One output is an array, several are a named tuple."""

    media = "text/x-julia; charset=utf-8"
    suffix = ".jl"
    first = 1
    infinity = "Inf"
    has_names = True
    functions: ClassVar[Mapping[str, str]] = {"atan2": "atan"}

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A constant."""
        return f"const {name} = {place}"

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A script that raises an error where a value is not the reference's."""
        lines = [f'include("{exported.name}.jl")', "", *_CHECK]
        for each in reference:
            given = [
                repr(v[0]) if s == "t" else f"Float64[{', '.join(map(repr, v))}]" for s, v in each.arguments.items()
            ]
            lines += ["", f"y = {each.called}({', '.join(given)})"]
            for check in each.checks:
                y = f"y[{check.output + 1}]" if len(each.shapes) > 1 else "y"
                index = ", ".join(str(i + 1) for i in check.index)
                found = f"sum({y})" if check.is_sum else f"{y}[{index}]" if index else y
                lines.append(f'check({found}, {check.value!r}, {check.limit!r}, "{each.called}")')
        return {f"{exported.name}_selftest.jl": "\n".join([*lines, "", 'println("ok")', ""])}

    def define(self, listing: Listing) -> list[str]:
        """A function with its checks."""
        body, arguments = [], []
        for vector in self.vectors():
            v = vector.symbol
            values = ", ".join("NaN" if isnan(x) else repr(x) for x in vector.defaults)
            arguments.append(f"p = Float64[{values}]" if v == "p" else v)
            message = f'"{v} has $(length({v})) elements, {len(vector)} are needed"'
            if v != "t":
                body.append(f"length({v}) == {len(vector)} || throw(DimensionMismatch({message}))")
        body += [f"{name} = {element}" for name, element in self.named(self.texts(listing))]
        body += [f"t{n} = {text}" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            v = self.variables[output]
            if array.shape:
                body.append(f"{v} = zeros({', '.join(map(str, array.shape))})")
            pairs = self.pairs(output, listing) or ([] if array.shape else [(v, "0.0")])
            body += [f"{element} = {text}" for element, text in pairs]
        results = list(self.variables.values())
        body.append(f"return {results[0]}" if len(results) == 1 else f"return (; {', '.join(results)})")
        return [f"function {self.called}({', '.join(arguments)})", *indented(body), "end"]
