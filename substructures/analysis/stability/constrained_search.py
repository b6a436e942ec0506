"""Steady motions and positions of rest of trees with velocity constraints: v' = 0, and all that matters keeps still.

Coordinates on which nothing depends (the place on the plane, the heading, the angle of a wheel) are ignorable; all
others x keep still. Sought are x and the quasi-velocities v, which are 0 at rest, with

    e(x, v) = bias - forces = 0        x' = (T v + r)_x = 0        gaps(x) = 0        q'^a = w_a of what is given

by Newton's method with the derivatives of :mod:`substructures.analysis.equations.nonholonomic.linearised`. Gaps are
those of planes through the origin of the world. Steady motions of such systems are families of some parameters: rates
that leave ways free are met by motions without number, and the one nearest to each start that is given, or to rest, is
taken (Ju. I. Neimark and N. A. Fufaev, Dynamics of Nonholonomic Systems, 1972, chapter VI).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from substructures.analysis.equations.nonholonomic.linearised import linearised
from substructures.analysis.equations.nonholonomic.quasi_velocities import chosen_near, rows_of
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of, row_values
from substructures.analysis.motion.problems.kinds import ConstrainedMotion
from substructures.analysis.stability.equilibrium_search import RESIDUAL, SAME, SearchRange
from substructures.analysis.stability.linearisation_result import ConstrainedLinearisation
from substructures.analysis.stability.linearise_constrained import (
    MATRICES,
    choice_of,
    ignorable_coordinates,
    linearise_constrained,
    values_at,
)
from substructures.analysis.stability.operating_point import OperatingPoint, RestConditions
from substructures.array import Array
from substructures.errors import Fault, InvalidArgument, listed
from substructures.expr.interpret import interpret
from substructures.quantities.measured import numeric
from substructures.tree.model import Model

#: singular values below this share of the largest leave a way free
FREE = 1e-8
#: steps of Newton's method, the longest one [rad, reach, 1/s, ...], and the least part of one that is tried
STEPS, FARTHEST, SHORTEST = 100, 0.5, 1e-4
#: what rounding leaves of forces that are the same after a full turn
NOTHING = 1e-14


@dataclass(frozen=True)
class FoundState:
    """A steady motion, and by how many parameters others with the same rates are beside it."""

    at: ConstrainedLinearisation
    free: int


class ConstrainedSearch:
    """Places y = (x, v), or x alone at rest. ``rates``: by coordinate or quasi-velocity, or None at rest;
    ``velocities``, ``independent``: see quasi_velocity_equations, by default chosen near the first start, or zero
    where that is possible.

    Raises InvalidInput as quasi_velocity_equations, InvalidArgument (``/rates/name``) for coordinates whose rates are
    not constant in a steady motion, and MissingValue.
    """

    def __init__(
        self,
        model: Model,
        within: SearchRange,
        conditions: RestConditions,
        rates: Mapping[str, float] | None,
        velocities: Mapping[str, str] | None = None,
        independent: Sequence[str] | None = None,
    ) -> None:
        self.model, self.within, self.conditions = model, within, conditions
        #: near the first ones a member of a family is wanted
        self.near, self.random = _starts(model, within)
        n = model.dof
        constraints = constraints_of(model)
        if velocities is None and independent is None:
            independent = self._chosen((self.near[0], self.random[0]))
        self.kind = ConstrainedMotion(constraints, velocities=velocities, independent=independent)
        self.equations, self.matrices = linearised(model, constraints, choice_of(self.kind, {}))
        self.known = self._values()
        order, moved = ignorable_coordinates(model.coordinates, self.equations.velocities, self.matrices, self.known)
        self.ignorable = sorted(order)
        #: at a constant rate in a steady motion
        self.moving = [a for a in self.ignorable if not moved[a, order].any()]
        self.still = [a for a in range(n) if a not in order]
        self.p = 0 if rates is None else len(self.equations.velocities)
        self.rates, self.speeds = dict[int, float](), dict[int, float]()
        for name, w in self._known_rates(rates or {}).items():
            self._put_rate(name, w)
        turning = [model.joints[a] == "R" for a in self.still]
        self.length = np.concatenate((np.where(turning, 1.0, within.reach), np.ones(self.p)))
        self.turning = np.array([*turning, *[False] * self.p], dtype=bool)
        self.n = len(self.length)

    def _chosen(self, places: Sequence[Array]) -> tuple[str, ...]:
        """Independent coordinates near the first place where there are such."""
        constraints = constraints_of(self.model)
        f, rows = rows_of(self.model, constraints)
        for place in places:
            at = values_at(self._point(place))
            if not rows or np.isfinite(row_values(f, rows, at)).all():
                break
        return chosen_near(self.model, constraints, at)

    def _values(self) -> dict[str, float]:
        """Of all symbols, where nothing moves."""
        rest = {f"{name}{prime}": 0.0 for name in self.equations.velocities for prime in ("", "'")}
        return values_at(self._point(self.near[0])) | rest

    def _put_rate(self, name: str, value: float) -> None:
        names = self.equations.velocities
        if name in names:
            self.speeds[names.index(name)] = value
        else:
            self.rates[self.model.coordinates.index(name)] = value

    def put(self, name: str, value: float) -> None:
        """A parameter, or the rate of a coordinate or quasi-velocity that is given, has another value."""
        if name in self.model.parameters:
            self.conditions = replace(self.conditions, parameters={**self.conditions.parameters, name: value})
            self.known = self._values()
        else:
            self._put_rate(name, value)

    def measure(self, speed: float) -> None:
        """Quasi-velocities are measured by this one, as lengths are by the reach."""
        self.length[len(self.still) :] = speed

    def is_rate(self, name: str) -> bool:
        """Whether this is no parameter."""
        return name not in self.model.parameters

    def by_rate(self, name: str) -> Array:
        """Derivatives of what is zero by a rate that is given."""
        names, k = self.equations.velocities, len(self.equations.velocities) + len(self.still)
        wanted = [*self.rates, *(len(self.model.coordinates) + i for i in self.speeds)]
        number = len(self.model.coordinates) + names.index(name) if name in names else -1
        number = self.model.coordinates.index(name) if number < 0 else number
        result = np.zeros(k + len(wanted) + len(self.equations.gaps))
        result[k + wanted.index(number)] = -1.0
        return result

    def _point(self, q: Array) -> OperatingPoint:
        held = self.conditions
        return OperatingPoint(self.model, q, None, None, held.t, held.parameters, held.inputs, {}, None)

    def _known_rates(self, rates: Mapping[str, float]) -> Mapping[str, float]:
        known = [*self.named(self.moving), *self.equations.velocities]
        message = (
            f"has no rate that is constant in steady motions in the velocities {listed(self.equations.velocities)}: "
            f"these are {listed(known) or 'none'}; or take other 'velocities'"
        )
        faults = [
            Fault(f"/rates/{name}", "not-cyclic", f"'{name[:80]}' {message}") for name in rates if name not in known
        ]
        if faults:
            raise InvalidArgument(faults)
        return rates

    def place(self, at: ConstrainedLinearisation) -> Array:
        """y of a linearisation."""
        return np.concatenate((at.q[self.still], at.v[: self.p]))

    def equations_at(self, y: Array) -> tuple[Array, Array]:
        """What is zero, and its Jacobian."""
        x, k = self.still, len(self.still)
        names = [*(self.model.coordinates[a] for a in x), *self.equations.velocities[: self.p]]
        at = self.known | dict(zip(names, y.tolist(), strict=True))
        gaps = ["gaps"] if self.equations.gaps else []
        found = interpret(self.equations.program, at, ["rates", *gaps])
        found |= interpret(self.matrices, at, [*MATRICES[:3], *MATRICES[4:], *(f"{name}_by_position" for name in gaps)])
        rates = np.array([*x, *self.rates], dtype=np.int64)
        wanted = np.array([0.0] * k + list(self.rates.values()))
        lines = [
            (found["residual"], found["stiffness"][:, x], found["damping"]),
            (
                found["rates"][rates] - wanted,
                found["rates_by_position"][np.ix_(rates, np.array(x, dtype=np.int64))],
                found["T"][rates],
            ),
        ]
        if self.speeds:
            some, v = list(self.speeds), y[k:]
            lines.append((v[some] - list(self.speeds.values()), np.zeros((len(some), k)), np.eye(self.p)[some]))
        if gaps:
            none = np.zeros((len(found["gaps"]), len(self.equations.velocities)))
            lines.append((found["gaps"], found["gaps_by_position"][:, x], none))
        F = np.concatenate([line[0] for line in lines])
        J = np.vstack([np.hstack([line[1], line[2][:, : self.p]]) for line in lines])
        return F, J

    def found(self) -> list[FoundState]:
        """Different ones, in the order of their coordinates."""
        places: list[tuple[Array, int]] = []
        for i, start in enumerate((*self.near, *self.random[1:])):
            found = self._solve(start[self.still])
            # of a family, the members near to what is given
            if found is None or (found[1] and i >= len(self.near)):
                continue
            if not any(self.distance(found[0], y) < SAME for y, _ in places):
                places.append(found)
        if places:
            order = np.lexsort(np.round(np.array([y / self.length for y, _ in places]), 6).T[::-1])
            places = [places[i] for i in order]
        states = [FoundState(self.linearised(y), free) for y, free in places]
        return [state for state in states if state.at.is_steady]

    def _solve(self, x: Array) -> tuple[Array, int] | None:
        y = np.concatenate((x, np.zeros(self.p)))
        F, J = self.equations_at(y)
        if not (np.isfinite(F).all() and np.isfinite(J).all()):
            return None
        if self.p:
            # velocities as near as can be to what is wanted
            rows = slice(len(self.equations.velocities), None)
            y[len(x) :] = np.linalg.lstsq(J[rows, len(x) :], -F[rows], rcond=1e-10)[0]
            F, J = self.equations_at(y)
        sizes = np.abs(J * self.length).max(axis=1, initial=0)
        unit = np.where(sizes > 0, sizes, 1.0)

        def both(z: Array) -> tuple[Array, Array]:
            """Equations and Jacobian over the units."""
            F, J = self.equations_at(z)
            return F / unit, np.where(np.isfinite(J), J, 0.0) / unit[:, None]

        y = self._newton(both, y) if len(y) else y
        F, J = both(y)
        if not (np.abs(F) <= RESIDUAL * np.fmax(1.0, np.abs(J * self.length).max(axis=1, initial=0))).all():
            return None
        sizes = np.linalg.svd(J * self.length, compute_uv=False) if len(y) else np.zeros(0)
        rank = int((sizes > FREE * sizes.max(initial=0)).sum())
        return self.wound(y), len(y) - rank

    def _newton(self, both: Callable[[Array], tuple[Array, Array]], y: Array) -> Array:
        """Steps of least size, as of families of places, shortened where they do not lead nearer."""
        for _ in range(STEPS):
            F, J = both(y)
            step = np.linalg.lstsq(J * self.length, -F, rcond=FREE)[0]
            step *= self.length * min(1.0, FARTHEST / (np.abs(step).max(initial=0) or 1.0))
            share, size = 1.0, float(np.linalg.norm(F))
            while share > SHORTEST and not np.linalg.norm(both(y + share * step)[0]) < size:
                share /= 2
            if share <= SHORTEST:
                return y
            y = y + share * step
        return y

    def wound(self, y: Array) -> Array:
        """Angles in (-pi, pi], where a full turn changes nothing."""
        (before, J), wound = self.equations_at(y), y.copy()
        sizes = np.nan_to_num(np.abs(J * self.length)).max(axis=1, initial=0)
        least = np.fmax(SAME * sizes, NOTHING)
        for a in np.flatnonzero(self.turning):
            other = y.copy()
            other[a] = np.pi - np.mod(np.pi - y[a], 2 * np.pi)
            if (np.abs(self.equations_at(other)[0] - before) <= least).all():
                wound[a] = other[a]
        return wound

    def distance(self, y: Array, z: Array) -> float:
        """The largest difference, angles by the shorter way."""
        d = np.abs(y - z) / self.length
        return float(np.where(self.turning, np.minimum(d, np.abs(2 * np.pi - d)), d).max(initial=0))

    def linearised(self, y: Array) -> ConstrainedLinearisation:
        """The linearisation about y."""
        q, k = np.zeros(self.model.dof), len(self.still)
        q[self.still] = y[:k]
        return linearise_constrained(self._point(q), replace(self.kind, v=y[k:] if self.p else None))

    def named(self, some: Sequence[int]) -> tuple[str, ...]:
        """Names of coordinates."""
        return tuple(self.model.coordinates[a] for a in some)


def _starts(model: Model, within: SearchRange) -> tuple[Array, Array]:
    """Those that are given and zero, and random ones, one more than are wanted."""
    rng, n = np.random.default_rng(within.seed), model.dof
    size = np.where([kind == "R" for kind in model.joints], np.pi, within.reach)
    given = np.zeros((0, n)) if within.starts is None else np.atleast_2d(numeric(within.starts, "/starts"))
    if given.ndim != 2 or given.shape[1] != n:
        raise InvalidArgument.at("/starts", "wrong-length", f"shape {given.shape} found, (N, {n}) expected")
    given = np.concatenate((given, np.zeros((int(within.from_zero), n))))
    return given, rng.uniform(-1, 1, (within.count + 1, n)) * size
