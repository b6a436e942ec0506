"""Rows of closures beside their own sizes: rank and openness whatever the units, for many states at a time.

A row of the Jacobian G is long or short by the lengths of its mechanism, metres or micrometres, and one of directions
has no unit at all. Each is judged beside how long it is in other positions; so a row that vanishes alone counts, too.
One that is nothing in all of them but rounding, beside its columns before they were projected onto an axis, is none:
so the row across a plane mechanism that stands in space by rounded angles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.array import Array

#: singular values of the balanced G below this part of the largest one, or of 1, count as zero
RANK = 1e-8
#: in which rows are looked at
POSITIONS = 8


class RowBounds(NamedTuple):
    """What the geometry allows: ``columns`` (N, m, n) of G before they are projected, ``spans`` (N, m) of phi."""

    columns: Array
    spans: Array


@dataclass(frozen=True)
class RowSizes:
    """``reach`` (N, m): how long the rows of G are in any position; ``width`` (N, m): how far they are open there. As
    long as the geometry allows where that is rounding everywhere, and 1 where there is no length.
    """

    reach: Array
    width: Array


def row_sizes(
    joints: Sequence[str],
    q: Array,
    look: Callable[[Array], tuple[Array, Array]],
    bounds: Callable[[Array], RowBounds],
) -> RowSizes:
    """The greatest |G_k| and |phi_k| at q (N, n) and with all joints turned anyhow and slides drawn in.

    ``joints``: R or P by coordinate; ``look``: G (P N, m, n) and phi (P N, m) at P positions of all N states, one
    position after the other; ``bounds``: what may be there, at one position of all.
    """
    part = np.random.default_rng(5).uniform(-1, 1, (POSITIONS, 1, len(joints)))
    turns = np.array([joint == "R" for joint in joints], dtype=bool)
    places = np.where(turns, np.pi * part, part * q)
    places[0] = q
    every = places.reshape(-1, len(joints))
    G, phi = look(every)
    # of lengths, which are as long in any position, one says enough
    columns, spans = bounds(every[len(q) : 2 * len(q)])
    rounding = (_greatest(G, len(q)) <= RANK * columns).all(axis=2)
    # |G_k| = (G_ka G_ka)^(1/2)
    reach = np.where(rounding, np.linalg.norm(columns, axis=2), _greatest(np.linalg.norm(G, axis=2), len(q)))
    width = _greatest(phi, len(q))
    width = np.where(rounding | (width == 0), spans, width)
    return RowSizes(*(np.where((x > 0) & np.isfinite(x), x, 1.0) for x in (reach, width)))


def _greatest(values: Array, states: int) -> Array:
    """The greatest sizes in all positions, of values that follow each other position by position."""
    return np.asarray(np.fmax.reduce(np.abs(values).reshape(-1, states, *values.shape[1:]), axis=0))


def rank_of(balanced: Array) -> int:
    """Rank of one G (m, n) with its rows over their reach."""
    return int(ranks(scipy.linalg.svdvals(balanced) if balanced.size else np.zeros(0)))


def ranks(sizes: Array) -> NDArray[np.int64]:
    """Number of singular values (..., k), in falling order, above RANK times the largest one, or times 1: the largest
    one is not below 1 but near singular positions.
    """
    least = RANK * np.maximum(1.0, sizes.max(axis=-1, initial=0.0, keepdims=True))
    return np.asarray((sizes > least).sum(axis=-1), dtype=np.int64)
