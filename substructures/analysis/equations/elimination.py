"""The metric as L^T D L in formulas, with a message about the coordinate that has no inertia.

It is the factorisation of :mod:`substructures.mechanics.factorisation`, and takes the same operations in another order.
The order is part of the digests of the programs built on it (accelerations, state space, Routh's equations), as the
order there is of those of forward dynamics; so neither can take the other's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.errors import InvalidDocument
from substructures.expr.graph import Expr


class MetricElimination:
    """g = L^T D L with unit lower triangular L, eliminated from the leaves: no entry outside the paths fills in.

    R. Featherstone, Efficient factorization of the joint-space inertia matrix for branched kinematic trees, 2005.
    """

    def __init__(self, metric: Mapping[tuple[int, ...], Expr], names: Sequence[str]) -> None:
        n = len(names)
        rows: list[dict[int, Expr]] = [{} for _ in range(n)]
        for (a, b), x in metric.items():
            if b <= a:
                rows[a][b] = x
        self.L: list[dict[int, Expr]] = [{} for _ in range(n)]
        self.D: list[Expr] = []
        self.inverse: list[Expr] = []
        for k in reversed(range(n)):
            row = rows[k]
            pivot = row.pop(k, None)
            if pivot is None or pivot.is_zero:
                message = f"coordinate '{names[k]}' has no inertia: give the bodies that it moves mass or inertia"
                raise InvalidDocument.at("", "singular-metric", message)
            self._eliminate(k, row, pivot, rows)  # g_ij - L_ki g_kj for i, j on the path from k to the base

    def _eliminate(self, k: int, row: dict[int, Expr], pivot: Expr, rows: list[dict[int, Expr]]) -> None:
        inverse = 1 / pivot
        self.D.insert(0, pivot)
        self.inverse.insert(0, inverse)
        for i in sorted(row, reverse=True):
            factor = self.L[k][i] = row[i] * inverse
            for j in sorted(x for x in row if x <= i):
                known = rows[i].get(j)
                product = factor * row[j]
                rows[i][j] = -product if known is None else known - product

    def solve(self, right: Sequence[Expr]) -> list[Expr]:
        """x of g x = right."""
        x = list(right)
        for k in reversed(range(len(x))):
            for i, factor in self.L[k].items():
                x[i] = x[i] - factor * x[k]
        x = [a * b for a, b in zip(x, self.inverse, strict=True)]
        for k, row in enumerate(self.L):
            for i, factor in sorted(row.items()):
                x[k] = x[k] - factor * x[i]
        return x
