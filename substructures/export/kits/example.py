"""What an example calls: one function, at the defaults of parameters and one coordinate that is not zero."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import prod

from substructures.export.exported import Exported, Function
from substructures.export.interface import PREPARE, WORK
from substructures.export.languages.c import C
from substructures.export.languages.named import described, elements
from substructures.export.reference import arguments

#: of the coordinate, in rad or m
VALUE = 0.5


@dataclass(frozen=True)
class Example:
    """The function that is called, of those that were exported."""

    exported: Exported

    @property
    def name(self) -> str:
        """Of what was exported."""
        return self.exported.name

    @property
    def function(self) -> Function:
        """The first one that has a quantity of mechanics, with elements if there is one."""
        some = [each for each in self.exported.functions if each.quantity != PREPARE]
        return next((each for each in some if _has_elements(each)), some[0])

    def shown(self, line: str) -> list[str]:
        """The line that prints the first element; none where nothing moves, and there is none."""
        return [line] if _has_elements(self.function) else []

    @property
    def called(self) -> str:
        """Its name."""
        return self.exported.called(self.function)

    @property
    def lengths(self) -> dict[str, int]:
        """Of its arguments that are vectors, those of ``prepare`` included."""
        symbols = [s for s in self.function.arguments if s != "t"]
        symbols += ["p"] if WORK in symbols and "p" not in symbols else []
        return {symbol: len(self.function.vector(symbol)) for symbol in symbols}

    @property
    def outputs(self) -> dict[str, tuple[int, ...]]:
        """Variables and shapes of its outputs."""
        variables = C(self.function, self.exported).variables
        return {variables[name]: output.shape for name, output in self.function.program.outputs.items()}

    @property
    def sizes(self) -> dict[str, int]:
        """Elements of its outputs."""
        return {name: prod(shape) for name, shape in self.outputs.items()}

    @property
    def coordinate(self) -> str:
        """What the first coordinate is; empty where the function has none."""
        q = self.function.vector("q") if "q" in self.function.arguments else ()
        return described(q, 0) if q else ""

    def values(self) -> dict[str, float]:
        """Numbers of all symbols."""
        found: dict[str, float] = {}
        for symbol, numbers in arguments(self.function).items():
            given = numbers if symbol == "p" else [0.0] * len(numbers)
            found |= dict(zip(self.function.vector(symbol).names, given, strict=True))
        if self.coordinate:
            found[self.function.vector("q").names[0]] = VALUE
        return found

    def place(self, written: str, alike: Callable[[str], str] = str, first: int = 0) -> str:
        """Of the coordinate by its constant, ``written`` with its name; by its number where it has none."""
        name = elements(self.function.vector("q"), alike)[0].name
        return written.format(name) if name else str(first)


def _has_elements(function: Function) -> bool:
    return prod(next(iter(function.program.outputs.values())).shape) > 0
