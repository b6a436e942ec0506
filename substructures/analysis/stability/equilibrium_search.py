"""The search for positions of rest: forces and their Jacobian, compiled, and Newton's method from many starts.

-Q_a(q, q' = 0) = 0, with the Jacobian K = -dQ/dq. So that mechanisms of any size and mass are searched alike, distances
count over the reach, and every force over how large it is elsewhere (``unit``).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from substructures.analysis.arguments import positive, whole
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.meetings import with_sides
from substructures.analysis.equations.perturbation import perturbation
from substructures.analysis.stability.operating_point import RestConditions, forces_that_are
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.quantities.measured import numeric
from substructures.quantities.numbers.quaternions import by_displacements, quaternions_in, with_unit_quaternions
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

#: two places closer than this are one [rad, m]
SAME = 1e-6
#: singular values of K below this share of the largest are none, and steps and their size along a family of places
FREE, SLIDES, STEP = 1e-8, 60, 0.3
#: forces left over, in units of the search, or relative to the largest entry of K times 1 rad or 1 m
RESIDUAL = 1e-10
NEEDS = ("metric", "forces")
MAX_STARTS = 10_000
MAX_SEED = 2**1000
#: of the search from one start
STEPS = 200
#: places where forces are looked at before, and the part of the largest one below which a force is rounding
PLACES, NOTHING = 8, 1e-13
#: of a start on a corner of a force [rad, m]
BESIDE = 1e-6
TOLERANCES = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)


@dataclass(frozen=True)
class SearchRange:
    """Where positions of rest are looked for: ``starts`` (N, n) that are given, zero (``from_zero``), and ``count``
    random ones in +-pi for angles, +-``reach`` [m] for distances. Raises InvalidArgument.
    """

    starts: Sequence[float] | Sequence[Sequence[float]] | Array | None = None
    count: int = 32
    reach: float = 1.0
    seed: int = 0
    from_zero: bool = True

    def __post_init__(self) -> None:
        whole(self.count, "count", 0, MAX_STARTS)
        object.__setattr__(self, "reach", positive(self.reach, "reach"))
        whole(self.seed, "seed", 0, MAX_SEED)


class RestSearch:
    """Forces of a tree and their Jacobian at rest, compiled."""

    def __init__(self, model: Model, within: SearchRange, conditions: RestConditions) -> None:
        n, self.n = model.dof, len(model.positions)
        self.model, self.within, self.conditions = model, within, conditions
        self.quaternions, start = quaternions_in(model.positions, model.balls), np.zeros(self.n)
        start[[some[0] for some in self.quaternions]] = 1
        states = read_states(model, {"q": start}, None)
        known = symbol_values(model, vars(conditions), states, NEEDS)
        values = {name: float(np.ravel(x)[0]) for name, x in known.items()}
        values |= {f"{name}''": 0.0 for name in model.coordinates}
        self.q, self.F, self.K = states.q.copy(), np.zeros((1, n)), np.zeros((1, n, n))
        outputs, columns = self._also()
        outputs |= {"residual": self.F, "stiffness": self.K}
        columns.append((list(model.positions), self.q))
        self.run, self._values = program_kernel(perturbation(model)).bind(outputs, values, columns=columns), values
        self._sized([model.state_units["q"][name] for name in model.positions])

    def _sized(self, units: Sequence[str]) -> None:
        """Where is looked, in which unit of force, and what has come round after a full turn."""
        reach = self.within.reach
        self.size = np.array([{"rad": np.pi, "m": reach}.get(unit, 1.0) for unit in units])
        self.length = np.array([reach if unit == "m" else 1.0 for unit in units])
        self.turning, self.unit = np.zeros(self.n, dtype=bool), np.ones(1)
        # |Q_a| and |K_ab| times a unit of q^b; a force that is rounding has no size of its own
        sizes = np.zeros(1)
        for q in self._anywhere():
            F, K = self.at(q)
            there = np.abs(np.column_stack((F, K * self.length)))
            sizes = np.maximum(sizes, np.where(np.isfinite(there), there, 0).max(axis=1, initial=0))
        sizes = self._without_rounding(sizes)
        largest = float(sizes.max(initial=0)) or 1.0
        self.unit = np.where(sizes > NOTHING * largest, sizes, largest)
        self.turning = np.array([x == "rad" and self._is_periodic(a) for a, x in enumerate(units)], dtype=bool)

    def _without_rounding(self, sizes: Array) -> Array:
        """Sizes (n,) of forces, 0 of all where they are nothing but rounding, as of gravity along an axis."""
        if self.model.closures:
            return sizes
        place = dict(zip(self.model.positions, self._anywhere()[0].tolist(), strict=True))
        return forces_that_are(perturbation(self.model), {**self._values, **place}, sizes, self.length)

    def _anywhere(self) -> Array:
        """Places in general position (PLACES, n)."""
        return np.asarray(np.random.default_rng(5).uniform(-1, 1, (PLACES, self.n)) * self.size)

    def _also(self) -> tuple[dict[str, Array], list[tuple[list[str], Array]]]:
        """Further outputs and columns of the kernel."""
        return {}, []

    def _is_periodic(self, a: int) -> bool:
        """Whether a full turn changes nothing (no spring in the joint)."""
        q = np.linspace(0.3, 0.9, self.n)
        before, turned = (self._judged(q + x * np.eye(len(q))[a]) for x in (0, 2 * np.pi))
        return bool(np.abs(turned - before).max() <= 1e-9 * max(1.0, float(np.abs(before).max())))

    def _judged(self, q: Array) -> Array:
        """What must be zero."""
        return self.at(q)[0]

    def starts(self) -> Array:
        """Those given, zero, and random ones, (N, n)."""
        rng = np.random.default_rng(self.within.seed)
        some = int(self.within.from_zero)
        rows = [np.zeros((some, self.n)), rng.uniform(-1, 1, (self.within.count, self.n)) * self.size]
        if self.within.starts is not None:
            n, given = len(self.model.positions), np.atleast_2d(numeric(self.within.starts, "/starts"))
            if given.ndim != 2 or given.shape[1] != n:
                message = f"shape {given.shape} found, (N, {n}) expected"
                raise InvalidArgument.at("/starts", "wrong-length", message)
            rows.insert(0, self._of_all(given))
        return np.concatenate(rows)

    def _of_all(self, rows: Array) -> Array:
        """Of rows (N, n) for all coordinates those that are looked for."""
        return rows

    def at(self, q: Array) -> tuple[Array, Array]:
        """-Q and its Jacobian at rest, over the units."""
        found = with_sides(self._ran, {"q": q}, ["q"])
        return found["F"] / self.unit, found["K"] / self.unit[:, None]

    def _ran(self, values: Mapping[str, Array]) -> dict[str, Array]:
        self.q[0] = values["q"]
        self.run()
        return {"F": self.F[0].copy(), "K": self.K[0].copy()}

    def held(self, starts: Array) -> list[int]:
        """Coordinates on which nothing depends, at starts and at places in general position."""
        places = np.concatenate((starts[:: max(1, len(starts) // PLACES)], self._anywhere()))
        found = np.array([np.abs(self._slopes(q)).max(axis=0) for q in places])
        # what is not finite depends on something
        least = NOTHING * np.max(found, where=np.isfinite(found), initial=1)
        return np.flatnonzero((found <= least).all(axis=0)).tolist()

    def _slopes(self, q: Array) -> Array:
        """Derivatives of what must be zero."""
        return self.at(q)[1]

    def places(self, starts: Array, moving: Sequence[int]) -> tuple[list[Array], int]:
        """Different places that are found from the starts, in the order of their coordinates, and how many others were
        left out, as the coordinates are singular there.
        """
        found: list[Array] = []
        for start in starts:
            q = self.solve(start, moving)
            if q is not None and not any(self.is_same(q, other, moving) for other in found):
                found.append(q)
        if found and self.n:
            found = [found[i] for i in np.lexsort(np.round(found / self.length, 6).T[::-1])]
        regular = [q for q in found if not self.is_singular(q)]
        return regular, len(found) - len(regular)

    def is_same(self, q: Array, other: Array, _: Sequence[int]) -> bool:
        """Whether two places are told as one."""
        return self.distance(q, other) < SAME

    def is_singular(self, _: Array) -> bool:
        """Whether the coordinates fail there, which the linearisation of an equilibrium tells."""
        return False

    def solve(self, start: Array, moving: Sequence[int]) -> Array | None:
        """An equilibrium near a start; None when there is none in reach."""
        q = start.copy()

        def both(x: Array) -> tuple[Array, Array]:
            """Forces and their Jacobian at free coordinates x."""
            q[moving] = x
            F, K = self.at(q)
            # a corner of a force, as of an end stop, has no derivative: any will do on the way
            return F, np.where(np.isfinite(K[:, moving]), K[:, moving], 0)

        if len(moving):
            if not np.isfinite(self.at(q)[1]).all():
                q[moving] += BESIDE * self.length[moving]
            # the amended potential of a reduced system is infinite where its coordinates fail
            if not np.isfinite(self.at(q)[0]).all():
                return None
            with np.errstate(all="ignore"):
                q[moving] = scipy.optimize.least_squares(
                    lambda x: both(x)[0],
                    q[moving].copy(),
                    lambda x: both(x)[1],
                    x_scale=self.length[moving],
                    **TOLERANCES,
                ).x
            q[moving] += self._last_step(q, moving)
        F, K = self.at(q)
        # |Q_a| <= 1e-10 max(1, |K_ab|), or 1 at a corner of a force, where K has no value
        if not (np.abs(F) <= RESIDUAL * np.fmax(1.0, np.abs(K * self.length).max(axis=1, initial=0))).all():
            return None
        return self.wound(q)

    def wound(self, q: Array) -> Array:
        """Angles in (-pi, pi]."""
        # pi - (pi - q mod 2 pi)
        return np.where(self.turning, np.pi - np.mod(np.pi - q, 2 * np.pi), q)

    def _last_step(self, q: Array, moving: Sequence[int], most: float = 1e-3) -> Array:
        """One step of Newton's method, of least size where K is singular; none if it is as large as ``most``."""
        F, K = self.at(q)
        if not (np.isfinite(F).all() and np.isfinite(K).all()):
            return np.zeros(len(moving))
        # K dq = Q, with F = -Q
        length = self.length[moving]
        step = np.linalg.lstsq(K[:, moving] * length, -F, rcond=1e-10)[0]
        return np.asarray(step * length if np.abs(step).max(initial=0) < most else np.zeros(len(moving)))

    def distance(self, p: Array, q: Array) -> float:
        """Largest difference of coordinates, of angles by the shorter way, of distances over the reach."""
        d = np.abs(p - q) / self.length
        return float(np.where(self.turning, np.minimum(d, np.abs(2 * np.pi - d)), d).max(initial=0))

    def advice(self, q: Array, held: Sequence[int]) -> str:
        """Why there is none."""
        F, _ = self.at(q)
        constant = dict(zip(self.model.coordinates, np.abs(F), strict=True))
        rest = [self.model.positions[a] for a in held]
        if names := ", ".join(f"'{name}'" for name in rest if constant.get(name, 0) > RESIDUAL):
            return f"nothing balances the constant force on {names}: change gravity or inputs, or add a spring"
        return "no equilibrium was found: give 'starts' near one, or raise 'count' and 'reach'"


class BallSearch(RestSearch):
    """The same with ball joints: K by all numbers of a state. Of families (turns about the vertical) one is told."""

    def _ran(self, values: Mapping[str, Array]) -> dict[str, Array]:
        model, found = self.model, super()._ran(values)
        found["K"] = found["K"] @ by_displacements(model.positions, model.coordinates, model.balls, values["q"])
        return found

    def starts(self) -> Array:
        """Those given, no turn, and random ones, with quaternions of length 1."""
        rows = super().starts()
        for some in self.quaternions:
            rows[~rows[:, some].any(axis=1), some[0]] = 1
        return np.array([self.wound(row) for row in rows])

    def _of_all(self, rows: Array) -> Array:
        return with_unit_quaternions(self.model.positions, self.model.balls, rows, "/starts")

    def is_same(self, q: Array, other: Array, moving: Sequence[int]) -> bool:
        """Also where q comes to the other one along its family, on which K leaves a direction free."""
        for _ in range(SLIDES):
            if self.distance(q, other) < SAME:
                return True
            _, sizes, ways = np.linalg.svd(self.at(q)[1][:, moving])
            free, before, q = ways[int(np.sum(sizes > FREE * sizes.max(initial=0))) :], q, q.copy()
            step = free.T @ (free @ (self._beside(q, other) - q)[moving])
            q[moving] += step * min(1.0, STEP / (np.linalg.norm(step) or 1.0))
            for _ in range(3):
                q[moving] += self._last_step(q, moving, STEP)
            q = self.wound(q)
            if self.distance(q, before) < SAME:
                break
        return False

    def _beside(self, q: Array, other: Array) -> Array:
        """The same as ``other``: of both quaternions that turn alike the one that is nearer to q."""
        result = other.copy()
        for some in self.quaternions:
            result[some] *= 1.0 if q[some] @ other[some] >= 0 else -1.0
        return result

    def wound(self, q: Array) -> Array:
        """Angles in (-pi, pi], quaternions of length 1, of both that turn alike the one with w > 0."""
        result = super().wound(q)
        for some in self.quaternions:
            unit = result[some] / np.linalg.norm(result[some])
            result[some] = unit if unit[int((np.abs(unit) > SAME).argmax())] > 0 else -unit
        return result

    def distance(self, p: Array, q: Array) -> float:
        """As of others, of quaternions by the nearer sign."""
        return super().distance(p, self._beside(p, q))
