"""Closed positions by independent coordinates: q(y) on the branch of a start, and its tangent.

q(y) is followed along the straight line from the start to y, by Newton's method in the dependent coordinates z from the
tangent q' = N y', G N = 0. A place where G_z is singular (a dead centre, a branching) bounds what can be reached.
"""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import Constrained, Singular
from substructures.analysis.closed.projection import CLOSED
from substructures.array import Array

#: longest step of a coordinate, how far it may be from the tangent, and the shortest part of the way
STRIDE, BEND, LEAST = 0.2, 0.05, 1e-9
#: smallest singular value of the balanced G_z, beside 1, that counts as none
FLAT = 1e-7
Index = NDArray[np.int64]


def followed(s: Constrained, q: Array, places: tuple[Index, Index], target: Array) -> Array:
    """The closed position on the branch of q, along the straight line of the independent coordinates. Raises Singular.

    A step is halved where Newton's method goes away from the tangent, or the sign of det G_z changes on independent
    rows: at a singular place it becomes shorter than LEAST.
    """
    (y, z), t, rest = places, s.t, np.zeros(s.n)
    begin, share, step = q[y].copy(), 0.0, 1.0
    while share < 1:
        s.move(t, q, rest)
        rows = s.independent_rows()
        side = np.linalg.det(s.balanced[np.ix_(rows, z)])
        slope = tangent(s, y, z) @ (target - begin)
        step = min(step, 1 - share, STRIDE / max(float(np.abs(slope).max(initial=0)), STRIDE))
        trial = q + step * slope
        trial[y] = begin + (share + step) * (target - begin)
        found = _closed(s, trial, z)
        beyond = found is None or np.abs(found - trial).max() > BEND
        if found is None or beyond or np.linalg.det(s.balanced[np.ix_(rows, z)]) * side <= 0:
            step /= 2
            if step < LEAST:
                raise Singular(_told(s, y, begin + share * (target - begin)))
            continue
        q, share, step = found, share + step, 2 * step
    return q


def _told(s: Constrained, y: Index, place: Array) -> str:
    # of those that move something in the loops
    pairs = [(s.model.coordinates[a], x) for a, x in zip(y, place, strict=True) if s.G[:, a].any()]
    at = ", ".join(f"{name} = {x:.9g}" for name, x in pairs)
    return (
        f"the closures are singular at {at}, beyond which nothing is reached on this branch: the independent "
        "coordinates do not determine the others there (a dead centre or a branching)"
    )


def _closed(s: Constrained, q: Array, z: Index) -> Array | None:
    """By Newton's method in the dependent coordinates; None where it does not meet the closures."""
    rest, size = np.zeros(s.n), np.inf
    for _ in range(12):
        s.move(s.t, q, rest)
        before, size = size, s.opening
        if size <= CLOSED / 100 or before / 2 < size <= CLOSED:
            return q
        if not np.isfinite(size):
            return None
        q = q.copy()
        # G_z dz = -phi, all rows over their reach
        q[z] -= scipy.linalg.lstsq(s.balanced[:, z], s.phi / s.reach)[0]
    return None


def tangent(s: Constrained, y: Index, z: Index) -> Array:
    """N (n, r) with G N = 0, N = 1 in the rows of y. Raises Singular."""
    sizes = scipy.linalg.svdvals(s.balanced[:, z])
    if len(sizes) < len(z) or sizes[-1] <= FLAT * max(1.0, sizes[0]):
        raise Singular(_told(s, y, s.q[y]))
    N = np.zeros((s.n, len(y)))
    N[y] = np.eye(len(y))
    N[z] = -scipy.linalg.lstsq(s.balanced[:, z], s.balanced[:, y])[0]
    return N
