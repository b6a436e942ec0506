"""Linear equations with the metric, for many states at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cholesky_solve(g: Array, f: Array) -> Array:
    """x with g x = f for (N, n, n) and (N, n), by g = L L^T; NaN in states where g is not positive definite."""
    try:
        return _solved(g, f)
    except np.linalg.LinAlgError:
        pass
    result = np.full_like(f, np.nan)
    for i in range(len(f)):
        try:
            result[i] = _solved(g[i : i + 1], f[i : i + 1])[0]
        except np.linalg.LinAlgError:
            continue
    return result


def _solved(g: Array, f: Array) -> Array:
    L = np.linalg.cholesky(g)
    y = np.linalg.solve(L, f[..., None])
    return np.asarray(np.linalg.solve(np.swapaxes(L, -1, -2), y)[..., 0], dtype=np.float64)
