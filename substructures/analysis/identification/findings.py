"""What excitation and identification find."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from substructures.analysis.verdict import Check, verdict
from substructures.array import Array

#: places of the ten parameters m, sx, sy, sz, Jxx, Jyy, Jzz, Jxy, Jxz, Jyz in P
PLACES = ((3, 3), (0, 3), (1, 3), (2, 3), (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
#: a scaled regressor of a larger condition number is badly excited
LIMIT = 1e3


@dataclass(frozen=True, repr=False)
class Excitation:
    """How well given motion excites the base parameters ``names`` (b).

    ``singular_values`` (b,) and ``condition`` of the stacked base regressor with columns of length one; ``rank``;
    ``weak``: those that take part in badly excited combinations (their share in singular vectors below the limit), the
    worst first; ``is_good``; ``advice``.
    """

    names: tuple[str, ...]
    singular_values: Array
    condition: float
    rank: int
    weak: tuple[str, ...]

    def __repr__(self) -> str:
        sizes = f"parameters={len(self.names)}, rank={self.rank}, condition={self.condition:.4g}"
        return f"Excitation({sizes})\n{self.advice or 'every base parameter is excited well'}"

    @property
    def is_good(self) -> bool:
        """Every base parameter is excited, and the condition number is moderate."""
        return self.rank == len(self.names) and self.condition <= LIMIT

    @property
    def advice(self) -> str:
        """What to change."""
        if self.is_good:
            return ""
        return "move more joints at a time, faster and farther, so that these parameters show: " + ", ".join(self.weak)


@dataclass(frozen=True, repr=False)
class Identification:
    """``values`` (b,) in ``units``, their ``deviations`` (b,) (standard) and ``covariance`` (b, b), ``residual`` (n,):
    root mean square of the force that is not explained, by joint [N m, N]; ``held_out`` (n,): the same of the samples
    that took no part, None without such; ``excitation``. ``status``: identified; failed where the motion does
    not excite all base parameters (``values`` is then the solution of least length). ``inertia``: of every body, where
    it was asked for, and ``parts``: by instance the definition of the next version with it. On closures ``residual``
    is of the ``independent`` coordinates (with velocity constraints along the allowed velocities nearest to theirs),
    and the parameters are ``combinations`` of those of the tree without them: coefficients by name."""

    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    deviations: Array
    covariance: Array
    residual: Array
    excitation: Excitation
    status: Literal["identified", "failed"]
    message: str
    checks: tuple[Check, ...] = ()
    held_out: Array | None = None
    inertia: ConsistentInertia | None = None
    parts: Mapping[str, Any] | None = None
    independent: tuple[str, ...] | None = None
    combinations: Mapping[str, Mapping[str, float]] | None = None

    @property
    def is_right(self) -> bool | None:
        """Whether forces are explained, and parameters known, as accurately as was asked for; None if failed."""
        return verdict(self.checks, self.status == "identified")

    def __repr__(self) -> str:
        worst = float(self.residual.max(initial=0))
        finding = f"failed: {self.message}" if self.status == "failed" else f"largest unexplained force {worst:.4g}"
        return f"Identification(parameters={len(self.names)}, joints={len(self.residual)})\n{finding}"


@dataclass(frozen=True, repr=False)
class ConsistentInertia:
    """``values`` (10 links,) in ``units`` by ``names``, those of the regressor; ``before``: what they were.

    ``least_eigenvalues`` (links,): of X, of each of the ``links``; ``held``: links that stay as they were, for they
    have no mass or are fixed to the interface of a host. ``misfit``: |R (G pi - beta)|^2/b, of 1 where the difference
    to the best base parameters is that of noise. Checks: every body is consistent, and the optimum is one.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    links: tuple[str, ...]
    values: Array
    before: Array
    least_eigenvalues: Array
    held: tuple[str, ...]
    misfit: float
    checks: tuple[Check, ...]

    @property
    def is_right(self) -> bool | None:
        """Whether all bodies are consistent, and the optimum is one."""
        return verdict(self.checks)

    def __repr__(self) -> str:
        return f"ConsistentInertia(links={len(self.links)})\nmisfit {self.misfit:.4g}, is_right={self.is_right}"

    def of(self, link: str) -> Array:
        """P of a link, (4, 4)."""
        return pseudo_inertia(self.values.reshape(-1, 10)[self.links.index(link)])


def pseudo_inertia(ten: Array) -> Array:
    """P (..., 4, 4) of m [kg], s [kg m], J [kg m^2] (..., 10)."""
    P = np.zeros((*ten.shape[:-1], 4, 4))
    for k, (i, j) in enumerate(PLACES):
        P[..., i, j] = P[..., j, i] = ten[..., k]
    return P
