"""Impacts, and what contacts do after them: open, stick or slip.

An impact of the contacts that touch, with Newton's restitution and Coulomb's law between impulses L and velocities:

    q'+ = q'- + g^-1 G^T L,    u_N+ = -e u_N-  where L_N > 0,    and the energy changes by 1/2 (q'+ + q'-) . G^T L

What touches with a velocity of zero is then closed if accelerations and forces say so: 0 <= lambda_N compl. g_N'' >= 0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.contacts.complementarity import Cones, coulomb
from substructures.analysis.motion.contacts.contact_motion import (
    EDGE,
    FULL,
    OPEN,
    PASSING,
    SLIP,
    SLOW,
    STARTS,
    STICK,
    STOPS,
    TOUCHING,
    ContactMotion,
    Modes,
)
from substructures.analysis.motion.contacts.pressing import NO_ROWS, turn
from substructures.analysis.motion.friction.dry_rates import DYNAMICS
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.right_hand_side import CHANGES, RightHandSide
from substructures.analysis.motion.trajectory import Crossing
from substructures.array import Array
from substructures.compile.machine import BoundCall
from substructures.compile.motion import CompiledRates, CompiledRun, Pressing, SaddlePoint

#: of the largest acceleration: what is none
NONE = 1e-11
#: of the largest impulse or force: what is none
LIGHT = 1e-11


class Impact(NamedTuple):
    """When; the work of the impulses at the contacts [J], which is the change of T where nothing else moves; what is
    missing in that change beside the impulses, T before [J]; how far complementarity conditions failed, relative.
    """

    t: float
    work: float
    missing: float
    energy: float
    violation: float


class DecidedContacts(ContactMotion):
    """Who touches, sticks and slips at the start of a piece; ``told``: what happened, ``impacts``: what they did."""

    told: list[Crossing]
    impacts: list[Impact]
    begun: bool
    #: the modes at a time of the last motion
    at: Callable[[float], Modes]
    #: in machine code with these modes
    _made: tuple[bytes, CompiledRun | None, Pressing | None] = b"", None, None

    def begin(self) -> None:
        """All contacts are open, and nothing has happened."""
        self.modes = np.zeros((len(self.contacts), 4))
        self.told, self.impacts, self.begun = [], [], False

    def compiled(self) -> CompiledRates | None:
        """As the modes are now, but for slips that begin, whose ways are found."""
        return None if (self.modes[:, 0] == STARTS).any() else self._rates()

    def _rates(self) -> CompiledRates | None:
        """With the ways given of slips that begin; None where many hold what is at rest, as rounding would move it."""
        rates, closed = RightHandSide.compiled(self), self.closed
        if rates is None or not closed.any():
            return rates
        rows, rubs = self.independent(), self.modes[:, 0] >= FULL
        rests = len(rows.kept) == self.n and (len(rows.inverse) > 0 or bool(self.tangents[rubs].any()))
        call, Q, bias, written = self._dynamics
        calls = tuple(each for each in (self._see, call) if isinstance(each, BoundCall))
        if rests or len(calls) < 2:
            return None
        slow = np.where(self.turns, STOPS * self.approach, 0.0)
        laws = np.column_stack((np.where(rubs, self.friction, 0.0), slow, self.modes[:, 1:3]))
        velocities = self._x[0, self.rates]
        contacts = rows.pressing(self.rate.reshape(-1), velocities, laws)
        place = self.G.reshape(-1, self.n), self.bias.reshape(-1), Q, bias, rows.kept, np.arange(self.n)
        saddle = SaddlePoint(self.g, *place, self._first, contacts, velocities, self._out[2])
        return replace(rates, calls=(*rates.calls, *calls), written=written, saddle=saddle)

    def evaluate(self, t: float, x: Array) -> tuple[Array, Array, float]:
        """(q'', pivots of the metric, power), in machine code where that may be."""
        if self.modes.tobytes() != self._made[0]:
            # rows are chosen where they are
            self.look(t, x)
            rates = self._rates() if self.closed.any() else None
            saddle = None if rates is None else rates.saddle
            run = None if rates is None else CompiledRun(TABLEAUX["DOP853"], rates, (1.0, 1.0))
            self._made = self.modes.tobytes(), run, None if saddle is None else saddle.pressing
        _, run, contacts = self._made
        if run is None or contacts is None:
            return super().evaluate(t, x)
        found = list[Array]()

        def second() -> Array:
            """With these ways."""
            found[:] = [run.rates(t, x)]
            return found[0][self.rates]

        turn(contacts.laws[:, 2:], self.modes[:, 0] == STARTS, self.G, self.bias, second)
        self.independent().forces(contacts, self.force)
        ways = np.where(self.turns[:, None], self.ways(self.velocities(x)), contacts.laws[:, 2:])
        self.force[:, 1:] -= contacts.laws[:, :1] * self.force[:, :1] * ways
        return found[0][self.rates], self._out[1][0], float(found[0][-1])

    @cached_property
    def _dynamics(self) -> tuple[Callable[[], None], Array, Array, Array]:
        """What is called for the metric, forces and what depends on velocities, the last two, and changes of q with
        ball joints before q'', which is written elsewhere: zeros among what kernels write are not written again.
        """
        (Q, bias), written = np.zeros((2, 1, self.n)), np.zeros_like(self._written)
        out = dict(zip(DYNAMICS, (self.g[None], Q, bias), strict=True))
        out |= {CHANGES: written[:, : self.m]} if self._first else {}
        call = self.bound(program_kernel(self._model.program.select(list(out))), out)
        return call, Q[0], bias[0], written

    def decided(self, t: float, x: Array) -> tuple[Modes, Array]:
        """The modes at a state, and the state after impacts, on the contacts. Raises ArithmeticError."""
        before, going = self.modes[:, 0].copy(), self._slips_going_on(t, x)
        self.modes, self._rows, self._made = self.modes.copy(), (b"", NO_ROWS), (b"", None, None)
        self.look(t, x)
        approach = self.velocities(x)[:, 0]
        touching = self._touching(approach)
        if touching.any():
            x = self.land(t, x, touching, None)
            if (approach < -self.approach)[touching].any():
                x = self._hit(t, x, np.flatnonzero(touching))
            v = self.velocities(x)
            closed = touching & (np.abs(v[:, 0]) <= self.approach)
            slow = closed & (np.linalg.norm(np.where(self.tangents, v[:, 1:], 0.0), axis=1) <= self.approach)
            self.modes[touching] = OPEN
            if closed.any():
                x = self.land(t, x, closed, slow & ~going)
                self._hold(t, x, np.flatnonzero(closed), ~slow[closed])
        opens = (self.gap <= TOUCHING) & (self.velocities(x)[:, 0] <= self.rest)
        self.slow = np.where(opens, SLOW, 0.0)
        if self.begun:
            self._tell(t, x, before)
        self.begun = True
        return self.modes, x

    def _slips_going_on(self, t: float, x: Array) -> NDArray[np.bool_]:
        """Slips that have begun (k,), and go on, against their friction: v_T . lambda_T < 0."""
        starts = self.modes[:, 0] == STARTS
        if not starts.any():
            return starts
        self.evaluate(t, x)
        self.look(t, x)
        return np.asarray(starts & ((self.force * self.velocities(x))[:, 1:].sum(axis=1) < 0))

    def _touching(self, approach: Array) -> NDArray[np.bool_]:
        """Contacts at their planes that act (k,); others begin or end to pass there."""
        mode, near = self.modes[:, 0], self.gap <= TOUCHING
        mode[(mode == PASSING) & (self.gap >= -TOUCHING) & (approach > 0)] = OPEN
        here = (mode == OPEN) & near & (approach <= self.rest)
        passes = here & ~(self.acts > 0)
        mode[passes] = PASSING
        return np.asarray((mode >= STICK) | (here & ~passes))

    def _hit(self, t: float, x: Array, some: NDArray[np.int64]) -> Array:
        """The state after an impact of these contacts."""
        n, m, v, u = self.n, self.m, self.rates, self.velocities(x)[some]
        G, qd = self.G[some], x[v]
        rebound = np.array([self.contacts[i].restitution for i in some.tolist()])
        rebound[-u[:, 0] <= self.rest_velocity[some]] = 0.0
        b = u.copy()
        b[:, 0] += rebound * np.minimum(u[:, 0], 0.0)
        W = np.linalg.solve(self.g, G.reshape(-1, n).T).reshape(n, -1, 3)
        cones = Cones(np.einsum("ian,njb->iajb", G, W), b, self.friction[some], self.tangents[some], self.yields(some))
        L = coulomb(cones)
        after = x.copy()
        after[v] += np.einsum("njb,jb->n", W, L)
        # 1/2 (q'+ + q'-) . G^T L of each, and T of the metric
        changes = 0.5 * np.einsum("ia,ian,n->i", L, G, after[v] + qd)
        T, T_after = (0.5 * float(u @ self.g @ u) for u in (qd, after[v]))
        after[-1] += changes.sum()
        work = 0.5 * float((L * (u + G @ after[v] + self.rate[some])).sum())
        self.impacts.append(Impact(t, work, T_after - T - changes.sum(), T, cones.violation(L)))
        for i, impulse, change in zip(some.tolist(), L, changes.tolist(), strict=True):
            if impulse[0] > LIGHT * np.abs(L).max():
                name, told = self.contacts[i].name, tuple(impulse.tolist())
                state = x[:m].copy(), qd.copy()
                ends = after[:m].copy(), after[v].copy()
                self.told.append(Crossing(name, t, *state, ends, change, "impact", told))
        self.look(t, after)
        return after

    def _hold(self, t: float, x: Array, some: NDArray[np.int64], slips: NDArray[np.bool_]) -> None:
        """Which of these contacts stay closed, and who sticks of those that do not slip."""
        free, v = self.free(t, x), self.velocities(x)
        v_T = np.where(self.tangents, v[:, 1:], 0.0)[some]
        d = np.where(slips[:, None], _unit(v_T), 0.0)
        mu, G = self.friction[some], self.G[some]
        F = G.copy()
        F[:, 0] -= np.einsum("i,ia,ian->in", mu, d, G[:, 1:])
        W = np.linalg.solve(self.g, F.reshape(-1, self.n).T).reshape(self.n, -1, 3)
        b = np.einsum("ian,n->ia", G, free) + self.bias[some]
        cones = Cones(np.einsum("ian,njb->iajb", G, W), b, mu, self.tangents[some] & ~slips[:, None], self.yields(some))
        p = coulomb(cones)
        w, size = cones.left(p), cones.size(p)
        w_T = np.where(cones.tangents, w[:, 1:], 0.0)
        begins = ~slips & (np.linalg.norm(w_T, axis=1) > NONE * size)
        smooth = ~self.tangents[some].any(axis=1)
        # what is not pressed has no force, also where it only touches
        pressed = p[:, 0] > LIGHT * p[:, 0].max()
        mode = np.where(slips | begins | smooth, SLIP, STICK)
        mode[begins & self.tangents[some].all(axis=1)] = STARTS
        self.modes[some, 0] = np.where(pressed, mode, OPEN)
        self.modes[some, 1:3] = np.where(begins[:, None], _unit(w_T), d)
        self.modes[some, 3] = cones.yields
        # what forces there are about
        self.scale[some] = np.maximum(p[:, 0], np.abs(b).max() / cones.yields)
        self._share(t, x, len(some))

    def _share(self, t: float, x: Array, count: int) -> None:
        """Of forces that are not unique: who would pull is open, who would drag more than it can drags what it can."""
        for _ in range(2 * count):
            self.evaluate(t, x)
            most = self.friction * self.force[:, 0] + EDGE / 2 * self.scale
            pulls = self.closed & (self.force[:, 0] < -EDGE / 2 * self.scale)
            drags = (self.modes[:, 0] == STICK) & (np.linalg.norm(self.force[:, 1:], axis=1) > most) & ~pulls
            if not (pulls | drags).any():
                return
            self.modes[pulls, 0], self.modes[drags, 0] = OPEN, FULL
            self.modes[drags, 1:3] = -_unit(self.force[drags, 1:])

    def _tell(self, t: float, x: Array, before: Array) -> None:
        """Contacts that lift off, and those that begin to stick or to slip."""
        state = x[: self.m].copy(), x[self.rates].copy()
        for contact, was, now in zip(self.contacts, before.tolist(), self.modes[:, 0].tolist(), strict=True):
            if was >= STICK > now:
                self.told.append(Crossing(contact.name, t, *state, kind="lift_off"))
            elif now >= STICK and (was < STICK or (now >= SLIP) != (was >= SLIP)):
                kind = "slip" if now >= SLIP else "stick"
                self.told.append(Crossing(contact.name, t, *state, kind=kind))


def _unit(v: Array) -> Array:
    """Rows (k, 2) of length 1, or 0."""
    return np.asarray(v / np.maximum(np.linalg.norm(v, axis=1), 1e-300)[:, None])
