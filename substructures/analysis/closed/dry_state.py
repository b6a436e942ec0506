"""A state with closures whose joints with friction slip or stick, in place of their smooth law; see dry_friction."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import Constrained, Equations, Singular
from substructures.analysis.closed.jacobian import Jacobian
from substructures.analysis.closed.pivoting import pivoted, singular_values
from substructures.analysis.closed.sticking_forces import RANK, holding, unit_rows
from substructures.analysis.motion.friction.dry_friction import FrictionLaws, Signs, friction_laws
from substructures.analysis.motion.friction.dry_rates import DryForces
from substructures.array import Array
from substructures.compile.motion import CompiledRates

#: a joint has no lever where it moves by less than this part of the motion
LEVER = 1e-6


class DryConstrained(Constrained):
    """A state whose joints with friction slip or stick as ``signs`` say, in place of their smooth law.

    ``friction`` (k,): the forces on the coordinates ``laws.places`` [N m, N], of those that stick as of the last
    :meth:`hold`, 0 before, and ``used``, the largest share of F_s in them.
    """

    laws: FrictionLaws
    signs: Signs

    def _arrays(self) -> None:
        super()._arrays()
        #: rows, and N as of them where s is
        self._ways: tuple[NDArray[np.int64], Array] | None = None
        self.all_laws = friction_laws(self.model, self.conditions.values)
        self.laws = _acting(self.all_laws, self.prescribed.index)
        k = len(self.laws.places)
        self.signs, self.used = np.ones(k, dtype=np.int64), 0.0
        self.friction, self._smooth, self._without = np.zeros(k), np.zeros(k), np.zeros(self.n)
        self._forces = DryForces(tuple(self.laws.places.tolist()), self.laws.numbers)

    def move(self, t: float, q: Array, qd: Array, *, jacobian: Jacobian | None = None) -> None:
        """Evaluate everything at a state; ``f`` is without what sticks."""
        super().move(t, q, qd, jacobian=jacobian)
        self._ways = None
        v = qd[self.laws.places]
        self._smooth = self.laws.smooth(v)
        self._without[:] = self.f
        self._without[self.laws.places] -= self._smooth
        self._take(-self.signs * self.laws.slipping(v))

    def compiled(self, chosen: Equations) -> CompiledRates | None:
        """As the signs are now."""
        rates = super().compiled(chosen)
        if rates is None or rates.saddle is None:
            return None
        call, forces, power = self._forces.taken(rates, self._out["forces"], self.signs)
        saddle = replace(rates.saddle, forces=forces[0], power=None if self.is_still else power)
        return replace(rates, calls=(*rates.calls, call), power=power, saddle=saddle)

    @property
    def lost_power(self) -> float:
        """As that of the formulas, with this friction in place of the smooth one [W]."""
        return super().lost_power + float((self.friction - self._smooth) @ self.qd[self.laws.places])

    def equations(self, rows: NDArray[np.int64]) -> Equations:
        """What sticks does not move, and takes its part of the rows, which are n - d, with it. Raises Singular."""
        stuck, B = self._stuck(rows)
        if not len(stuck):
            return super().equations(rows)
        moving = np.setdiff1d(np.arange(self.n), self.laws.places[stuck])
        # d - rank B ways are left to the n - k that move
        rank = len(rows) - len(stuck) + _rank(B)
        left = pivoted(self.balanced[rows][:, moving].T, rank)[:rank]
        return Equations(rows[np.sort(left)], moving)

    def hold(self, rows: NDArray[np.int64]) -> None:
        """The forces of what sticks. Raises Singular."""
        self.used = 0.0
        stuck, B = self._stuck(rows)
        if len(stuck):
            a = self.unheld(rows)[self.laws.places[stuck]]
            friction = self.friction.copy()
            friction[stuck], self.used = holding(B, a, self.laws.static[stuck])
            self._take(friction)

    def _stuck(self, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], Array]:
        """Which joints stick and have a lever, and their rows of N."""
        found = np.flatnonzero(self.signs == 0)
        if not len(found):
            return found, np.zeros((0, 0))
        B = self.basis(rows)[self.laws.places[found]]
        able = B.any(axis=1)
        return found[able], B[able]

    def unheld(self, rows: NDArray[np.int64]) -> Array:
        """q'' (n,) with the friction of the joints that slip alone. Raises Singular."""
        self._take(-self.signs * self.laws.slipping(self.qd[self.laws.places]))
        return self.solved(super().equations(rows))[0]

    def basis(self, rows: NDArray[np.int64]) -> Array:
        """N (n, d) with G N = 0 and N^T g N = 1; zero in the rows of coordinates without a lever. Raises Singular."""
        if self._ways is not None and np.array_equal(self._ways[0], rows):
            return self._ways[1]
        Z = np.eye(self.n)
        if len(rows):
            Z = np.linalg.svd(self.balanced[rows])[2][len(rows) :].T
        try:
            L = np.linalg.cholesky(Z.T @ self.g @ Z)
        except np.linalg.LinAlgError as error:
            raise Singular("the metric is not positive definite along the closures: check masses") from error
        N = np.asarray(np.linalg.solve(L, Z.T).T, dtype=np.float64)
        N[np.linalg.norm(Z, axis=1) <= LEVER] = 0.0
        self._ways = rows, N
        return N

    def _take(self, friction: Array) -> None:
        """These forces of friction (k,), and no others."""
        self.friction = friction
        self.f[:] = self._without
        self.f[self.laws.places] += friction


def _acting(laws: FrictionLaws, prescribed: Any) -> FrictionLaws:
    """Of coordinates that are not prescribed, where there is any friction."""
    kept = ~np.isin(laws.places, list(prescribed)) & ((laws.coulomb > 0) | (laws.static > 0))
    columns = {name: getattr(laws, name)[kept] for name in ("places", "coulomb", "static", "stribeck", "velocity")}
    return replace(laws, **columns)


def _rank(B: Array) -> int:
    """Of rows of any length."""
    values = singular_values(unit_rows(B)[0]) if len(B) else np.zeros(1)
    return int((values > RANK * values[0]).sum())
