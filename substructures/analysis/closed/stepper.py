"""Steps of a motion with closures: an integrator of reduced states that lands on the closures after every step.

A singular position between two states is looked for where one may be: along a smooth motion det(G_new G_old^T) over
independent rows changes its sign where a singular value of G passes through zero, and a motion that leaves a branching
on another branch has a kink. There the smallest singular value is minimised along the step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy
from scipy.linalg import svdvals

from substructures.analysis.closed.constrained import SINGULAR, Singular
from substructures.analysis.closed.reductions import Reduction
from substructures.analysis.motion.steppers import Stepper, within
from substructures.array import Array

#: how often a step that ran into a singular position is begun again, each time a quarter as long
RETRIES = 10
#: a step along the closures is longer than this many times speed * time, and than LENGTH [rad, m], only if it has
#: leapt to another branch
LEAP, LENGTH = 10, 1e-6
#: a step is searched for singular positions when velocities change by more than this share of the largest
KINK = 0.3
#: singular values below this part of their best share along the motion, in between, are a singular position
NEAR = 1e-4
SAMPLES = 8


class ClosedStepper:
    """For states x = (q, q', work) on the closures; the attributes are those of scipy.integrate.OdeSolver."""

    def __init__(self, reduction: Reduction, make: Stepper, t: float, x: Array, end: float) -> None:
        """Raises Singular."""
        self.reduction, self.s, self.make, self.end = reduction, reduction.s, make, end
        self.t = self.t_old = t
        self.y, self.status, self._counted = x, "running", 0
        self._way = x[: self.s.n], x[: self.s.n]
        self.s.move(t, *self._state())
        reduction.choose()
        self.inner = self._begun(None)
        self.fresh, self._message = True, ""

    @property
    def nfev(self) -> int:
        """Evaluations of the reduced right-hand side."""
        return self._counted + int(self.inner.nfev)

    def _state(self) -> tuple[Array, Array]:
        n = self.s.n
        return self.y[:n], self.y[n : 2 * n]

    def _begun(self, first: float | None) -> Any:
        """An integrator from the present state."""
        y = self.reduction.pack(*self._state(), float(self.y[-1]))
        step = {} if first is None else {"first_step": min(first, self.end - self.t)}
        return self.make(self.reduction.rates, self.t, y, self.end, **step)

    def step(self) -> str | None:
        """Advance by one step, at most to the end; a message when that failed. Raises Singular."""
        if self._message:
            self.status = "failed"
            return self._message
        self._prepare()
        before = self.s.G.copy()
        self.t_old = self.t
        try:
            message = self._advanced()
        except Singular:
            message = self._retried()
        if self.inner.status == "failed":
            self.status = "failed"
            return message
        q, qd = self.s.q, self.s.qd
        self._way = self.y[: self.s.n], q
        time = self._passed() if self._suspicious(before) else None
        if time is not None:
            self._stop_before(time)
            return None
        self.t, self.y = float(self.inner.t), np.concatenate((q, qd, self.inner.y[-1:]))
        self.status = self.inner.status
        return None

    def _stop_before(self, time: float) -> None:
        """End this step a little before a singular position; the next one fails."""
        self._message = f"a singular position is passed at t = {time:.9g} s: {SINGULAR}"
        state, end = self._search(), self.t + 0.999 * (time - self.t)
        self.t, self.y = end, state(end)

    def _prepare(self) -> None:
        """Where s is on the closures: the reduction is chosen anew if it is worn, and the integrator begins there."""
        self.s.move(self.t, *self._state())
        if self.fresh:
            self.fresh = False
            return
        if self.reduction.choose():
            self._begin(self.inner.h_abs)
        else:
            # the step goes on from the state on the closures: y and y' there
            self.inner.y = self.reduction.pack(*self._state(), float(self.y[-1]))
            self.inner.f = self.reduction.rates(self.t, self.inner.y)
        self.s.move(self.t, *self._state())

    def _begin(self, first: float) -> None:
        self._counted += self.inner.nfev
        self.inner = self._begun(first)

    def _advanced(self) -> str | None:
        """One step of the integrator and s on the closures at its end; a message when there is none."""
        message: str | None = self.inner.step()
        if self.inner.status == "failed":
            return message
        q, qd = self.reduction.land(self.inner.t, self.inner.y)
        before, rates = self._state()
        way = (self.inner.t - self.t) * np.maximum(np.abs(qd).max(initial=0), np.abs(rates).max(initial=0))
        # |q_1 - q_0| <= LEAP h |q'| + LENGTH along one branch
        if np.abs(q - before).max(initial=0) > LEAP * way + LENGTH:
            raise Singular(SINGULAR)
        return message

    def _retried(self) -> str | None:
        """Shorter steps with other rows and coordinates from the present state, until one succeeds."""
        for k in range(RETRIES):
            self.s.move(self.t, *self._state())
            self.reduction.choose(anew=True)
            self._begin(self.inner.h_abs / 4)
            try:
                return self._advanced()
            except Singular:
                if k == RETRIES - 1:
                    raise
        return None

    def _suspicious(self, before: Array) -> bool:
        """Whether a singular position may lie between the last two states."""
        rows = self.reduction.rows
        if not len(rows):
            return False
        # det(G_new G_old^T) <= 0: a singular value of G may have passed through zero
        if np.linalg.det(self.s.G[rows] @ before[rows].T) <= 0:
            return True
        old, new = self._state()[1], self.s.qd
        fastest = max(float(np.abs(old).max()), float(np.abs(new).max()))
        return bool(np.abs(new - old).max() > KINK * fastest)

    def _passed(self) -> float | None:
        """When the smallest singular value comes near zero within the last step [s]."""
        state, start, h = self._search(), self.t, self.inner.t - self.t
        rows, least = self.reduction.rows, NEAR * self.reduction.best_share

        def share(part: float) -> float:
            state(start + part * h)
            # sigma_min / sigma_max of the independent rows
            values = svdvals(self.s.G[rows])
            return float(values[-1] / values[0])

        k = 1 + int(np.argmin([share(i / SAMPLES) for i in range(1, SAMPLES)]))
        bounds = (k - 1) / SAMPLES, (k + 1) / SAMPLES
        found = scipy.optimize.minimize_scalar(share, bounds=bounds, method="bounded", options={"xatol": 1e-9})
        return float(start + found.x * h) if found.fun < least else None

    def dense_output(self) -> Callable[[float], Array]:
        """States within the last step, on the closures."""
        first = self._way[0]

        def make(*arguments: Any, **options: Any) -> Any:
            self.reduction.expect(first)
            return self.make(*arguments, **options)

        return self._landed(within(self.inner, make, self.t))

    def _search(self) -> Callable[[float], Array]:
        """The same, less accurate, but also where the accelerations are not determined."""
        self.reduction.expect(self._way[0])  # the integrator evaluates once more within the step
        return self._landed(self.inner.dense_output())

    def _landed(self, dense: Callable[[float], Array]) -> Callable[[float], Array]:
        (first, last), start, end = self._way, self.t_old, self.inner.t

        def state(t: float) -> Array:
            y = dense(t)
            self.reduction.expect(first + (t - start) / (end - start) * (last - first))
            return np.concatenate((*self.reduction.land(t, y), y[-1:]))

        return state
