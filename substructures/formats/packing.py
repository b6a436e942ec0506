"""Packed arrays: the independent elements of the metric and of the Christoffel symbols, and all of them again.

The metric (N, n, n) becomes (N, n (n + 1) / 2), its lower triangle row by row: g_ab for a = 0, 1, ..., b = 0, ..., a.
The Christoffel symbols (N, n, n, n) become (N, n (n^2 - 1) / 3): Gamma_abc for c = 0, 1, ..., a = 0, ..., c - 1,
b = 0, ..., c, from which all others follow (:class:`substructures.expr.operations.Output`). Both begin with those of
the first coordinates alone. Where relations move joints Gamma_abc = Gamma_acb is all that holds, and packed they are
(N, n^2 (n + 1) / 2): for a = 0, 1, ..., c = 0, 1, ..., b = 0, ..., c.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.expr.operations import images

#: the quantities that can be packed, and the rules by which their elements depend on each other
SYMMETRIES = {"metric": "symmetric", "christoffel": "christoffel"}
RANKS = {"metric": 2, "christoffel": 3}
#: places in the dense array of one state, row by row
Elements = NDArray[np.int64]


def packed_indices(quantity: str, n: int, symmetry: str = "") -> list[tuple[int, ...]]:
    """The indices of the packed elements of ``metric`` or ``christoffel`` for n coordinates, in their order.

    ``symmetry``: of Christoffel symbols; those of relations are a ``connection``.
    """
    if quantity == "metric":
        return [(a, b) for a in range(n) for b in range(a + 1)]
    if symmetry == "connection":
        return [(a, b, c) for a in range(n) for c in range(n) for b in range(c + 1)]
    return [(a, b, c) for c in range(n) for a in range(c) for b in range(c + 1)]


@lru_cache(maxsize=128)
def packed_elements(quantity: str, n: int, symmetry: str = "") -> Elements:
    """The places (K,) of the packed elements of ``metric`` or ``christoffel`` for n coordinates."""
    rank = RANKS[quantity]
    places = np.array(packed_indices(quantity, n, symmetry), dtype=np.int64).reshape(-1, rank)
    return places @ np.array([n**k for k in range(rank)][::-1], dtype=np.int64)


def unpack(quantity: str, packed: Any, n: int) -> NDArray[Any]:
    """The dense array (..., n, n) of ``metric``, or (..., n, n, n) of ``christoffel``, from the packed one (..., K).

    Raises ValueError for another quantity, or a number of elements that n coordinates do not have.

    >>> unpack("metric", [1.0, 2.0, 3.0], 2).tolist()
    [[1.0, 2.0], [2.0, 3.0]]
    """
    if quantity not in SYMMETRIES:
        raise ValueError(f"'{quantity}' is never packed; there are {', '.join(SYMMETRIES)}")
    values, indices, symmetry = np.asarray(packed), packed_indices(quantity, n), SYMMETRIES[quantity]
    if quantity == "christoffel" and n and values.shape[-1] == n * n * (n + 1) // 2:
        symmetry = "connection"
        indices = packed_indices(quantity, n, symmetry)
    if values.shape[-1] != len(indices):
        raise ValueError(f"{len(indices)} elements are packed for {n} coordinates, found {values.shape[-1]}")
    dense = np.zeros(values.shape[:-1] + (n,) * RANKS[quantity], dtype=values.dtype)
    for k, index in enumerate(indices):
        for image, sign in images(index, symmetry):
            place: tuple[Any, ...] = (..., *image)
            dense[place] = sign * values[..., k]
    return dense
