"""A Python module that needs NumPy only: ``name_metric(q, p)``, vectorised over leading axes."""

from __future__ import annotations

import keyword
from collections.abc import Iterable
from math import isnan

from substructures.export.exported import Exported
from substructures.export.interface import MEANINGS, Vector
from substructures.export.languages.code import Code, head, indented
from substructures.export.languages.named import STRUCTURES, Named, members
from substructures.export.reference import Reference
from substructures.printers.language import Listing, Piece

_READ = """
def _columns(name, value, length):
    value = np.asarray(value, dtype=float)
    if not value.ndim or value.shape[-1] != length:
        raise ValueError(f"{name} has the shape {value.shape}, (..., {length}) is needed")
    return np.moveaxis(value, -1, 0)
"""

CHECK = (
    "",
    "",
    "def differs(found, expected, limit, what):",
    "    if abs(found - expected) <= limit:",
    "        return False",
    '    print(what, found, "for", expected)',
    "    return True",
    "",
)


class Python(Code):
    """Python; arguments may have leading axes, which outputs have in front."""

    media = "text/x-python; charset=utf-8"
    suffix = ".py"
    infinity = "np.inf"
    power_sign = "**"
    executed = "CPython and NumPy"
    has_names = True
    #: what a module is told to import, what it says beside, its function that reads arguments, and what is no number
    imported, reader, nan = "import numpy as np", _READ, "np.nan"
    notes: tuple[str, ...] = ()

    def pi(self) -> Piece:
        """The constant of numpy."""
        return Piece("np.pi")

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function of numpy, some of which have longer names there."""
        names = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2"}
        return Piece(f"np.{names.get(op, op)}({', '.join(a.text for a in args)})")

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A module; ``P`` are the defaults of the parameters."""
        lines = ['"""', *head(exported, cls.first, software, cls.executed), *cls.notes, '"""', ""]
        lines += ["from typing import NamedTuple", "", cls.imported, ""]
        for symbol in exported.symbols:
            vector = exported.interface.vectors[symbol]
            if symbol != "t":
                lines += [f"{symbol.upper()}_NAMES = (", *(f"    {name!a}," for name in vector.names), ")"]
        for symbol, called in STRUCTURES.items():
            lines += cls._structure(called, exported.interface.vectors[symbol])
        lines += ["", "", "P = Parameters()", "", *cls.reader.split("\n")]
        for each in functions:
            lines += ["", *each, ""]
        return "\n".join(lines)

    @classmethod
    def _structure(cls, called: str, vector: Vector) -> list[str]:
        """A tuple with a name for every element, which is an argument as it is."""
        body = [
            f"{each.name}: float = {cls.nan if isnan(each.value) else repr(each.value)}  # {each.told}"
            for each in fields(vector)
        ]
        return [
            "",
            "",
            f"class {called}(NamedTuple):",
            *indented([f'"""{MEANINGS[vector.symbol].capitalize()}."""', *body]),
        ]

    def define(self, listing: Listing) -> list[str]:
        """A function; one output is an array, several are a dictionary."""
        arguments = ["p=P" if symbol == "p" else symbol for symbol in self.function.arguments]
        body = []
        for vector in self.vectors():
            v = vector.symbol
            body.append("t = np.asarray(t, dtype=float)" if v == "t" else f"{v} = _columns({v!r}, {v}, {len(vector)})")
        shapes = ", ".join("t.shape" if v == "t" else f"{v}.shape[1:]" for v in self.function.arguments)
        body.append(f"batch = np.broadcast_shapes({shapes})")
        body += [f"{name} = {element}" for name, element in self.named(self.texts(listing))]
        inner = [f"t{n} = {text}" for n, text in listing.temporaries]
        for output in self.program.outputs:
            inner += self._fill(output, listing)
        body += ['with np.errstate(all="ignore"):', *indented(inner or ["pass"])]
        return [f"def {self.called}({', '.join(arguments)}):", *indented([*body, self.returned()])]

    def returned(self) -> str:
        """The statement that gives one array, or a dictionary of several."""
        variables = list(self.variables.items())
        pairs = ", ".join(f"{n!a}: {v}" for n, v in variables)
        return f"return {variables[0][1]}" if len(variables) == 1 else f"return {{{pairs}}}"

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:
        """A script that exits with 1 where a value is not the reference's."""
        lines = ["import sys", "", "import numpy as np", "", f"import {exported.name}", "", "wrong = False", *CHECK]
        for each in reference:
            given = [repr(values[0] if s == "t" else list(values)) for s, values in each.arguments.items()]
            lines += ["", f"y = {exported.name}.{each.called}({', '.join(given)})"]
            names = list(exported.functions[each.number].program.outputs)
            for check in each.checks:
                y = f"y[{names[check.output]!a}]" if len(names) > 1 else "y"
                found = f"np.sum({y})" if check.is_sum else f"{y}[{check.index!r}]"
                lines.append(f"wrong |= differs({found}, {check.value!r}, {check.limit!r}, {each.called!r})")
        return {f"{exported.name}_selftest.py": "\n".join([*lines, "", 'sys.exit(1 if wrong else print("ok"))', ""])}

    def _fill(self, output: str, listing: Listing) -> list[str]:
        array, v = self.program.outputs[output], self.variables[output]
        lines = [f"{v} = np.zeros(batch + {array.shape!r})"]
        return lines + [f"{element} = {text}" for element, text in self.pairs(output, listing)]

    def place(self, variable: str, array: object, index: tuple[int, ...]) -> str:  # noqa: ARG002 - of the interface
        """An element, behind the axes of the batch."""
        return f"{variable}[{', '.join(['...', *map(str, index)])}]"


def fields(vector: Vector) -> list[Named]:
    """Of the structure of a vector."""
    return members(vector, keyword.iskeyword, 0)
