"""How far a frame gets from another one, of many parameter sets at once.

The square of the distance is a + b cos q + c sin q in the angle of one joint and a parabola in the travel of one, so
that the largest over one coordinate is known from three values; coordinate by coordinate it grows up to a largest one.
Times |Q|^2 it is a quadratic form in the quaternion Q of one ball joint, whose largest eigenvalue is the largest of it.
Where a coordinate moves more than one joint (relations, screws) values on a grid take the place of that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument, among
from substructures.quantities.numbers.quaternions import quaternions_in
from substructures.quantities.numbers.states import known_values, read_states
from substructures.sweeps.document import WORLD, ReachColumn
from substructures.sweeps.grouped import alike, inside
from substructures.sweeps.shapes import Shape
from substructures.tree.cuts import require_open
from substructures.tree.given.driven import PRIMES
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

#: starts, which are drawn between the limits; rounds over all coordinates; points of a grid
STARTS, ROUNDS, POINTS = 6, 200, 65
#: relative growth below which a round is the last; relative difference that is rounding
LEAST, SAME = 1e-13, 1e-10
PERIOD = 2 * np.pi
#: times at which given motions are looked at [s]
TIMES = (0.317, 1.229)


def reach_columns(
    shape: Shape, columns: Mapping[str, ReachColumn], parameters: Mapping[str, Any], rows: int
) -> dict[str, Array]:
    """The largest distances (rows,) [m] within the limits of joints. Raises InvalidInput (``no-limits`` for a sliding
    joint without), MissingValue.
    """
    found = dict[str, Array]()
    for same in alike({name: {"of": c.of, "about": c.about} for name, c in columns.items()}):
        with inside(f"/columns/{same[0]}"):
            largest = _Search(shape, columns[same[0]], parameters, rows).largest()
        found |= dict.fromkeys(same, largest)
    return found


def _frame(model: Model, name: str, field: str) -> int | None:
    if name == WORLD:
        return None
    if name not in model.frames:
        message = f"there is no frame '{name[:80]}'{among(name, [*model.frames, WORLD])}"
        raise InvalidArgument.at(f"/{field}", "unknown-name", message)
    return model.frames.index(name)


@dataclass
class _Search:
    shape: Shape
    column: ReachColumn
    parameters: Mapping[str, Any]
    rows: int
    t: float = 0.0  #: the time, and the values of driven inputs

    def __post_init__(self) -> None:
        model = self.shape.model
        require_open(model.closures, "sweep other columns")
        require_untied(model, "columns of reach")
        self.ends = _frame(model, self.column.of, "of"), _frame(model, self.column.about, "about")
        m, own = len(model.positions), dict(zip(model.coordinates, model.joints, strict=True))
        self.turns = {some[0]: some for some in quaternions_in(model.positions, model.balls)}
        within = {a for some in self.turns.values() for a in some}
        #: of all numbers of a state but quaternions; places of floating joints slide
        self.kinds = {a: own.get(name, "P") for a, name in enumerate(model.positions) if a not in within}
        self.matters, self.is_simple = np.ones((2, m, self.rows), dtype=np.bool_)
        self.matters[[a for a in within if a not in self.turns]] = False
        judge = self.shape.sources.judge
        limits = {} if judge is None else judge.limits(self.parameters)
        #: of what loops move, by its place
        self.bounds = {k: limits[name][:2] for k, name in enumerate(model.dependent) if name in limits}
        self.low, self.high = np.zeros((2, m, self.rows))
        self.high[list(within)] = 1
        draw = np.random.default_rng(0)
        self.starts = [np.full(m, 0.5), *draw.uniform(0.05, 0.95, (STARTS - 1, m))]
        for a, kind in self.kinds.items():
            if (name := model.positions[a]) in limits:
                self.low[a], self.high[a] = limits[name][:2]
            else:
                self.low[a], self.high[a] = (-np.pi, np.pi) if kind == "R" else (0, 1)
        self._require_steady()
        for a, kind in self.kinds.items():
            self._look(a, self._at(self.starts[-1]))
            if (name := model.positions[a]) in limits or kind == "R":
                continue
            if self.matters[a].any():
                message = f"'{name}' slides and has no limits: what it carries gets anywhere"
                raise InvalidArgument.at("/of", "no-limits", message)
            self.high[a] = 0

    def _at(self, start: Array) -> Array:
        """States (rows, m) so far from the lower limits, beside the ranges."""
        return np.ascontiguousarray((self.low + start[:, None] * (self.high - self.low)).T)

    def _require_steady(self) -> None:
        """Raises InvalidArgument (``not-steady``) where given motions change the distance."""
        q = self._at(self.starts[-1])
        here = self.square(q)
        for t in TIMES if self.shape.model.driven else ():
            self.t = t
            near = self.square(q)
            if (np.abs(near - here) > SAME * np.fmax(here, near)).any():
                message = f"given motions ('driven') move '{self.column.of}' from '{self.column.about}'"
                raise InvalidArgument.at("/of", "not-steady", f"{message}: give it from what they move, too")
        self.t = 0.0

    def _look(self, a: int, q: Array) -> None:
        """Whether a coordinate changes the distance, and whether as one joint does; row by row."""
        here, x, step = self.square(q), q[:, a], (self.high[a] - self.low[a]) / 4
        near = self._with(q, a, x + step)
        size = np.fmax(here, near)
        self.matters[a] = ~(np.abs(near - here) <= SAME * size)  # also where a loop does not close
        if self.kinds[a] == "R":
            off = near - self._sinusoid(q, here, a)(x + step)
        else:  # the third difference of a parabola is 0
            off = self._with(q, a, x + 2 * step) - 3 * near + 3 * here - self._with(q, a, x - step)
        self.is_simple[a] = (np.abs(off) <= SAME * size) & (not self.bounds)

    def square(self, q: Array) -> Array:
        """|r_of - r_about|^2 (rows,) [m^2] at states (rows, m), whose quaternions have any length that is not 0; not a
        number where loops do not close, or leave the limits of what they move.
        """
        model, q = self.shape.model, q.copy()
        for some in self.turns.values():
            q[:, some] /= np.linalg.norm(q[:, some], axis=1, keepdims=True)
        states = read_states(model, {"q": q, "parameters": self.parameters}, None)
        inputs = {f"{name}{primes}": self.t for name in model.driven for primes in PRIMES if name in model.inputs}
        given = {"parameters": self.parameters, "t": self.t, "inputs": inputs}
        values = known_values(model, given, states, model.parameters)
        names = ["position", *(["dependent"] if self.bounds else [])]
        found = self.shape.evaluate(model.program, values, names, self.rows)
        of, about = (0.0 if k is None else np.asarray(found["position"])[:, k] for k in self.ends)
        square = np.broadcast_to(np.sum(np.square(np.zeros(3) + of - about), axis=-1), (self.rows,))
        for k, (low, high) in self.bounds.items():
            x, slack = np.asarray(found["dependent"])[:, k], SAME * (1 + np.abs(low) + np.abs(high))
            square = np.where((low - slack <= x) & (x <= high + slack), square, np.nan)
        return square

    def _with(self, q: Array, a: int, x: Array) -> Array:
        """The square with one coordinate at ``x`` (rows,)."""
        moved = q.copy()
        moved[:, a] = x
        return self.square(moved)

    def largest(self) -> Array:
        """The largest distance (rows,) from any of the starts."""
        best = np.full(self.rows, -np.inf)
        for start in self.starts:
            best = np.fmax(best, self._climbed(self._at(start)))
        with np.errstate(invalid="ignore"):
            return np.sqrt(best)

    def _climbed(self, q: Array) -> Array:
        here = _or_nowhere(self.square(q))
        runs = here < np.inf
        for _ in range(ROUNDS):
            before = here
            for a in np.flatnonzero(self.matters.any(axis=1)).tolist():
                there = q.copy()
                if a in self.turns:
                    there[:, self.turns[a]] = self._turned(q, self.turns[a])
                else:
                    there[:, a] = self._along(q, here, a)
                found = self.square(there)
                better = runs & self.matters[a] & (found > here)
                q[better] = there[better]
                here = np.where(better, found, here)
            runs = runs & (here > before * (1 + LEAST))
            if not runs.any():
                break
        return here

    def _turned(self, q: Array, some: list[int]) -> Array:
        """The quaternion (rows, 4) of one ball joint at which the distance is largest, the others as they are."""
        form, there = np.zeros((self.rows, 4, 4)), q.copy()
        for i, j in zip(*np.triu_indices(4), strict=True):
            there[:, some] = np.fmax(np.eye(4)[i], np.eye(4)[j])
            form[:, i, j] = form[:, j, i] = np.nan_to_num(self.square(there))
        # N_ii of Q = e_i; of e_i + e_j, whose square is 2, half of N_ii + 2 N_ij + N_jj
        own = np.einsum("kii->ki", form).copy()
        form -= (own[:, :, None] + own[:, None, :]) / 2 * (1 - np.eye(4))
        return np.asarray(np.linalg.eigh(form)[1][:, :, -1])

    def _along(self, q: Array, here: Array, a: int) -> Array:
        """The values of one coordinate (rows,) at which the distance is largest, the others as they are."""
        low, high, simple = self.low[a], self.high[a], self.is_simple[a]
        ends, points = np.stack([low, high]), np.linspace(low, high, POINTS)
        if self.kinds[a] != "R":
            return _best(lambda x: self._with(q, a, x), ends if simple.all() else points)
        fit = self._sinusoid(q, here, a)
        top = q[:, a] + fit.top
        top = top - PERIOD * np.ceil((top - high) / PERIOD)  # the last one that is not above
        found = _best(fit, np.stack([low, high, np.fmax(top, low)]))
        return found if simple.all() else np.where(simple, found, _best(lambda x: self._with(q, a, x), points))

    def _sinusoid(self, q: Array, here: Array, a: int) -> _Sinusoid:
        x = q[:, a]
        left, right = (self._with(q, a, x + turn * PERIOD / 3) for turn in (1, -1))
        return _Sinusoid(x, (here + left + right) / 3, (2 * here - left - right) / 3, (left - right) / np.sqrt(3))


@dataclass
class _Sinusoid:
    """a + b cos(x - x0) + c sin(x - x0), (rows,)."""

    x0: Array
    a: Array
    b: Array
    c: Array

    def __call__(self, x: Array) -> Array:
        return np.asarray(self.a + self.b * np.cos(x - self.x0) + self.c * np.sin(x - self.x0))

    @property
    def top(self) -> Array:
        """x - x0 where it is largest."""
        return np.asarray(np.arctan2(self.c, self.b))


def _best(at: Callable[[Array], Array], candidates: Array) -> Array:
    """Of some values (k, rows) those with the largest of ``at``, (rows,)."""
    values = _or_nowhere(np.stack([at(x) for x in candidates]))
    return np.asarray(np.take_along_axis(candidates, values.argmax(axis=0)[None], axis=0)[0])


def _or_nowhere(square: Array) -> Array:
    """What is no number is less than all that are."""
    return np.where(np.isnan(square), -np.inf, square)


ANALYSES = {"reach": reach_columns}
