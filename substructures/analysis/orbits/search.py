"""Newton's method on the return map: one orbit, with its multipliers and checks (see periodic)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np
import scipy

from substructures.analysis.motion.conditions import state_names
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.orbits.flow import EndsEarlyError, Flow
from substructures.analysis.orbits.hybrid import HybridFlow
from substructures.analysis.orbits.orbit import Orbit, Shooting, stability
from substructures.analysis.orbits.quadrature import period_by_quadrature
from substructures.analysis.orbits.returns import Returns
from substructures.analysis.verdict import About, Check
from substructures.array import Array
from substructures.errors import InvalidArgument

#: times of an orbit in the result
TIMES = 101
#: relative, of the return to the start
CLOSED = 1e-9
ITERATIONS = 40
#: no step changes the state by more than this part of its size
LONGEST = 0.2
#: of the period that was given: what is shorter is no orbit but a place where nothing moves
SHORTEST = 0.1
#: what moves less in a period at its first rate, relative to the size of the state, rests
LEAST = 1e-6
#: steps of differences, relative, and what may be between them and the derivatives, relative to the square of those
DIFFERENCE, AGREE, RETURN = 1e-4, 1e-3, 1e-7


class Search:
    """Of one orbit. Raises InvalidInput and MissingValue as periodic_orbits."""

    def __init__(self, problem: TreeProblem, shooting: Shooting) -> None:
        self.problem, self.shooting = problem, shooting
        self.period = shooting.period_at(problem.model, problem.start.parameters or {})
        self.flow = HybridFlow(problem) if problem.events else Flow(problem)
        self.chart = self.flow.chart
        names = state_names(problem.model)
        self.held = [names.index(name) for name in shooting.hold]
        self.kept = self._numbers(self.flow.start)[self.held]
        self.is_fixed = shooting.is_fixed or self.flow.is_forced
        self.turned = np.zeros(self.chart.size)
        for name, turns in (shooting.turns or {}).items():
            self.turned[problem.model.positions.index(name)] = 2 * np.pi * turns
        self.returns = None if shooting.section is None else Returns(self.flow, problem, shooting.section)
        if self.returns and self.flow.is_forced:
            message = "what acts depends on the time, so that the period is known: give 'period' in place of 'section'"
            raise InvalidArgument.at("/section", "not-supported", message)
        #: whether the orbit begins on the section
        self.is_met = self.returns is not None and not self.held

    def _begun(self) -> tuple[Array, float]:
        """Where the search begins. Raises EndsEarlyError."""
        x, period = self.flow.start.copy(), self.period
        if self.returns and period is None:
            met, period = self.returns.first(x)
            x = x if self.held else met
        begun = x if self.held else self.flow.begun(x, period or 0.0)
        self.is_met = self.is_met and begun is x
        return begun, period or 0.0

    def run(self) -> Orbit:
        """The orbit, or how far the search came."""
        best = np.inf
        try:
            x, guess = self._begun()
        except EndsEarlyError as error:
            why = f"the motion from the start has no end: {error}"
            return self.orbit(self.flow.start, self.period or np.nan, why, 0)
        period = guess
        for k in range(ITERATIONS):
            try:
                step, size = self._step(x, period)
            except EndsEarlyError as error:
                return self.orbit(x, period, f"a motion on the way has no end: {error}", k)
            if size <= CLOSED or best <= size <= 1e3 * CLOSED:
                return self.orbit(x, period, self._rest(x, period), k)
            best = min(best, size)
            largest = max(np.abs(step[:-1]).max() / (1 + np.abs(x).max()), abs(step[-1]) / period)
            step *= min(1.0, LONGEST / largest) if largest > 0 else 1.0
            x, period = self.chart.moved(x, step[:-1]), period + float(step[-1])
            if period < SHORTEST * guess:
                why = f"the search comes to a period of {period:.3g} s, where there is nothing but rest"
                return self.orbit(x, period, why, k)
        why = f"after {ITERATIONS} steps of Newton's method the motion does not come back: choose another start"
        return self.orbit(x, period, why, ITERATIONS)

    def _rest(self, x: Array, period: float) -> str:
        """Why this is no orbit: nothing moves."""
        moved = float(np.abs(self.flow.rate(0.0, x)).max(initial=0)) * period
        if self.flow.is_forced or moved > LEAST * (1 + np.abs(x).max(initial=0)):
            return ""
        return "the search comes to rest at an equilibrium: hold what makes the orbit large, or choose another start"

    def _step(self, x: Array, period: float) -> tuple[Array, float]:
        """Newton's step of (x, T), and how far the motion is from where it began, relative to its size."""
        width, flow = self.chart.width, self.flow
        states, slopes = flow.move(x, np.eye(width), (0.0, period), np.array([0.0, period]))
        end, monodromy = states[-1], slopes[-1]
        gap = self._gap(x, end)
        size = float(np.abs(gap).max() / (1 + np.abs(x).max()))
        rows = np.column_stack([monodromy - np.eye(width), flow.rate(period, end)])
        right = -self.chart.along(x) @ gap
        if not self.is_fixed and not self.held:  # no step along the motion
            along, short = flow.rate(0.0, x), 0.0
            if self.returns and self.is_met:
                slopes_of, short = self.returns.row(x, flow.conditions.values)
                along = self.chart.ways(x) @ slopes_of
            rows, right = np.vstack([rows, np.append(along, 0.0)]), np.append(right, short)
        fixed, wanted = self._fixed(x)
        if not len(fixed):
            return np.linalg.lstsq(rows, right, rcond=1e-9)[0], size
        back, ways = np.linalg.pinv(fixed) @ wanted, scipy.linalg.null_space(fixed)
        return back + ways @ np.linalg.lstsq(rows @ ways, right - rows @ back, rcond=1e-9)[0], size

    def _fixed(self, x: Array) -> tuple[Array, Array]:
        """Rows of what stays as it is, of (x, T), and what they have to make up for."""
        unit, chart = np.eye(len(self._numbers(x))), self.chart
        rows = [np.append(chart.ways(x) @ self.flow.by_state(x, unit[k]), 0.0) for k in self.held]
        back = self.kept - self._numbers(x)[self.held]
        if self.is_fixed:
            rows, back = [*rows, np.eye(chart.width + 1)[-1]], np.append(back, 0.0)
        return np.array(rows).reshape(-1, chart.width + 1), back

    def _numbers(self, x: Array) -> Array:
        """q and q'."""
        return np.concatenate(self.flow.split(x))

    def _gap(self, x: Array, end: Array) -> Array:
        """What is between the start and the end (size,)."""
        return self.chart.difference(x, end - self.turned)

    def orbit(self, x: Array, period: float, message: str, iterations: int) -> Orbit:
        """What is known of it; with a message why it is none."""
        q, qd = self.flow.split(x)
        try:
            if np.isnan(period):
                raise EndsEarlyError(message)
            motion, monodromy = self.flow.motion(x, period, TIMES)
        except EndsEarlyError as error:
            message, names = message or str(error), self.problem.model.coordinates
            motion = Trajectory(names, np.zeros(1), q[None], qd[None], status="failed", message=message)
            monodromy = np.full((self.chart.width, self.chart.width), np.nan)
        if motion.status != "finished":
            message = message or motion.message
        multipliers = np.full(self.chart.width, np.nan, dtype=complex)
        if np.isfinite(monodromy).all():
            multipliers = np.linalg.eigvals(monodromy).astype(complex)
        multipliers = multipliers[np.argsort(-np.abs(multipliers), kind="stable")]
        with np.errstate(divide="ignore", invalid="ignore"):
            exponents = np.log(multipliers) / period
        told: tuple[Any, str] = ("unknown", "no orbit was found")
        checks: tuple[Check, ...] = motion.checks
        if not message:
            told = stability(multipliers, not self.flow.is_forced)
            checks = (*checks, *self._checks(x, period, motion, monodromy))
        status: Literal["finished", "failed"] = "failed" if message else "finished"
        found = q, qd, period, multipliers, exponents, *told, status, message, iterations
        return Orbit(*found, checks, replace(motion, checks=()))

    def _checks(self, x: Array, period: float, motion: Trajectory, monodromy: Array) -> list[Check]:
        """The return, the multipliers' product, and the derivatives of the return map against differences."""
        last, states = np.array([period]), self.flow.states(motion.q, motion.qd)
        gap = np.array([np.abs(self._gap(x, states[-1])).max()])
        about: About = ("return", "zero", "after a period the state is the first one", "")
        found = [Check.of(about, gap, last, 1 + float(np.abs(x).max()), RETURN)]
        expected = self.flow.volume(motion)
        sizes = np.abs(np.linalg.eigvals(monodromy))
        reason = "the product of the multipliers is exp of the integral of the divergence of the flow"
        scale = max(expected, 1e-3 * float(np.prod(np.maximum(1.0, sizes))))
        gap = np.array([np.linalg.det(monodromy) - expected])
        found.append(Check.of(("product", "accurate", reason, ""), gap, last, scale, AGREE))
        reason = "the derivative of the return map is what differences of motions give"
        gap = np.array([np.abs(self._differences(x, period) - monodromy).max()])
        scale = max(1.0, float(np.abs(monodromy).max())) ** 2
        found.append(Check.of(("return-map", "accurate", reason, ""), gap, last, scale, AGREE))
        if self.returns:
            found += self.returns.checks(x, period, self.flow.conditions.values if self.is_met else None)
        whole = self._by_quadrature(motion)
        if whole is not None:
            reason = "the period is that of the closed integral of sqrt(g/(2 (E - V))) dq, or a whole number of them"
            gap = np.array([period / whole - max(1, round(period / whole))])
            found.append(Check.of(("quadrature", "accurate", reason, "1"), gap, last, 1.0, RETURN))
        return found

    def _by_quadrature(self, motion: Trajectory) -> float | None:
        """The period of one coordinate at a constant energy, another way; None of others, and where it is open."""
        is_kept = any((check.name, check.rule) == ("energy", "constant") for check in motion.checks)
        if self.flow.n != 1 or self.flow.equations or self.flow.is_forced or self.problem.events or not is_kept:
            return None
        inputs = self.flow.conditions.inputs_at(motion.t[:1], np.column_stack([motion.q, motion.qd])[:1])
        values = {**self.flow.conditions.values, **{name: float(x[0]) for name, x in inputs.items()}, "t": 0.0}
        return period_by_quadrature(self.problem.model, values, motion, float(self.turned[0]))

    def _differences(self, x: Array, period: float) -> Array:
        """dx(T)/dx by central differences."""
        one, ends, chart = np.eye(self.chart.width), np.array([0.0, period]), self.chart
        columns = []
        for k, h in enumerate(DIFFERENCE * np.maximum(1e-2, np.abs(chart.along(x) @ x))):
            starts = (chart.moved(x, s * h * one[k]) for s in (1, -1))
            above, below = (self.flow.move(start, one, (0.0, period), ends)[0][-1] for start in starts)
            columns.append(chart.along(below) @ chart.difference(below, above) / (2 * h))
        return np.array(columns).T
