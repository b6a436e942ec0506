"""Best parameters: the least of an expression in columns, within bounds and where conditions hold.

From several starts by sequential quadratic programming, with differences of columns that are computed for all steps at
once, then by looking around: points about the best one, at ever smaller distances, of which none may be better in the
end. That holds for costs with corners, too, such as the largest of several torques.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import scipy

from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.verdict import About, Check, verdict
from substructures.array import Array
from substructures.documents import escape
from substructures.ensembles.samples import Distribution, Sampler, Samples
from substructures.errors import InvalidArgument, InvalidDocument, among
from substructures.quantities.sources import Sources
from substructures.sweeps.columns import Columns, columns_of
from substructures.sweeps.conditions import Expression, read_expression
from substructures.sweeps.document import Column
from substructures.sweeps.shapes import Shape

#: steps of differences relative to the bounds: of formulas, and of motions with their tolerance
STEP, STEP_OF_MOTIONS = 1e-6, 1e-3
#: what a condition may be violated by, relative to its sides; distances of the last looks around, relative to bounds
FEASIBLE, LOOKS = 1e-8, (1e-2, 1e-3, 1e-4)
#: further ones: nearer than the search goes, where costs without a least value fall on
NEARER = (1e-10, 1e-12)
#: nearest look of the search, relative to the bounds; rounds of it; points of each
NEAREST, ROUNDS, POINTS = 1e-9, 400, 64
#: what is no better than this, relative, is not better
BETTER, BETTER_OF_MOTIONS = 1e-9, 1e-6
ITERATIONS, DRAWN = 200, 64  # points of which the best ones are starts
WORST = 1e30
BOUNDED = ("<", "<=", ">", ">=")


@dataclass(frozen=True)
class Aim:
    """``minimise``: an expression in columns and in what varies, ``where``: comparisons that have to hold; ``vary``:
    lowest and highest value of parameters [SI]; ``starts``: how many there are, drawn for a ``seed``.
    """

    minimise: str
    vary: Mapping[str, tuple[float, float]]
    columns: Mapping[str, Column]
    where: str = ""
    starts: int = 8
    seed: int = 0


@dataclass(frozen=True)
class BestParameters:
    """``parameters`` [SI] of the least ``value``, the ``columns`` there, and the bounds and conditions that are
    ``active``.

    ``found``: the value from each start, not a number where none was; ``evaluations``: rows of columns. ``status`` is
    ``failed`` where no start led to a value within the conditions.
    """

    parameters: Mapping[str, float]
    value: float
    columns: Mapping[str, float]
    active: tuple[str, ...]
    found: Array
    evaluations: int
    status: Literal["finished", "failed"]
    message: str
    checks: tuple[Check, ...]

    @property
    def is_right(self) -> bool | None:
        """Whether all checks hold; None where nothing was found."""
        return verdict(self.checks, self.status == "finished")


def optimal_parameters(
    sources: Sources,
    aim: Aim,
    parameters: Mapping[str, float] | None = None,
    progress: ProgressReport | None = None,
) -> BestParameters:
    """The best of the parameters that vary, the others at ``parameters`` or their defaults.

    Raises InvalidInput (pointers ``/vary/name``, ``/columns/name``, ``/minimise``, ``/where``), MissingValue.
    """
    return _Search(sources, aim, dict(parameters or {}), progress).run()


class _Search:
    def __init__(
        self, sources: Sources, aim: Aim, parameters: dict[str, float], progress: ProgressReport | None
    ) -> None:
        self.shape, self.aim, self.given, self.progress = Shape(sources), aim, parameters, progress
        self.names = list(aim.vary)
        _check(aim, self.given, sources.model.parameters)
        known = [*self.names, *aim.columns]
        self.columns: Columns = columns_of(aim.columns, self.names, aim.where)
        self.cost: Expression = read_expression(aim.minimise, known, "/minimise")
        self.sides = _sides(self.columns)
        self.low, self.high = (np.array([ends[k] for ends in aim.vary.values()]) for k in (0, 1))
        moving = {*self.columns.of_motions} & {*self.cost.needs, *self.columns.where.needs}
        self.step, self.better = (STEP_OF_MOTIONS, BETTER_OF_MOTIONS) if moving else (STEP, BETTER)
        self.evaluations = 0

    def values(self, x: Array) -> tuple[Array, Array]:
        """The cost (N,) and what conditions have left (N, m), of points (N, k) between 0 and 1."""
        names = self.low + np.clip(x, 0.0, 1.0) * (self.high - self.low)
        varied = {name: np.ascontiguousarray(names[:, k]) for k, name in enumerate(self.names)}
        self.evaluations += len(x)
        with np.errstate(all="ignore"):
            found = self.columns.of(self.shape, {**self.given, **varied}, varied, len(x))
            known = {**varied, **found}
            cost = self.cost.of(known, len(x))
            left = [_left(*side, known, len(x)) for side in self.sides]
        good = np.isfinite(cost)
        for each in left:
            good = good & np.isfinite(each)
        room = np.stack(left, axis=1) if left else np.zeros((len(x), 0))
        return np.where(good, cost, WORST), np.where(good[:, None], room, -WORST)

    def run(self) -> BestParameters:
        """The best of all starts."""
        starts = self._starts()
        found, best = np.full(len(starts), np.nan), np.full(len(self.names), np.nan)
        for k, start in enumerate(starts):
            x = self._looked(self._solved(start))
            cost, room = self.values(x[None])
            if cost[0] < WORST and (room >= -FEASIBLE).all():
                found[k] = cost[0]
                if cost[0] <= np.nanmin(found):
                    best = x
            if self.progress is not None and self.progress((k + 1) / len(starts)) is False:
                break
        return self._optimum(best, found)

    def _starts(self) -> Array:
        """Points (N, k): drawn ones, of which more are looked at, and the defaults where they are within the bounds."""
        names = [f"x{k}" for k in range(len(self.names))]
        of = {name: Distribution(uniform=(0, 1)) for name in names}
        rows = Sampler(Samples(method="sobol", count=DRAWN, seed=self.aim.seed, of=of)).rows(0, DRAWN)
        points = np.stack([rows[name] for name in names], axis=1)
        defaults = self.shape.sources.defaults
        own = np.array([self.given.get(name, defaults.get(name, np.nan)) for name in self.names])
        own = (own - self.low) / (self.high - self.low)
        if ((own >= 0) & (own <= 1)).all():
            points = np.vstack([own, points])
        cost, room = self.values(points)
        spoilt = np.where((room >= 0).all(axis=1), 0, 1)
        order = np.lexsort((cost, spoilt))
        return points[order[: self.aim.starts]]

    def _solved(self, start: Array) -> Array:
        """By sequential quadratic programming; the start where that leads nowhere."""

        def differenced(of: Callable[[tuple[Array, Array]], Array]) -> Callable[[Array], Array]:
            """The slopes of a function of the values."""

            def slopes(x: Array) -> Array:
                """Central differences, within the bounds."""
                above, below = np.minimum(x + self.step, 1.0), np.maximum(x - self.step, 0.0)
                n = len(x)
                points = np.concatenate([np.where(np.eye(n, dtype=bool), side, x) for side in (above, below)])
                found = of(self.values(points))
                return np.asarray((found[:n] - found[n:]).T / (above - below))

            return slopes

        scale = max(1.0, abs(float(self.values(start[None])[0][0])))
        scale = 1.0 if scale >= WORST else scale
        conditions = []
        if self.sides:
            room = differenced(lambda pair: pair[1])
            conditions = [{"type": "ineq", "fun": lambda x: self.values(x[None])[1][0], "jac": room}]
        slope = differenced(lambda pair: pair[0][:, None])
        found = scipy.optimize.minimize(
            lambda x: float(self.values(x[None])[0][0]) / scale,
            start,
            jac=lambda x: slope(x)[0] / scale,
            bounds=[(0.0, 1.0)] * len(start),
            constraints=conditions,
            method="SLSQP",
            options={"maxiter": ITERATIONS, "ftol": 1e-14},
        )
        x = np.clip(found.x, 0.0, 1.0)
        return x if np.isfinite(x).all() and not self._is_better(start, x) else start

    def _is_better(self, x: Array, than: Array) -> bool:
        cost, room = self.values(np.stack([x, than]))
        return bool(_rank(cost, room)[0] < _rank(cost, room)[1])

    def _looked(self, x: Array) -> Array:
        """Moves to the best of points around, and looks nearer where none is better."""
        draw, distance = np.random.default_rng(self.aim.seed), LOOKS[0]
        for _ in range(ROUNDS):
            points = np.vstack([x, np.clip(x + distance * self._around(draw), 0.0, 1.0)])
            cost, room = self.values(points)
            k = int(np.argmin(_rank(cost, room)))
            if (k and cost[k] < cost[0] - self.better * abs(cost[0])) or (k and (room[0] < -FEASIBLE).any()):
                x, distance = points[k], min(2 * distance, 0.1)
            elif (distance := distance / 4) < NEAREST:
                break
        return x

    def _around(self, draw: np.random.Generator) -> Array:
        """Directions: both ways along each parameter, and random ones."""
        n = len(self.names)
        random = draw.normal(size=(POINTS, n))
        return np.vstack([np.eye(n), -np.eye(n), random / np.linalg.norm(random, axis=1, keepdims=True)])

    def _optimum(self, x: Array, found: Array) -> BestParameters:
        if not np.isfinite(x).all():
            why = "no start led to finite columns within the conditions: widen the bounds, or loosen 'where'"
            none = dict.fromkeys(self.names, float("nan"))
            return BestParameters(none, float("nan"), {}, (), found, self.evaluations, "failed", why, ())
        names = self.low + x * (self.high - self.low)
        varied = {name: names[k : k + 1] for k, name in enumerate(self.names)}
        columns = self.columns.of(self.shape, {**self.given, **varied}, varied, 1)
        cost, room = self.values(x[None])
        at = dict(zip(self.names, names.tolist(), strict=True))
        told = {name: float(column[0]) for name, column in columns.items()}
        checks = tuple(self._checks(x, float(cost[0]), room[0]))
        return BestParameters(
            at, float(cost[0]), told, self._active(x, room[0]), found, self.evaluations, "finished", "", checks
        )

    def _active(self, x: Array, room: Array) -> tuple[str, ...]:
        bounds = [f"{name} >= {low:g}" for name, low, y in zip(self.names, self.low, x, strict=True) if y <= 1e-7]
        bounds += [
            f"{name} <= {high:g}" for name, high, y in zip(self.names, self.high, x, strict=True) if y >= 1 - 1e-7
        ]
        return (*bounds, *(text for (*_, text), left in zip(self.sides, room, strict=True) if left <= 1e-6))

    def _checks(self, x: Array, cost: float, room: Array) -> Sequence[Check]:
        """Conditions hold, and nothing around is better."""
        worst = float(np.maximum(-room, 0).max(initial=0))
        about: About = ("conditions", "zero", "the conditions hold, relative to their sides", "1")
        checks = [Check.at(about, worst, 0.0, 1.0, FEASIBLE)]
        draw, gains, sizes = np.random.default_rng(self.aim.seed + 1), [0.0], [abs(cost), 1e-12]
        for distance in (*LOOKS, *NEARER):
            costs, rooms = self.values(np.clip(x + distance * self._around(draw), 0.0, 1.0))
            better = costs[(rooms >= 0).all(axis=1)]
            gains.append(cost - float(better.min(initial=cost)))
            sizes.append(float(np.abs(costs[costs < WORST] - cost).max(initial=0)))  # the least cost may be 0
        reason = f"of {len((*LOOKS, *NEARER)) * (POINTS + 2 * len(x))} points around, at five distances, none is better"
        limit = 100 * self.better
        checks.append(Check.at(("neighbours", "zero", reason, ""), max(gains), 0.0, max(sizes), limit))
        return checks


def _check(aim: Aim, given: Mapping[str, float], known: Mapping[str, Any]) -> None:
    for where, names in (("vary", aim.vary), ("parameters", given)):
        for name in names:
            if name not in known:
                message = f"the tree has no parameter '{name[:80]}' that is free{among(name, known)}"
                raise InvalidArgument.at(f"/{where}/{escape(name)}", "unknown-parameter", message)
    for name, (low, high) in aim.vary.items():
        if not low < high:
            raise InvalidArgument.at(f"/vary/{name}", "empty-range", f"from {low:g} to {high:g} there is nothing")
        if not np.isfinite(high - low):
            raise InvalidArgument.at(f"/vary/{name}", "too-large", f"{low:g} and {high:g} are too far apart")


def _sides(columns: Columns) -> list[tuple[Expression, Expression, str]]:
    """Of each condition what has to be less, what has to be more, and how it is written."""
    groups = columns.where.groups
    if len(groups) > 1:
        raise InvalidDocument.at("/where", "not-supported", "conditions of an optimum are joined by 'and' alone")
    found = []
    for left, how, right in groups[0] if groups else ():
        if how not in BOUNDED:
            raise InvalidDocument.at("/where", "not-supported", f"'{how}' bounds nothing: use < <= > >=")
        less, more = (left, right) if how in ("<", "<=") else (right, left)
        found.append((less, more, f"{left.text} {how} {right.text}"))
    return found


def _left(less: Expression, more: Expression, _: str, known: Mapping[str, Array], rows: int) -> Array:
    """How much room there is, relative to the sides; below zero where the condition does not hold."""
    a, b = less.of(known, rows), more.of(known, rows)
    size = np.maximum(np.abs(a), np.abs(b))
    return np.asarray((b - a) / np.where(size > 0, size, 1.0))


def _rank(cost: Array, room: Array) -> Array:
    """What is to be least: the cost, behind it all that violates a condition, by how much."""
    violated = np.maximum(-room - FEASIBLE, 0).max(axis=1, initial=0)
    return np.where(violated > 0, WORST * (1 + np.minimum(violated, 1e3)), cost)
