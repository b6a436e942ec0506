"""MATLAB (and Octave): ``metric = name_metric(q, p)``; ``p`` has its defaults, wrong lengths are errors.

Roots and logarithms of negative numbers, and arcs of numbers beyond 1, are NaN as everywhere, not complex.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import isnan

from substructures.export.exported import Exported
from substructures.export.interface import Vector
from substructures.export.languages.code import REAL, Code, head, indented
from substructures.export.languages.named import STRUCTURES, Named, members
from substructures.export.reference import Reference
from substructures.expr.program import Output
from substructures.printers.language import Listing, Piece

_CHECK = (
    "    disp('ok');",
    "end",
    "",
    "function check(found, expected, limit, what)",
    "    if ~(abs(found - expected) <= limit)",
    "        error('selftest:wrong', '%s: %.17g for %.17g', what, found, expected);",
    "    end",
    "end",
    "",
)


_LISTED = (
    "break case catch classdef continue else elseif end for function global if otherwise parfor persistent return spmd",
    "switch try while do until endif endfor endwhile endfunction endswitch unwind_protect end_try_catch",
)
_WORDS = frozenset(word for line in _LISTED for word in line.split())


class Matlab(Code):
    """Function files. Vectors are columns; any vector with the right number of elements is taken."""

    media = "text/x-matlab; charset=utf-8"
    mark = "%"
    suffix = ".m"
    infinity = "Inf"
    first = 1
    brackets = ("(", ")")
    executed = "Octave"
    has_names = True

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function; by its real branch where the argument is no constant."""
        return self.real_call(op, args)

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A function file: its help is the head."""
        first, *others = functions
        lines = [first[0], *cls.commented(head(exported, cls.first, software, cls.executed)), *first[1:]]
        for each in others:
            lines += ["", *each]
        return "\n".join(lines) + "\n"

    def define(self, listing: Listing) -> list[str]:
        """A function with its checks, and what it calls."""
        results = ", ".join(self.variables.values())
        body = self._checks()
        body += [f"{name} = {element};" for name, element in self.named(self.texts(listing))]
        body += [f"t{n} = {text};" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            body += self._fill(self.variables[output], array, listing, output)
        signature = f"function [{results}] = {self.called}({', '.join(self.function.arguments)})"
        return [signature, *indented(body), "end", *self._real_branches()]

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A function that raises an error where a value is not the reference's."""
        lines = [f"function {exported.name}_selftest()"]
        for each in reference:
            given = [
                repr(values[0]) if s == "t" else f"[{'; '.join(map(repr, values))}]"
                for s, values in each.arguments.items()
            ]
            results = [f"y{k}" for k in range(len(each.shapes))]
            lines.append(f"    [{', '.join(results)}] = {each.called}({', '.join(given)});")
            for check in each.checks:
                y, index = f"y{check.output}", ", ".join(str(i + 1) for i in check.index)
                found = f"sum({y}(:))" if check.is_sum else f"{y}({index})" if index else y
                lines.append(f"    check({found}, {check.value!r}, {check.limit!r}, '{each.called}');")
        return {f"{exported.name}_selftest.m": "\n".join([*lines, *_CHECK])}

    def _checks(self) -> list[str]:
        """The defaults of p, which is the last argument, and the lengths of all."""
        lines, count = [], len(self.function.arguments)
        for vector in self.vectors():
            v = vector.symbol
            if v == "p":
                values = "; ".join("NaN" if isnan(x) else repr(x) for x in vector.defaults)
                lines += [f"if nargin < {count}", f"    p = [{values}];", "end"]
            lines += [
                f"if numel({v}) ~= {len(vector)}",
                f"    error('{self.called}:length', '{v} has %d elements, {len(vector)} are needed', numel({v}));",
                "end",
            ]
        return lines

    def _real_branches(self) -> list[str]:
        """The functions that are NaN where MATLAB's own are complex."""
        lines = []
        for f in self.partial():
            # 0/true is 0 and 0/false is NaN
            lines += ["", f"function y = real_{f}(x)", f"    y = {f}(x + 0/({REAL[f]}));", "end"]
        return lines

    def _fill(self, v: str, array: Output, listing: Listing, output: str) -> list[str]:
        if not array.shape:
            texts = listing.entries[output]
            return [f"{v} = {texts[0] if texts else '0.0'};"]
        dimensions = ", ".join(map(str, (*array.shape, *(1,) * (2 - len(array.shape)))))
        lines = [f"{v} = zeros({dimensions});"]
        return lines + [f"{element} = {text};" for element, text in self.pairs(output, listing)]


def structures(exported: Exported) -> dict[str, str]:
    """Functions that make structures of coordinates, inputs and parameters, and columns of these."""
    found = {}
    for symbol, called in STRUCTURES.items():
        name = f"{exported.name}_{called.lower()}"
        named = fields(exported.interface.vectors[symbol])
        values = ("NaN" if isnan(each.value) else repr(each.value) for each in named)
        lines = [
            f"function y = {name}(s)",
            f"% {name}() is a structure of the {called.lower()}; {name}(s) is the column of a structure.",
            "if nargin == 0",
            "    y = struct();",
            *(line for each, value in zip(named, values, strict=True) for line in _member(each, value)),
            "else",
            f"    unknown = setdiff(fieldnames(s), fieldnames({name}()));",
            "    if ~isempty(unknown)",
            f"        error('{name}:name', '%s is none of the {called.lower()}', unknown{{1}});",
            "    end",
            f"    y = zeros({len(named)}, 1);",
            *(f"    y({each.place + 1}) = s.{each.name};" for each in named),
            "end",
            "end",
            "",
        ]
        found[f"{name}.m"] = "\n".join(lines)
    return found


def _member(each: Named, value: str) -> list[str]:
    return [f"    % {each.told}", f"    y.{each.name} = {value};"]


def fields(vector: Vector) -> list[Named]:
    """Of the structure of a vector."""
    return members(vector, _WORDS.__contains__, Matlab.first)
