"""Linear complementarity problems by Lemke's pivoting."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array

#: of the largest number: what is zero in a pivot
ZERO = 1e-12
JAMMED = (
    "no contact forces were found that agree with Coulomb's law (Painleve's paradox: the contact jams): take less "
    "friction, or end the span before it"
)


def lemke(M: Array, q: Array) -> Array:
    """z >= 0 with M z + q >= 0 and z . (M z + q) = 0 by C. E. Lemke's pivoting (R. W. Cottle, J.-S. Pang, R. E. Stone,
    The Linear Complementarity Problem, 1992, section 4.4), ties by the lexicographic rule. Raises ArithmeticError where
    it ends on a ray.
    """
    n = len(q)
    if not n or q.min() >= 0:
        return np.zeros(n)
    # w - M z - z_0 = q: columns w, z, z_0, and q
    T = np.hstack([np.eye(n), -M, -np.ones((n, 1)), q[:, None]])
    basis = np.arange(n)
    row, entering = int(q.argmin()), 2 * n
    for _ in range(50 * (n + 1)):
        leaving = int(basis[row])
        basis[row] = entering
        T[row] /= T[row, entering]
        others = np.arange(n) != row
        T[others] -= np.outer(T[others, entering], T[row])
        if leaving == 2 * n:
            z = np.zeros(2 * n + 1)
            z[basis] = T[:, -1]
            return np.maximum(z[n : 2 * n], 0.0)
        # the complement of what has left
        entering = leaving + n if leaving < n else leaving - n
        row = _leaving(T, basis, entering)
    raise ArithmeticError(JAMMED)


def _leaving(T: Array, basis: NDArray[np.int64], entering: int) -> int:
    """The row that bounds the entering variable, z_0 first among equals. Raises ArithmeticError where none does."""
    n, column = len(T), T[:, entering]
    rows = np.flatnonzero(column > ZERO * np.abs(T[:, : 2 * n]).max(initial=1))
    if not len(rows):
        raise ArithmeticError(JAMMED)
    ratios = T[rows, -1] / column[rows]
    rows = rows[ratios <= ratios.min() + ZERO]
    if (basis[rows] == 2 * n).any():
        return int(rows[basis[rows] == 2 * n][0])
    for j in range(n):
        if len(rows) == 1:
            break
        ratios = T[rows, j] / column[rows]
        rows = rows[ratios <= ratios.min() + ZERO]
    return int(rows[0])
