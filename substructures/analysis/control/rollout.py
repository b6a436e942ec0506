"""Motions under controls, and derivatives of numbers that they end in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from substructures.array import Array


@dataclass(frozen=True)
class Rollout:
    """All segments S after J steps each. ``stages`` (J, 4, S, 2 n), with ball joints (J, 4, S, m + n): states inside
    the steps, ``accelerations`` (J, 4, S, n), ``metrics`` (J, 4, S, n, n), independent rows ``held`` of closures (J, 4,
    S, r, n) and the ``multipliers`` of all of them (J, 4, S, k) there; ``end`` (S, 2 n); ``cost``: integral of l, plus
    phi at the last end.
    """

    controls: Array
    stages: Array
    accelerations: Array
    metrics: Array
    held: Array
    multipliers: Array
    end: Array
    cost: float

    @property
    def states(self) -> Array:
        """(q, q') before every step and at the last end, (S J + 1, 2 n)."""
        inner = self.stages[:, 0].swapaxes(0, 1)
        return np.concatenate([inner.reshape(-1, inner.shape[-1]), self.end[-1:]])


@dataclass(frozen=True)
class Slope:
    """Derivatives of W numbers: by the ``start`` of each segment (W, S, 2 n), the ``controls`` (W, nodes, m) and what
    is varied, ``parameters`` (W, r), which are the sum of those of all segments, ``shares`` (W, S, r); ``costates``
    (W, J + 1, S, 2 n) before every step and at the ends; ``parts`` (W, S, intervals/S + 1, m): what each segment adds
    to the derivatives by its nodes."""

    start: Array
    controls: Array
    parts: Array
    shares: Array
    costates: Array

    @property
    def parameters(self) -> Array:
        """By what is varied, (W, r)."""
        return self.shares.sum(axis=1)
