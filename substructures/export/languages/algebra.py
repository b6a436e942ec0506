"""Computer algebra: functions of lists, exact numbers, any scalars as arguments, results as nested lists."""

from __future__ import annotations

from abc import abstractmethod
from fractions import Fraction

from substructures.export.languages.code import Code, nested
from substructures.expr.operations import Output
from substructures.printers.language import NEGATION, PRODUCT, Listing, Piece


class Algebra(Code):
    """``ends`` of lists."""

    powers = True
    first = 1
    ends = ("[", "]")

    def number(self, value: Fraction) -> Piece:
        """An exact number."""
        if value < 0:
            return Piece("-" + self.number(-value).text, NEGATION)
        if value.denominator == 1:
            return Piece(str(value.numerator))
        return Piece(f"{value.numerator}/{value.denominator}", PRODUCT)

    def values(self, listing: Listing) -> list[str]:
        """All outputs as nested lists."""
        return [self.value(o, listing.entries[n]) for n, o in self.program.outputs.items()]

    def value(self, array: Output, texts: tuple[str, ...]) -> str:
        """An output as nested lists."""
        return nested(array, texts, self.ends, "0")

    def result(self, listing: Listing) -> str:
        """The value of the function: of several outputs the list of them."""
        found = self.values(listing)
        return found[0] if len(found) == 1 else f"{self.ends[0]}{', '.join(found)}{self.ends[1]}"

    @classmethod
    def alike(cls, name: str) -> str:
        """Names in camel case have neither capitals of their own nor _."""
        return name.lower().replace("_", "")

    @abstractmethod
    def define(self, listing: Listing) -> list[str]:
        """The lines of the function."""


def camel(name: str) -> str:
    """``demo_forward_dynamics`` as ``demoForwardDynamics``: where _ is no letter."""
    first, *others = name.split("_")
    return first + "".join(each[:1].upper() + each[1:] for each in others)
