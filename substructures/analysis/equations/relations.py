"""Exact elimination in sparse rows of formulas, each with its value in a prime field that decides what is zero."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from substructures.expr.graph import Expr


@dataclass(frozen=True)
class Entry:
    """A formula with its value in the field."""

    formula: Expr
    value: int


class Relations:
    """Relations sum_j row_j F_j = 0, each solved for a column of its own (Gauss and Jordan).

    They are solved for columns of ``auxiliary`` where they have any, else for columns of ``wanted``.
    """

    def __init__(self, prime: int, wanted: Collection[int], auxiliary: Collection[int]) -> None:
        self.prime, self.wanted, self.auxiliary = prime, frozenset(wanted), frozenset(auxiliary)
        self.rows: dict[int, dict[int, Entry]] = {}

    def add(self, entries: Mapping[int, Entry]) -> None:
        """Solve one more for a column, where it is independent of those before."""
        row = {j: x for j, x in entries.items() if x.value}
        for j in [j for j in row if j in self.rows]:
            row = self._minus(row, j, self.rows[j])
        open_columns = [j for j in row if j in self.auxiliary] or [j for j in row if j in self.wanted]
        if not open_columns:
            if row:
                raise ArithmeticError("a relation between columns that are independent in the field")
            return
        # numbers first, then formulas that were made early
        pivot = min(open_columns, key=lambda j: (not row[j].formula.is_number, row[j].formula.index, j))
        divisor, inverse = row[pivot].formula, pow(row[pivot].value, -1, self.prime)
        row = {j: Entry(x.formula / divisor, x.value * inverse % self.prime) for j, x in row.items()}
        for other in [k for k, known in self.rows.items() if pivot in known]:
            self.rows[other] = self._minus(self.rows[other], pivot, row)
        self.rows[pivot] = row

    def _minus(self, row: dict[int, Entry], j: int, other: Mapping[int, Entry]) -> dict[int, Entry]:
        """row - row_j other, whose pivot j is one; what is zero in the field is zero."""
        factor, result = row[j], {i: x for i, x in row.items() if i != j}
        for i, y in other.items():
            if i == j:
                continue
            x = result.pop(i, None)
            value = ((x.value if x else 0) - factor.value * y.value) % self.prime
            if value:
                product = factor.formula * y.formula
                result[i] = Entry(x.formula - product if x else -product, value)
        return result
