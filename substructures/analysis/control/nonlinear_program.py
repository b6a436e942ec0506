"""Optimal control as a nonlinear program: controls u, starts s of segments, parameters p and the horizon T are unknown.

    minimise J(u, s, p, T)    subject to    end_k = s_(k+1),    end_last = what the end demands,
                                            bounds on u, p, T,  low <= c(x, u, t, p) <= high at all nodes

(direct multiple shooting; all derivatives by the discrete adjoint of substructures.analysis.control.shooting).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from substructures.analysis.control.adjoint import HORIZON
from substructures.analysis.control.closed_start import independent_demands, start_state
from substructures.analysis.control.demands import Demands, bounds_of, demanded, ranges_of, rows_of, segments_of
from substructures.analysis.control.motion_sizes import motion_sizes, power_of_2
from substructures.analysis.control.path_limits import PathLimits
from substructures.analysis.control.problem import ControlProblem, per_node
from substructures.analysis.control.rollout import Rollout, Slope
from substructures.analysis.control.shooting import Shooting
from substructures.analysis.control.warm_start import WarmStart, warm_start
from substructures.analysis.given import require_known
from substructures.analysis.motion.judges.balls import with_lengths
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import InvalidArgument
from substructures.quantities.numbers.quaternions import quaternions_in
from substructures.tree.model import Model

#: variables and conditions: the solver's time grows with their third power
MAX_VARIABLES = 2_000
#: the cost of a motion that is not finite
BEYOND = 1e30


class ShootingProgram:
    """The nonlinear program. Variables z: controls (nodes, m), the starts of all segments but the first, and what is
    varied beside them: parameters, and the horizon last.
    """

    def __init__(self, model: Model, problem: ControlProblem, wanted: Demands) -> None:
        self.model, self.problem, self.wanted = model, problem, wanted
        self.size = len(model.positions) + model.dof
        self.S = segments_of(problem, wanted)
        require_known("free_parameters", "parameter", wanted.free_parameters, model.parameters)
        self.varied = (*wanted.free_parameters, *([] if wanted.free_horizon is None else [HORIZON]))
        if not (problem.controls or self.varied):
            message = "nothing is unknown: name controls, 'free_parameters', or a 'free_horizon'"
            raise InvalidArgument.at("/controls", "too-short", message)
        demands = [*demanded(model, wanted.end.q, "q", 0), *demanded(model, wanted.end.qd, "qd", len(model.positions))]
        named = {f"/free_parameters/{escape(name)}": name for name in wanted.free_parameters}
        start = start_state(model, problem, named)
        self.first, self.demands = start.x, independent_demands(start, demands)
        self.wanted_rows, self.wanted_values = rows_of(model, self.demands)
        self.sizes = motion_sizes(model, self.first, self.demands, problem.horizon)
        self.bounds = bounds_of(problem.controls, wanted)
        self.ranges = ranges_of(wanted)
        self.m = len(problem.controls)
        self.split = problem.nodes * self.m
        self.rows = (self.S - 1) * self.size + len(self.wanted_rows)
        self.own = self.split + (self.S - 1) * self.size
        size = self.own + len(self.varied) + self.rows
        if size > MAX_VARIABLES:
            message = (
                f"{size:,} variables and conditions; the limit is {MAX_VARIABLES:,}: take fewer intervals or segments"
            )
            raise InvalidArgument.at("/intervals", "too-large", message)
        self.shooting = Shooting(model, problem, start, self.varied, self.S)
        self.limits_on_path = PathLimits(model, wanted.path, problem.controls, self.varied) if wanted.path else None
        self.earlier = None if wanted.warm_start is None else warm_start(wanted.warm_start, model)
        self._at: tuple[bytes, Rollout, Slope] | None = None
        self._require_start()

    def guess(self) -> Array:
        """Controls that were given; starts of segments on a line from the first state to the demanded one; all as in
        the earlier result where there is one.
        """
        controls = per_node(self.problem, self.wanted.guess, "guess")
        values = {**self.shooting.values, HORIZON: self.problem.horizon}
        share = np.arange(1, self.S) / self.S
        starts = self._line(share)
        if self.earlier is not None:
            _warm(self.problem, self.earlier, controls)
            starts = self._turned(self.earlier.state(share))
            values |= self.earlier.parameters
            values[HORIZON] = self.earlier.horizon or self.problem.horizon
        others = np.clip([values[name] for name in self.varied], *self.ranges) if self.varied else []
        return np.concatenate([np.clip(controls, *self.bounds).ravel(), starts.ravel(), others])

    def _line(self, share: Array) -> Array:
        end = self.first.copy()
        for i, value in self.demands:
            end[i] = value
        for some in quaternions_in(self.model.positions, self.model.balls):
            # of both that turn alike the nearer one
            end[some] *= 1.0 if end[some] @ self.first[some] >= 0 else -1.0
        # s_k = x_0 + k/S (x_end - x_0)
        return self._turned(self.first + share[:, None] * (end - self.first))

    def _turned(self, states: Array) -> Array:
        """States (K, size) with quaternions of length 1."""
        m = len(self.model.positions)
        return np.concatenate([with_lengths(self.model, states[:, :m]), states[:, m:]], axis=1)

    def parts(self, z: Array) -> tuple[Array, Array]:
        """Starts (S, 2 n) and controls (nodes, m)."""
        starts = np.concatenate([self.first, z[self.split : self.own]]).reshape(self.S, self.size)
        return starts, z[: self.split].reshape(self.problem.nodes, self.m)

    def found(self, z: Array) -> tuple[dict[str, float], float]:
        """Parameters that are varied, and the horizon."""
        # the solver may step outside by rounding
        values = dict(zip(self.varied, np.clip(z[self.own :], *self.ranges).tolist(), strict=True))
        return values, values.pop(HORIZON, self.problem.horizon)

    def shooting_at(self, z: Array) -> Shooting:
        """The equations with the parameters and the horizon of z."""
        return self.shooting.at(*self.found(z)) if self.varied else self.shooting

    def evaluated(self, z: Array) -> tuple[Rollout, Slope]:
        """The motion, and the derivatives of the cost (row 0) and of every end state (other rows)."""
        key = z.tobytes()
        if self._at is None or self._at[0] != key:
            shooting = self.shooting_at(z)
            run = shooting.run(*self.parts(z))
            needed = self.rows or self.limits_on_path is not None
            unit = np.concatenate([np.zeros((1, self.size)), np.eye(self.size)]) if needed else np.zeros((1, self.size))
            ends = np.repeat(unit[:, None], self.S, axis=1)
            slope = shooting.pullback(run, ends, np.eye(len(unit))[0])
            self._at = key, run, slope
        return self._at[1], self._at[2]

    def cost(self, z: Array) -> tuple[float, Array]:
        """J and its gradient."""
        run, slope = self.evaluated(z)
        gradient = np.concatenate([slope.controls[0].ravel(), slope.start[0, 1:].ravel(), slope.parameters[0]])
        if not (np.isfinite(run.cost) and np.isfinite(gradient).all()):
            return BEYOND, np.zeros_like(z)
        return run.cost, gradient

    def residual(self, z: Array) -> Array:
        """What must vanish: gaps between segments, and the demands."""
        run, _ = self.evaluated(z)
        starts, _ = self.parts(z)
        # end_k - s_(k+1), and end_last less what is demanded
        demanded = self.wanted_rows @ run.end[-1] - self.wanted_values
        gaps = (run.end[:-1] - starts[1:]).ravel()
        return np.nan_to_num(np.concatenate([gaps, demanded]), nan=BEYOND, posinf=BEYOND, neginf=-BEYOND)

    def jacobian(self, z: Array) -> Array:
        """Derivatives of the residual, (rows, variables)."""
        _, slope = self.evaluated(z)
        result, gaps = np.zeros((self.rows, len(z))), (self.S - 1) * self.size
        for at in range(gaps):
            s, i = divmod(at, self.size)
            self._by_end(result[at], slope, s, i)
            # -1 for s_(s+1)
            result[at, self.split + at] = -1
        last = np.zeros((self.size, len(z)))
        for i in range(self.size if self.demands else 0):
            self._by_end(last[i], slope, self.S - 1, i)
        result[gaps:] = self.wanted_rows @ last
        return np.nan_to_num(result, nan=0.0, posinf=0.0, neginf=0.0)

    def _by_end(self, row: Array, slope: Slope, s: int, i: int) -> None:
        """d end_(s,i)/dz into a row of zeros."""
        # the nodes of segment s alone
        first = s * (slope.parts.shape[2] - 1) * self.m
        own = slope.parts[1 + i, s].ravel()[: self.split - first]
        row[first : first + len(own)] = own
        if s:
            before = self.split + (s - 1) * self.size
            row[before : before + self.size] = slope.start[1 + i, s]
        row[self.own :] = slope.shares[1 + i, s]

    def on_path(self, z: Array) -> tuple[Array, Array]:
        """What must not be negative, distances to limits at all nodes over their sizes, and its derivatives by z."""
        path = self.limits_on_path
        if path is None:
            return np.zeros(0), np.zeros((0, len(z)))
        run, slope = self.evaluated(z)
        value, by = self._along(path, z, run)
        nodes, slopes = np.arange(self.S + 1), np.zeros((self.S + 1, len(path.texts), len(z)))
        for k in nodes:
            self._by_node(slopes[k], by[k], int(k), slope)
        # c - low and high - c, where they are finite
        signs = [(1.0, path.low, np.isfinite(path.low)), (-1.0, path.high, np.isfinite(path.high))]
        sizes, slopes = self.path_sizes, slopes / self.path_sizes[:, None]
        rows = [(sign * (value - limit) / sizes)[self._first_free :, some].ravel() for sign, limit, some in signs]
        ways = [(sign * slopes)[self._first_free :, some].reshape(-1, len(z)) for sign, _, some in signs]
        return np.nan_to_num(np.concatenate(rows), nan=-BEYOND, posinf=BEYOND, neginf=-BEYOND), np.nan_to_num(
            np.concatenate(ways), nan=0.0, posinf=0.0, neginf=0.0
        )

    def _along(self, path: PathLimits, z: Array, run: Rollout) -> tuple[Array, Array]:
        """Values and slopes of the limited expressions at all nodes."""
        starts, controls = self.parts(z)
        shooting, nodes = self.shooting_at(z), np.arange(self.S + 1)
        u = controls[np.minimum(nodes, self.problem.nodes - 1)]
        t = self.problem.t + nodes / self.S * shooting.problem.horizon
        return path.at(shooting.values, np.concatenate([starts, run.end[-1:]]), u, t)

    @cached_property
    def path_sizes(self) -> Array:
        """Of the limited expressions (k,): what changes of the size of the motion make of them, at most 1."""
        path, z = self.limits_on_path, self.guess()
        if path is None:
            return np.zeros(0)
        _, slopes = self._along(path, z, self.evaluated(z)[0])
        changes = np.abs(slopes[..., : self.size + self.m]) @ np.concatenate([self.sizes, self.units[0][: self.m]])
        return np.array([power_of_2(min(x, 1.0)) for x in changes.max(axis=0)])

    def _by_node(self, rows: Array, by: Array, k: int, slope: Slope) -> None:
        """dc/dz at the node k into rows of zeros (expressions, variables), from dc/d(x, u, varied) ``by``."""
        n, node = self.size, min(k, self.problem.nodes - 1)
        if k == self.S:
            ends = np.zeros((n, rows.shape[1]))
            for i in range(n):
                self._by_end(ends[i], slope, self.S - 1, i)
            rows += by[:, :n] @ ends
        elif k:
            rows[:, self.split + (k - 1) * n : self.split + k * n] += by[:, :n]
        rows[:, node * self.m : (node + 1) * self.m] += by[:, n : n + self.m]
        others = by[:, n + self.m :].copy()
        if self.varied and self.varied[-1] == HORIZON:
            # t = t_0 + k/S T
            others[:, -1] *= k / self.S
        rows[:, self.own :] += others

    def _require_start(self) -> None:
        """The first state is given: what it alone decides must hold. Raises InvalidArgument."""
        path = self.limits_on_path
        #: the first node with a limit that anything unknown can meet
        self._first_free = 0
        if path is None:
            return
        z = self.guess()
        value, by = path.at(
            self.shooting_at(z).values, self.first[None], self.parts(z)[1][:1], np.full(1, self.problem.t)
        )
        if by[0, :, self.size :].any():
            return
        self._first_free = 1
        for text, x, outside in zip(path.texts, value[0], path.excess(value)[0], strict=True):
            if outside > 0:
                message = f"the motion starts at {x:g}: no control helps; give another 'q', 'qd' or limit"
                raise InvalidArgument.at(f"/path/{escape(text)}", "start-outside", message)

    def limits(self) -> tuple[Array, Array]:
        """Bounds of all variables."""
        free = np.full((self.S - 1) * self.size, np.inf)
        low, high = (np.broadcast_to(b, (self.problem.nodes, self.m)).ravel() for b in self.bounds)
        return np.concatenate([low, -free, self.ranges[0]]), np.concatenate([high, free, self.ranges[1]])

    @cached_property
    def units(self) -> tuple[Array, float]:
        """What variables (size,) and the cost are measured in: a control in what moves the end by the size of the
        motion, states in that, all others in 1; the cost in what such controls change it by, at most in 1. Powers of 2:
        nothing is rounded.
        """
        z = self.guess()
        unit = np.ones(len(z))
        unit[self.split : self.own] = np.tile(self.sizes, self.S - 1)
        if not self.m:
            return unit, 1.0
        shooting, ends = self.shooting_at(z), np.repeat(np.eye(self.size)[:, None], self.S, axis=1)
        run = shooting.run(*self.parts(z))
        # sum over nodes of |d end/d u|
        effects = np.abs(shooting.pullback(run, ends, np.zeros(self.size)).parts).sum(axis=(1, 2))
        effect = (effects / self.sizes[:, None]).max(axis=0)
        unit[: self.split] = np.tile([power_of_2(1 / x) if x > 0 else 1.0 for x in effect], self.problem.nodes)
        z[: self.split] += unit[: self.split]
        return unit, power_of_2(min(abs(self.cost(z)[0] - run.cost), 1.0))

    @cached_property
    def row_sizes(self) -> Array:
        """Of the residual (rows,)."""
        demanded = np.abs(self.wanted_rows) @ self.sizes
        return np.concatenate([np.tile(self.sizes, self.S - 1), np.where(demanded > 0, demanded, 1.0)])

    def violation(self, z: Array) -> float:
        """The largest violation of a demand, relative to the size of the motion where this is small."""
        outside = -float(self.on_path(z)[0].min(initial=0))
        return max(float(np.abs(self.residual(z) / self.row_sizes).max(initial=0)), outside)

    def progress(self, z: Array) -> tuple[float, float]:
        """Cost, and the largest violation."""
        return self.cost(z)[0], self.violation(z)


def _warm(problem: ControlProblem, earlier: WarmStart, controls: Array) -> None:
    """Controls of the earlier result into those that were guessed."""
    times = np.arange(problem.nodes) / problem.intervals
    for i, name in enumerate(problem.controls):
        column = earlier.column(name, times, problem.hold)
        if column is not None:
            controls[:, i] = column
