"""Choices of independent rows and coordinates that do not hang on rounding."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.array import Array

#: lengths of rows or columns that differ by this part are equal
TIE = 1e-6


def singular_values(A: Array) -> Array:
    """Of a matrix, the largest first; as scipy.linalg.svdvals, for small ones. Raises LinAlgError."""
    _, values, _, info = scipy.linalg.lapack.dgesdd(A.T, compute_uv=0)
    if info:
        raise np.linalg.LinAlgError("there are no singular values of what is not finite")
    return np.asarray(values, dtype=np.float64)


def pivoted(A: Array, rank: int) -> NDArray[np.int64]:
    """Columns of A in the order of a QR decomposition with pivoting, the first ``rank`` by what they add to those
    before; of columns that differ by rounding the first one, so that a choice does not hang on the last bits.
    """
    left, order = np.array(A, dtype=np.float64), list(range(A.shape[1]))
    for k in range(rank):
        sizes = np.linalg.norm(left[:, order[k:]], axis=0)
        place = k + int((sizes >= (1 - TIE) * sizes.max()).argmax())
        order.insert(k, order.pop(place))
        # what is left beside the column e: A - e e^T A
        e = left[:, order[k]] / np.linalg.norm(left[:, order[k]])
        left -= np.outer(e, e @ left)
    return np.array(order, dtype=np.int64)
