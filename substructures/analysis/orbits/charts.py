"""Coordinates of the neighbours of a state: as many as it has, and where it is on a surface as that has.

Ball joints: displacements and rotation vectors in the axes of bodies, as rates are, for quaternions of length 1.
Closures phi(q) = 0 with the rows G: of q = (independent, dependent) the first are free, G_d dq_d = -G_i dq_i.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import scipy

from substructures.analysis.equations.nonholonomic.positions import at_rest, closed_positions, closure_rows
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.analysis.motion.conditions import state_names
from substructures.array import Array
from substructures.quantities.numbers.quaternions import by_displacements, moved_on, quaternions_in
from substructures.tree.model import Model


class Chart:
    """Of states x (size,) that are all there are: ``names`` of the coordinates d (width,) of their changes; ``free``:
    which coordinates these are of states (q, v), none of others.
    """

    free: Sequence[int] = ()
    #: whether the numbers of a state are coordinates and velocities, and have any values
    is_flat = True

    def __init__(self, names: tuple[str, ...], size: int) -> None:
        self.names, self.width, self.size = names, len(names), size

    def ways(self, _x: Array) -> Array:
        """The change of x (size,) with each coordinate, as rows (width, size)."""
        return np.eye(self.size)

    def along(self, _x: Array) -> Array:
        """The coordinates of the changes of all numbers of x, (width, size)."""
        return np.eye(self.size)

    def surface(self, x: Array) -> tuple[Array, Array]:
        """What all states keep at zero (size - width,), and its derivatives by x."""
        return np.zeros(0), np.zeros((0, len(x)))

    def moved(self, x: Array, d: Array) -> Array:
        """The state at d."""
        return x + d

    def difference(self, x: Array, y: Array) -> Array:
        """y - x (size,)."""
        return y - x


class BallChart(Chart):
    """Of states with ball joints (q, v)."""

    is_flat = False

    def __init__(self, model: Model) -> None:
        rates = [f"{name}'" for name in model.coordinates]
        super().__init__((*model.coordinates, *rates), len(model.positions) + model.dof)
        self.model, self.m, self.n = model, len(model.positions), model.dof
        self.quaternions = quaternions_in(model.positions, model.balls)

    def _displaced(self, x: Array) -> Array:
        return by_displacements(self.model.positions, self.model.coordinates, self.model.balls, x[: self.m])

    def ways(self, x: Array) -> Array:
        """Rows (2n, m + n)."""
        found = scipy.linalg.block_diag(np.linalg.pinv(self._displaced(x)).T, np.eye(self.n))
        return np.asarray(found, dtype=np.float64)

    def along(self, x: Array) -> Array:
        """(2n, m + n)."""
        return np.asarray(scipy.linalg.block_diag(self._displaced(x), np.eye(self.n)), dtype=np.float64)

    def surface(self, x: Array) -> tuple[Array, Array]:
        """(|Q|^2 - 1)/2 of all quaternions."""
        rows = np.zeros((len(self.quaternions), self.size))
        for row, some in zip(rows, self.quaternions, strict=True):
            row[some] = x[some]
        return (rows @ x - 1) / 2, rows

    def moved(self, x: Array, d: Array) -> Array:
        """The state at d, with quaternions of length 1."""
        states = self.model.positions, self.model.coordinates, self.model.balls
        q = moved_on(*states, x[: self.m], d[: self.n])
        for some in self.quaternions:
            q[some] /= np.linalg.norm(q[some])
        return np.concatenate((q, x[self.m :] + d[self.n :]))

    def difference(self, x: Array, y: Array) -> Array:
        """y - x, of both quaternions that turn alike the one that is nearer."""
        found = y - x
        for some in self.quaternions:
            if x[some] @ y[some] < 0:
                found[some] = -y[some] - x[some]
        return found


class ClosedChart(Chart):
    """Of states (q, v) on closures, which leave the coordinates ``free``: all of them with velocity constraints."""

    is_flat = False

    def __init__(self, equations: QuasiVelocities, values: Mapping[str, Any], q: Array) -> None:
        self.equations, self.values, self.n = equations, values, len(q)
        self.rows, p = closure_rows(equations), len(equations.velocities)
        G = self._rows(q)
        held = scipy.linalg.qr(G, pivoting=True, mode="r")[1][: len(self.rows)] if len(G) else np.zeros(0, dtype=int)
        self.held = sorted(int(k) for k in held)
        self.free = [a for a in range(self.n) if a not in self.held]
        names = (equations.model.coordinates[a] for a in self.free)
        super().__init__((*names, *equations.velocities), self.n + p)

    def _rows(self, q: Array) -> Array:
        """G (h, n)."""
        found = at_rest(self.equations, self.values, q[None], ["constraints"])["constraints"][0]
        return np.asarray(found[self.rows], dtype=np.float64)

    def ways(self, x: Array) -> Array:
        """Rows (n - h + p, n + p)."""
        G, moved = self._rows(x[: self.n]), np.zeros((len(self.free), self.n))
        moved[:, self.free] = np.eye(len(self.free))
        if self.held:
            moved[:, self.held] = -np.linalg.solve(G[:, self.held], G[:, self.free]).T
        return np.asarray(scipy.linalg.block_diag(moved, np.eye(self.size - self.n)), dtype=np.float64)

    def along(self, _x: Array) -> Array:
        """(n - h + p, n + p)."""
        return np.eye(self.size)[[*self.free, *range(self.n, self.size)]]

    def surface(self, x: Array) -> tuple[Array, Array]:
        """The residuals of the closures, those rows that are independent."""
        if not self.rows:
            return super().surface(x)
        q, constraints = x[: self.n], self.equations.constraints
        gaps = [self.equations.gaps.index(constraints[k]) for k in self.rows]
        found = at_rest(self.equations, self.values, q[None], ["gaps"])["gaps"][0]
        return found[gaps], np.hstack((self._rows(q), np.zeros((len(gaps), self.size - self.n))))

    def moved(self, x: Array, d: Array) -> Array:
        """The state at d, on the closures."""
        y = x + d @ self.ways(x)
        y[: self.n] = closed_positions(self.equations, self.values, y[None, : self.n], self.free)[0]
        return y


def chart_of(model: Model, equations: QuasiVelocities | None, values: Mapping[str, Any], q: Array) -> Chart:
    """That of a tree at a state q; ``equations``: in quasi-velocities, of one with closures or velocity constraints."""
    if equations is not None:
        return ClosedChart(equations, values, q)
    names = tuple(state_names(model))
    return BallChart(model) if model.balls else Chart(names, len(names))
