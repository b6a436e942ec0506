"""What the steps of a textbook form cost: counted, never timed, so that the same formula has the same form everywhere.

A unit is a product of two terms of rational functions that are cancelled, some microseconds.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from substructures.errors import TooLarge

#: steps in harmonics, and terms that are looked at, for one unit
STEPS = 4
#: products of terms of one product
MOST = 300_000


Found = TypeVar("Found")


class Work:
    """Units that are left of a limit, and what was found with those that are gone. Raises TooLarge (size, limit) before
    what is larger is done.
    """

    def __init__(self, limit: int) -> None:
        self.limit, self.spent = limit, 0
        self._known: dict[Any, Any] = {}

    def once(self, key: tuple[Any, ...], find: Callable[[], Found]) -> Found:
        """What was found before for the key, or else now."""
        if key not in self._known:
            self._known[key] = find()
        found: Found = self._known[key]
        return found

    def spend(self, products: int) -> None:
        """Before so many products of terms are formed."""
        if products > min(MOST, self.limit):
            raise TooLarge("a product in the textbook form (products of terms)", products, min(MOST, self.limit))
        if self.spent + products > self.limit:
            together = "all steps of a textbook form together (products of terms)"
            raise TooLarge(together, self.spent + products, self.limit)
        self.spent += products

    def steps(self, count: int) -> None:
        """Before so many small steps."""
        self.spend(count // STEPS + 1)

    def factor(self, poly: Any) -> tuple[Any, list[tuple[Any, int]]]:
        """A number and the irreducible factors of a polynomial with their powers."""
        self.spend(hardness(poly))
        number, parts = poly.factor()
        return number, [(part, int(n)) for part, n in parts]


def hardness(poly: Any) -> int:
    """About what a factorisation costs: terms, times what one more variable and a higher degree make of them."""
    degrees = [max(int(n), 0) for n in poly.degrees()]
    used = [n for n in degrees if n]
    return len(poly) * (1 + sum(used)) if used else 1
