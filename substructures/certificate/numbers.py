"""Numbers and expressions of documents at one state, as balls that contain their exact values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from decimal import Decimal
from typing import Any

from flint import arb, ctx, fmpq

from substructures.certificate.linear import Ball, Matrix, vector
from substructures.expr.direct import ball, steps_of
from substructures.expr.steps import needed_first

#: a document as plain data
Plain = Mapping[str, Any]
#: most numbers of a document
_ZERO = arb(0)


class Numbers:
    """What the numbers of a document are; ``names``: the values of the names in its expressions."""

    def __init__(self, names: Mapping[str, Ball]) -> None:
        self.names = names

    def read(self, given: Any) -> Ball:
        """A number or an expression."""
        if isinstance(given, (int, Decimal)):
            return arb(fmpq(*given.as_integer_ratio())) if given else _ZERO
        # most texts are one name
        return self.names[given] if given in self.names else ball(given, self.names, ctx.prec)

    def vector(self, given: Sequence[Any]) -> Matrix:
        """Three of them."""
        return vector(*(self.read(x) for x in given))


class Bindings(Mapping[str, Ball]):
    """The names of a tree document: its parameters, and those of instances as ``instance.name``, bound or free.

    ``values``: of all names that are free; ``bound``: numbers, or expressions in other names, by name.
    """

    def __init__(self, values: Mapping[str, Ball], bound: Mapping[str, Any]) -> None:
        self.values_of, self.bound = dict(values), dict(bound)

    def __getitem__(self, name: str) -> Ball:
        # taken out of what is bound first, so that a circle ends as an unknown name
        for each in needed_first(name, self._bound_in) if name in self.bound else ():
            if each in self.bound:
                given = self.bound.pop(each)
                self.values_of[each] = Numbers(self).read(given)
        return self.values_of[name]

    def _bound_in(self, name: str) -> list[str]:
        names = (str(step.value) for step in steps_of(self.bound[name]) if step.op == "name")
        return [each for each in names if each in self.bound]

    def __iter__(self) -> Any:
        return iter({**self.bound, **self.values_of})

    def __len__(self) -> int:
        return len({**self.bound, **self.values_of})

    def __contains__(self, name: object) -> bool:
        return name in self.bound or name in self.values_of
