"""What the linearisation tells of many parameter sets at once: M dq'' + D dq' + K dq = 0 (notation.md, section 7)."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.stability.vibrations import NEUTRAL, SYMMETRIC
from substructures.array import Array, ComplexArray
from substructures.sweeps.document import LinearColumn
from substructures.sweeps.grouped import alike, inside
from substructures.sweeps.rest import AtRest
from substructures.sweeps.shapes import Shape


def linear_columns(
    shape: Shape, columns: Mapping[str, LinearColumn], parameters: Mapping[str, Any], rows: int
) -> dict[str, Array]:
    """What columns take, (rows,), of the linearisation about a state with one set of parameters a row; NaN where that
    is no equilibrium, unless it is ``held`` there or has ``settled``.

    Raises InvalidInput, MissingValue.
    """
    found = dict[str, Array]()
    about = {name: {"at": c.at, "held": c.held, "settle": c.settle} for name, c in columns.items()}
    for same in alike(about):
        takes = {columns[name].take for name in same}
        with inside(f"/columns/{same[0]}/at"):
            taken = _about(AtRest(shape, columns[same[0]].at, parameters, rows), columns[same[0]], takes)
        found |= {name: taken[columns[name].take] for name in same}
    return found


def _about(rest: AtRest, how: LinearColumn, takes: Collection[str]) -> dict[str, Array]:
    q = rest.settled() if how.settle else rest.start
    settled = np.asarray(np.isfinite(q).all(axis=1))
    q = np.where(settled[:, None], q, rest.start)
    qdd = rest.still if how.held else rest.accelerations(q)
    M, D, K = rest.matrices(q, qdd)
    good = settled & rest.is_rest(q, qdd, M, K) & np.isfinite(D).all(axis=(1, 2))
    eigenvalues = np.full((rest.rows, 2 * M.shape[1]), np.nan, dtype=np.complex128)
    if good.any():
        eigenvalues[good] = _eigenvalues(M[good], D[good], K[good])
    return {take: np.where(good, _taken(take, eigenvalues), np.nan) for take in takes}


def _eigenvalues(M: Array, D: Array, K: Array) -> ComplexArray:
    """(N, 2 n): of symmetric problems K x = w^2 M x without damping by Cholesky's factor of M, else of dx' = A x."""
    scale = np.abs(K).max(axis=(1, 2))
    symmetric = np.abs(K - K.transpose(0, 2, 1)).max(axis=(1, 2)) <= SYMMETRIC * scale
    found = np.full((len(M), 2 * M.shape[1]), np.nan, dtype=np.complex128)
    simple = symmetric & (np.abs(D).max(axis=(1, 2)) == 0) & _is_positive(M)
    if simple.any():
        L = np.linalg.cholesky(M[simple])
        half = np.linalg.solve(L, K[simple])
        C = np.linalg.solve(L, half.transpose(0, 2, 1))
        squares = _where_finite(np.linalg.eigvalsh, (C + C.transpose(0, 2, 1)) / 2)
        # what rounding makes of no restoring force is none
        squares = np.where(np.abs(squares) <= 1e-13 * np.abs(squares).max(axis=1, keepdims=True), 0.0, squares)
        roots = 1j * np.sqrt(squares.astype(np.complex128))
        found[simple] = np.concatenate([roots, -roots], axis=1)
    rest = ~simple
    if rest.any():
        n = M.shape[1]
        A = np.zeros((int(rest.sum()), 2 * n, 2 * n))
        A[:, :n, n:] = np.eye(n)
        A[:, n:, :n] = -np.linalg.solve(M[rest], K[rest])
        A[:, n:, n:] = -np.linalg.solve(M[rest], D[rest])
        found[rest] = _where_finite(np.linalg.eigvals, A)
    return found


def _where_finite(eigenvalues: Callable[[Array], Any], matrices: Array) -> Any:
    """(N, n) of (N, n, n), not a number where these overflow."""
    good = np.asarray(np.isfinite(matrices).all(axis=(1, 2)))
    found = eigenvalues(np.where(good[:, None, None], matrices, 0.0))
    return np.where(good[:, None], found, np.nan)


def _is_positive(M: Array) -> NDArray[np.bool_]:
    return np.linalg.eigvalsh((M + M.transpose(0, 2, 1)) / 2)[:, 0] > 0


def _taken(take: str, eigenvalues: ComplexArray) -> Array:
    size, real = np.abs(eigenvalues), eigenvalues.real
    match take:
        case "lowest_frequency":
            return size.min(axis=1)
        case "highest_frequency":
            return size.max(axis=1)
        case "largest_real_part":
            return real.max(axis=1)
        case "is_stable":
            stable = real.max(axis=1) <= NEUTRAL * size.max(axis=1)
            return np.where(np.isnan(size).any(axis=1), np.nan, stable.astype(np.float64))
    with np.errstate(invalid="ignore", divide="ignore"):
        ratios = np.where(size > 0, -real / size, 0.0)
    return np.where(np.isnan(size).any(axis=1), np.nan, ratios.min(axis=1))


ANALYSES = {"linearisation": linear_columns}
