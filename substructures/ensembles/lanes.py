"""Explicit Runge-Kutta methods for many motions at once: each is in a lane of arrays, with steps of its own.

Steps are those of E. Hairer, S. P. Norsett, G. Wanner, Solving ordinary differential equations I, II.4 and II.10, with
the coefficients of SciPy, but that a step ends where a result is wanted. What a lane computes does not depend on the
others: a motion is the same to the last bit whatever stands beside it, in whatever order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.expr.graph import Graph
from substructures.expr.program import Symbol, array, program

Places = NDArray[np.int64]
SAFETY, LEAST, MOST = 0.9, 0.2, 10.0
#: steps are no shorter than so many distances of the time from the next number
RESOLUTION = 10
#: how motions end; CUT: whoever watched the progress ended them all
FINISHED, TOO_SMALL, TOO_MANY, CUT = 0, 1, 2, 3


class LaneRates(Protocol):
    """x' of all lanes, as bound calls of kernels."""

    def load(self, lanes: Places, members: Places) -> None:
        """The parameters of ``members`` become those of ``lanes``."""

    def bound(self, t: Array, x: Array, found: Array) -> Callable[[], None]:
        """What writes x' (L, m) at t (L,), x (L, m) into ``found``."""


@dataclass(frozen=True)
class LaneSettings:
    """A method with its tolerances; ``longest``: step [s]; ``steps``: that a motion may have; ``lanes``: at a time."""

    method: str = "DOP853"
    relative: float = 1e-10
    absolute: float = 1e-12
    longest: float = np.inf
    steps: int = 1_000_000
    lanes: int = 512


@dataclass(frozen=True)
class LaneMotions:
    """States ``x`` (M, K, m) at the times, not a number behind the end of a motion that failed; ``steps`` (M,) that
    were accepted, ``evaluations`` of x', how each ended (M,), and when (M,) [s].
    """

    x: Array
    steps: NDArray[np.int64]
    evaluations: int
    endings: NDArray[np.int8]
    reached: Array


@lru_cache(maxsize=8)
def sums(method: str) -> tuple[Kernel, ...]:
    """y + h sum_j a_sj k_j of every stage, then of the step, then both estimates of its error, element by element."""
    made = TABLEAUX[method]
    steps = [*(made.a[s][:s] for s in range(1, made.stages)), made.b]
    errors = [row for row in (made.e, made.e3) if any(row)]
    return (*(_weighted(row, is_step=True) for row in steps), *(_weighted(row, is_step=False) for row in errors))


def _weighted(row: Sequence[float], is_step: bool) -> Kernel:
    graph = Graph()
    terms = [graph.symbol(f"k{j}") * graph.number(Fraction(factor)) for j, factor in enumerate(row) if factor]
    total = graph.sum(terms)
    value = graph.symbol("y") + graph.symbol("h") * total if is_step else total
    symbols = {name: Symbol(name, "parameter") for name in ("y", "h", *(f"k{j}" for j in range(len(row))))}
    return compile_program(program(graph, {"sum": array((), lambda: value)}, symbols), ["sum"])


class _Memory:
    """Arrays of all lanes, and what is bound to them: x' of every stage and the sums between."""

    def __init__(self, rates: LaneRates, method: str, lanes: int, size: int) -> None:
        made = TABLEAUX[method]
        self.stages, self.exponent = made.stages, made.exponent
        self.k = np.zeros((made.stages + 1, lanes, size))
        self.y, self.new, self.step = np.zeros((3, lanes, size))
        self.errors = np.zeros((2, lanes, size))
        self.t, self.c = np.zeros(lanes), made.c
        flat = {"y": self.y.reshape(-1), "h": self.step.reshape(-1)}
        flat |= {f"k{j}": k.reshape(-1) for j, k in enumerate(self.k)}
        targets = [*[self.new] * made.stages, *self.errors]
        self.sums = [
            kernel.bind({"sum": target.reshape(-1)}, {name: flat[name] for name in kernel.symbols})
            for kernel, target in zip(sums(method), targets, strict=False)
        ]
        self.rates = [rates.bound(self.t, self.new, k) for k in self.k]
        self.first = rates.bound(self.t, self.y, self.k[0])

    def attempt(self, t: Array, new: Array) -> None:
        """All stages of a step of each lane, the new states and the estimates of their errors."""
        h = new - t
        self.step[:] = h[:, None]
        for s in range(1, self.stages):
            self.sums[s - 1]()
            self.t[:] = t + self.c[s] * h
            self.rates[s]()
        self.sums[self.stages - 1]()
        self.t[:] = new
        self.rates[-1]()
        for estimate in self.sums[self.stages :]:
            estimate()

    def error(self, h: Array, scale: Array) -> Array:
        """The norm (L,) of the error of a step in units of the tolerance."""
        # |e|^2 / sqrt(|e|^2 + 0.01 |e3|^2), which is |e| where there is one estimate
        first, second = (((x / scale) ** 2).sum(axis=1) for x in self.errors)
        both = first + 0.01 * second
        with np.errstate(invalid="ignore", divide="ignore"):
            norm = np.abs(h) * first / np.sqrt(both * self.y.shape[1])
        return np.where(both == 0, 0.0, norm)


def march(
    rates: LaneRates,
    starts: Array,
    times: Array,
    settings: LaneSettings,
    progress: Callable[[int], bool] = lambda _: True,
) -> LaneMotions:
    """Motions x' = f(t, x) from ``starts`` (M, m) at times[0] on, with states at ``times`` (K,), which increase.

    ``progress`` is told how many have ended, and stops by False. What fails is no number from there on.
    """
    return _March(rates, starts, times, settings).run(progress)


class _March:
    def __init__(self, rates: LaneRates, starts: Array, times: Array, settings: LaneSettings) -> None:
        self.rates, self.starts, self.times, self.settings = rates, starts, times, settings
        count, size = starts.shape
        self.lanes = min(settings.lanes, count)
        self.memory = _Memory(rates, settings.method, self.lanes, size)
        self.member = np.full(self.lanes, -1)
        self.t, self.h = np.full(self.lanes, times[0]), np.zeros(self.lanes)
        self.place = np.ones(self.lanes, dtype=np.int64)  # of the next result
        self.refused = np.zeros(self.lanes, dtype=bool)
        self.x = np.full((count, len(times), size), np.nan)
        self.x[:, 0] = starts
        self.steps, self.reached = np.zeros(count, dtype=np.int64), np.full(count, times[0])
        self.endings = np.full(count, CUT if len(times) > 1 else FINISHED, dtype=np.int8)
        self.begun = self.ended = self.evaluations = 0

    def run(self, progress: Callable[[int], bool]) -> LaneMotions:
        """All motions."""
        count = len(self.starts) if len(self.times) > 1 else 0
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            while self.ended < count:
                idle = np.flatnonzero(self.member < 0)
                if self.begun < count and len(idle) * 8 >= self.lanes:
                    self._begin(idle[: count - self.begun])
                self._advance()
                if not progress(self.ended):
                    break
        return LaneMotions(self.x, self.steps, self.evaluations, self.endings, self.reached)

    def _begin(self, lanes: Places) -> None:
        """The next motions take the places of those that have ended; their first steps: Hairer et al., II.4."""
        members = np.arange(self.begun, self.begun + len(lanes))
        self.begun += len(lanes)
        memory, start = self.memory, self.times[0]
        self.rates.load(lanes, members)
        self.member[lanes], self.t[lanes], self.place[lanes], self.refused[lanes] = members, start, 1, False
        memory.y[lanes] = self.starts[members]
        memory.t[:] = self.t
        memory.first()  # of all lanes: of those that go on it is as it was
        y, f = memory.y[lanes], memory.k[0][lanes]
        scale = self.settings.absolute + self.settings.relative * np.abs(y)
        size, slope = _norm(y / scale), _norm(f / scale)
        small = (size < 1e-5) | (slope < 1e-5)
        first = np.where(small, 1e-6, 0.01 * size / np.where(small, 1.0, slope))
        first = np.minimum(first, self.times[-1] - start)
        memory.new[:] = memory.y
        memory.new[lanes] += first[:, None] * f
        memory.t[lanes] += first
        memory.rates[1]()
        change = _norm((memory.k[1][lanes] - f) / scale) / first
        largest = np.maximum(slope, change)
        flat = largest <= 1e-15
        guess = (0.01 / np.where(flat, 1.0, largest)) ** -memory.exponent
        guess = np.where(flat, np.maximum(1e-6, first * 1e-3), guess)
        self.h[lanes] = np.minimum(np.minimum(100 * first, guess), self.settings.longest)
        self.evaluations += 2 * len(lanes)

    def _advance(self) -> None:
        """A step of every lane, which is accepted or made smaller."""
        memory, t, runs = self.memory, self.t, self.member >= 0
        due = self.times[np.minimum(self.place, len(self.times) - 1)]
        least = RESOLUTION * np.abs(np.nextafter(t, np.inf) - t)
        h = np.where(self.refused, self.h, np.minimum(np.maximum(self.h, least), self.settings.longest))
        lost = runs & ~(h >= least)
        is_due = runs & (t + h >= due)
        new = np.where(runs, np.where(is_due, due, t + h), t)
        memory.attempt(t, new)
        self.evaluations += memory.stages * int(runs.sum())
        taken = new - t
        scale = self.settings.absolute + self.settings.relative * np.maximum(np.abs(memory.y), np.abs(memory.new))
        error = memory.error(taken, scale)
        good = runs & ~lost & (error < 1)
        factor = np.where(error > 0, SAFETY * np.where(error > 0, error, 1.0) ** memory.exponent, MOST)
        longer = taken * np.minimum(factor, np.where(self.refused, 1.0, MOST))
        # a step that was cut off for a result says nothing against the longer one
        longer = np.where(is_due, np.maximum(longer, h), longer)
        shorter = taken * np.fmax(factor, LEAST)
        shorter = np.where(np.isfinite(error), shorter, taken * LEAST)
        self.h = np.where(good, longer, np.where(runs, shorter, 0.0))
        self.refused = runs & ~good
        self.t = np.where(good, new, t)
        np.copyto(memory.y, memory.new, where=good[:, None])
        np.copyto(memory.k[0], memory.k[-1], where=good[:, None])
        self.steps[self.member[good]] += 1
        self._note(good & is_due)
        self._end(lost, TOO_SMALL)
        self._end((self.member >= 0) & (self.steps[self.member] >= self.settings.steps), TOO_MANY)

    def _note(self, due: NDArray[np.bool_]) -> None:
        """Results of the lanes that are at the time of one."""
        lanes = np.flatnonzero(due)
        self.x[self.member[lanes], self.place[lanes]] = self.memory.y[lanes]
        self.place[lanes] += 1
        whole = np.zeros(self.lanes, dtype=bool)
        whole[lanes] = self.place[lanes] == len(self.times)
        self._end(whole, FINISHED)

    def _end(self, which: NDArray[np.bool_], how: int) -> None:
        lanes = np.flatnonzero(which)
        members = self.member[lanes]
        self.endings[members], self.reached[members] = how, self.t[lanes]
        self.member[lanes] = -1
        self.ended += len(lanes)


def _norm(x: Array) -> Array:
    return np.sqrt((x**2).mean(axis=1))
