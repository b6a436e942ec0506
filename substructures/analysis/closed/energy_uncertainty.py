"""How well the energy of states on closures is known: next to a singular position rounding errors are amplified.

A position that was rounded opens the closures by r, about eps |q| S_1 with the singular values S_1 >= ... >= S_p of G
(balanced, S_1 at least 1), and so do the last steps of Newton's method that are left out. As far as that tells, the
motion may be at q + dq too,

    dq = (r / S_k) v_k        dq' = -G^+ (G(q + dq) q' + phi_t)

for each of the right singular vectors v_k, and there its energy is another one. Far from singular positions the
difference is the work of the closures' forces along r; beside them it grows with (S_1 / S_p)^2, to 1e-10 of the energy
where S_p / S_1 is 1e-3. It is found by evaluating both states; no property of the integrator goes into it.
"""

from __future__ import annotations

import numpy as np

from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.projection import CLOSED
from substructures.array import Array

#: units in the last place by which terms of a residual are wrong together, and with them the steps of a motion there
UNITS = 16
#: all states whose share of the smallest singular value is below this part of the largest one are looked at; FEW others
NEAR, FEW = 0.03, 8


def energy_uncertainty(s: Constrained, rank: int, t: Array, x: Array, ends: Array) -> Array:
    """What T + V is uncertain by at times t (K,), in order, and states (q, q') = x (K, 2 n): (K,) [J], never falling.

    ``ends``: of the steps of the integrator, in order: an error at the end of a step is in all of its results.
    """
    if not rank:
        return np.zeros(len(t))
    shares, found = np.full(len(t), np.nan), np.zeros(len(t))
    for k in np.flatnonzero(np.isfinite(x).all(axis=1)).tolist():
        s.move(float(t[k]), x[k, : s.n], x[k, s.n :])
        shares[k] = s.share(rank)
    best = float(np.nanmax(shares, initial=0))
    some = np.linspace(0, len(t) - 1, FEW).astype(np.int64)
    for k in np.union1d(np.flatnonzero(shares < NEAR * best), some).tolist():
        if np.isfinite(shares[k]):
            s.move(float(t[k]), x[k, : s.n], x[k, s.n :])
            found[k] = _difference(s, rank, float(shares[k]) / best)
    worst = np.maximum.accumulate(np.nan_to_num(found, nan=0.0))
    after = np.append(ends, np.inf)[np.searchsorted(ends, t)]
    return worst[np.searchsorted(t, after, side="right") - 1]


def _difference(s: Constrained, rank: int, part: float) -> float:
    """The largest difference of T + V between where s is and beside it; ``part``: the share there over the best one."""
    t, q, qd, energy = s.t, s.q, s.qd, sum(s.energies)
    S, V = s.jacobian.values, s.jacobian.right
    # r: of rounding, and what project() leaves open, over the lengths of the rows
    rounding = UNITS * np.finfo(float).eps * max(1.0, float(np.abs(q).max())) * max(1.0, float(S[0]))
    opening = rounding + part**2 * CLOSED / 100 * float((s.width / s.reach).max())
    return max(abs(_energy(s, rank, t, q + opening / S[k] * V[:, k], qd) - energy) for k in range(rank))


def _energy(s: Constrained, rank: int, t: float, q: Array, qd: Array) -> float:
    """T + V with the nearest velocities that meet the closures at q."""
    s.move(t, q, qd)
    G = s.jacobian
    s.move(t, q, qd - G.right[:, :rank] @ ((G.left[:rank] @ (s.velocity_residual / s.reach)) / G.values[:rank]))
    return sum(s.energies)
