"""Onto the closures: consistent initial positions and velocities, and small corrections along a motion."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import Constrained
from substructures.array import Array
from substructures.mechanics.closure_rows import RANK

#: residuals over the width of their rows (see Constrained) that count as none
CLOSED = 1e-12
ITERATIONS = 200
#: longest step of the search [rad, m]
STRIDE = 0.5


@dataclass(frozen=True)
class Consistent:
    """Positions and velocities that meet all closures, or the nearest that were found and a message that says why.

    ``residual``, ``velocity_residual``: the largest that is left [m, 1; per s].
    """

    q: Array
    qd: Array
    residual: float
    velocity_residual: float
    iterations: int
    message: str = ""

    @property
    def found(self) -> bool:
        """Whether the closures are met."""
        return not self.message


def consistent_state(s: Constrained, t: float, q: Array, qd: Array, fixed: Collection[str] = ()) -> Consistent:
    """The nearest state that meets all closures at time t; the coordinates ``fixed`` keep position and velocity.

    Gauss-Newton steps of least mass-weighted size, dq = -W (G W)^+ phi with W = diag(g)^(-1/2), shortened until the
    residual falls; then velocities with G q' + phi_t = 0 by one such step. A failure is a value with advice.
    """
    free = np.array([a for a, name in enumerate(s.model.coordinates) if name not in fixed], dtype=np.int64)
    q, iterations = _close(s, t, q, free)
    s.move(t, q, qd)
    residual = _largest(s.phi)
    if not s.opening <= CLOSED * max(1.0, _largest(q)):
        return Consistent(q, qd, residual, _largest(s.velocity_residual), iterations, _open_message(s, fixed))
    # dq' = -W (G W)^+ (G q' + phi_t): linear, so that once is enough but for rounding
    qd = qd.copy()
    for _ in range(2):
        s.move(t, q, qd)
        qd[free] += _least(s, free, s.velocity_residual)
    s.move(t, q, qd)
    left = _largest(s.velocity_residual)
    message = _turned_message(s)
    if not message and not s.opening_rate <= CLOSED * max(1.0, _largest(qd)):
        message = _rate_message(s, fixed)
    return Consistent(q, qd, residual, left, iterations, message)


def _close(s: Constrained, t: float, q: Array, free: NDArray[np.int64]) -> tuple[Array, int]:
    """Positions, and the number of steps."""
    rest = np.zeros_like(q)
    s.move(t, q, rest)
    size = float(np.linalg.norm(s.phi / s.width))
    for k in range(ITERATIONS):
        if s.opening <= CLOSED / 100:
            return q, k
        step = _least(s, free, s.phi)
        # no longer than STRIDE, then halved until |phi| falls
        step *= min(1.0, STRIDE / max(_largest(step), STRIDE))
        for _ in range(30):
            trial = q.copy()
            trial[free] += step
            s.move(t, trial, rest)
            new = float(np.linalg.norm(s.phi / s.width))
            if new < size:
                break
            step = step / 2
        else:
            return q, k
        q, size = trial, new
    return q, ITERATIONS


def _least(s: Constrained, free: NDArray[np.int64], residual: Array) -> Array:
    """The least mass-weighted change of the free coordinates that takes the residual away to first order."""
    if not len(residual) or not len(free):
        return np.zeros(len(free))
    inertia = np.diag(s.g)[free]
    # dq = -W (G W)^+ phi, W = diag(g)^(-1/2)
    weight = 1 / np.sqrt(np.where(inertia > 0, inertia, 1.0))
    G, left = s.balanced[:, free], residual / s.reach
    # rows of G W, as long again as those of G: of small and large mechanisms side by side
    size, before = (np.linalg.norm(x, axis=1) for x in (G * weight, G))
    scale = np.divide(before, size, out=np.ones_like(size), where=size > 0)
    found = scipy.linalg.lstsq(
        G * weight * scale[:, None], -left * scale, cond=RANK, lapack_driver="gelsd", check_finite=False
    )
    return np.asarray(weight * found[0], dtype=np.float64)


def _largest(x: Array) -> float:
    return float(np.abs(x).max(initial=0))


def worst_label(s: Constrained, residual: Array) -> str:
    """The name of the closure (or prescribed coordinate) that is violated most."""
    return s.labels[int(np.abs(residual).argmax())]


def _open_message(s: Constrained, fixed: Collection[str]) -> str:
    k = int(np.abs(s.phi / s.width).argmax())
    advice = f"free one of the fixed coordinates ({', '.join(sorted(fixed))}), " if fixed else ""
    return (
        f"the closures cannot be met: the nearest position found leaves {s.labels[k]} open by {abs(s.phi[k]):.3g}; "
        f"{advice}begin closer to a closed position, or change the lengths"
    )


def _turned_message(s: Constrained) -> str:
    name = s.upside_down()
    advice = "begin closer to the wanted position, or turn one of its frames"
    return f"'{name}' is closed with axes in opposite directions, which it cannot hold: {advice}" if name else ""


def _rate_message(s: Constrained, fixed: Collection[str]) -> str:
    r = s.velocity_residual
    return (
        f"the given velocities cannot be met: {worst_label(s, r)} would open with {_largest(r):.3g} per second; free "
        f"one of the fixed coordinates ({', '.join(sorted(fixed)) or 'none is fixed'}), or begin away from a singular "
        "position"
    )


def project(
    s: Constrained, t: float, q: Array, qd: Array, rows: NDArray[np.int64], closed: Callable[[], float]
) -> tuple[Array, Array]:
    """The nearest state in the metric that meets the independent ``rows``; for states that nearly do, where s is.

    dq = -g^-1 G^T mu with G dq = -phi, repeated until residuals are below ``closed`` of where s is, at most CLOSED /
    100, or no longer halved, and one step of the same kind for the velocities; s stays at the result. Raises Singular.
    """
    factor = s.factor(rows)
    nothing, width, size = np.zeros(s.n), s.width[rows], np.inf
    for _ in range(8):
        before, size = size, _largest(s.phi[rows] / width)
        if (size <= CLOSED / 100 and size <= closed()) or before / 2 < size:
            break
        # g dq + G^T mu = 0, G dq = -phi
        q = q + factor.solve(nothing, -s.phi[rows])[0]
        s.move(t, q, qd)
        factor = s.factor(rows)
    # g dq' + G^T mu = 0, G dq' = -(G q' + phi_t)
    qd = qd + factor.solve(nothing, -s.velocity_residual[rows])[0]
    s.move(t, q, qd, jacobian=s.jacobian)
    return q, qd
