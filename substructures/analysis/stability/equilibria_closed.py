"""The search for positions of rest with closures: -Q_a - lambda_k G_ka = 0 and phi_k = 0 for q and lambda together.

The Jacobian is [K -G^T; G 0] with K = -dQ/dq - lambda_k d2phi_k; where closures depend on each other the steps are of
least size.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import least_squares

from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.equations.formulas import multipliers_of
from substructures.analysis.motion.problem import Start
from substructures.analysis.stability.equilibrium_search import RESIDUAL, EquilibriaRequest, RestSearch
from substructures.array import Array
from substructures.tree.model import Model

#: of the search from one start
STEPS = 200
TOLERANCES = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)


class ClosedSearch(RestSearch):
    """Forces, closures and their Jacobians at rest, compiled."""

    def __init__(self, model: Model, read: EquilibriaRequest) -> None:
        super().__init__(model, read)
        start = Start([0.0] * model.dof, parameters=read.parameters, inputs=read.inputs)
        self.s = Constrained(model, start, (read.t, read.t))
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
        state = consistent_state(self.s, self.read.t, start, rest)
        if not state.found:
            self.open = state.message
            return None
        q, k = state.q.copy(), len(moving)
        self.multipliers[:] = 0
        F, K = self.at(q)
        scale = max(1.0, float(np.abs(K).max(initial=0)))

        def both(x: Array) -> tuple[Array, Array]:
            q[moving], self.multipliers[0] = x[:k], x[k:]
            F, K = self.at(q)
            G = self.G[0]
            J = np.block([[K[:, moving], -G.T], [scale * G[:, moving], np.zeros((len(G), len(G)))]])
            return np.concatenate((F, scale * self.phi[0])), J

        x = np.concatenate((q[moving], np.linalg.lstsq(self.G[0].T, F, rcond=1e-8)[0]))
        with np.errstate(all="ignore"):
            x = least_squares(lambda x: both(x)[0], x, lambda x: both(x)[1], max_nfev=STEPS, **TOLERANCES).x
        residual, J = both(x)
        if np.isfinite(residual).all() and np.isfinite(J).all():
            step = np.linalg.lstsq(J, -residual, rcond=1e-10)[0]
            residual, J = both(x + step if np.abs(step[:k]).max(initial=0) < 1e-3 else x)
        size = float(np.abs(self.K).max(initial=0))
        if not np.abs(residual).max(initial=0) <= RESIDUAL * max(scale, size):
            return None
        self.s.move(self.read.t, q, rest)
        return None if self.s.upside_down() else self._wound(q)

    def advice(self, q: Array, held: Sequence[int]) -> str:
        """Why there is none."""
        return self.open or super().advice(q, held)
