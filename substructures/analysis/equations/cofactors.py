"""The inverse of a small matrix of formulas by cofactors: no pivots that could vanish, one common divisor."""

from __future__ import annotations

from collections.abc import Sequence

from substructures.errors import TooLarge
from substructures.expr.graph import Expr

MatrixRows = list[list[Expr]]
#: products of minors that are formed at most
MAX_MINORS = 200_000


def inverse(rows: Sequence[Sequence[Expr]]) -> MatrixRows | None:
    """Y^-1 = adj(Y) / det(Y) (n, n); None when the determinant is zero as a formula. Raises TooLarge.

    Minors are expanded row by row over sets of columns; zeros are skipped, so sparse matrices cost little.
    """
    n = len(rows)
    if not n:
        return []
    graph = rows[0][0].graph
    budget = [MAX_MINORS]
    cofactors = [_row_cofactors(rows, j, budget) for j in range(n)]
    # det Y = sum_i Y_0i C_0i, and (Y^-1)_ij = C_ji / det Y
    determinant = graph.sum(rows[0][i] * cofactors[0][i] for i in range(n))
    if determinant.is_zero:
        return None
    return [[cofactors[j][i] / determinant for j in range(n)] for i in range(n)]


def determinant(rows: Sequence[Sequence[Expr]]) -> Expr:
    """det(Y) of at least one row. Raises TooLarge."""
    graph, budget = rows[0][0].graph, [MAX_MINORS]
    minors: dict[int, Expr] = {0: graph.one}
    for row in rows:
        minors = _extended(minors, row, budget)
    return minors.get((1 << len(rows)) - 1, graph.zero)


def _row_cofactors(rows: Sequence[Sequence[Expr]], left_out: int, budget: list[int]) -> list[Expr]:
    """Cofactors of the elements of one row: minors of all other rows."""
    n = len(rows)
    graph = rows[0][0].graph
    minors: dict[int, Expr] = {0: graph.one}
    for k in range(n):
        if k != left_out:
            minors = _extended(minors, rows[k], budget)
    # C_ji = (-1)^(j+i) M_ji; a set of columns is a word with a bit for each of them
    full = (1 << n) - 1
    result = []
    for i in range(n):
        minor = minors.get(full & ~(1 << i), graph.zero)
        result.append(-minor if (left_out + i) % 2 else minor)
    return result


def _extended(minors: dict[int, Expr], row: Sequence[Expr], budget: list[int]) -> dict[int, Expr]:
    """Minors with one more row, by the set of their columns: expansion along the new last row."""
    result: dict[int, Expr] = {}
    for columns, minor in minors.items():
        for i, x in enumerate(row):
            if x.is_zero or columns >> i & 1:
                continue
            budget[0] -= 1
            if budget[0] < 0:
                raise TooLarge("the inverse of the quasi-velocities (in minors)", MAX_MINORS + 1, MAX_MINORS)
            # (-1)^(columns of the minor to the right of column i) gives the sign
            term = x * minor
            if bin(columns >> (i + 1)).count("1") % 2:
                term = -term
            key = columns | 1 << i
            result[key] = result[key] + term if key in result else term
    return {key: minor for key, minor in result.items() if not minor.is_zero}
