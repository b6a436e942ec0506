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

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.closed.constrained import Singular
from substructures.analysis.closed.dry_state import DryConstrained
from substructures.analysis.closed.reductions import Reduction
from substructures.analysis.closed.sticking_forces import RANK, bounded, unit_rows
from substructures.analysis.motion.friction.dry_friction import EDGE, REST, Signs
from substructures.analysis.motion.friction.dry_run import DryRun
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.array import Array

#: of times [s], 1 or more, at which watched quantities are zero
RESOLUTION = 1e-14


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
        try:
            with self._at(t, x, signs) as rows:
                second, _ = self.s.accelerations(rows)
                self.s.hold(rows)
        except Singular:
            self.s.used = np.inf
            return np.full(self.n, np.nan), np.full(len(signs), np.nan), np.nan
        return second, self.s.friction.copy(), self.s.lost_power

    def held(self, t: float, x: Array, signs: Signs) -> Array:
        """The friction (k,) alone; not finite where it is not determined."""
        if signs.all():
            return np.asarray(-signs * self.laws.slipping(x[self.n + self.laws.places]))
        try:
            with self._at(t, x, signs) as rows:
                self.s.hold(rows)
        except Singular:
            self.s.used = np.inf
            return np.full(len(signs), np.nan)
        return self.s.friction.copy()

    @contextmanager
    def _at(self, t: float, x: Array, signs: Signs) -> Iterator[NDArray[np.int64]]:
        """s at a state, with other signs for a while; independent rows there."""
        s, before = self.s, self.s.signs
        s.signs = signs
        try:
            s.move(t, x[: self.n], x[self.n : 2 * self.n])
            yield s.independent_rows() if self.reduction is None else self.reduction.rows
        finally:
            s.signs = before

    def friction(self, run: DryRun, t: Array, x: Array) -> Array:
        """The friction on all coordinates (K, n) along a motion."""
        laws, force = self.s.all_laws, np.zeros((len(t), self.n))
        for i, (at, state) in enumerate(zip(t.tolist(), x, strict=True)):
            force[i, self.laws.places] = self.held(at, state, run.at(at))
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
            self.held(t, x, self.signs)
            return float(1 + EDGE - min(self.s.used, 2.0))

        found = [
            starts(k) if sign == 0 else self.laws.rest(k, self.n, sign) for k, sign in enumerate(self.signs.tolist())
        ]
        return [*found, Watch("slip", left, -1)] if (self.signs == 0).any() else found


def _stopping(N: Array, places: NDArray[np.int64], qd: Array) -> Array:
    """The change of q' (n,), least in the metric, by which these coordinates stop."""
    if not len(places):
        return np.zeros(len(qd))
    B, size = unit_rows(N[places])
    return np.asarray(N @ np.linalg.lstsq(B, -qd[places] / size, rcond=RANK)[0])
