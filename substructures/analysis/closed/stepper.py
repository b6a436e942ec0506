"""Steps of a motion with closures: an integrator of reduced states that lands on the closures after every step.

Whether a step came to a singular position, or leapt from one branch of closed positions to another, is told by how far
G changes along it (see branches), and looked for where G changes much or velocities have a kink.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy

from substructures.analysis.closed.branches import FAR, change, singular_part
from substructures.analysis.closed.constrained import SINGULAR, Singular
from substructures.analysis.closed.jacobian import Jacobian, Rows
from substructures.analysis.closed.reductions import Reduction
from substructures.analysis.motion.integrators.compiled_steps import CompiledStepper
from substructures.analysis.motion.integrators.steppers import Stepper, within
from substructures.array import Array

#: how often a step that ran into a singular position is begun again, each time a quarter as long
RETRIES = 10
#: a step along the closures is longer than this many times speed * time, and than LENGTH [rad, m], only if it has
#: leapt to another branch
LEAP, LENGTH = 10, 1e-6
#: a step is looked into when velocities change by more than this share of the largest
KINK = 0.3
#: for the end of a step before a singular position
BISECTIONS = 30
NOTHING = np.zeros(0)
#: of (t, y) makes (q, q')
Put = Callable[[float, Array], tuple[Array, Array]]


class _Step(NamedTuple):
    """The state at the end of a step, or a message why there is none.

    ``stop``: a time [s] up to which the step comes to a singular position, if it does, and the advice.
    """

    message: str | None
    q: Array = NOTHING
    qd: Array = NOTHING
    stop: tuple[float, str] | None = None


class ClosedStepper:
    """For states x = (q, q', work) on the closures; the attributes are those of scipy.integrate.OdeSolver."""

    def __init__(
        self, reduction: Reduction, make: Stepper, t: float, x: Array, end: float, first_step: float | None = None
    ) -> None:
        """Raises Singular."""
        self.reduction, self.s, self.make = reduction, reduction.s, make
        self.inner: Any = None
        self._counted = 0
        self.begin(t, x, end, first_step)

    def begin(self, t: float, x: Array, end: float, first_step: float | None = None) -> None:
        """From another state on. Raises Singular."""
        self.t = self.t_old = t
        self.y, self.end, self.status = x, end, "running"
        self.fresh, self._message = True, ""
        self._landed = self._state()
        self._way = self._landed[0], self._landed[0]
        self.s.move(t, *self._landed)
        is_other = self.reduction.choose()
        if first_step is not None and not is_other and isinstance(self.inner, CompiledStepper):
            self.inner.begin(t, self._packed(), end, first_step)
        else:
            self.inner = self._begun(first_step)

    @property
    def nfev(self) -> int:
        """Evaluations of the reduced right-hand side."""
        return self._counted + int(self.inner.nfev)

    def _state(self) -> tuple[Array, Array]:
        n = self.s.n
        return self.y[:n], self.y[n : 2 * n]

    def _packed(self) -> Array:
        """The present state as the reduction has it."""
        return self.reduction.pack(*self._state(), float(self.y[-1]))

    def _begun(self, first: float | None) -> Any:
        """An integrator from the present state."""
        y = self._packed()
        step = {} if first is None else {"first_step": min(first, self.end - self.t)}
        return self.make(self.reduction, self.t, y, self.end, **step)

    def step(self) -> str | None:
        """Advance by one step, at most to the end; a message when that failed. Raises Singular."""
        if self._message:
            self.status = "failed"
            return self._message
        before = self._prepare()
        self.t_old = self.t
        try:
            step = self._advanced(before)
        except Singular:
            step = self._retried(before)
        if step.message is not None or self.inner.status == "failed":
            self.status = "failed"
            return step.message
        if step.stop is not None:
            self._stop_before(*step.stop)
            return None
        self._landed = step.q, step.qd
        self.t, self.y = float(self.inner.t), np.concatenate((*self._landed, self.inner.y[-1:]))
        self.status = self.inner.status
        return None

    def _stop_before(self, time: float, message: str) -> None:
        """End this step where states are still determined well enough to go on from there; the next one fails."""
        self._message, state, end = message, self.rough_output(), self.t
        for _ in range(BISECTIONS):
            middle = (end + time) / 2
            end, time = (middle, time) if self._determined(state, middle) else (end, middle)
        self.t, self.y = end, self.rough_output(self.reduction.land)(end)

    def _determined(self, state: Callable[[float], Array], t: float) -> bool:
        """Whether the motion could go on from there."""
        try:
            state(t)
        except Singular:
            return False
        return not self.reduction.is_singular()

    def _prepare(self) -> Jacobian:
        """G on the closures, where the reduction is chosen anew if it is worn, and the integrator begins."""
        if self.s.q is not self._landed[0]:
            # since the last step other states were looked at
            self.s.move(self.t, *self._state())
        jacobian = self.s.jacobian
        if self.fresh:
            self.fresh = False
        elif self.reduction.choose():
            self._begin(self.inner.h_abs)
        else:
            self._go_on(self._packed())
        return jacobian

    def _go_on(self, y: Array) -> None:
        """The next step goes on from the state on the closures: y and y' there."""
        if isinstance(self.inner, CompiledStepper):
            self.inner.go_on(y)
            return
        self.inner.y = y
        if isinstance(self.inner, scipy.integrate.BDF):
            # its differences begin with y; those of higher order stay, as in CVODE beside a projection
            self.inner.D[0] = y
        else:
            self.inner.f = self.inner.fun(self.t, y)

    def _begin(self, first: float) -> None:
        self._counted += self.inner.nfev
        self.inner = self._begun(first)

    def _advanced(self, before: Jacobian) -> _Step:
        """One step of the integrator, landed on the closures; ``before``: G at its start.

        Raises Singular.
        """
        message: str | None = self.inner.step()
        if self.inner.status == "failed":
            return _Step(message)
        q, qd = self.reduction.land(self.inner.t, self.inner.y)
        old, rates = self._state()
        way = (self.inner.t - self.t) * np.maximum(np.abs(qd).max(initial=0), np.abs(rates).max(initial=0))
        # |q_1 - q_0| <= LEAP h |q'| + LENGTH along one branch
        if np.abs(q - old).max(initial=0) > LEAP * way + LENGTH:
            raise Singular(SINGULAR)
        self._way = old, q
        return _Step(message, q, qd, self._looked_at(before, qd))

    def _retried(self, before: Jacobian) -> _Step:
        """Shorter steps with other rows and coordinates from the present state, until one succeeds."""
        failure = Singular(SINGULAR)
        for _ in range(RETRIES):
            # the step that was taken but did not land, or else the one that was tried
            tried = float(self.inner.t - self.t) or float(self.inner.h_abs)
            self.s.move(self.t, *self._state())
            self.reduction.choose(anew=True)
            self._begin(tried / 4)
            try:
                return self._advanced(before)
            except Singular as error:
                failure = error
        raise failure

    def _looked_at(self, before: Jacobian, qd: Array) -> tuple[float, str] | None:
        """Whether the way from the last state to s comes to a singular position; see _Step. Raises Singular."""
        rows, old = self.reduction.rows, self._state()[1]
        if not len(rows):
            return None
        first, last = before.rows(rows), self.s.jacobian.rows(rows)
        singular = self.reduction.is_singular()
        fastest = max(float(np.abs(old).max()), float(np.abs(qd).max()))
        kinked = bool(np.abs(qd - old).max() > KINK * fastest)
        part = singular_part(self._inside(), first, last) if kinked or change(first, last, FAR) > FAR else None
        if part is not None:
            time = self.t + part * float(self.inner.t - self.t)
            return time, f"a singular position is passed near t = {time:.6g} s: {SINGULAR}"
        return (float(self.inner.t), SINGULAR) if singular else None

    def _inside(self) -> Callable[[float], Rows | None]:
        """The independent rows of the balanced G at a part of the last step; None where it is singular."""
        state, start, h = self.rough_output(), self.t, self.inner.t - self.t

        def rows_of_G(part: float) -> Rows | None:
            state(start + part * h)
            return None if self.reduction.is_singular() else self.s.jacobian.rows(self.reduction.rows)

        return rows_of_G

    def dense_output(self) -> Callable[[float], Array]:
        """States within the last step, on the closures."""
        first = self._way[0]

        def make(*arguments: Any, **options: Any) -> Any:
            """A stepper that goes on from the state at hand."""
            self.reduction.expect(first)
            return self.make(*arguments, **options)

        return self._at(within(self.inner, make, self.t), self.reduction.land)

    def rough_output(self, put: Put | None = None) -> Callable[[float], Array]:
        """The same, less accurate, beside the closures by that, but also where the accelerations are not determined.

        ``put``: of a state of the integrator a state (q, q').
        """
        self.reduction.expect(self._way[0])  # the integrator evaluates once more within the step
        plain = self.inner.plain() if isinstance(self.inner, CompiledStepper) else self.inner
        return self._at(plain.dense_output(), put or self.reduction.unpack)

    def _at(self, dense: Callable[[float], Array], put: Put) -> Callable[[float], Array]:
        (first, last), start, end = self._way, self.t_old, self.inner.t

        def state(t: float) -> Array:
            """(q, q', W) at t."""
            y = dense(t)
            self.reduction.expect(first + (t - start) / (end - start) * (last - first))
            return np.concatenate((*put(t, y), y[-1:]))

        return state
