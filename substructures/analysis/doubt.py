"""How well the energy of states on closures is known: next to a singular position rounding errors are amplified.

A position q that was rounded opens the closures by about eps |q| S_1, with the singular values S_1 >= ... >= S_r of G:
as far as doubles can tell, the motion may as well be at q + dq, where dq is along the direction v_r that G holds least,

    dq = eps max(1, |q|) (S_1 / S_r) v_r        dq' = -G^+ (G(q + dq) q' + phi_t)

and there its energy is another one. The difference grows with (S_1 / S_r)^2: to 1e-10 of the energy where S_r / S_1 is
1e-3, to 1e-8 where it is 1e-4. It is found by evaluating both states; no property of the integrator goes into it.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import svd, svdvals

from substructures.analysis.constrained import Constrained
from substructures.states import Array

#: units in the last place by which terms of a residual are wrong together, and with them the steps of a motion there
UNITS = 16
#: states whose share of the smallest singular value is above this part of the largest one are known to 1e-12
NEAR = 0.03


def energy_doubt(s: Constrained, rank: int, t: Array, x: Array, ends: Array) -> Array:
    """What T + V is uncertain by at times t (K,), in order, and states (q, q') = x (K, 2 n): (K,) [J], never falling.

    ``ends``: of the steps of the integrator, in order: an error at the end of a step is in all of its results.
    """
    if not rank:
        return np.zeros(len(t))
    shares, found = np.full(len(t), np.nan), np.zeros(len(t))
    for k in np.flatnonzero(np.isfinite(x).all(axis=1)).tolist():
        s.move(float(t[k]), *np.split(x[k], 2))
        values = svdvals(s.G)
        shares[k] = values[rank - 1] / values[0]
    for k in np.flatnonzero(shares < NEAR * np.nanmax(shares, initial=0)).tolist():
        found[k] = UNITS * _difference(s, rank, float(t[k]), *np.split(x[k], 2))
    worst = np.maximum.accumulate(np.nan_to_num(found, nan=0.0))
    after = np.append(ends, np.inf)[np.searchsorted(ends, t)]
    return worst[np.searchsorted(t, after, side="right") - 1]


def _difference(s: Constrained, rank: int, t: float, q: Array, qd: Array) -> float:
    """|T + V| between a state and the one beside it."""
    s.move(t, q, qd)
    energy = sum(s.energies)
    _, S, W = svd(s.G)
    beside = q + np.finfo(float).eps * max(1.0, float(np.abs(q).max())) * S[0] / S[rank - 1] * W[rank - 1]
    s.move(t, beside, qd)
    U, S, W = svd(s.G)
    turned = qd - W[:rank].T @ ((U[:, :rank].T @ s.velocity_residual) / S[:rank])
    s.move(t, beside, turned)
    return abs(sum(s.energies) - energy)
