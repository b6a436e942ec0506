"""Julia: ``model(x)`` returns a named tuple of arrays. Roots and logarithms of negative numbers raise DomainError."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from substructures.printers.language import Language, Piece
from substructures.printers.matlab import Matlab


class Julia(Matlab):
    """A function of a vector; needs no packages."""

    media = "text/x-julia; charset=utf-8"
    mark = "#"
    opening, closing = "[", "]"
    functions: ClassVar[Mapping[str, str]] = {"atan2": "atan"}

    def head(self, name: str) -> list[str]:
        """The signature, below what describes the arguments."""
        return [*self.comments(name), f"function {self.function_name(name)}(x)"]

    def tail(self) -> list[str]:
        """The named tuple of all arrays."""
        results = ", ".join(f"{v} = {v}" for v in self.variables.values())
        return [f"    return (; {results})", "end"]

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A function."""
        return Language.call(self, op, args)

    def dimensions(self, shape: tuple[int, ...]) -> str:
        """Arguments of zeros(); a vector has one axis."""
        return ", ".join(map(str, shape))
