"""Linear equations with the metric, for many states at a time."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cholesky_solve(g: Array, f: Array) -> Array:
    """x with g x = f for (N, n, n) and (N, n), by g = L L^T; NaN in states where g is not positive definite."""
    try:
        L = np.linalg.cholesky(g)
    except np.linalg.LinAlgError:
        half = len(f) // 2
        if not half:
            return np.full_like(f, np.nan)
        return np.concatenate([cholesky_solve(g[:half], f[:half]), cholesky_solve(g[half:], f[half:])])
    x = np.array(f, dtype=np.float64)
    n = x.shape[1]
    for k in range(n):
        x[:, k] = (x[:, k] - np.einsum("ni,ni->n", L[:, k, :k], x[:, :k])) / L[:, k, k]
    for k in reversed(range(n)):
        x[:, k] = (x[:, k] - np.einsum("ni,ni->n", L[:, k + 1 :, k], x[:, k + 1 :])) / L[:, k, k]
    return x
