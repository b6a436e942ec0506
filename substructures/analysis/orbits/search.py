"""Newton's method on the return map: one orbit, with its multipliers and checks (see periodic)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import numpy as np

from substructures.analysis.motion.conditions import state_names
from substructures.analysis.motion.simulation import TreeProblem
from substructures.analysis.motion.trajectory import Trajectory
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
        self.flow = HybridFlow(problem) if problem.events else Flow(problem)
        n, names = self.flow.n, state_names(problem.model)
        self.held = [names.index(name) for name in shooting.hold]
        self.is_fixed = shooting.is_fixed or self.flow.is_forced
        self.turned = np.zeros(2 * n)
        for name, turns in (shooting.turns or {}).items():
            self.turned[problem.model.coordinates.index(name)] = 2 * np.pi * turns
        self.returns = None if shooting.section is None else Returns(problem, shooting.section)
        if self.returns and self.flow.is_forced:
            message = "what acts depends on the time, so that the period is known: give 'period' in place of 'section'"
            raise InvalidArgument.at("/section", "not-supported", message)
        #: whether the orbit begins on the section
        self.is_met = self.returns is not None and not self.held

    def _begun(self) -> tuple[Array, float]:
        """Where the search begins. Raises EndsEarlyError."""
        x, period = self.flow.start.copy(), self.shooting.period
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
            return self.orbit(self.flow.start, self.shooting.period or np.nan, why, 0)
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
            x, period = x + step[:-1], period + float(step[-1])
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
        n, flow = self.flow.n, self.flow
        states, slopes = flow.move(x, np.eye(2 * n), (0.0, period), np.array([0.0, period]))
        end, monodromy = states[-1], slopes[-1]
        gap = end - x - self.turned
        rows = np.column_stack([monodromy - np.eye(2 * n), flow.rate(period, end)])
        right = -gap
        if not self.is_fixed and not self.held:  # no step along the motion
            along, short = flow.rate(0.0, x), 0.0
            if self.returns and self.is_met:
                along, short = self.returns.row(x, flow.conditions.values)
            rows, right = np.vstack([rows, np.append(along, 0.0)]), np.append(right, short)
        kept = {*self.held, *([2 * n] if self.is_fixed else [])}
        free = [k for k in range(2 * n + 1) if k not in kept]
        step = np.zeros(2 * n + 1)
        step[free] = np.linalg.lstsq(rows[:, free], right, rcond=1e-9)[0]
        return step, float(np.abs(gap).max() / (1 + np.abs(x).max()))

    def orbit(self, x: Array, period: float, message: str, iterations: int) -> Orbit:
        """What is known of it; with a message why it is none."""
        n = self.flow.n
        try:
            if np.isnan(period):
                raise EndsEarlyError(message)
            motion, monodromy = self.flow.motion(x, period, TIMES)
        except EndsEarlyError as error:
            message, names = message or str(error), self.problem.model.coordinates
            motion = Trajectory(names, np.zeros(1), x[None, :n], x[None, n:], status="failed", message=message)
            monodromy = np.full((2 * n, 2 * n), np.nan)
        if motion.status != "finished":
            message = message or motion.message
        multipliers = np.full(2 * n, np.nan, dtype=complex)
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
        found = x[:n], x[n:], period, multipliers, exponents, *told, status, message, iterations
        return Orbit(*found, checks, replace(motion, checks=()))

    def _checks(self, x: Array, period: float, motion: Trajectory, monodromy: Array) -> list[Check]:
        """The return, the multipliers' product, and the derivatives of the return map against differences."""
        last, states = np.array([period]), np.column_stack([motion.q, motion.qd])
        gap = np.array([np.abs(states[-1] - x - self.turned).max()])
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
        if self.flow.n != 1 or self.flow.is_forced or self.problem.events or not is_kept:
            return None
        inputs = self.flow.conditions.inputs_at(motion.t[:1], np.column_stack([motion.q, motion.qd])[:1])
        values = {**self.flow.conditions.values, **{name: float(x[0]) for name, x in inputs.items()}, "t": 0.0}
        return period_by_quadrature(self.problem.model, values, motion, float(self.turned[0]))

    def _differences(self, x: Array, period: float) -> Array:
        """dx(T)/dx by central differences."""
        one, ends = np.eye(len(x)), np.array([0.0, period])
        columns = []
        for k, h in enumerate(DIFFERENCE * np.maximum(1e-2, np.abs(x))):
            above, below = (self.flow.move(x + s * h * one[k], one, (0.0, period), ends)[0][-1] for s in (1, -1))
            columns.append((above - below) / (2 * h))
        return np.array(columns).T
