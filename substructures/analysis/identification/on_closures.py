"""Identification of trees with closures: what actuators do along the velocities that closures leave free.

Reactions of closures do no work along q' = N v with G N = 0. Of the n equations of the tree r = n - rank G are left,

    N^T Y_B(q, q', q'') beta = N^T tau        N = 1 in the rows of the independent coordinates

and on motions that the closures allow more columns depend on each other than elsewhere. With an independent set of
them, as far left as possible, N^T Y_B beta = (N^T Y_B)_1 (beta_1 + C beta_2), where C is found in numbers, at random
closed states (M. Gautier, Numerical calculation of the base inertial parameters of robots, Journal of Robotic Systems
8(4), 1991; W. Khalil and S. Guegan, Inverse and direct dynamic modeling of Gough-Stewart robots, IEEE Transactions on
Robotics 20(4), 2004).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.loops import independent_coordinates
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.identification.base_parameters import BaseParameters
from substructures.analysis.motion.problems.start import Start
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret_in_blocks
from substructures.mechanics.accelerations import CLOSED
from substructures.quantities.numbers.defaults import default_numbers
from substructures.tree.model import Model

#: relative part of a column that others do not explain and that counts as zero, of coefficients as well
DEPENDENT = 1e-8
#: closed states are drawn this far from measured ones [rad, or m over the largest of its coordinate]
SPREAD = 1.0
#: draws for each closed state, and draws after which none was closed
TRIES, VAIN = 5, 40
#: coefficient of an open base parameter by its name, by the name of a closed one
Combinations = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class Loops:
    """Closures beside a motion: the ``independent`` coordinates, and which base parameters (``kept``) stand for all,
    beta_1 + C beta_2 = ``regrouping`` (k, b) beta.
    """

    model: Model
    values: Mapping[str, Any]
    independent: tuple[str, ...]
    kept: tuple[int, ...]
    regrouping: Array

    @classmethod
    def of(cls, model: Model, base: BaseParameters, q: Array, parameters: Mapping[str, Any]) -> Loops:
        """Near measured positions q (N, n), as many random closed ones as tell the dependencies.

        Raises InvalidArgument (``/q``: ``open-closure``) where the loops cannot be closed there.
        """
        # masses need no value: what they weigh only tells which closed position is the nearest
        needed = {symbol.name for symbol in model.program.select(CLOSED).symbols}
        values = dict.fromkeys((name for name in model.parameters if name not in needed), 1.0)
        values |= {**default_numbers(model.parameters), **parameters}
        s = Constrained(model, Start(q[0], None, values, {}), (0.0, 0.0))
        states = _closed(s, q, 8 + 3 * base.count)
        s.move(0.0, states[0], np.zeros(s.n))
        named = model.reduction.independent if model.reduction else ()
        independent = named or tuple(model.coordinates[a] for a in independent_coordinates(s.balanced))
        return cls(model, values, independent, (), np.zeros((0, base.count))).told(base, states)

    def told(self, base: BaseParameters, states: Array) -> Loops:
        """With what random motions at positions (N, n) tell of the parameters."""
        W = self.tangential(self.tangents(states), self.regressor(base, states))
        kept, regrouping = _dependencies(W.reshape(-1, base.count))
        return replace(self, kept=kept, regrouping=regrouping)

    def tangents(self, q: Array) -> Array:
        """N (N, n, r) at positions (N, n): dq = N dy of the independent coordinates y."""
        n, chosen = q.shape[1], [self.model.coordinates.index(name) for name in self.independent]
        others = [a for a in range(n) if a not in chosen]
        G = self._outputs(q, np.zeros_like(q), "closure.jacobian")["closure.jacobian"]
        result = np.zeros((len(q), n, len(chosen)))
        result[:, chosen] = np.eye(len(chosen))
        # G_d N_d = -G_i, by least squares: rows may depend on each other
        result[:, others] = -np.linalg.pinv(G[:, :, others]) @ G[:, :, chosen]
        return result

    def regressor(self, base: BaseParameters, q: Array) -> Array:
        """Y_B (N, n, b) at positions with random velocities and accelerations that the closures allow."""
        values = {**self.values, **self._columns(q, *self.moving(q))}
        return interpret_in_blocks(base.program, values, ["base_regressor"], len(q))["base_regressor"]

    def moving(self, q: Array) -> tuple[Array, Array]:
        """These velocities and accelerations, (N, n) each."""
        rng, N = np.random.default_rng(7), self.tangents(q)
        qd, way = (np.einsum("nar,nr->na", N, rng.uniform(-1, 1, N[:, 0].shape)) for _ in range(2))
        found = self._outputs(q, qd, "closure.jacobian", "closure.acceleration")
        # G q'' = -c
        short = np.einsum("nak,nk->na", np.linalg.pinv(found["closure.jacobian"]), found["closure.acceleration"])
        return qd, way - short

    def tangential(self, N: Array, rows: Array) -> Array:
        """N^T of rows (N, n, ...)."""
        return np.einsum("nar,na...->nr...", N, rows)

    def reduced(self, base: BaseParameters, q: Array, W: Array, tau: Array | None) -> tuple[BaseParameters, Array, Any]:
        """Base parameters that closed motions tell, their regressor (N, r, k), and the forces (N, r)."""
        N = self.tangents(q)
        names = replace(base, base=tuple(base.base[i] for i in self.kept))
        return names, self.tangential(N, W[..., list(self.kept)]), None if tau is None else self.tangential(N, tau)

    def combinations(self, base: BaseParameters) -> Combinations:
        """What each of them is made of, in base parameters of the tree without closures."""
        return {
            base.names[i]: {base.names[j]: float(c) for j, c in enumerate(row) if c}
            for i, row in zip(self.kept, self.regrouping, strict=True)
        }

    def _outputs(self, q: Array, qd: Array, *names: str) -> dict[str, Array]:
        return interpret_in_blocks(self.model.program, {**self.values, **self._columns(q, qd)}, names, len(q))

    def _columns(self, *states: Array) -> dict[str, Any]:
        """Values of all symbols of a state: q, q' and q'', as many as there are."""
        names = self.model.coordinates
        moving = {
            f"{name}{primes}": x[:, a]
            for primes, x in zip(("", "'", "''"), states, strict=False)
            for a, name in enumerate(names)
        }
        return {**dict.fromkeys(self.model.input_names, 0.0), "t": 0.0, **moving}


def _closed(s: Constrained, q: Array, count: int) -> Array:
    """Closed positions (count, n) near those that were measured."""
    rng, found = np.random.default_rng(5), list[Array]()
    turns = np.array([joint == "R" for joint in s.model.joints])
    size = np.where(turns, SPREAD, SPREAD * np.abs(q).max(axis=0))
    for k in range(TRIES * count):
        place = q[k % len(q)] + size * rng.uniform(-1, 1, s.n) * (k > 0)
        state = consistent_state(s, 0.0, place, np.zeros(s.n))
        if state.found:
            found.append(state.q)
        if len(found) == count:
            return np.array(found)
        if k == VAIN and not found:
            break
    message = f"of {k + 1} positions near the measured ones {len(found)} could be closed, {count} are needed"
    raise InvalidArgument.at("/q", "open-closure", f"{message}: measured positions have to meet the closures")


def _dependencies(W: Array) -> tuple[tuple[int, ...], Array]:
    """Independent columns (k) of W, as far left as possible, and [1 C] (k, b) with W = W_1 [1 C]."""
    size = np.linalg.norm(W, axis=0)
    kept, basis = list[int](), np.zeros((len(W), 0))
    for j in np.flatnonzero(size > DEPENDENT * size.max(initial=0)).tolist():
        left = W[:, j] / size[j]
        for _ in range(2):  # twice is enough (W. Kahan)
            left = left - basis @ (basis.T @ left)
        if np.linalg.norm(left) > DEPENDENT:
            kept.append(j)
            basis = np.column_stack([basis, left / np.linalg.norm(left)])
    scaled = W / np.where(size > 0, size, 1.0)
    C = np.linalg.lstsq(scaled[:, kept], scaled, rcond=None)[0]
    C[np.abs(C) < DEPENDENT] = 0.0
    C[:, kept] = np.eye(len(kept))
    # W_j = sum_i W_i C_ij |W_j|/|W_i|
    return tuple(kept), C * size / size[kept][:, None]
