"""Maple: ``name_metric(q, p)`` of lists or vectors; results are nested lists."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from substructures.export.languages.algebra import Algebra
from substructures.export.languages.code import indented
from substructures.printers.language import Listing, Piece


class Maple(Algebra):
    """A file for ``read``."""

    media = "text/x-maple; charset=utf-8"
    suffix = ".mpl"
    functions: ClassVar[Mapping[str, str]] = {
        "asin": "arcsin",
        "acos": "arccos",
        "atan": "arctan",
        "atan2": "arctan",
        "log": "ln",
        "sign": "signum",
    }

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A variable."""
        return f"{name} := {place}:"

    def pi(self) -> Piece:
        """The constant pi."""
        return Piece("Pi")

    def define(self, listing: Listing) -> list[str]:
        """A procedure with its checks."""
        body = [f"local {', '.join(f't{n}' for n, _ in listing.temporaries)};"] if listing.temporaries else []
        for v in self.vectors():
            if v.symbol != "t":
                message = f'"{self.called}: {v.symbol} needs {len(v)} elements"'
                body.append(f"if numelems({v.symbol}) <> {len(v)} then error {message} end if;")
        body += [f"t{n} := {text};" for n, text in listing.temporaries]
        body.append(f"{self.result(listing)};")
        return [f"{self.called} := proc({', '.join(self.function.arguments)})", *indented(body), "end proc:"]
