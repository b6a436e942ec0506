"""Dry friction that sticks exactly in motions with closures and prescribed coordinates.

As :mod:`substructures.analysis.motion.friction.dry_friction`, on the velocities that the closures leave: with a basis N
of them, G N = 0 and N^T g N = 1, and B = N in the rows of the joints with friction, B B^T are the accelerations of
these joints by unit forces on them, and a what they have by all else:

    joints that stick: B B^T f = -a        Gauss: least 1/2 |B^T f|^2 + a^T f with |f_i| <= F_s,i

In a mechanism of one degree of freedom all joints stop together, B has rank 1, and accelerations are unique, forces are
not. Of those that hold it the ones are taken whose largest share of F_s is least (then the next largest, and so on):
when that is more than 1, none do. Where a joint is at a turning point it has no lever (B = 0 in its row): there it can
hold nothing, and has no force until its rate tells which way it goes. Friction of a prescribed coordinate is smooth: it
is a part of its actuation.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import Constrained, Singular
from substructures.analysis.closed.reductions import Reduction
from substructures.analysis.closed.sticking_forces import RANK, bounded, holding, unit_rows
from substructures.analysis.motion.friction.dry_friction import EDGE, REST, FrictionLaws, Signs, friction_laws
from substructures.analysis.motion.friction.dry_run import DryRun
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.array import Array

#: a joint has no lever where it moves by less than this part of the motion
LEVER = 1e-6
#: of times [s], 1 or more, at which watched quantities are zero
RESOLUTION = 1e-14


class DryConstrained(Constrained):
    """A state whose joints with friction slip or stick as ``signs`` say, in place of their smooth law.

    ``friction`` (k,): the forces on the coordinates ``laws.places`` [N m, N], and ``used``, the largest share of F_s in
    those that stick, both as of the last :meth:`accelerations`. ``least``: where forces are not unique, those are taken
    whose largest share is least, in place of those of least squares.
    """

    laws: FrictionLaws
    signs: Signs
    least: bool

    def _arrays(self) -> None:
        super()._arrays()
        self.all_laws = friction_laws(self.model, self.conditions.values)
        self.laws = _acting(self.all_laws, self.prescribed.index)
        k = len(self.laws.places)
        self.signs, self.least, self.used = np.ones(k, dtype=np.int64), False, 0.0
        self.friction, self._smooth, self._without = np.zeros(k), np.zeros(k), np.zeros(self.n)

    def move(self, t: float, q: Array, qd: Array) -> None:
        """Evaluate everything at a state; ``f`` is without what sticks until :meth:`accelerations`."""
        super().move(t, q, qd)
        v = qd[self.laws.places]
        self._smooth = self.laws.smooth(v)
        self._without[:] = self.f
        self._without[self.laws.places] -= self._smooth
        self._take(-self.signs * self.laws.slipping(v))

    def compiled(self, rows: NDArray[np.int64]) -> None:
        """None: who sticks is decided beside the kernels."""

    @property
    def lost_power(self) -> float:
        """As that of the formulas, with this friction in place of the smooth one [W]."""
        return super().lost_power + float((self.friction - self._smooth) @ self.qd[self.laws.places])

    def accelerations(self, rows: NDArray[np.int64]) -> tuple[Array, Array]:
        """q'' (n,) and the multipliers of the given rows. Raises Singular."""
        places, self.used = self.laws.places, 0.0
        if not (self.signs == 0).any():
            return super().accelerations(rows)
        N = self.basis(rows)
        B = N[places]
        stuck = np.flatnonzero((self.signs == 0) & B.any(axis=1))
        a = self.unheld(rows)[places[stuck]]
        force, self.used = holding(B[stuck], a, self.laws.static[stuck], self.least)
        friction = self.friction.copy()
        friction[stuck] = force
        self._take(friction)
        q2, multipliers = super().accelerations(rows)
        # what forces leave of those that stick is rounding, and so is what goes with it in the others
        q2 += _stopping(N, places[stuck], q2)
        q2[places[stuck]] = 0.0
        return q2, multipliers

    def unheld(self, rows: NDArray[np.int64]) -> Array:
        """q'' (n,) with the friction of the joints that slip alone. Raises Singular."""
        self._take(-self.signs * self.laws.slipping(self.qd[self.laws.places]))
        return super().accelerations(rows)[0]

    def basis(self, rows: NDArray[np.int64]) -> Array:
        """N (n, d) with G N = 0 and N^T g N = 1; zero in the rows of coordinates without a lever. Raises Singular."""
        Z = np.eye(self.n)
        if len(rows):
            Z = np.linalg.svd(self.balanced[rows])[2][len(rows) :].T
        try:
            L = np.linalg.cholesky(Z.T @ self.g @ Z)
        except np.linalg.LinAlgError as error:
            raise Singular("the metric is not positive definite along the closures: check masses") from error
        N = np.linalg.solve(L, Z.T).T
        N[np.linalg.norm(Z, axis=1) <= LEVER] = 0.0
        return np.asarray(N, dtype=np.float64)

    def _take(self, friction: Array) -> None:
        """These forces of friction (k,), and no others."""
        self.friction = friction
        self.f[:] = self._without
        self.f[self.laws.places] += friction


class ClosedDryMotion:
    """The motion of a reduction while joints slip or stick: who does, and until when. Not for several threads."""

    def __init__(self, s: DryConstrained, reduction: Reduction | None = None) -> None:
        self.s, self.reduction, self.laws, self.n = s, reduction, s.laws, s.n
        self.enter = s.inputs.enter
        self.signs = np.ones(len(s.laws.places), dtype=np.int64)

    @property
    def signs(self) -> Signs:
        """By joint with friction: 1 and -1 slip that way, 0 sticks or has no lever."""
        return self.s.signs

    @signs.setter
    def signs(self, signs: Signs) -> None:
        self.s.signs = signs

    def __call__(self, t: float, x: Array) -> Array:
        """x' for x as the reduction has it."""
        if self.reduction is None:
            raise ValueError("there is nothing to integrate")
        return self.reduction.rates(t, x)

    def moved(self, t: float, x: Array, signs: Signs) -> tuple[Array, Array, float]:
        """q'' (n,), the friction (k,) and the power without potential; not finite where they are not determined."""
        s, before = self.s, self.s.signs
        s.signs, s.least = signs, True
        try:
            s.move(t, x[: self.n], x[self.n : 2 * self.n])
            second, _ = s.accelerations(s.independent_rows())
        except Singular:
            s.used = np.inf
            return np.full(self.n, np.nan), np.full(len(signs), np.nan), np.nan
        finally:
            s.signs, s.least = before, False
        return second, s.friction.copy(), s.lost_power

    def friction(self, run: DryRun, t: Array, x: Array) -> Array:
        """The friction on all coordinates (K, n) along a motion."""
        laws, (_, force) = self.s.all_laws, run.forces(self, t, x)
        smooth = np.setdiff1d(laws.places, self.laws.places)
        force[:, smooth] = laws.smooth(x[:, self.n + laws.places])[:, np.isin(laws.places, smooth)]
        return force

    def decided(self, t: float, x: Array) -> tuple[Signs, Array]:
        """Who slips and who sticks at a state, and the state with those at rest at rest. Raises Singular."""
        s, places, x = self.s, self.laws.places, x.copy()
        q, qd = x[: self.n], x[self.n : 2 * self.n]
        least = np.fmax(2 * REST * self.laws.velocity, np.abs(self._unresolved(t, x, self.signs)))
        s.move(t, q, qd)
        rows = s.independent_rows()
        N = s.basis(rows)
        able = N[places].any(axis=1)
        rest = (np.abs(qd[places]) <= least) | ((self.signs == 0) & able)
        # what comes to rest by that is at rest, too
        count = -1
        while count < rest.sum():
            count = rest.sum()
            stopped = places[rest & able]
            qd += _stopping(N, stopped, qd)
            qd[stopped] = 0.0
            rest |= np.abs(qd[places]) <= least
        signs = np.sign(qd[places]).astype(np.int64)
        signs[rest] = 0
        self._release(t, (q, qd), signs, np.flatnonzero(rest & able), (rows, N[places]))
        if (rest & ~able).any():
            # those without a lever that are past rest before the next time
            change = self._unresolved(t, x, signs)
            turn = rest & ~able & (np.abs(change) > REST * self.laws.velocity)
            signs[turn] = np.sign(change[turn]).astype(np.int64)
        return signs, x

    def _unresolved(self, t: float, x: Array, signs: Signs) -> Array:
        """The changes of rates within the resolution of times (k,)."""
        return self.moved(t, x, signs)[0][self.laws.places] * RESOLUTION * max(abs(t), 1.0)

    def _release(
        self,
        t: float,
        state: tuple[Array, Array],
        signs: Signs,
        rest: NDArray[np.int64],
        ways: tuple[NDArray[np.int64], Array],
    ) -> None:
        """Give those at ``rest`` that break away a sign; they have the force of slipping, so that others may follow."""
        self.signs, (rows, B) = signs, ways
        while len(rest):
            self.s.move(t, *state)
            a, most = self.s.unheld(rows)[self.laws.places[rest]], self.laws.static[rest]
            W = B[rest] @ B[rest].T
            a = a + W @ bounded(B[rest], a, (1 - EDGE) * most)
            # beyond what friction makes there
            away = np.abs(a) > EDGE / 10 * (np.abs(W) @ most)
            if not away.any():
                return
            signs[rest[away]] = np.sign(a[away]).astype(np.int64)
            rest = rest[~away]

    def watches(self) -> list[Watch]:
        """A joint that slips comes to rest; one at rest has a rate; those that stick need more than they can have."""

        def starts(k: int) -> Watch:
            """One without a lever, by itself; of others that is rounding."""
            place, most = self.n + int(self.laws.places[k]), 4 * REST * self.laws.velocity[k]
            return Watch("way", lambda _, x: float(most - abs(x[place])), -1)

        def left(t: float, x: Array) -> float:
            """What is left of the static friction, as a part of it."""
            self.moved(t, x, self.signs)
            return float(1 + EDGE - min(self.s.used, 2.0))

        found = [
            starts(k) if sign == 0 else self.laws.rest(k, self.n, sign) for k, sign in enumerate(self.signs.tolist())
        ]
        return [*found, Watch("slip", left, -1)] if (self.signs == 0).any() else found


def _acting(laws: FrictionLaws, prescribed: Any) -> FrictionLaws:
    """Of coordinates that are not prescribed, where there is any friction."""
    kept = ~np.isin(laws.places, list(prescribed)) & ((laws.coulomb > 0) | (laws.static > 0))
    columns = {name: getattr(laws, name)[kept] for name in ("places", "coulomb", "static", "stribeck", "velocity")}
    return replace(laws, **columns)


def _stopping(N: Array, places: NDArray[np.int64], qd: Array) -> Array:
    """The change of q' (n,), least in the metric, by which these coordinates stop."""
    if not len(places):
        return np.zeros(len(qd))
    B, size = unit_rows(N[places])
    return np.asarray(N @ np.linalg.lstsq(B, -qd[places] / size, rcond=RANK)[0])
