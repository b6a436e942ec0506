"""Linear equations with the metric, for many states at a time."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.mechanics.closure_rows import RANK, RowSizes, ranks

#: outputs of a model that accelerations with closures need beside those without
CLOSED = ("closure.residual", "closure.jacobian", "closure.acceleration")
#: residuals of positions of a state that counts as closed, over their width and its largest number or 1: below RANK,
#: because rows that depend on each other in closed positions do so only there
MET = 1e-9
#: the same for velocities
MET_RATE = 1e-6


def cholesky_solve(g: Array, f: Array) -> Array:
    """x with g x = f for (N, n, n) and (N, n), by g = L L^T; NaN in states where g is not positive definite."""
    return definite_solve(g, f)[0]


def definite_solve(g: Array, f: Array) -> tuple[Array, Array]:
    """x (N, n) with g x = f for (N, n, n) and (N, n), by g = L L^T, and the pivots L_kk^2 / g_kk (N, n) in (0, 1].

    NaN in states where g is not positive definite. Entries of L are as large as the roots of those of g: no product
    leaves the range of numbers before g does.
    """
    try:
        L = np.linalg.cholesky(g)
    except np.linalg.LinAlgError:
        half = len(f) // 2
        if not half:
            return np.full_like(f, np.nan), np.full_like(f, np.nan)
        parts = definite_solve(g[:half], f[:half]), definite_solve(g[half:], f[half:])
        x, pivots = (np.concatenate(both) for both in zip(*parts, strict=True))
        return x, pivots
    # L y = f forwards, L^T x = y backwards, in all states at once
    x = np.array(f, dtype=np.float64)
    n = x.shape[1]
    for k in range(n):
        x[:, k] = (x[:, k] - np.einsum("ni,ni->n", L[:, k, :k], x[:, :k])) / L[:, k, k]
    for k in reversed(range(n)):
        x[:, k] = (x[:, k] - np.einsum("ni,ni->n", L[:, k + 1 :, k], x[:, k + 1 :])) / L[:, k, k]
    return x, np.einsum("nkk->nk", L) ** 2 / np.einsum("nkk->nk", g)


def saddle_solve(g: Array, G: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """x (N, n) and y (N, r) with g x + G^T y = a and G x = b for (N, n, n), (N, r, n) of independent rows, (N, n) and
    (N, r); NaN in states where both are not determined. Without rows x is that of :func:`cholesky_solve`.
    """
    (count, r, n) = G.shape
    if not r:
        return cholesky_solve(g, a), np.zeros((count, 0))
    whole, right = np.zeros((count, n + r, n + r)), np.concatenate([a, b], axis=1)
    whole[:, :n, :n], whole[:, n:, :n], whole[:, :n, n:] = g, G, G.swapaxes(1, 2)
    try:
        found = np.linalg.solve(whole, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        half = count // 2
        if not half:
            return np.full((1, n), np.nan), np.full((1, r), np.nan)
        parts = [saddle_solve(g[some], G[some], a[some], b[some]) for some in (slice(half), slice(half, None))]
        x, y = (np.concatenate(both) for both in zip(*parts, strict=True))
        return x, y
    return found[:, :n], found[:, n:]


def condition(g: Array) -> Array:
    """Condition number (N,) of g (N, n, n) after its rows and columns are scaled to a unit diagonal.

    That of h = S g S, S = diag(g_kk)^-1/2, the largest eigenvalue over the smallest: whatever the units of the
    coordinates, about the least that scaling can reach (A. van der Sluis, Numerische Mathematik 14, 1969), and the
    relative error of g^-1 f is about that times the unit of rounding (N. J. Higham, Accuracy and Stability of Numerical
    Algorithms, 2002, section 10.1). Infinite where g is not positive definite to rounding, NaN where it is not finite.
    """
    diagonal = np.einsum("nkk->nk", g)
    result = np.full(len(g), np.nan)
    finite = np.isfinite(g).all(axis=(1, 2))
    result[finite] = np.inf
    good = np.flatnonzero(finite & (diagonal > 0).all(axis=1))
    if g.shape[1] and len(good):
        s = 1 / np.sqrt(diagonal[good])
        sizes = np.linalg.eigvalsh(s[:, :, None] * g[good] * s[:, None, :])
        with np.errstate(divide="ignore"):
            result[good] = np.where(sizes[:, 0] > 0, sizes[:, -1] / sizes[:, 0], np.inf)
    return result if g.shape[1] else np.ones(len(g))


def closed_solve(
    found: Mapping[str, Array], q: Array, qd: Array, rows: RowSizes, second: Callable[[Array], Array]
) -> tuple[Array, Array]:
    """q'' (N, n) with g q'' + Gamma q'q' = Q + G^T lambda and G q'' + G'q' = 0; the rows of G may depend on each other.

    The second result (N,): the condition of N^T g N below times the largest over the smallest singular value of G.

    ``found``: metric, bias, forces and CLOSED at states (N, n); ``rows``: the sizes beside which rows are judged;
    ``second``: G'q' for other velocities (N, n). NaN where a state does not meet the closures (also their velocities),
    where they lose rank, so that the motion is not determined, and where no free motion has inertia.

    With an orthonormal basis N of the velocities that G leaves free: q'' = -G^+ G'q' + N z and N^T (g q'' - f) = 0. Of
    rows that depend on each other, mu^T G = 0, always, also mu^T G'v = 0 for every such velocity v; where the rank is
    lower than nearby this fails. All rows are taken over their reach.
    """
    reach = rows.reach
    G, c = found["closure.jacobian"] / reach[:, :, None], found["closure.acceleration"] / reach
    f = found["forces"] - found["bias"]
    result = np.full(np.broadcast_shapes(q.shape, qd.shape, f.shape), np.nan)
    conditions = np.full(len(result), np.nan)
    # G = U diag(sizes) V^T; the rows of V^T beyond the rank span the velocities that G leaves free
    left, sizes, right = np.linalg.svd(np.where(np.isfinite(G), G, 0), full_matrices=True)
    rank_here = ranks(sizes)
    good = _keeps_rank(left, right, rank_here, lambda v: second(v) / reach)
    good = good & _met(found, q, np.broadcast_to(qd, result.shape), rows)
    for rank in np.unique(rank_here):
        some = np.flatnonzero(good & (rank_here == rank))
        N = right[some, rank:].swapaxes(1, 2)
        U, V = left[some, :, :rank], right[some, :rank]
        # G^+ c = V diag(1/sizes) U^T c
        solved = np.einsum("nka,nk->na", V, np.einsum("njk,nj->nk", U, c[some]) / sizes[some, :rank])
        # N^T g N z = N^T (f + g G^+ c),   q'' = N z - G^+ c
        wanted = f[some] + np.einsum("nab,nb->na", found["metric"][some], solved)
        reduced = N.swapaxes(1, 2) @ found["metric"][some] @ N
        z = cholesky_solve(reduced, np.einsum("nak,na->nk", N, wanted))
        result[some] = np.einsum("nak,nk->na", N, z) - solved
        conditions[some] = condition(reduced) * (
            np.maximum(sizes[some, 0], 1.0) / sizes[some, rank - 1] if rank else 1.0
        )
    return result, conditions


def _keeps_rank(
    left: Array, right: Array, rank: NDArray[np.int64], second: Callable[[Array], Array]
) -> NDArray[np.bool_]:
    """Where (n,) mu^T G'v is zero of one free velocity v and all mu with mu^T G = 0."""
    probe = np.random.default_rng(5).standard_normal(right.shape[-1])
    free = np.arange(right.shape[-1]) >= rank[:, None]
    along = np.einsum("nka,nk->na", right, np.where(free, right @ probe, 0))
    across = np.arange(left.shape[-1]) >= rank[:, None]
    curved = np.where(across, np.einsum("nkj,nk->nj", left, second(along)), 0)
    return np.asarray(np.abs(curved).max(axis=1, initial=0) <= np.sqrt(RANK))


def _met(found: Mapping[str, Array], q: Array, qd: Array, rows: RowSizes) -> NDArray[np.bool_]:
    """Which states (n,) meet the closures, positions and velocities: phi = 0 and G q' = 0."""
    rate = np.einsum("nka,na->nk", found["closure.jacobian"], qd) / rows.width
    opened = np.abs(found["closure.residual"] / rows.width).max(axis=1, initial=0)
    met = opened <= MET * np.abs(q).max(axis=1, initial=1)
    return np.asarray(met & (np.abs(rate).max(axis=1, initial=0) <= MET_RATE * np.abs(qd).max(axis=1, initial=1)))
