"""The search for positions of rest on closures: -Q_a - lambda_k G_ka = 0 and phi_k = 0 for q and lambda together.

The Jacobian is [K -G^T; G 0] with K = -dQ/dq - lambda_k d2phi_k; where closures depend on each other the steps are of
least size. Every phi_k counts over its width, and every lambda_k over what it is for forces of one unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import scipy

from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.equations.formulas import multipliers_of
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.stability.equilibrium_search import RESIDUAL, STEPS, TOLERANCES, RestSearch, SearchRange
from substructures.analysis.stability.operating_point import RestConditions
from substructures.array import Array
from substructures.mechanics.closure_rows import RANK
from substructures.tree.model import Model


class ClosedSearch(RestSearch):
    """Forces, closures and their Jacobians at rest, compiled."""

    def __init__(self, model: Model, within: SearchRange, conditions: RestConditions) -> None:
        super().__init__(model, within, conditions)
        start = Start([0.0] * model.dof, parameters=conditions.parameters, inputs=conditions.inputs)
        self.s = Constrained(model, start, (conditions.t, conditions.t))
        self.open = ""

    def _also(self) -> tuple[dict[str, Array], list[tuple[list[str], Array]]]:
        names = multipliers_of(self.model)
        m, n = len(names), self.model.dof
        self.multipliers, self.phi, self.G = np.ones((1, m)), np.zeros((1, m)), np.zeros((1, m, n))
        return {"closure.residual": self.phi, "closure.jacobian": self.G}, [(list(names), self.multipliers)]

    def _judged(self, q: Array) -> Array:
        return np.concatenate((self.at(q)[0], self.phi[0]))

    def _slopes(self, q: Array) -> Array:
        return np.concatenate((self.at(q)[1], self.G[0]))

    def solve(self, start: Array, moving: Sequence[int]) -> Array | None:
        """A closed equilibrium near a start; None when there is none in reach."""
        rest = np.zeros(len(start))
        state = consistent_state(self.s, self.conditions.t, start, rest)
        if not state.found:
            self.open = state.message
            return None
        q, k = state.q.copy(), len(moving)
        self.multipliers[:] = 0
        F, _ = self.at(q)
        length = np.append(self.length[moving], np.ones(len(self.s.width)))
        # multipliers over what they are for forces of one unit
        force = multiplier_units(self.G[0], self.s.reach, self.unit)
        both = partial(self._with_multipliers, q, moving, force)
        # lambda_0 of least squares: G^T lambda = -Q
        x = np.append(q[moving], np.linalg.lstsq((self.G[0] * force[:, None] / self.unit).T, F, rcond=1e-8)[0])
        with np.errstate(all="ignore"):
            x = scipy.optimize.least_squares(
                lambda x: both(x)[0], x, lambda x: both(x)[1], max_nfev=STEPS, x_scale=length, **TOLERANCES
            ).x
        residual, J = both(x)
        if np.isfinite(residual).all() and np.isfinite(J).all():
            step = np.linalg.lstsq(J * length, -residual, rcond=1e-10)[0]
            residual, J = both(x + step * length if np.abs(step[:k]).max(initial=0) < 1e-3 else x)
        if not is_met(residual, J[: self.n, :k] * length[:k]):
            return None
        self.s.move(self.conditions.t, q, rest)
        return None if self.s.upside_down() else self.wound(q)

    def _with_multipliers(self, q: Array, moving: Sequence[int], force: Array, x: Array) -> tuple[Array, Array]:
        """Residuals and their Jacobian at free coordinates and multipliers ``x``, the latter over ``force``; the
        coordinates are put into ``q``.
        """
        q[moving], self.multipliers[0] = x[: len(moving)], force * x[len(moving) :]
        F, K = self.at(q)
        G, width = self.G[0], self.s.width
        # F = -Q - lambda G and phi, by q and lambda
        K = np.where(np.isfinite(K), K, 0)
        J = np.block(
            [
                [K[:, moving], -(G * force[:, None] / self.unit).T],
                [G[:, moving] / width[:, None], np.zeros((len(G), len(G)))],
            ]
        )
        return np.concatenate((F, self.phi[0] / width)), J

    def advice(self, q: Array, held: Sequence[int]) -> str:
        """Why there is none."""
        return self.open or super().advice(q, held)


def is_met(residual: Array, K: Array) -> bool:
    """Whether forces, each beside what a unit displacement causes there (n, k), and openings, all over their units, are
    none.
    """
    forces, openings = np.abs(residual[: len(K)]), np.abs(residual[len(K) :])
    sizes = np.maximum(1.0, np.abs(K).max(axis=1, initial=0))
    return bool((forces <= RESIDUAL * sizes).all() and openings.max(initial=0) <= RESIDUAL)


def multiplier_units(G: Array, reach: Array, unit: Array) -> Array:
    """Multipliers (m,) of rows of G (m, n) that cause forces of about one ``unit`` (n,); those of rows that are nothing
    beside their ``reach`` (m,) cause none.
    """
    sizes = (np.abs(G) / unit).max(axis=1, initial=0)
    there = np.linalg.norm(G, axis=1) > RANK * reach
    nothing = reach / float(unit.min(initial=np.inf)) if len(unit) else reach
    return np.asarray(1 / np.where(there, sizes, nothing), dtype=np.float64)
