"""Zeros of watched quantities within a step of an integrator."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
import scipy

from substructures.analysis.motion.integrators.steppers import Stepper, roughly_within, within
from substructures.analysis.motion.integrators.turning_points import turns
from substructures.array import Array

#: where a watched quantity turns this near to its level, beside how far it is from it before and after, the turn is
#: looked at closely
PEAK = 0.1


class Corner(Protocol):
    """A quantity that a right-hand side has on one side of zero: ``side`` 1 or -1."""

    @property
    def side(self) -> float:
        """The side that is taken."""

    def take(self, side: float) -> None:
        """Take a side."""

    def stays(self, t: float, x: Array) -> bool:
        """Whether the motion goes on at that side; if not, it stays at the corner."""

    def slides(self, t: float, x: Array) -> bool:
        """Whether it is thrown back from both sides, by laws that jump there."""

    def leave(self) -> None:
        """Take no sides, nor do other corners."""


@dataclass(frozen=True)
class Watch:
    """Zeros of g(t, x), a quantity less ``level``, that are looked for: ``direction`` +1 rising, -1 falling, 0 both.

    ``stops``: at the ``count``-th. ``corner``: at the zeros the right-hand side changes, and the integrator begins
    anew. ``exact``: or known only as well as the step's own polynomial is.
    """

    name: str
    function: Callable[[float, Array], float]
    direction: int = 0
    stops: bool = True
    level: float = 0.0
    corner: Corner | None = None
    count: int = 1
    exact: bool = True


class Dense:
    """Dense output of the last step, made when it is first needed; exact at its ends."""

    def __init__(self, solver: Any, make: Stepper) -> None:
        self.solver, self.make = solver, make
        self.output: Any = None
        self._roughly: dict[bytes, Array] = {}
        self._exactly: dict[float, Array] = {}

    @cached_property
    def _polynomial(self) -> Callable[[Array], Array]:
        return roughly_within(self.solver)

    def rough(self, times: Array) -> Array:
        """States (K, N) at times (K,) by the stepper's own polynomial, which costs little and is less accurate; those
        of times that were asked for are kept, as all watches look at the same ones first.
        """
        key = times.tobytes()
        if key not in self._roughly:
            self._roughly[key] = self._polynomial(times)
        return self._roughly[key]

    def __call__(self, t: float) -> Array:
        """The state (N,) at a time within the step."""
        if t == self.solver.t:
            return np.asarray(self.solver.y)
        if self.output is None:
            self.output = within(self.solver, self.make)
        if t not in self._exactly:
            self._exactly[t] = np.array(self.output(t))
        return self._exactly[t]


def zeros_of(watch: Watch, solver: Any, dense: Dense, ends: tuple[float, float], until: float) -> list[float]:
    """The zeros of a watched function in the last step up to a time, in order; ``ends``: its values at those of the
    step.
    """

    def g(t: float) -> float:
        """The watched function within the step."""
        return watch.function(t, np.asarray(dense(t), dtype=np.float64))

    def roughly(times: Array) -> list[float]:
        """The same at several times."""
        return [watch.function(t, x) for t, x in zip(times.tolist(), dense.rough(times), strict=True)]

    a, b = float(solver.t_old), float(solver.t)
    points = [(a, ends[0]), *turns(roughly, a, b, ends, watch.level), (b, ends[1])]
    found = []
    for (start, before), (end, after) in pairwise(_reaching(g, points)):
        if start >= until:
            break
        if end > until:
            end, after = until, g(until)
        # g changes its sign from one time to the next; g = 0 at the start was counted before
        rising = before < 0 <= after
        falling = before > 0 >= after
        if (rising and watch.direction >= 0) or (falling and watch.direction <= 0):
            found.append(_zero(g if watch.exact else lambda t: roughly(np.array([t]))[0], start, end))
    return found


def _reaching(g: Callable[[float], float], points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """The same (t, g) with exact values near zero, where a turn is looked for again: it was one of rough states."""
    result = list(points)
    for k in range(1, len(points) - 1):
        (start, before), (t, peak), (end, after) = points[k - 1 : k + 2]
        sign = 1.0 if peak > 0 else -1.0
        if abs(peak) > PEAK * max(abs(before), abs(after)):
            continue
        result[k] = t, g(t)
        # g comes towards zero from both sides, and leaves it again before it is there
        if abs(peak) < min(sign * before, sign * after):
            options = {"xatol": 1e-9 * (end - start)}
            found = scipy.optimize.minimize_scalar(
                lambda t, sign=sign: sign * g(t), bounds=(start, end), method="bounded", options=options
            )
            result[k] = float(found.x), sign * float(found.fun)
    return result


def _zero(g: Callable[[float], float], a: float, b: float) -> float:
    # g(t*) = 0 in [a, b], found to the resolution of times
    first, last = g(a), g(b)
    if first * last > 0:  # the zero is within rounding of an end
        return a if abs(first) < abs(last) else b
    t = float(scipy.optimize.brentq(g, a, b, xtol=4e-15 * max(abs(a), abs(b), 1.0), rtol=1e-15))
    step = float(np.spacing(max(abs(a), abs(b))))
    # up to where g has its new sign: a motion that goes on from there does not meet the same zero again
    while t < b and first * g(t) > 0:
        t, step = min(t + step, b), 2 * step
    return t
