"""Integration over a span by steppers like SciPy's: outputs, events, breaks, limits; what goes wrong is a value.

E. Hairer, S. P. Norsett, G. Wanner, Solving ordinary differential equations I (DOP853); II (Radau IIA, BDF).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.motion.integrators.at_once import taken_at_once
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.steppers import Stepper
from substructures.analysis.motion.integrators.zeros import Corner, Dense, Watch, zeros_of
from substructures.array import Array

Function = Callable[[float, Array], Array]
#: told the time reached; False stops
TimeReport = Callable[[float], bool | None]

#: so many steps in a row of less than this share of the span mean that the integrator is stuck
PATIENCE, TINY = 200, 1e-12
#: so many steps tell the pace of a motion that stays at a corner
CHATTER = 1000
#: the level of a watch that is zero, with a sign
LEAST = 1e-300
#: of the largest level so far: what a level that jumps changes by at least
JUMP = 1e-9
STIFF = "try the method 'Radau' for stiff equations"
SLIDES = (
    "the motion stays where a law jumps ('sign'), thrown back from both sides (a sliding mode): take tanh(x/w) in "
    "place of sign(x), w small beside x, and the method 'Radau'; for dry friction the joint's 'friction', taken 'exact'"
)
NO_ERROR = "an 'absolute_tolerance' of 0 allows no error of what is 0"


@dataclass(frozen=True)
class IntegratorSettings:
    """``advice``: what to change when the integrator gives up, beside state, span and tolerances."""

    stepper: Stepper
    max_steps: int
    advice: str = STIFF


def integrate(
    f: Function,
    x: Array,
    span: tuple[float, float],
    outputs: Array,
    settings: IntegratorSettings,
    watches: Sequence[Watch] = (),
    breaks: Sequence[float] = (),
    progress: TimeReport | None = None,
    enter: Callable[[float, float], None] | None = None,
) -> IntegratedMotion:
    """x(t) at the times ``outputs`` in the span; the integrator begins anew at the times ``breaks``.

    A motion that ends early has the last state that was reached, too.

    ``enter``: told the times between which f is called next, from break to break.
    """
    run = _Run(f, span, outputs, settings, watches, progress)
    motion = run.motion
    run.begin(span[0], x)
    # the method's order holds where the right-hand side is smooth: from break to break
    ends = [*breaks, span[1]]
    start = span[0]
    with np.errstate(all="ignore"):
        for end in ends:
            if enter is not None:
                enter(start, end)
            if start > span[0]:
                run.broken(start, x)
            x = run.segment(start, x, end)
            if motion.status != "finished":
                break
            start = end
    if motion.status != "finished" and run.last is not None:
        motion.keep_last(*run.last)
    return motion


class _Run:
    def __init__(
        self,
        f: Function,
        span: tuple[float, float],
        outputs: Array,
        settings: IntegratorSettings,
        watches: Sequence[Watch],
        progress: TimeReport | None,
    ) -> None:
        self.f, self.settings, self.watches, self.progress = f, settings, watches, progress
        self.outputs = outputs.tolist()
        self.next = 0
        self.levels: list[float] = []
        #: how often each was zero
        self.met = [0] * len(watches)
        #: the largest that they were
        self.sizes: list[float] = []
        self.span, self.end, self.tiny = span[1] - span[0], span[1], 0
        #: when, and after how many steps, it began to be thrown back from both sides of a corner
        self.slid: tuple[float, int] | None = None
        self.motion = IntegratedMotion()
        self.last: tuple[float, Array] | None = None
        #: where the integrator begins anew
        self.corner: tuple[float, Array] | None = None

    def begin(self, t: float, x: Array) -> None:
        """The first state."""
        self.motion.step_t.append(t)
        self.motion.step_x.append(x)
        self.last = t, x
        self.collect(t, lambda _: x)
        self.levels = [w.function(t, x) for w in self.watches]
        self.sizes = np.abs(self.levels).tolist()
        for watch, level in zip(list(self.watches), list(self.levels), strict=True):
            if watch.corner is not None and level == 0 and watch.corner.slides(t, x):
                self._left(watch.corner, t, x)

    def segment(self, start: float, x: Array, end: float) -> Array:
        """Integrate from start to end, from corner to corner; the last state."""
        x = self._piece(start, x, end)
        while self.corner is not None and self.motion.status == "finished":
            start, x = self.corner
            self.corner = None
            if start < end:
                x = self._piece(start, x, end)
        return x

    def _piece(self, start: float, x: Array, end: float) -> Array:
        """Integrate from start to the next corner, or to the end."""
        s, motion, solver = self.settings, self.motion, None
        try:
            solver = s.stepper(self.f, start, x, end)
            if np.isnan(getattr(solver, "h_abs", 0.0)):
                # of it SciPy makes steps without end
                is_tolerance = (x == 0).any() and np.isfinite(self.f(start, x)).all()
                raise ArithmeticError(NO_ERROR if is_tolerance else "the equations have no finite value")
            while solver.status == "running" and motion.status == "finished" and self.corner is None:
                if self._takes_many(solver):
                    continue
                message = solver.step()
                if solver.status == "failed":
                    motion.end("failed", self._advice(solver.t, str(message)))
                    break
                self._accepted(solver)
        except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
            motion.end("failed", self._advice(start if self.last is None else self.last[0], str(error)))
            return x
        finally:
            motion.evaluations += 0 if solver is None else solver.nfev
        return np.asarray(solver.y, dtype=np.float64)

    def _takes_many(self, solver: Any) -> bool:
        """Whether steps could be taken at once, between which nothing is watched."""
        if self.watches or self.slid is not None:
            return False
        least, most = TINY * self.span, self.settings.max_steps - 1 - self.motion.steps
        told = None if self.progress is None else self._goes_on
        found = taken_at_once(solver, self.outputs, self.next, least, most, told)
        if found is not None:
            self.motion.go_on(found)
            self.next += len(found.result_t)
            self.last, self.tiny = (float(found.t[-1]), found.x[-1]), 0
        return found is not None

    def _goes_on(self, t: float) -> bool:
        """Whether whoever watches the progress has not had enough."""
        if self.progress is not None and self.progress(t) is False and self.motion.status == "finished":
            self.motion.cancel(t)
        return self.motion.status == "finished"

    def _advice(self, t: float, message: str) -> str:
        if self.slid is not None and t - self.slid[0] < JUMP * self.span:
            return f"at t = {t:.9g} s {SLIDES}"
        return (
            f"the integrator could not go on at t = {t:.9g} s ({message.strip()}): the motion may be singular there; "
            f"look at the state, end the span before it, loosen 'relative_tolerance', or {self.settings.advice}"
        )

    def _accepted(self, solver: Any) -> None:
        motion = self.motion
        if not np.isfinite(solver.y).all():
            motion.end("failed", self._advice(solver.t_old, "the state is not finite"))
            return
        motion.keep(solver.t, solver.y.copy())
        self.last = float(solver.t), solver.y.copy()
        self.tiny = self.tiny + 1 if solver.t - solver.t_old < TINY * self.span else 0
        if self.tiny > PATIENCE:
            motion.end("failed", self._advice(solver.t, f"{PATIENCE} steps brought it no further"))
            return
        if self._chatters(solver.t):
            motion.end("failed", f"at t = {solver.t:.9g} s {SLIDES}")
            return
        dense = Dense(solver, self.settings.stepper)
        last = self._watch(solver, dense)
        self.collect(last, dense)
        if motion.status == "finished" and motion.steps >= self.settings.max_steps and solver.status == "running":
            advice = f"raise 'max_steps', loosen the tolerances, or {self.settings.advice}"
            motion.end("failed", f"{motion.steps:,} steps reached only t = {solver.t:.9g} s: {advice}")
        self._goes_on(solver.t)

    def collect(self, last: float, dense: Callable[[float], Array]) -> None:
        """Results at the wanted times up to ``last``."""
        while self.next < len(self.outputs) and self.outputs[self.next] <= last:
            t = self.outputs[self.next]
            x = np.array(dense(t), dtype=np.float64)  # or fails
            self.motion.t.append(t)
            self.motion.x.append(x)
            self.next += 1

    def _watch(self, solver: Any, dense: Dense) -> float:
        """Zeros in the last step, in the order of time, up to the first that stops; how far the motion goes."""
        zeros, earlier, until = list[tuple[float, int]](), list(self.levels), float(solver.t)
        for k, watch in enumerate(self.watches):
            before, after = self.levels[k], watch.function(solver.t, solver.y)
            self.levels[k], self.sizes[k] = after, max(self.sizes[k], abs(after))
            found, left = zeros_of(watch, solver, dense, (before, after), until), watch.count - self.met[k]
            zeros += [(t, k) for t in found]
            # nothing counts behind an event that stops
            if watch.stops and watch.corner is None and len(found) >= left:
                until = found[max(left, 1) - 1]
        zeros.sort()
        for i, (t, k) in enumerate(zeros):
            x = np.array(dense(t), dtype=np.float64)
            if self.watches[k].corner is not None:
                self.collect(t, dense)  # on the side that is left
                signs = {j: earlier[j] for _, j in zeros[i:]} | {j: self.levels[j] for _, j in zeros[:i]}
                self._turn(k, t, x, signs)
                return t
            self.motion.found.append((k, t, x))
            self.met[k] += 1
            if self.watches[k].stops and self.met[k] >= self.watches[k].count:
                self.motion.end("stopped", f"stopped by the event '{self.watches[k].name}' at t = {t:.9g} s")
                self.collect(t, dense)
                self.last = t, x
                self._drop(t)
                return t
        return float(solver.t)

    def _drop(self, t: float) -> None:
        """The end of the step lies beyond an event: no state of this motion."""
        if self.motion.step_t[-1] > t:
            del self.motion.step_t[-1], self.motion.step_x[-1]

    def _turn(self, k: int, t: float, x: Array, signs: Mapping[int, float]) -> None:
        """Begin anew at a corner, on its other side; ``signs`` of events that are before or after it."""
        self._drop(t)
        self.motion.keep(t, x)
        self.last = self.corner = t, x
        turned = self.watches[k].corner
        if turned is not None:
            before = [watch.function(t, x) for watch in self.watches]
            turned.take(-turned.side)
            self._jumped(t, x, before)
            if not turned.stays(t, x):
                self._left(turned, t, x)
        self.levels = [watch.function(t, x) for watch in self.watches]
        for i, watch in enumerate(self.watches):  # what is zero there is where it has to be, whatever the rounding
            side = signs.get(i, self.levels[i]) if watch.corner is None else watch.corner.side
            self.levels[i] = math.copysign(max(abs(self.levels[i]), LEAST), side)

    def _left(self, corner: Corner, t: float, x: Array) -> None:
        """No corner is followed any more, as the motion stays at one."""
        self.slid = (t, self.motion.steps) if corner.slides(t, x) else None
        corner.leave()
        kept = [i for i, watch in enumerate(self.watches) if watch.corner is None]
        self.watches = [self.watches[i] for i in kept]
        self.sizes, self.levels = ([each[i] for i in kept] for each in (self.sizes, self.levels))

    def _chatters(self, t: float) -> bool:
        """Whether what is thrown back from both sides of a corner would take far more steps than it may."""
        if self.slid is None or self.motion.steps < self.slid[1] + CHATTER:
            return False
        since, steps = self.slid
        self.slid = t, self.motion.steps
        return (self.motion.steps - steps) * (self.end - t) > 2 * self.settings.max_steps * (t - since)

    def broken(self, t: float, x: Array) -> None:
        """Go on behind a break, where levels of corners may have jumped."""
        self._jumped(t, x, self.levels)
        for i, watch in enumerate(self.watches):
            if watch.corner is not None:
                self.levels[i] = math.copysign(max(abs(watch.function(t, x)), LEAST), watch.corner.side)

    def _jumped(self, t: float, x: Array, before: Sequence[float]) -> None:
        """Take the sides of corners that were jumped over; those that others depend on come first."""
        for i, watch in enumerate(self.watches):
            if watch.corner is None:
                continue
            after = watch.function(t, x)
            self.sizes[i] = max(self.sizes[i], abs(after))
            if abs(after - before[i]) > JUMP * self.sizes[i]:
                watch.corner.take(math.copysign(1.0, after))
