"""Families of periodic orbits over a parameter, by pseudo-arclength, with their bifurcations.

The unknowns are those of shooting, the state on the orbit and a period that is free, and the parameter. States with
quaternions or on closures are all their numbers, with what these keep, |Q|^2 = 1 and phi = 0, among the equations
(:mod:`.charts`). It is watched whether the value rises, and how many multipliers, but for the one along a free motion,
are beyond the unit circle on the real axis at +1, at -1, and in pairs:

    fold               the value is extreme, the family turns back; a multiplier is +1
    branch-point       another multiplier passes through +1: a family crosses, or symmetry is lost
    period-doubling    a multiplier passes through -1
    torus              a pair leaves the unit circle (Neimark and Sacker)

R. Seydel, Practical Bifurcation and Stability Analysis, 3rd ed. 2010, chapters 4 and 7.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from substructures.analysis.continuation import Change, Continuation
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.orbits.flow import EndsEarlyError
from substructures.analysis.orbits.orbit import NOISE, BifurcationKind, Family, Orbit, OrbitBifurcation, Shooting
from substructures.analysis.orbits.search import Search
from substructures.array import Array

#: of the range, in differences by the parameter
STEP = 1e-4
#: of a step: what changes so near to a fold is the fold
NEAR = 0.1
#: orbits over those of one range
MOST = 10
#: what is told of a change, in the order of what is watched
TOLD: tuple[tuple[BifurcationKind, str], ...] = (
    ("fold", "the value is extreme along the family, which turns back: a multiplier is +1"),
    ("branch-point", "a multiplier passes through +1 where the value is not extreme: another family crosses"),
    ("period-doubling", "a multiplier passes through -1: a family of twice the period branches off"),
    ("torus", "a pair of multipliers passes through the unit circle"),
)


def orbit_family(
    problem: TreeProblem, shooting: Shooting, vary: str, between: tuple[float, float], steps: int
) -> Family:
    """The family through the orbit near the start at the first value, to the end of the range of values."""
    coordinates = problem.model.coordinates
    first = replace(_with(problem, shooting, vary, between[0]).run(), value=between[0])
    if first.status != "finished":
        return Family(coordinates, vary, (first,))
    branch = _Branch(problem, shooting, vary, between, first)
    curve = Continuation(branch.equations, branch.signature, 1 / steps)
    points, changes = list[Array](), list[Change]()
    with np.errstate(all="ignore"):
        for u, met in curve.follow(branch.first, np.eye(len(branch.first))[-1]):
            points.append(u)
            changes += met
            if len(points) == MOST * steps:
                curve.message = f"{len(points)} orbits were followed, and no others: raise 'steps', or choose a range"
                break
    folds = [one for one in changes if one.which == 0]
    kept = [
        one
        for one in changes
        if one.which != 1 or all(np.linalg.norm(one.u - fold.u) > NEAR * curve.step for fold in folds)
    ]
    bifurcations = tuple(OrbitBifurcation(*TOLD[one.which], branch.orbit(one.u)) for one in kept)
    return Family(coordinates, vary, tuple(map(branch.orbit, points)), bifurcations, curve.message)


def _with(problem: TreeProblem, shooting: Shooting, vary: str, value: float) -> Search:
    start = problem.start
    return Search(replace(problem, start=replace(start, parameters={**start.parameters, vary: value})), shooting)


class _Branch:
    """u = (x, T, s) over their sizes, but for what is held or fixed."""

    def __init__(
        self, problem: TreeProblem, shooting: Shooting, vary: str, between: tuple[float, float], orbit: Orbit
    ) -> None:
        self.problem, self.vary, self.between = problem, vary, between
        self.shooting = replace(shooting, section=None)
        search = _with(problem, replace(self.shooting, period=orbit.period), vary, between[0])
        self.z = np.append(search.flow.states(orbit.q[None], orbit.qd[None])[0], orbit.period)
        #: whether the period is a formula
        self.is_told = search.is_fixed and isinstance(shooting.period, str)
        self.shooting = self.shooting if self.is_told else search.shooting
        self.is_forced = search.flow.is_forced
        self.start, self.along = self.z[:-1].copy(), search.flow.full_rate(0.0, self.z[:-1])
        # of states that are no coordinates and velocities what is held is an equation
        self.is_flat = search.chart.is_flat
        kept = {*(search.held if self.is_flat else ()), *([len(self.z) - 1] if search.is_fixed else [])}
        self.is_phase_free = not (search.held or search.is_fixed)
        self.free = [k for k in range(len(self.z)) if k not in kept]
        self.size = np.full(len(self.z), 1 + np.abs(self.start).max())
        self.size[-1] = orbit.period
        self.first = np.append((self.z / self.size)[self.free], 0.0)
        self._known: dict[bytes, tuple[Array, Array, Array]] = {}

    def _search(self, value: float) -> Search:
        return _with(self.problem, self.shooting, self.vary, value)

    def _at(self, u: Array) -> tuple[Array, float, float]:
        """State, period and value."""
        z = self.z.copy()
        z[self.free] = u[:-1] * self.size[self.free]
        return z[:-1], float(z[-1]), self._value(u[-1])

    def _value(self, s: float) -> float:
        return (1 - s) * self.between[0] + s * self.between[1]

    def orbit(self, u: Array) -> Orbit:
        """With its multipliers and checks."""
        x, period, value = self._at(u)
        search = self._search(value)
        return replace(search.orbit(x, self._period(search, period), "", 0), value=value)

    def equations(self, u: Array) -> tuple[Array, Array]:
        """(x(T) - x, phase) over the sizes, and derivatives; not a number where a motion ends early."""
        return self._computed(u)[:2]

    def signature(self, u: Array) -> tuple[int, ...]:
        """How many multipliers are beyond +1, -1, and in pairs beyond the unit circle."""
        found, noise = np.linalg.eigvals(self._computed(u)[2]), 0.0
        if not self.is_forced:
            found, noise = np.delete(found, np.argmin(np.abs(found - 1))), NOISE
        beyond = found[np.abs(found) > 1 + noise]
        real = beyond[beyond.imag == 0].real
        return int((real > 0).sum()), int((real < 0).sum()), int((beyond.imag > 0).sum())

    def _computed(self, u: Array) -> tuple[Array, Array, Array]:
        """F, F_u and the monodromy matrix."""
        key = u.tobytes()
        if key not in self._known:
            if len(self._known) > 64:
                self._known.clear()
            try:
                self._known[key] = self._compute(u)
            except EndsEarlyError:
                search, k = self._search(self._value(u[-1])), len(self.free)
                rows = len(self.start) + self.is_phase_free + len(self._held(search, self.start)[0])
                nowhere = np.full((rows, k + 1), np.nan), np.full((search.chart.width, search.chart.width), np.nan)
                self._known[key] = np.full(rows, np.nan), *nowhere
        return self._known[key]

    def _compute(self, u: Array) -> tuple[Array, Array, Array]:
        x, period, value = self._at(u)
        search, size = self._search(value), self.size
        end, monodromy = self._ends(search, x, period)
        period, along = self._period(search, period), search.chart.along(x)
        others = [self._search(self._value(u[-1] + side * STEP)) for side in (1, -1)]
        sides = [self._ends(other, x, period)[0] for other in others]
        met, normals = search.chart.surface(x)
        held, by_held = self._held(search, x)
        rows = np.column_stack([(monodromy - np.eye(len(along))) @ along, search.flow.rate(period, end)])
        more = np.column_stack([np.vstack((normals, by_held)), np.zeros(len(met) + len(held))])
        rows = np.vstack((rows, more)) * size / size[0]
        F = np.concatenate((along @ search._gap(x, end), met, held)) / size[0]
        moved = [np.append(along @ side, other.chart.surface(x)[0]) for side, other in zip(sides, others, strict=True)]
        slopes = np.append(moved[0] - moved[1], 0 * held) / (2 * STEP) / size[0]
        if self.is_phase_free:  # no step along the motion where the family begins
            scale = float(np.linalg.norm(self.along)) * size[0]
            F = np.append(F, self.along @ (x - self.start) / scale)
            rows = np.vstack((rows, np.append(self.along, 0.0) * size / scale))
            slopes = np.append(slopes, 0.0)
        return F, np.column_stack((rows[:, self.free], slopes)), monodromy

    def _held(self, search: Search, x: Array) -> tuple[Array, Array]:
        """What is held less what it is at the start (k,), and its derivatives (k, size), where it is an equation."""
        if self.is_flat or not search.held:
            return np.zeros(0), np.zeros((0, len(x)))
        now = np.concatenate(search.flow.split(x))
        rows = np.array([search.flow.by_state(x, unit) for unit in np.eye(len(now))[search.held]])
        return (now - np.concatenate(search.flow.split(self.start)))[search.held], rows

    def _period(self, search: Search, period: float) -> float:
        """That of the formula, if it is one."""
        return search.period if self.is_told and search.period else period

    def _ends(self, search: Search, x: Array, period: float) -> tuple[Array, Array]:
        period = self._period(search, period)
        states, slopes = search.flow.move(x, np.eye(search.chart.width), (0.0, period), np.array([0.0, period]))
        return states[-1], slopes[-1]
