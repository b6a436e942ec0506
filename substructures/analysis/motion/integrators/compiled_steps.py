"""Explicit methods whose steps are machine code around the kernels, with the interface of SciPy's integrators."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.motion.integrators.steppers import LEAST_TOLERANCE, Stepper, scipy_stepper
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.array import Array
from substructures.compile.motion import FINISHED, HEAD, MANY, RUNNING, WAY, CompiledRates, CompiledRun

#: steps that are tried in one call of machine code: a few milliseconds, then whoever watches the progress is told
MOST = 256
EXPLICIT = tuple(TABLEAUX)
NOT_FINITE = "All components of the initial state `y0` must be finite."
TOO_SMALL = "Required step size is less than spacing between numbers."


def rates_of(f: Any) -> CompiledRates | None:
    """The calls of kernels that a function consists of, as its method ``compiled`` has them; None where it does not."""
    compiled: Callable[[], CompiledRates | None] | None = getattr(f, "compiled", None)
    return None if compiled is None else compiled()


def compiled_stepper(method: str, rtol: float, atol: float, max_step: float | None = None) -> Stepper:
    """The same as scipy_stepper, with machine code where an explicit method has a right-hand side of kernels."""
    plain = scipy_stepper(method, rtol, atol, max_step)
    limits, most = (max(rtol, LEAST_TOLERANCE), atol), np.inf if max_step is None else max_step

    def make(f: Any, start: float, x: Array, end: float, **first_step: float) -> Any:
        """A stepper of f from x at start to end. Raises ValueError for a state that is not finite."""
        rates = rates_of(f)
        if rates is None or end <= start:
            return plain(f, start, x, end, **first_step)
        if not np.isfinite(x).all():
            raise ValueError(NOT_FINITE)
        made = TABLEAUX[method]
        h = first_step.get("first_step") or _first_step(f, (start, end), x, made.exponent, limits, most)
        evaluations = 1 if first_step else 2
        return CompiledStepper(
            f, method, evaluations, (start, x, end, h), lambda tried: CompiledRun(made, rates, limits, most, tried)
        )

    return make if method in EXPLICIT else plain


def _first_step(
    f: Any, span: tuple[float, float], x: Array, exponent: float, limits: tuple[float, float], most: float
) -> float:
    """The size of the first step, as SciPy chooses it (Hairer, Norsett, Wanner, section II.4)."""

    def size(y: Array) -> float:
        """The root mean square over the scale."""
        return float(np.linalg.norm(y / scale) / len(y) ** 0.5)

    start, length = span[0], abs(span[1] - span[0])
    scale = limits[1] + np.abs(x) * limits[0]
    slope = np.asarray(f(start, x))
    d0, d1 = size(x), size(slope)
    h0 = min(1e-6 if d0 < 1e-5 or d1 < 1e-5 else 0.01 * d0 / d1, length)
    d2 = size(np.asarray(f(start + h0, x + h0 * slope)) - slope) / h0
    h1 = max(1e-6, h0 * 1e-3) if d1 <= 1e-15 and d2 <= 1e-15 else (0.01 / max(d1, d2)) ** -exponent
    return min(100 * h0, h1, length, most)


class CompiledStepper:
    """One step after the other, of which many are made at a time; the attributes are those of
    scipy.integrate.OdeSolver.
    """

    #: whether each step is looked at, so that they cannot be taken many at a time
    is_watched = False

    def __init__(
        self,
        f: Any,
        method: str,
        evaluations: int,
        first: tuple[float, Array, float, float],
        run: Callable[[int], CompiledRun],
    ) -> None:
        """``evaluations`` until now; ``first``: as of ``begin``; ``run``: of so many steps in a call."""
        self.fun, self.nfev, self._method = f, evaluations, method
        self._make = run
        self.status: Literal["running", "finished", "failed"]
        self.begin(*first)

    def begin(self, t: float, y: Array, end: float, first_step: float) -> None:
        """From another state on."""
        self.t, self.t_old, self._end, self._before = t, t, end, self.nfev - 1
        self.y: Array = np.array(y)
        self.y_old, self.status = self.y, "running"
        self._start = t, self.y, end, first_step
        if "_run" in vars(self):
            self._run.begin(*self._start)
        self._made: Array = np.zeros((0, HEAD + len(self.y)))
        self._next, self._tried = 0, 1

    def step(self) -> str | None:
        """Advance by one step; a message when that failed."""
        if self._next == len(self._made) and not self._more():
            self.status = "failed"
            return TOO_SMALL
        row = self._made[self._next]
        self._next += 1
        self.t_old, self.y_old = self.t, self.y
        self.t, self.y, self.nfev = float(row[0]), row[HEAD:], self._before + int(row[1])
        if self._next == len(self._made) and self._run.status == FINISHED:
            self.status = "finished"
        return None

    def ahead(self) -> Array:
        """Steps (k, HEAD + size) that are made and not yet taken: time, evaluations up to there, state."""
        if self._next == len(self._made):
            self._tried = MOST
            self._more()
        return self._made[self._next :]

    def take(self, count: int) -> None:
        """Advance by so many of the steps ahead, at least one."""
        if count > 1:
            self._next += count - 1
            self.t, self.y = float(self._made[self._next - 1, 0]), self._made[self._next - 1, HEAD:]
        self.step()

    def reach(self, ways: Array, states: Array, most: int = MANY) -> tuple[Array, NDArray[np.bool_]]:
        """States at the ends of ways (k, 3), which are start, first step and end, from ``states`` (k, size), or from
        one (1, size), each by steps of its own, in about ``most`` evaluations at most; and whether they are reached
        (k,).
        """
        rows = np.zeros((len(ways), len(WAY) + states.shape[1]))
        rows[:, :3], rows[:, len(WAY) :] = ways, states
        self._short.reach(rows, most)
        evaluations = int(rows[:, WAY.index("evaluations")].sum())
        self._before += evaluations
        self.nfev += evaluations
        return rows[:, len(WAY) :], rows[:, WAY.index("status")] == FINISHED

    @property
    def h_abs(self) -> float:
        """The size of the step that is tried next."""
        return self._run.next_step

    def go_on(self, y: Array) -> None:
        """The next step goes on from this state at the present time."""
        self.y, self._before = y, self.nfev
        self._run.begin(self.t, y, self._end, self._run.next_step)
        self._made, self._next, self._tried = self._made[:0], 0, 1

    def plain(self) -> Any:
        """SciPy's stepper that made the last step, as its polynomial may be wanted."""
        h = self.t - self.t_old
        # any error is taken
        solver = scipy_stepper(self._method, 1.0, 1.0)(self._rates, self.t_old, self.y_old, self.t, first_step=h)
        solver.step()
        return solver

    def _rates(self, t: float, x: Array) -> Array:
        """x' at (t, x), by Python where it is not finite, which may tell why."""
        found = self._short.rates(t, x)
        return found if np.isfinite(found).all() else np.asarray(self.fun(t, x))

    def _more(self) -> bool:
        """Further steps: more and more of them, as the first ones may end at a corner."""
        self._made, self._next = self._made[:0], 0
        while not len(self._made) and self._run.status == RUNNING:
            self._made = self._run.advance(self._tried).copy()
        self._tried = min(2 * self._tried, MOST)
        return bool(len(self._made))

    @cached_property
    def _run(self) -> CompiledRun:
        """Of the steps themselves."""
        run = self._make(MOST)
        run.begin(*self._start)
        return run

    @cached_property
    def _short(self) -> CompiledRun:
        """For steps within the last one."""
        return self._make(1)

    def dense_output(self) -> Callable[[float], Array]:
        """States within the last step."""
        return self._at

    def _at(self, t: float) -> Array:
        return self.states_at(np.array([t]))[0]

    def states_at(self, times: Array) -> Array:
        """States (k, size) at times (k,) within the last step, by shorter steps from its start, which are as accurate.

        Raises ArithmeticError where the method fails.
        """
        start = np.full(len(times), self.t_old)
        ways = np.stack([start, times - start, times], axis=1)
        found, is_reached = self.reach(ways, self.y_old[None])
        if not (is_reached | (times <= start)).all():
            raise ArithmeticError(TOO_SMALL)
        return found
