"""The metric of a tree as g = L^T D L, from the leaves to the base, over any scalar.

Eliminated in this order the zeros between branches stay zeros, so that nothing is done for pairs of coordinates that
are not on one path from the base (R. Featherstone, Rigid Body Dynamics Algorithms, 2008, section 6.5).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, Self, TypeVar


class Divisible(Protocol):
    """A scalar of one kind (:class:`~substructures.mechanics.linear3.Scalar`) by which 1 can be divided."""

    def __sub__(self, other: Self, /) -> Self:
        """self - other."""

    def __rsub__(self, other: int, /) -> Self:
        """0 - self."""

    def __mul__(self, other: Self, /) -> Self:
        """self other."""

    def __rtruediv__(self, other: int, /) -> Self:
        """1 / self."""


D = TypeVar("D", bound=Divisible)


@dataclass(frozen=True)
class Factors(Generic[D]):
    """``pivots`` D_k; ``below[k]``: L_ki by i < k, zero where there is no entry; L_kk = 1."""

    pivots: tuple[D, ...]
    inverse: tuple[D, ...]
    below: tuple[Mapping[int, D], ...]

    def solve(self, f: Sequence[D]) -> list[D]:
        """x with g x = f."""
        x = list(f)
        # L^T y = f from the leaves to the base, D z = y, L x = z back
        for k in reversed(range(len(x))):
            for i, l_ki in self.below[k].items():
                x[i] = x[i] - l_ki * x[k]
        for k, row in enumerate(self.below):
            x[k] = x[k] * self.inverse[k]
            for i, l_ki in row.items():
                x[k] = x[k] - l_ki * x[i]
        return x


def factorised(n: int, metric: Mapping[tuple[int, ...], D]) -> Factors[D]:
    """L and D of a symmetric matrix from its entries (i, k), i <= k; absent ones are zero.

    No rows are exchanged: the pivots of a positive definite matrix are positive. Raises ZeroDivisionError where a pivot
    is known to be zero.
    """
    rows: list[dict[int, D]] = [{} for _ in range(n)]
    for (i, k), x in metric.items():
        rows[max(i, k)][min(i, k)] = x
    pivots: dict[int, D] = {}
    inverse: dict[int, D] = {}
    for k in reversed(range(n)):
        row = rows[k]
        if k not in row:
            raise ZeroDivisionError(f"pivot {k} is zero")
        pivots[k] = row.pop(k)
        inverse[k] = 1 / pivots[k]
        # L_ki = g_ki / D_k,  then g_ij -= L_ki D_k L_kj = L_ki g_kj
        rows[k] = {i: g_ki * inverse[k] for i, g_ki in row.items()}
        for i, l_ki in rows[k].items():
            rows[i] |= {j: rows[i].get(j, 0) - l_ki * g_kj for j, g_kj in row.items() if j <= i}
    return Factors(tuple(pivots[k] for k in range(n)), tuple(inverse[k] for k in range(n)), tuple(rows))


def factor_operations(n: int, index: Iterable[tuple[int, ...]]) -> int:
    """About how many operations :func:`factorised` and one solution need for entries at these places."""
    sizes = [0] * n
    for i, k in index:
        sizes[max(i, k)] += i != k
    return sum(size * (size + 7) for size in sizes)
