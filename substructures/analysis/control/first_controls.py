"""Controls from which a search can start.

Where a motion without them stands still, brackets of the ways that controls push are needed to go sideways (a blade at
rest: W. L. Chow, Mathematische Annalen 117, 1940): to first order no change of controls that are zero meets the
demands, and the search would end where it begins. Controls that swing make such ways (R. M. Murray and S. S. Sastry,
Nonholonomic motion planning: steering using sinusoids, IEEE Transactions on Automatic Control 38, 1993, 700-716).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from substructures.analysis.control.nonlinear_program import ShootingProgram
from substructures.array import Array

#: what is left of demands, relative to the largest, that counts as met to first order; singular values that are zero
MET, RANK = 1e-6, 1e-10
#: swinging controls that are tried one after the other, of so many waves over the horizon, and their size in units
TRIED, WAVES, SIZE = 3, 2, 0.5


def first_variables(search: ShootingProgram) -> Iterator[Array]:
    """Where searches start, until one of them meets the demands: at the guess, or at swinging controls where none was
    given and no change of zero meets the demands to first order.
    """
    z, wanted = search.guess(), search.wanted
    if wanted.guess or wanted.warm_start is not None or not search.m or not unmet(search, z).any():
        yield z
        return
    unit, _ = search.units
    angles = 2 * np.pi * np.linspace(0, 1, search.problem.nodes)[:, None] * np.arange(1, WAVES + 1)
    waves = np.concatenate([np.cos(angles), np.sin(angles)], axis=1)
    low, high = search.limits()
    for seed in range(TRIED):
        sizes = np.random.default_rng(seed).normal(size=(waves.shape[1], search.m))
        swinging = z.copy()
        swinging[: search.split] += SIZE * unit[: search.split] * (waves @ sizes).ravel()
        yield np.clip(swinging, low, high)


def unmet(search: ShootingProgram, z: Array) -> Array:
    """Which of the equations (rows,) no change of z meets to first order."""
    sizes = search.row_sizes
    residual, by = search.residual(z) / sizes, search.jacobian(z) * search.units[0] / sizes[:, None]
    change = np.linalg.lstsq(by, -residual, rcond=RANK)[0] if len(residual) else np.zeros(len(z))
    return np.asarray(np.abs(by @ change + residual) > MET * np.abs(residual).max(initial=0))
