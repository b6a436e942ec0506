"""SciPy's integrators, and states within their steps that are as accurate as those at the ends.

The interpolating polynomials of one-step methods are of lower order than their steps (7 beside 8 for DOP853, 4 beside 5
for RK45, 3 beside 5 for Radau), and nothing controls their errors: first integrals drift ten times as far between the
steps as at their ends. The polynomials of multistep methods are those that the method itself goes on with.

SciPy loads its parts when one of their names is first used: scipy.integrate, with 0.3 s of a start, by a motion whose
steps are not machine code.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy

from substructures.array import Array

#: of (f, t, x, end) makes an object with the interface of scipy.integrate.OdeSolver
Stepper = Callable[..., Any]

METHODS = ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA")
ONE_STEP = ("DOP853", "RK45", "RK23", "Radau")
#: relative, of a step
LEAST_TOLERANCE = 1e-13
#: so many states of a step are found one by one, further ones by a polynomial
FEW = 8
#: Chebyshev's points of the second kind in [0, 1] and their barycentric weights
NODES = (1 - np.cos(np.pi * np.arange(10) / 9)) / 2
WEIGHTS = np.where(np.arange(10) % 9, 1.0, 0.5) * (-1.0) ** np.arange(10)


def scipy_stepper(method: str, rtol: float, atol: float, max_step: float | None = None) -> Stepper:
    """One of METHODS with its tolerances; smaller relative ones are out of reach of doubles."""
    most = np.inf if max_step is None else max_step

    def make(f: Any, start: float, x: Array, end: float, **first_step: float) -> Any:
        """A stepper of f from x at start to end. Raises ValueError for a state that is not finite."""
        solver = getattr(scipy.integrate, method)
        return solver(f, start, x, end, rtol=max(rtol, LEAST_TOLERANCE), atol=atol, max_step=most, **first_step)

    return make


def within(solver: Any, make: Stepper, end: float | None = None) -> Callable[[float], Array]:
    """States at times within the last step of a stepper that was made by ``make``, up to ``end`` if not to its end.

    What is returned raises ArithmeticError where the method fails.
    """
    if type(solver).__name__ in ONE_STEP:
        return _Within(solver, make, solver.t if end is None else end)
    found: Callable[[float], Array] = solver.dense_output()
    return found


def roughly_within(solver: Any) -> Callable[[Array], Array]:
    """States (K, N) at times (K,) within the last step by the stepper's own polynomial."""
    if hasattr(solver, "states_at"):  # at once
        at: Callable[[Array], Array] = solver.states_at
        return at
    found = getattr(solver, "rough_output", solver.dense_output)()
    if hasattr(found, "t_min"):  # SciPy's
        return lambda times: np.asarray(found(times).T)
    return lambda times: np.array([found(t) for t in times.tolist()])


class _Within:
    """A shorter step from the start of the last one leads to any time in it; for many times only to the nodes of a
    polynomial of degree nine (J.-P. Berrut and L. N. Trefethen, Barycentric Lagrange interpolation, SIAM Review 46,
    2004), whose error is far below that of the step.
    """

    def __init__(self, solver: Any, make: Stepper, end: float) -> None:
        self.solver, self.make, self.asked = solver, make, 0
        self.start, self.first, self.end = solver.t_old, solver.y_old.copy(), end
        self.times, self.states = np.zeros(0), np.zeros(0)

    def __call__(self, t: float) -> Array:
        self.asked += 1
        return self._short(t) if self.asked <= FEW else self._between(t)

    def _short(self, t: float) -> Array:
        if t <= self.start:
            return self.first.copy()
        if t == self.solver.t:
            return np.array(self.solver.y)
        # one step of the method itself from the same start, as accurate as those that it accepts
        solver = self.make(self.solver.fun, self.start, self.first, t, first_step=t - self.start)
        message = None
        while solver.status == "running":
            message = solver.step()
        if solver.status == "failed":
            raise ArithmeticError(message)
        return np.asarray(solver.y, dtype=np.float64)

    def _between(self, t: float) -> Array:
        if not len(self.times):
            self.times = self.start + (self.end - self.start) * NODES
            self.states = np.array([self._short(t) for t in (*self.times[:-1].tolist(), self.end)])
        way = t - self.times
        if not way.all():
            return np.array(self.states[np.flatnonzero(way == 0)[0]])
        # x(t) = sum w_k x_k / (t - t_k) over sum w_k / (t - t_k)
        shares = WEIGHTS / way
        return np.asarray(shares @ self.states / shares.sum())
