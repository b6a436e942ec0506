"""Numbers and expressions of a document against the dimensions of their places; what is wrong, doubtful, converted."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from substructures.documents.fields import Quantity
from substructures.documents.units import Dimension, UnknownUnitError, read_unit, si_text
from substructures.errors import Fault, InvalidDocument
from substructures.expr.steps import ExpressionError, Step
from substructures.expr.syntax import read
from substructures.expr.units.dimensions import Dimensioned, DimensionError, Inference, Inferred

#: pointer, code, message
Notice = dict[str, str]
#: (pointer, number of a document, dimension of the place; None where there is none)
Place = tuple[str, Any, Dimension | None]


@dataclass
class UnitCheck:
    """Checks numbers of a document against their places; collects what is wrong, doubtful, or was converted.

    ``names``: dimensions of the names that expressions may use.
    """

    names: Callable[[str], Inferred]
    faults: list[Fault] = field(default_factory=list)
    warnings: list[Notice] = field(default_factory=list)
    converted: list[dict[str, Any]] = field(default_factory=list)

    def require(self) -> None:
        """Raises InvalidDocument for contradictions."""
        if self.faults:
            raise InvalidDocument(self.faults)

    def check(self, places: Iterable[Place], tells_doubts: bool) -> None:
        """Look at all numbers; ``tells_doubts``: also say where numbers in expressions would need a unit."""
        for pointer, value, expected in places:
            if isinstance(value, Quantity):
                self._quantity(pointer, value, expected)
            elif isinstance(value, str):
                self._expression(pointer, value, expected, tells_doubts)

    def _quantity(self, pointer: str, value: Quantity, expected: Dimension | None) -> None:
        unit = value.measure
        if isinstance(value.value, str) and any(step.op == "name" for step in steps_of(value.value)):
            message = f"'{value.value[:80]}': what has a unit is constant: names in it have units of their own"
            self.faults.append(Fault(pointer, "unit-of-expression", message))
        elif expected is not None and unit.dimension != expected:
            message = f"{si_text(expected)} expected, found {value}"
            self.faults.append(Fault(pointer, "unit-mismatch", message))
        elif not unit.is_si:
            self.converted.append({"pointer": pointer, **value.model_dump(), "si": value.si, "si_unit": unit.si})

    def _expression(self, pointer: str, text: str, expected: Dimension | None, tells_doubts: bool) -> None:
        inference = Inference(self.names)
        try:
            found = inference.of(steps_of(text))
            if expected is not None:
                inference.require(found, expected)
        except DimensionError as error:
            self.faults.append(Fault(pointer, "unit-mismatch", f"'{text[:80]}': {error}"))
            return
        for doubt in inference.doubts if tells_doubts else ():
            message = f"'{text[:80]}': {doubt}, unless numbers in it have units"
            self.warnings.append({"pointer": pointer, "code": "unit-doubtful", "message": message})


@lru_cache(maxsize=10_000)
def steps_of(text: str) -> tuple[Step, ...]:
    """The steps of an expression; of one that cannot be read a number, since the fault is told elsewhere."""
    try:
        return read(text)
    except ExpressionError:
        return read("0")


def dimension_of(unit: str) -> Inferred:
    """What is known of a quantity by its unit: nothing where it has none, or one of old that is not known."""
    try:
        return Dimensioned(read_unit(unit).dimension) if unit else "unknown"
    except UnknownUnitError:
        return "unknown"
