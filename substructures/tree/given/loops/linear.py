"""Linear equations of few unknowns in formulas, without a choice of pivots that would hold at some positions alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from substructures.expr.graph import Expr
from substructures.mechanics.factorisation import factorised
from substructures.tree.given.loops.dependent import NotReduced

#: most unknowns by Cramer's rule
CRAMER = 3
Solve = Callable[[Sequence[Expr]], list[Expr]]


def solver(A: Sequence[Sequence[Expr]], again: bool = True) -> Solve:
    """x of A x = b, by least squares (A^T A)^-1 A^T b where there are more rows or more than CRAMER columns; ``again``:
    once more for what is left of b then. Raises NotReduced for a matrix that is always singular.
    """
    if len(A) == len(A[0]) <= CRAMER:
        back = inverse(A)
        return lambda b: [_product(row, b) for row in back]
    columns = list(zip(*A, strict=True))
    square: dict[tuple[int, ...], Expr] = {
        (i, k): _product(a, c) for i, a in enumerate(columns) for k, c in enumerate(columns) if i <= k
    }
    try:
        factors = factorised(len(columns), square)
    except ZeroDivisionError:
        raise NotReduced("it does not tell the coordinates that are unknown") from None

    def once(b: Sequence[Expr]) -> list[Expr]:
        """The solution by the factors."""
        return factors.solve([_product(a, b) for a in columns])

    def refined(b: Sequence[Expr]) -> list[Expr]:
        """With one step of iterative refinement."""
        x = once(b)
        rest = [y - _product(row, x) for row, y in zip(A, b, strict=True)]
        return [v + more for v, more in zip(x, once(rest), strict=True)]

    return refined if again else once


def inverse(A: Sequence[Sequence[Expr]]) -> list[list[Expr]]:
    """Of one, two or three rows, by Cramer's rule. Raises NotReduced for a determinant that is always zero."""
    n = len(A)

    def det(rows: Sequence[int], columns: Sequence[int]) -> Expr:
        """Of a block."""
        if not rows:
            return A[0][0].graph.one
        terms = [
            A[rows[0]][c] * det(rows[1:], [x for x in columns if x != c]) * (-1) ** k for k, c in enumerate(columns)
        ]
        return A[0][0].graph.sum(terms)

    every = range(n)
    whole = det(every, every)
    if whole.is_zero:
        raise NotReduced("it does not tell the coordinates that are unknown")
    return [
        [det([r for r in every if r != i], [c for c in every if c != j]) * (-1) ** (i + j) / whole for i in every]
        for j in every
    ]


def determinant(A: Sequence[Sequence[Expr]]) -> Expr:
    """Of any rows, by elimination along the diagonal: its sign is right wherever its pivots are not zero."""
    rest, found = [list(row) for row in A], A[0][0].graph.one
    while rest:
        (pivot, *row), *below = rest
        found = found * pivot
        rest = [[x - each[0] / pivot * y for x, y in zip(each[1:], row, strict=True)] for each in below]
    return found


def _product(a: Sequence[Expr], b: Sequence[Expr]) -> Expr:
    return b[0].graph.sum(x * y for x, y in zip(a, b, strict=True))
