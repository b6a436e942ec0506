"""Equations of motion while contacts are open or closed, with the forces that closed ones need.

Closed contacts keep their gaps, G_N q'' + G_N' q' = 0; those that stick keep their places, with the rows G_T as well;
those that slip along d have the friction -mu lambda_N d:

    g q'' + Gamma q'q' = Q + (G_N - mu d . G_T)^T lambda_N + G_T^T lambda_T

Who does what is decided anew (see :mod:`.deciding`) where a gap closes, a force along the normal vanishes, a point that
slips stops, or one that sticks needs more than mu lambda_N.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.conditions import Conditions
from substructures.analysis.motion.contacts.complementarity import LEAST, least
from substructures.analysis.motion.contacts.pressing import (
    DEPENDENT,
    NO_ROWS,
    Pressed,
    Rows,
    independent,
    parted,
    pressed,
    turn,
)
from substructures.analysis.motion.contacts.rows import BIAS, GAP, RATE, ROWS, WHEN, contact_rows
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.motion.problems.contacts import Contact
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.array import Array
from substructures.compile.motion import CompiledRates
from substructures.errors import InvalidArgument
from substructures.quantities.numbers.states import require
from substructures.tree.model import Model

#: of a contact; one that passes is below its plane, where it did not act when it came there; a full one has all of its
#: friction, as one that slips, but others hold it; one that starts slips from rest in two directions
PASSING, OPEN, STICK, FULL, SLIP, STARTS = -1, 0, 1, 2, 3, 4
#: by contact (k, 4): one of these, the way (2,) of its slip, and A_NN of it alone
Modes = Array
#: of the velocity below which restitution ends, 1e-4 m/s at most: an approach that is an impact, and a slip that is
#: none where contacts change; by so much a point slips back before its stop is seen
FAST, APPROACH, REST = 1e-4, 1e-3, 1e-6
#: of that approach: where a slip in two directions ends, and where one that starts has a way of its own
STOPS, GOES = 1e-2, 2.0
#: a contact with a smaller gap [m] touches; so far below may the start be
TOUCHING, BELOW = 1e-9, 1e-6
#: of the size of forces: how far beyond what it can do a contact is watched, and what rounding leaves of one at rest
EDGE, NOTHING = 1e-9, 1e-14
#: gaps [m] and velocities [m/s] that are closed well enough within a motion; offset of a gap that opens slowly [m]
DRIFT, SLOW = 1e-13, 1e-11
#: states of a step that watches remember
MANY = 256


class ContactMotion(RightHandSide):
    """x' = f(t, x), x = (q, q', W), while contacts are as ``modes`` say; W has the work of their forces.

    ``gap`` (k,), ``G`` (k, 3, n), ``rate`` (k, 3) = G_0, ``bias`` (k, 3), ``acts`` (k,) and ``g`` (n, n) are those of
    the last :meth:`look`; ``force`` (k, 3) along the normal and two tangents that of the last :meth:`evaluate`. Not for
    several threads. Raises as RightHandSide and :func:`contact_rows`.
    """

    def __init__(
        self,
        model: Model,
        values: Mapping[str, float],
        zero: Iterable[str],
        conditions: Conditions,
        contacts: Sequence[Contact],
        folder: Path | None = None,
    ) -> None:
        super().__init__(model, values, zero, conditions, folder)
        self.has_power, self.contacts, self._model = True, tuple(contacts), model
        k, n = len(self.contacts), self.n
        self.modes: Modes = np.zeros((k, 4))
        self._rows: tuple[bytes, Rows] = b"", NO_ROWS
        self.friction = np.array([contact.friction for contact in self.contacts])
        count = np.array([contact.tangents for contact in self.contacts])
        self.tangents = (np.arange(2) < count[:, None]) & (self.friction > 0)[:, None]
        self.rest_velocity = speed = np.array([contact.rest_velocity for contact in self.contacts])
        self.approach, self.rest = (share * np.minimum(speed, FAST) for share in (APPROACH, REST))
        self.force, self.scale, self.slow = np.zeros((k, 3)), np.ones(k), np.zeros(k)
        self._watched: dict[tuple[float, bytes], tuple[Array, Array, Array, float]] = {}
        found = {GAP: np.zeros((1, k)), ROWS: np.zeros((1, k, 3, n)), RATE: np.zeros((1, k, 3))}
        found |= {BIAS: np.zeros((1, k, 3)), WHEN: np.zeros((1, k))}
        self.gap, self.G, self.rate, self.bias, self.acts = (x[0] for x in found.values())
        self.g = np.zeros((n, n))
        source = contact_rows(model, contacts)
        pushed = {a for i, r, a in source.outputs[ROWS].index if r == 0 or self.tangents[i, r - 1]}
        self.pushed = [model.coordinates[a] for a in sorted(pushed)]
        names = [name for some, _ in self._columns for name in some]
        require(source, list(found), dict.fromkeys([*self._values, *names]))
        self._see = self.bound(program_kernel(source, folder), found)
        self._weigh = self.bound(program_kernel(model.program.select(["metric"]), folder), {"metric": self.g[None]})

    def compiled(self) -> CompiledRates | None:
        """None: contact forces are found in between."""

    @property
    def signs(self) -> Modes:
        """The modes."""
        return self.modes

    @signs.setter
    def signs(self, modes: Modes) -> None:
        self.modes = modes

    @property
    def closed(self) -> NDArray[np.bool_]:
        """Contacts that are closed (k,)."""
        return self.modes[:, 0] >= STICK

    @property
    def turns(self) -> NDArray[np.bool_]:
        """Contacts that slip along a way with two directions (k,)."""
        return np.asarray((self.modes[:, 0] == SLIP) & self.tangents.all(axis=1))

    def require_above(self, t: float, x: Array) -> None:
        """Raises InvalidArgument (``/q``) for a start at which a contact that acts is below its plane."""
        self.look(t, x)
        for contact, gap, acts in zip(self.contacts, self.gap.tolist(), (self.acts > 0).tolist(), strict=True):
            if acts and gap < -BELOW:
                message = (
                    f"the point of the contact '{contact.name}' starts {-gap:.3g} m below its plane: raise it, or let "
                    "the contact act later ('when')"
                )
                raise InvalidArgument.at("/q", "penetration", message)

    def look(self, t: float, x: Array) -> None:
        """Gaps, rows and the metric at a state."""
        self._move(t, x)
        self._see()
        self._weigh()

    def velocities(self, x: Array) -> Array:
        """G q' + G_0 (k, 3) at the state that was looked at."""
        return np.asarray(self.G @ x[self.rates] + self.rate)

    def power(self, x: Array) -> float:
        """Of the forces of the last evaluation on the coordinates, at the state that was looked at [W]."""
        return float((self.force * (self.G @ x[self.rates])).sum())

    def free(self, t: float, x: Array) -> Array:
        """q'' (n,) without contact forces, a copy; gaps and rows are those of the state."""
        second = super().evaluate(t, x)[0].copy()
        self.look(t, x)
        return second

    def evaluate(self, t: float, x: Array) -> tuple[Array, Array, float]:
        """(q'', pivots of the metric, power)."""
        free, pivots, power = super().evaluate(t, x)
        self.force[:] = 0.0
        if not self.closed.any():
            return free, pivots, power
        self.look(t, x)
        rows, ways, found = self.independent(), self.ways(self.velocities(x)), list[Pressed]()

        def second() -> Array:
            """With these ways."""
            F = self.G.copy()
            F[:, 0] -= np.einsum("i,ia,ian->in", self.friction, ways, self.G[:, 1:])
            found[:] = [pressed(self.g, self.G, self.bias, rows, free, F)]
            return found[0].second

        turn(ways, self.modes[:, 0] == STARTS, self.G, self.bias, second)
        qdd, size, self.force[:] = found[0]
        self.force[:, 1:] -= self.friction[:, None] * self.force[:, :1] * ways
        qdd[np.abs(qdd) <= NOTHING * size] = 0.0
        return qdd, pivots, power + self.power(x)

    def independent(self) -> Rows:
        """Of what is closed and what sticks, chosen where these modes are looked at first."""
        if (key := self.modes.tobytes()) != self._rows[0]:
            holds = np.column_stack((self.closed, self.tangents & (self.modes[:, :1] == STICK)))
            self._rows = key, independent(self.g, self.G, holds, self.modes[:, 3])
        return self._rows[1]

    def ways(self, v: Array) -> Array:
        """The unit vectors d (k, 2) along which points slip at velocities (k, 3), 0 of others: a way with two
        directions turns, and is shorter where it ends.
        """
        speed = np.maximum(np.linalg.norm(v[:, 1:], axis=1), STOPS * self.approach)
        there = np.where(self.turns[:, None], v[:, 1:] / speed[:, None], self.modes[:, 1:3])
        return np.where(self.modes[:, :1] >= FULL, there, 0.0)

    def land(self, t: float, x: Array, closed: NDArray[np.bool_], still: NDArray[np.bool_] | None) -> Array:
        """The nearest state in the metric whose ``closed`` gaps (k,) are zero and stay so, and whose points ``still``
        do not slip; without these only positions change. It is looked at.
        """
        x = x.copy()
        for _ in range(3):
            self.look(t, x)
            if np.abs(self.gap[closed]).max(initial=0) <= 1e-16:
                break
            x[: self.m] = self.moved(x[: self.m], self._change(self.G[closed, 0], -self.gap[closed]))
        if still is not None:
            rows, v = (self._kept(of, closed, still) for of in (self.G, self.velocities(x)))
            x[self.rates] += self._change(rows, -v)
        self.look(t, x)
        return x

    def _kept(self, rows: Array, closed: NDArray[np.bool_], still: NDArray[np.bool_]) -> Array:
        """Of rows (k, 3, ...) those of velocities that are zero."""
        of, tangent = np.nonzero(self.tangents & still[:, None])
        return np.concatenate([rows[closed, 0], rows[of, 1 + tangent]])

    def _change(self, J: Array, wanted: Array) -> Array:
        """dq (n,) with J dq = wanted, least in the metric."""
        W = np.linalg.solve(self.g, J.T)
        A = J @ W
        return np.asarray(W @ least(A, wanted, np.diag(A)))

    def yields(self, some: NDArray[np.int64]) -> Array:
        """G_N g^-1 G_N^T of each of these contacts, of the state that was looked at."""
        return np.maximum(np.einsum("ia,ai->i", self.G[some, 0], np.linalg.solve(self.g, self.G[some, 0].T)), LEAST)

    def has_drifted(self, t: float, x: Array) -> bool:
        """Whether contacts that are closed are not closed well enough."""
        if not self.closed.any():
            return False
        self.look(t, x)
        rates = self._kept(self.velocities(x), self.closed, self.modes[:, 0] == STICK)
        return bool(np.abs([*self.gap[self.closed], *rates]).max() > DRIFT)

    def watches(self) -> list[Watch]:
        """A gap closes, or a point comes back; a contact lifts off, stops, or sticks no more."""
        found, rows = list[Watch](), self.independent()
        self._watched.clear()
        if len(rows.inverse):
            found.append(Watch("parted", lambda t, x: 10 * DEPENDENT - self._seen(t, x)[3], -1))
        # slips that begin end first, and what comes behind is not looked for
        for i, mode in sorted(enumerate(self.modes[:, 0].tolist()), key=lambda each: -each[1]):
            if mode in (OPEN, PASSING):
                found.append(Watch("gap", self._gap(i), -1 if mode == OPEN else 1))
                continue
            found.append(Watch("lift_off", self._margin(i, lambda p, _: p[0]), -1))
            if mode == STICK and self.tangents[i].any():
                found.append(Watch("slip", self._margin(i, lambda p, mu: mu * p[0] - np.hypot(p[1], p[2])), -1))
            elif mode >= SLIP and self.tangents[i].any():
                # where a slip has a way of its own from need not be known well
                found.append(Watch("stick", self._slip(i), -1, exact=mode != STARTS))
        return found

    def _gap(self, i: int) -> Callable[[float, Array], float]:
        """g_N of a contact; of one that opens slowly a little more, so that it is not closed at once."""

        def g(t: float, x: Array) -> float:
            """Of a state."""
            return float(self._seen(t, x)[0][i] + self.slow[i])

        return g

    def _margin(self, i: int, left: Callable[[Array, float], float]) -> Callable[[float, Array], float]:
        """What is left of a force of a contact, and EDGE of its size."""

        def g(t: float, x: Array) -> float:
            """Of a state."""
            return float(left(self._seen(t, x)[2][i], self.friction[i]) + EDGE * self.scale[i])

        return g

    def _slip(self, i: int) -> Callable[[float, Array], float]:
        """The velocity along the way of slip; in two directions until this turns by 60 degrees, or has its own way."""
        fast, mode = self.approach[i], self.modes[i, 0] if self.tangents[i].all() else OPEN

        def g(t: float, x: Array) -> float:
            """Of a state."""
            _, velocities, forces, _ = self._seen(t, x)
            v, way = velocities[i, 1:], self.modes[i, 1:3]
            if mode == STARTS:  # against its friction
                way = -forces[i, 1:] / max(self.friction[i] * forces[i, 0], LEAST)
            along, speed = float(way @ v), math.hypot(*v)
            if mode == SLIP:
                return min(along - speed / 2, speed - STOPS * fast)
            along += self.rest[i]
            return min(along, GOES * fast - speed) if mode == STARTS else along

        return g

    def _seen(self, t: float, x: Array) -> tuple[Array, Array, Array, float]:
        """Gaps, velocities and forces at a state, which several watches look at, and how far rows have parted."""
        key = t, x.tobytes()
        if key not in self._watched:
            if len(self._watched) >= MANY:
                self._watched.clear()
            second = self.evaluate(t, x)[0].copy()
            self.look(t, x)
            apart = parted(self.independent(), self.g, self.G, self.bias, second)
            self._watched[key] = self.gap.copy(), self.velocities(x), self.force.copy(), apart
        return self._watched[key]
