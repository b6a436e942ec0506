"""Forces of joints that stick: a (k,) are accelerations without them, B B^T those of unit forces, B (k, d).

Rows of B have any length, and depend on each other where joints can only move together.
"""

from __future__ import annotations

from itertools import combinations
from math import comb
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.motion.friction.dry_friction import EDGE
from substructures.array import Array

#: rows of B of unit length are dependent when a singular value is below this part of the largest
RANK = 1e-8
#: of forces, what is left to be shared that counts as none
NOTHING = 1e-13
#: so many choices of zeros are looked at one by one
MANY = 1000
#: added to B B^T of unit rows, so that it is definite
DEFINITE = 1e-13


def unit_rows(B: Array) -> tuple[Array, Array]:
    """Rows of unit length, and how long they were."""
    size = np.linalg.norm(B, axis=1)
    return B / size[:, None], size


def holding(B: Array, a: Array, most: Array) -> tuple[Array, float]:
    """f with B B^T f = -a, and the largest |f_i| / most_i; that is infinite where there is no such f.

    Of several that whose largest |f_i| / most_i is least.
    """
    if not len(a):
        return a, 0.0
    most = np.maximum(most, 1e-300)
    unit, size = unit_rows(B)
    U, S, _ = np.linalg.svd(unit)
    rank = int((S / S[0] > RANK).sum())
    U, a = U[:, :rank], a / size
    # U^T f = -S^-2 U^T a, for forces times the lengths of their rows
    right = -(U.T @ a) / S[:rank] ** 2
    f = U @ right
    scale = np.abs(unit @ unit.T) @ (most * size) + np.abs(a)
    if (np.abs(a - U @ (U.T @ a)) > EDGE * scale).any():
        return f / size, np.inf
    if rank < len(a):
        f = _shared(U.T, right, most * size)
    return f / size, float(np.abs(f / size / most).max())


def _shared(A: Array, b: Array, most: Array) -> Array:
    """f with A f = b whose largest |f_i| / most_i is least, then the next largest, ...; rows of A are orthonormal."""
    f, free, left = np.zeros(len(most)), np.arange(len(most)), b
    weight = most / most.max()
    while len(free) and np.abs(left).max() > NOTHING * np.abs(b).max():
        size = float(np.abs(left).max())
        found, tight = _least_largest(A[:, free] * weight[free], left / size)
        f[free[tight]] = size * (weight[free] * found)[tight]
        free = free[~tight]
        left = b - A @ f
    # less rounding
    return np.asarray(f + A.T @ (b - A @ f))


def _least_largest(A: Array, b: Array) -> tuple[Array, NDArray[np.bool_]]:
    """h with A h = b whose largest |h_i| is least, and which of them are as large whatever the others are.

    By duality it is the largest b^T y with sum_i |(A^T y)_i| = 1 (r numbers y), which is where r - 1 of the (A^T y)_i
    are zero; h has the signs of the others.
    """
    U, S, V = np.linalg.svd(A, full_matrices=False)
    rank, k = int((RANK * S[0] < S).sum()), A.shape[1]
    if not rank:
        return np.zeros(k), np.ones(k, dtype=np.bool_)
    # independent rows: V h = S^-1 U^T b
    A, b = V[:rank], (U.T @ b)[:rank] / S[:rank]
    if comb(k, rank - 1) > MANY:
        return _by_linear_program(A, b)
    zeros = np.array(list(combinations(range(k), rank - 1)), dtype=np.int64)
    y = np.linalg.svd(A.T[zeros])[2][:, -1] if rank > 1 else np.ones((1, 1))
    forms = y @ A
    values = (y @ b) / np.abs(forms).sum(axis=1)
    best = int(np.abs(values).argmax())
    form = forms[best] / np.abs(forms[best]).max()
    return values[best] * np.sign(form), np.abs(form) > RANK


def _by_linear_program(A: Array, b: Array) -> tuple[Array, NDArray[np.bool_]]:
    """The same where there are many choices."""
    k = A.shape[1]
    ones = np.ones((k, 1))
    # least s with h - s <= 0 and -h - s <= 0
    below, equal = np.block([[np.eye(k), -ones], [-np.eye(k), -ones]]), np.hstack([A, np.zeros((len(A), 1))])
    goal, bounds = np.append(np.zeros(k), 1.0), [(None, None)] * (k + 1)
    found: Any = scipy.optimize.linprog(goal, below, np.zeros(2 * k), equal, b, bounds, method="highs-ds")
    if found.status != 0:
        return np.asarray(np.linalg.lstsq(A, b, rcond=None)[0], dtype=np.float64), np.ones(k, dtype=np.bool_)
    tight = np.abs(found.ineqlin.marginals).reshape(2, k).max(axis=0) > RANK
    return found.x[:k], tight if tight.any() else np.ones(k, dtype=np.bool_)


def bounded(B: Array, a: Array, most: Array) -> Array:
    """f with the least 1/2 |B^T f|^2 + a^T f and |f| <= most."""
    unit, size = unit_rows(B)
    a, bound = a / size, np.maximum(most * size, 1e-300)
    y = np.linalg.lstsq(unit, a, rcond=RANK)[0]
    # a = B y + rest: least |B^T f + y|^2 + |e f + rest / e|^2 with a small e
    e = np.sqrt(DEFINITE)
    left, right = np.vstack([unit.T, e * np.eye(len(a))]), -np.concatenate([y, (a - unit @ y) / e])
    found: Any = scipy.optimize.lsq_linear(left, right, bounds=(-bound, bound), method="bvls", tol=1e-14)
    return np.asarray(found.x, dtype=np.float64) / size
