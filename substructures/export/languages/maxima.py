"""Maxima: ``name_metric(q, p)``, matrices as ``matrix``, other arrays as nested lists."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from substructures.export.exported import Exported
from substructures.export.languages.algebra import Algebra
from substructures.export.languages.code import head, indented, nested
from substructures.expr.operations import Output
from substructures.printers.language import Listing, Piece


class Maxima(Algebra):
    """A file for ``load`` or ``batch``."""

    media = "text/x-maxima; charset=utf-8"
    suffix = ".mac"
    executed = "Maxima"
    functions: ClassVar[Mapping[str, str]] = {"sign": "signum"}

    def pi(self) -> Piece:
        """The constant pi."""
        return Piece("%pi")

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A variable."""
        return f"{name}: {place}$"

    @classmethod
    def commented(cls, lines: Iterable[str]) -> list[str]:
        """Lines as comments."""
        return [f"/* {line} */" for line in lines]

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A batch file, with the defaults of the parameters as ``name_p``."""
        lines = cls.commented(head(exported, cls.first, software, cls.executed))
        values = ", ".join("und" if x != x else repr(x) for x in exported.interface.vectors["p"].defaults)
        lines += [f"{exported.name}_p: [{values}]$", *cls.constants(exported), ""]
        return "\n".join([*lines, *(line for each in functions for line in (*each, ""))])

    def value(self, array: Output, texts: tuple[str, ...]) -> str:
        """A matrix, or nested lists."""
        plain = nested(array, texts, self.ends, "0")
        return f"matrix({plain[1:-1]})" if len(array.shape) == 2 and all(array.shape) else plain

    def define(self, listing: Listing) -> list[str]:
        """A function with its checks."""
        locals_ = ", ".join(f"t{n}" for n, _ in listing.temporaries)
        body = [f"[{locals_}],"]
        for v in self.vectors():
            if v.symbol != "t":
                message = f'error("{self.called}: {v.symbol} needs {len(v)} elements")'
                body.append(f"if length({v.symbol}) # {len(v)} then {message},")
        body += [f"t{n}: {text}," for n, text in listing.temporaries]
        body.append(self.result(listing))
        return [f"{self.called}({', '.join(self.function.arguments)}) := block(", *indented(body), ")$"]
