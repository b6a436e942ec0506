"""Two ways from the equations with closures to ordinary differential equations: projection and partitioning.

Both integrate accelerations from [g G^T; G 0] [q''; -lambda] = [Q - Gamma q'q'; -c] with a set of independent rows.

* Projected: the state is (q, q'); after every step it is moved onto the closures, in the metric.
* Partitioned: the state is (q, q') of the independent coordinates only; the others follow from the closures at every
  evaluation, by Newton's method. When the choice becomes ill conditioned, another one is taken (R. A. Wehage and
  E. J. Haug, ASME J. Mech. Design 104, 1982).
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import SINGULAR, Constrained, Equations, Singular
from substructures.analysis.closed.pivoting import pivoted, singular_values
from substructures.analysis.closed.projection import CLOSED, project
from substructures.array import Array
from substructures.compile.motion import CompiledRates
from substructures.mechanics.closure_rows import RANK

#: independent rows or coordinates are chosen anew when they are worse conditioned than this part of the best choice
WORN = 0.3
#: residuals over their width that are as small as rounding lets them be
ROUNDING = 1e-10
UNDETERMINED = "the independent coordinates do not determine the others: " + SINGULAR


class Reduction(ABC):
    """The vector y of the integrator for a state (q, q'); its last element is the work of lossy and driving forces.

    ``close``: a position is singular when the share of the smallest singular value in the largest one has fallen to
    this part of what it was at best along the motion.

    Residuals that count as none get smaller with the square of that part: a residual r leaves q uncertain by r / S and
    q' by q' r / S^2, S the smallest singular value.
    """

    close = 1e-4

    def __init__(self, s: Constrained, rank: int) -> None:
        self.s, self.n, self.rank = s, s.n, rank
        self.rows = s.independent_rows()
        self.equations = s.equations(self.rows)
        self.best_share = 0.0
        self.near = s.q.copy()

    @abstractmethod
    def pack(self, q: Array, qd: Array, work: float) -> Array:
        """y of a state."""

    @abstractmethod
    def unpack(self, t: float, y: Array) -> tuple[Array, Array]:
        """q, q' of y; s stays at this state. Raises Singular."""

    def expect(self, q: Array) -> None:
        """Where the next state will be, about: several may belong to the same y."""
        self.near = q

    @abstractmethod
    def rates(self, t: float, y: Array) -> Array:
        """y'. Raises Singular."""

    def __call__(self, t: float, y: Array) -> Array:
        """:meth:`rates`, as a function that integrators take. Raises Singular."""
        return self.rates(t, y)

    def compiled(self) -> CompiledRates | None:
        """The same in machine code; None where it is not."""
        return None

    @abstractmethod
    def choose(self, anew: bool = False) -> bool:
        """Look at the closures where s is: choose anew what has become ill conditioned; whether y changed its meaning.

        ``anew``: in any case. Raises Singular when the closures have lost rank.
        """

    def land(self, t: float, y: Array) -> tuple[Array, Array]:
        """The state of y (q, q'), on the closures; s stays there. Raises Singular."""
        return project(self.s, t, *self.unpack(t, y), self.rows, self._closed)

    def _closed(self) -> float:
        """Residuals over their width that count as none where s is."""
        part = min(1.0, self.s.share(self.rank) / self.best_share) if self.best_share else 1.0
        return part**2 * CLOSED / 100

    def is_singular(self) -> bool:
        """Whether s is at a singular position, or so near that it counts as one."""
        least = max(100 * RANK, self.close * self.best_share)
        return self.rank > 0 and not self.s.share(self.rank) > least

    def _acceleration(self) -> tuple[Array, float]:
        """q'' and the power of lossy forces, actuators of prescribed coordinates and moving closures, where s is."""
        s = self.s
        qdd, multipliers = s.solved(self.equations)
        # W' = (Q + dV/dq) q' + sum of lambda_k s'_k, and phi_t = -s'
        power = 0.0 if s.conservative else s.lost_power
        if not s.is_still:
            power -= float(multipliers @ s.phi_t[self.equations.rows])
        return qdd, power

    def _check_rank(self, anew: bool) -> None:
        """Rows that stay independent; all other rows depend on them."""
        if not self.rank:
            return
        share = self.s.share(self.rank)
        self.best_share = max(self.best_share, share)
        if self.is_singular():
            raise Singular(SINGULAR)
        if anew or self.s.jacobian.rows(self.rows).share(self.rank) < WORN * share:
            self.rows = np.sort(pivoted(self.s.balanced.T, self.rank)[: self.rank])


class Projected(Reduction):
    """y = (q, q', work)."""

    def compiled(self) -> CompiledRates | None:
        """The equations with multipliers and the rows that are chosen then."""
        return self.s.compiled(self.equations)

    def pack(self, q: Array, qd: Array, work: float) -> Array:
        """(q, q', work)."""
        return np.concatenate((q, qd, (work,)))

    def unpack(self, t: float, y: Array) -> tuple[Array, Array]:
        """As they are, beside the closures by the error of a step."""
        q, qd = y[: self.n], y[self.n : -1]
        self.s.move(t, q, qd)
        return q, qd

    def rates(self, t: float, y: Array) -> Array:
        """(q', q'', power). Raises Singular."""
        q, qd = y[: self.n], y[self.n : -1]
        self.s.move(t, q, qd)
        qdd, power = self._acceleration()
        result = np.empty(len(y))
        result[: self.n], result[self.n : -1], result[-1] = qd, qdd, power
        return result

    def choose(self, anew: bool = False) -> bool:
        """Rows only: y means the same whatever they are, but machine code reads as many as there were."""
        self._check_rank(anew)
        before, chosen = self.equations, self.s.equations(self.rows)
        if len(before.rows) == len(chosen.rows) and np.array_equal(before.moving, chosen.moving):
            before.rows[:] = chosen.rows
            return False
        self.equations = Equations(chosen.rows.copy(), chosen.moving)
        return True


class Partitioned(Reduction):
    """y = (q, q' of the independent coordinates, work); rounding in the others grows as singular values fall."""

    close = 1e-3

    def __init__(self, s: Constrained, rank: int) -> None:
        super().__init__(s, rank)
        self.best_pivots = 0.0
        self._partition()

    def _partition(self) -> None:
        order = pivoted(self.s.balanced[self.rows], self.rank)
        self.dependent, self.independent = np.sort(order[: self.rank]), np.sort(order[self.rank :])
        # where G_x and G_y are in G, and what their rows are over
        self._x, self._y = (self.rows[:, None] * self.n + some for some in (self.dependent, self.independent))
        self._reach, self._width = self.s.reach[self.rows], self.s.width[self.rows]
        self.best = self._condition()

    def _condition(self) -> float:
        """Smallest singular value of the columns of the dependent coordinates over that of all columns, 0 to 1.

        The condition of those columns alone says nothing: of one column it is 1 wherever that goes through zero.
        """
        if not self.rank:
            return 1.0
        G = self.s.balanced[self.rows]
        return float(singular_values(G[:, self.dependent])[-1] / singular_values(G)[-1])

    def pack(self, q: Array, qd: Array, work: float) -> Array:
        """(y, y', work) of the independent coordinates."""
        self.near = q.copy()
        return np.concatenate((q[self.independent], qd[self.independent], (work,)))

    def unpack(self, t: float, y: Array) -> tuple[Array, Array]:
        """On the closures near :meth:`expect`, by Newton's method. Raises Singular."""
        s, k = self.s, len(self.independent)
        q, qd = self.near.copy(), np.zeros(self.n)
        q[self.independent], qd[self.independent] = y[:k], y[k:-1]
        size = np.inf
        for _ in range(20):
            s.move(t, q, qd)
            residual, before = s.phi.take(self.rows), size
            size = float(np.abs(residual / self._width).max(initial=0))
            factor = self._factor()
            if (size <= CLOSED / 10 and size <= self._part(factor) ** 2 * CLOSED / 10) or before / 2 < size <= ROUNDING:
                break
            # Newton: G_x dx = -phi for the dependent coordinates x
            q[self.dependent] -= self._solve(factor, residual)
        else:
            raise Singular("the dependent coordinates cannot be found: " + SINGULAR)
        # G_x x' = -(G_y y' + phi_t)
        opening = s.G.take(self._y) @ y[k:-1] + s.phi_t.take(self.rows)
        qd[self.dependent] = -self._solve(factor, opening)
        self.near = q
        s.move(t, q, qd)
        return q, qd

    def _factor(self) -> tuple[Array, NDArray[np.int32]]:
        """L U of the balanced columns G_d of the dependent coordinates, and the order of its rows."""
        if not self.rank:
            return np.ones((0, 0)), np.zeros(0, dtype=np.int32)
        lu, order, info = scipy.linalg.lapack.dgetrf(self.s.G.take(self._x) / self._reach[:, None])
        if info:
            raise Singular(UNDETERMINED)
        return lu, order

    def _part(self, factor: tuple[Array, NDArray[np.int32]]) -> float:
        """The smallest pivot over the largest, here or elsewhere, as a part of the best along the motion."""
        if not self.rank:
            return 1.0
        pivots = np.abs(factor[0].diagonal())
        share = float(pivots.min() / max(pivots.max(), 1.0))
        self.best_pivots = max(self.best_pivots, share)
        return share / self.best_pivots

    def _solve(self, factor: tuple[Array, NDArray[np.int32]], b: Array) -> Array:
        """x with G_d x = b. Raises Singular."""
        if not self.rank:
            return b
        x, _ = scipy.linalg.lapack.dgetrs(*factor, b / self._reach)
        if not np.isfinite(x).all():
            raise Singular(UNDETERMINED)
        return np.asarray(x, dtype=np.float64)

    def rates(self, t: float, y: Array) -> Array:
        """(y', y'', power) of the independent coordinates. Raises Singular."""
        _, qd = self.unpack(t, y)
        qdd, power = self._acceleration()
        return np.concatenate((qd[self.independent], qdd[self.independent], (power,)))

    def choose(self, anew: bool = False) -> bool:
        """Rows and independent coordinates, when the dependent ones have become ill conditioned."""
        before = self.rows
        self._check_rank(anew)
        self.equations = self.s.equations(self.rows)
        if not anew and self._condition() >= WORN * self.best and before is self.rows:
            return False
        self._partition()
        return True


REDUCTIONS: dict[str, type[Reduction]] = {"projection": Projected, "partitioning": Partitioned}
