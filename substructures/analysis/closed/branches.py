"""Whether a step along the closures has stayed on one branch, away from singular positions.

At a singular position the closures lose rank, and branches of closed positions may cross there. With the independent
rows G_0 = U S V^T of G at a closed position q_0, at another one

    e = |S^-1 U^T (G - G_0)|        (the largest singular value)

is the change of G beside its smallest singular values. Where e < 1 in a convex neighbourhood of q_0, G has full rank
there, as S^-1 U^T G = V^T + S^-1 U^T (G - G_0) and all singular values of V^T are 1; and the closed positions in it are
the graph of a function over the directions with G_0 t = 0, one branch, as S^-1 U^T G V = 1 + E, |E| < 1, is definite.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from substructures.analysis.closed.constrained import SINGULAR, Singular
from substructures.analysis.closed.jacobian import Rows
from substructures.analysis.closed.pivoting import singular_values
from substructures.array import Array

#: a whole step is on one branch without a further look where G changes by less than this from both of its ends: from
#: each of them up to the middle by half of it
FAR = 1.0
#: the same for parts of a step that is looked into
NEXT = 0.25
#: parts of a step that are this short but not on one branch have a leap between their ends
FINEST = 2.0**-20
LOOKS = 500


def change(A: Rows, B: Rows, enough: float = 0.0) -> float:
    """The larger one of |S^-1 U^T (B - A)|, A = U S V^T, and of the same with A and B exchanged; r rows of G each.

    Where a bound of it is at most ``enough``, this bound.
    """
    difference = B.G - A.G
    return max(_from(A, difference, enough), _from(B, difference, enough))


def _from(A: Rows, difference: Array, enough: float) -> float:
    if not len(A.G):
        return 0.0
    if not A.values[-1] > 0:
        return np.inf
    E = (A.left @ difference) / A.values[:, None]
    # Frobenius' norm is not below the largest singular value
    bound = float(np.vdot(E, E)) ** 0.5
    return bound if bound <= enough else float(singular_values(E)[0])


def singular_part(G_at: Callable[[float], Rows | None], first: Rows, last: Rows) -> float | None:
    """Where a step comes to a singular position first, 0 to 1; None: nowhere, it stays on one branch.

    ``first``, ``last``: independent rows of the balanced G at its ends; ``G_at``: the same at a part of it, None where
    that position is singular. Raises Singular where its ends are on different branches, or that cannot be told.
    """
    left = [(0.0, first, 1.0, last)]
    for _ in range(LOOKS):
        if not left:
            return None
        low, A, high, B = left.pop()
        if change(A, B, NEXT) <= NEXT:
            continue
        if high - low < FINEST:
            break
        middle = (low + high) / 2
        G = G_at(middle)
        if G is None:
            return middle
        left += [(middle, G, high, B), (low, A, middle, G)]
    raise Singular(SINGULAR)
