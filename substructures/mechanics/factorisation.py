"""The metric of a tree as g = L^T D L, from the leaves to the base, over any scalar.

Eliminated in this order the zeros between branches stay zeros, so that nothing is done for pairs of coordinates that
are not on one path from the base (R. Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from substructures.mechanics.linear3 import S


@dataclass(frozen=True)
class Factors:
    """``pivots`` D_k; ``below[k]``: L_ki by i < k, zero where there is no entry; L_kk = 1."""

    pivots: tuple[S, ...]
    inverse: tuple[S, ...]
    below: tuple[Mapping[int, S], ...]

    def solve(self, f: Sequence[S]) -> list[S]:
        """x with g x = f."""
        x = list(f)
        for k in reversed(range(len(x))):
            for i, l_ki in self.below[k].items():
                x[i] = x[i] - l_ki * x[k]
        for k, row in enumerate(self.below):
            x[k] = x[k] * self.inverse[k]
            for i, l_ki in row.items():
                x[k] = x[k] - l_ki * x[i]
        return x


def factorised(n: int, metric: Mapping[tuple[int, ...], S]) -> Factors:
    """L and D of a symmetric matrix from its entries (i, k), i <= k; absent ones are zero.

    No rows are exchanged: the pivots of a positive definite matrix are positive. Raises ZeroDivisionError where a pivot
    is known to be zero.
    """
    rows: list[dict[int, S]] = [{} for _ in range(n)]
    for (i, k), x in metric.items():
        rows[max(i, k)][min(i, k)] = x
    pivots: list[S] = [0] * n
    inverse: list[S] = [0] * n
    for k in reversed(range(n)):
        row = rows[k]
        pivots[k] = row.pop(k, 0)
        inverse[k] = 1 / pivots[k]
        rows[k] = {i: g_ki * inverse[k] for i, g_ki in row.items()}
        for i, l_ki in rows[k].items():
            rows[i] |= {j: rows[i].get(j, 0) - l_ki * g_kj for j, g_kj in row.items() if j <= i}
    return Factors(tuple(pivots), tuple(inverse), tuple(rows))


def factor_operations(n: int, index: Iterable[tuple[int, ...]]) -> int:
    """About how many operations :func:`factorised` and one solution need for entries at these places."""
    sizes = [0] * n
    for i, k in index:
        sizes[max(i, k)] += i != k
    return sum(size * (size + 7) for size in sizes)
