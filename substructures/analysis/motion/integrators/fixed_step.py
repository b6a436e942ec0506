"""Real-time mode: steps of a fixed size with a known number of evaluations."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Literal

import numpy as np

from substructures.analysis.arguments import one_of, positive
from substructures.analysis.motion.integrators.compiled_steps import rates_of
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import Function, TimeReport
from substructures.array import Array
from substructures.compile.motion import CompiledRates, CompiledRun, Tableau
from substructures.errors import InvalidArgument

StepMethod = Callable[[Function, float, Array, float], Array]
EVALUATIONS = {"semi-implicit-euler": 1, "rk4": 4}


@dataclass(frozen=True)
class FixedStep:
    """Real-time mode: steps of ``step`` [s] that take the same, known time each, without control of their errors.

    ``method``: semi-implicit Euler (one evaluation a step), or Runge-Kutta of fourth order (four). Raises
    InvalidArgument.
    """

    step: float
    method: Literal["semi-implicit-euler", "rk4"] = "rk4"

    def __post_init__(self) -> None:
        object.__setattr__(self, "step", positive(self.step, "step"))
        one_of(self.method, "method", tuple(EVALUATIONS))

    def halved(self) -> FixedStep:
        """Steps half as long."""
        return replace(self, step=self.step / 2)


@dataclass(frozen=True)
class Pace:
    """Measured: seconds of motion in a second of computing, and the longest computing time of a step [s]."""

    factor: float
    longest: float

    @property
    def figures(self) -> dict[str, float]:
        """By the names of trajectories."""
        return {"real_time_factor": self.factor, "longest_step": self.longest}


def require_no_stops(events: Collection[object]) -> None:
    """Raises InvalidArgument (``/events``) where there are any."""
    if events:
        message = "steps of a fixed size do not stop for events: leave 'events' or 'fixed_step' out"
        raise InvalidArgument.at("/events", "not-supported", message)


def rk4(f: Function, t: float, x: Array, h: float) -> Array:
    """The classical Runge-Kutta method of fourth order; four evaluations."""
    # x_1 = x + h/6 (k_1 + 2 k_2 + 2 k_3 + k_4)
    k1 = f(t, x)
    k2 = f(t + h / 2, x + h / 2 * k1)
    k3 = f(t + h / 2, x + h / 2 * k2)
    k4 = f(t + h, x + h * k3)
    return x + h / 6 * (k1 + 2 * (k2 + k3) + k4)


#: the same as coefficients, without an estimate of the error
RK4 = Tableau(
    ((0.0,) * 4, (1 / 2, 0.0, 0.0, 0.0), (0.0, 1 / 2, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0)),
    (1 / 6, 1 / 3, 1 / 3, 1 / 6),
    (0.0, 1 / 2, 1 / 2, 1.0),
    (0.0,) * 5,
    (0.0,) * 5,
    -1.0,
)


def compiled_rk4(rates: CompiledRates) -> StepMethod:
    """:func:`rk4` in machine code around kernels; four evaluations where a step begins at the end of the last one."""
    run, reached = CompiledRun(RK4, rates, (0.0, 1.0)), np.zeros(0)

    def step(_: Function, t: float, x: Array, h: float) -> Array:
        """One step."""
        nonlocal reached
        if x is reached:
            run.go_on(t, t + h, h)
        else:
            run.begin(t, x, t + h, h)
        made = run.advance()
        # a step that is no number is none
        reached = run.state if len(made) else np.full(len(x), np.nan)
        return reached

    return step


def semi_implicit_euler(n: int, m: int | None = None, move: Callable[[Array, Array], Array] = np.add) -> StepMethod:
    """Velocities first, then coordinates with the new velocities; one evaluation. ``n``: number of velocities, ``m`` of
    the numbers q before them (default n); ``move``: where q comes at constant rates, (n,) in all (default: q + h q').
    """
    m = n if m is None else m

    def step(f: Function, t: float, x: Array, h: float) -> Array:
        """One step: velocities first."""
        # q'_1 = q' + h q''(t, q, q'), then q_1 = q + h q'_1
        new = x + h * f(t, x)
        new[:m] = move(x[:m], h * new[m : m + n])
        return new

    return step


def rk4_of(rates: CompiledRates | None) -> StepMethod:
    """In machine code where the function consists of kernels."""
    return rk4 if rates is None else compiled_rk4(rates)


def march(
    f: Function,
    euler: StepMethod,
    x: Array,
    span: tuple[float, float],
    outputs: Array,
    fixed: FixedStep,
    max_steps: int,
    progress: TimeReport | None = None,
) -> tuple[IntegratedMotion, Pace]:
    """Steps of size ``fixed.step`` over the span (the last one may be shorter); ``euler``: of semi-implicit Euler.

    Outputs within a step are the ends of shorter steps from its start.
    """
    step = euler if fixed.method != "rk4" else rk4_of(rates_of(f))
    motion, wanted = IntegratedMotion(step_t=[span[0]], step_x=[x]), outputs.tolist()
    count = max(1, math.ceil((span[1] - span[0]) / fixed.step * (1 - 1e-12)))
    longest, t, k, begin = 0.0, span[0], 0, perf_counter()
    with np.errstate(all="ignore"):
        while motion.status == "finished" and motion.steps < count:
            before = perf_counter()
            end = span[1] if motion.steps == count - 1 else span[0] + (motion.steps + 1) * fixed.step
            new = step(f, t, x, end - t)
            longest = max(longest, perf_counter() - before)
            while k < len(wanted) and wanted[k] <= end:
                motion.t.append(wanted[k])
                motion.x.append(new if wanted[k] == end else step(f, t, x, wanted[k] - t))
                k += 1
            t, x = end, new
            _accepted(motion, t, x, max_steps, count, progress)
    pace = Pace((t - span[0]) / max(perf_counter() - begin, 1e-9), longest)
    motion.evaluations = motion.steps * EVALUATIONS[fixed.method]
    return motion, pace


def _accepted(
    motion: IntegratedMotion, t: float, x: Array, max_steps: int, count: int, progress: TimeReport | None
) -> None:
    if not np.isfinite(x).all():
        advice = "take a smaller 'fixed_step', or leave it out for an integrator that chooses its steps"
        motion.end("failed", f"the motion is not finite at t = {t:.9g} s: {advice}")
        return
    motion.keep(t, x)
    if motion.steps >= max_steps and motion.steps < count:
        motion.end("failed", f"{motion.steps:,} steps reached only t = {t:.9g} s: raise 'max_steps'")
    elif progress is not None and progress(t) is False:
        motion.cancel(t)
