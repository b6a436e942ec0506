"""REDUCE: ``name!_metric(q, p)`` of lists; results are nested lists. The time is ``tt``: ``t`` is true there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import ClassVar

from substructures.export.exported import Exported
from substructures.export.languages.algebra import Algebra
from substructures.export.languages.code import head, indented
from substructures.printers.language import Listing


class Reduce(Algebra):
    """A file for ``in``."""

    media = "text/x-reduce; charset=utf-8"
    mark = "%"
    has_steps = False
    suffix = ".red"
    ends = ("{", "}")
    functions: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A variable."""
        return f"{name.replace('_', '!_')} := {place};"

    def element(self, vector: str, n: int) -> str:
        """An element of a list."""
        return "tt" if vector == "t" else f"part({vector}, {n + 1})"

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A file of procedures."""
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed)), "", *cls.constants(exported)]
        return "\n".join([*lines, *(line for each in functions for line in (*each, "")), "end;", ""])

    def define(self, listing: Listing) -> list[str]:
        """A procedure with its checks."""
        names = [v.replace("t", "tt") if v == "t" else v for v in self.function.arguments]
        body = [f"scalar {', '.join(f't{n}' for n, _ in listing.temporaries)};"] if listing.temporaries else []
        for v in self.vectors():
            if v.symbol != "t":
                message = f'rederr "{self.called}: {v.symbol} needs {len(v)} elements"'
                body.append(f"if length({v.symbol}) neq {len(v)} then {message};")
        body += [f"t{n} := {text};" for n, text in listing.temporaries]
        body.append(f"return {self.result(listing)}")
        called = self.called.replace("_", "!_")
        return [f"procedure {called}({', '.join(names)});", "begin", *indented(body), "end;"]
