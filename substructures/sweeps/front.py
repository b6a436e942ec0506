"""Pareto fronts: the rows that no other row beats in all columns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array

#: rows that are compared with all that are left at a time
AT_ONCE = 512


def front(values: Array) -> NDArray[np.int64]:
    """The rows (indices, ascending) of ``values`` (N, k), all to be minimised, that none dominates.

    A row is dominated by one that is nowhere larger and somewhere smaller; equal rows stay together. By the sum of
    scaled columns the candidates come in an order in which what dominates comes first, so most rows fall early.

    >>> front(np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]))
    array([0, 1, 3])
    """
    if not values.size:
        return np.arange(len(values), dtype=np.int64)
    ranks = np.stack([np.unique(column, return_inverse=True)[1] for column in values.T], axis=1).astype(np.int32)
    order = np.argsort(ranks.sum(axis=1), kind="stable")
    left, kept = ranks[order], []
    numbers = order
    while len(left):
        head = left[:AT_ONCE]
        # a row of the head can be dominated by an earlier row of the head only, since its sum is smaller
        own = ~_dominated(head, head)
        best = head[own]
        kept.append(numbers[:AT_ONCE][own])
        rest = left[AT_ONCE:]
        stays = ~_dominated(rest, best)
        left, numbers = rest[stays], numbers[AT_ONCE:][stays]
    return np.sort(np.concatenate(kept))


def _dominated(rows: NDArray[np.int32], by: NDArray[np.int32]) -> NDArray[np.bool_]:
    found = np.zeros(len(rows), dtype=np.bool_)
    for each in by:
        alive = ~found
        if not alive.any():
            break
        some = rows[alive]
        found[alive] = (each <= some).all(axis=1) & (each < some).any(axis=1)
    return found
