"""Forces of closed contacts, of which independent rows decide.

Contacts that are closed, and directions in which they stick, have rows J q'' = -c, and forces x along the columns of
F = (G_N - mu d . G_T)^T, G_T^T. Where rows depend on each other many x hold them; taken are those of contacts that
yield by D x, D = A_NN of each alone, less and less. What they yield is a motion of the mechanism, and so is S J_r^T y:

    g q'' = g q''_free + F x,    D x = J S J_r^T y,    J_r q'' = -c_r

with as many independent rows J_r as there are. S = diag(1 / g_aa) changes y alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.analysis.motion.contacts.pivoting import JAMMED
from substructures.array import Array
from substructures.compile.motion import Pressing

#: rows that add less than this part of their length, in the metric, depend on others
DEPENDENT = 1e-7
#: of the sizes of accelerations: what a row is not kept by that depends on others
KEPT = 1e-10
#: most steps to ways of slips that begin, none longer than this [rad], and the last one, of which the square is left
STEPS, FAR, FOUND = 30, 1.0, 1e-7
#: for differences [rad]
BESIDE = 1e-7


@dataclass(frozen=True)
class Rows:
    """``held`` (m,): which of the 3 k velocities stay as they are, by contact; ``kept`` (r,): independent ones;
    ``inverse`` (m,) = 1/D and ``scales`` (n,) = S; no 1/D where no row depends on others.
    """

    held: NDArray[np.int64]
    kept: NDArray[np.int64]
    inverse: Array
    scales: Array

    def pressing(self, rate: Array, velocities: Array, laws: Array) -> Pressing:
        """The same in machine code. ``rate`` G_0 (3 k,); ``laws`` (k, 4): mu, v_0 where ways turn, and ways."""
        n, m, r = len(velocities), len(self.inverse), len(self.kept)
        written = np.zeros((len(rate), n)), np.zeros((m, r)), np.zeros((r, n)), np.zeros(r)
        return Pressing(rate, velocities, laws, self.held[:m], self.inverse, self.scales, *written)

    def forces(self, made: Pressing, force: Array) -> None:
        """x into ``force`` (k, 3), as machine code has found it."""
        force[:] = 0.0
        force.reshape(-1)[self.held] = made.shares @ made.pressed if len(self.inverse) else made.pressed


NO_ROWS = Rows(np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0))


def independent(g: Array, G: Array, holds: NDArray[np.bool_], yields: Array) -> Rows:
    """Of rows G (k, 3, n) those that hold, by ``holds`` (k, 3); ``yields`` (k,): D. Raises LinAlgError."""
    held = np.flatnonzero(holds)
    if not len(held):
        return NO_ROWS
    pivots, order = _pivots(g, G, held)
    rank = int((pivots > DEPENDENT).sum())
    kept = held[np.sort(order[:rank])]
    inverse = 1 / yields[held // 3] if rank < len(held) else np.zeros(0)
    return Rows(held, kept, inverse, 1 / np.diagonal(g))


def _pivots(g: Array, G: Array, held: NDArray[np.int64]) -> tuple[Array, NDArray[np.int64]]:
    """What rows add to those before, as parts of their lengths in the metric, and in which order."""
    rows = np.linalg.solve(np.linalg.cholesky(g), G.reshape(-1, len(g))[held].T)
    R, order = scipy.linalg.qr(rows / np.maximum(np.linalg.norm(rows, axis=0), 1e-300), mode="r", pivoting=True)
    return np.abs(np.diagonal(R)), order


def parted(rows: Rows, g: Array, G: Array, bias: Array, second: Array) -> float:
    """How far rows that depended on others are from that, as :data:`DEPENDENT` is, where q'' = ``second`` (n,) of the
    independent ones does not keep them; 0 where it does.
    """
    if not len(rows.inverse):
        return 0.0
    J, c, rank = G.reshape(-1, len(g))[rows.held], bias.reshape(-1)[rows.held], len(rows.kept)
    if np.abs(J @ second + c).max() <= KEPT * (np.abs(J) @ np.abs(second) + np.abs(c)).max():
        return 0.0
    pivots, _ = _pivots(g, G, rows.held)
    return float(pivots[rank]) if rank < len(pivots) else 0.0


class Pressed(NamedTuple):
    """q'' (n,), the sum of the ``size`` of its parts (n,), and the forces x (k, 3)."""

    second: Array
    size: Array
    force: Array


def pressed(g: Array, G: Array, bias: Array, rows: Rows, free: Array, F: Array) -> Pressed:
    """Of contacts with rows G (k, 3, n) and ``bias`` c (k, 3); ``free`` (n,): q'' without them; ``F`` (k, 3, n).

    Raises ArithmeticError where no forces hold them.
    """
    n = len(g)
    J, F, c = G.reshape(-1, n), F.reshape(-1, n), bias.reshape(-1)
    kept = J[rows.kept]
    if len(rows.inverse):
        shares = rows.inverse[:, None] * (J[rows.held] @ (kept * rows.scales).T)
        columns = F[rows.held].T @ shares
    else:
        columns = F[rows.kept].T
    try:
        W = np.linalg.solve(g, columns)
        y = np.linalg.solve(kept @ W, -(kept @ free + c[rows.kept]))
    except np.linalg.LinAlgError as error:
        raise ArithmeticError(JAMMED) from error
    x = np.zeros(len(J))
    x[rows.held] = shares @ y if len(rows.inverse) else y

    return Pressed(free + W @ y, np.abs(free) + np.abs(W) @ np.abs(y), x.reshape(-1, 3))


def turn(ways: Array, begin: NDArray[np.bool_], G: Array, bias: Array, second: Callable[[], Array]) -> None:
    """Turn those ``ways`` d (k, 2) of slips that ``begin`` (k,) along their accelerations w, d x w = 0, by Newton's
    method. ``second``: q'' (n,) with ways as they are, with G (k, 3, n) and ``bias`` (k, 3); asked with the last ones
    last.

    A slip from rest in two directions has no way of its own: its velocity follows its acceleration, and friction, which
    is against that, decides this at once. Raises ArithmeticError.
    """

    def across(d: Array) -> Array:
        """d x w (s,)."""
        ways[begin] = d
        qdd = second()
        w = G[begin, 1:] @ qdd + bias[begin, 1:]
        return np.asarray(d[:, 0] * w[:, 1] - d[:, 1] * w[:, 0])

    if not begin.any():
        second()
        return
    d = ways[begin]
    left = across(d)
    for _ in range(STEPS):
        slopes = np.column_stack([(across(_turned(d, BESIDE * each)) - left) / BESIDE for each in np.eye(len(d))])
        try:
            step = np.clip(np.linalg.solve(slopes, -left), -FAR, FAR)
        except np.linalg.LinAlgError as error:
            raise ArithmeticError(JAMMED) from error
        d = _turned(d, step)
        left = across(d)
        if np.abs(step).max() <= FOUND:
            break


def _turned(d: Array, step: Array) -> Array:
    """By angles (s,)."""
    c, s = np.cos(step), np.sin(step)
    return np.column_stack((c * d[:, 0] - s * d[:, 1], s * d[:, 0] + c * d[:, 1]))
