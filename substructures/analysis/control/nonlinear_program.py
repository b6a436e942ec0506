"""Optimal control as a nonlinear program: controls and starts of segments are the variables.

    minimise J(u, s)    subject to    end_k(u, s) = s_(k+1),    end_last = what the end demands,    bounds on u

(direct multiple shooting; all derivatives by the discrete adjoint of substructures.analysis.control.shooting).
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from substructures.analysis.arguments import real, whole
from substructures.analysis.control.problem import ControlProblem, initial_state, per_node
from substructures.analysis.control.shooting import Rollout, Shooting, Slope
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import InvalidArgument, among
from substructures.quantities.measured import numeric
from substructures.tree.model import Model

#: variables and conditions: the solver's time grows with their third power
MAX_VARIABLES = 2_000
#: the cost of a motion that is not finite
BEYOND = 1e30
#: segments that are taken where nothing says how many
SEGMENTS = 10
MAX_ITERATIONS = 100_000


#: numbers of the last state, None where nothing is demanded: all in the order of the coordinates, or some by name
Demanded = Sequence[float | None] | Mapping[str, float | None]


@dataclass(frozen=True)
class End:
    """Demands on the last state: ``q`` [rad, m] and ``qd`` [rad/s, m/s]."""

    q: Demanded = field(default_factory=dict)
    qd: Demanded = field(default_factory=dict)


@dataclass(frozen=True)
class Demands:
    """What an optimum must meet, and how it is searched for.

    ``end``: demands on the last state; ``bounds``: least and largest value by control [N m, N], None for none;
    ``guess``: controls to begin with, by name one number or one for each node; ``segments``: divides the intervals
    (default: the largest such up to 10); ``tolerance``: change of the cost at which the search ends, after
    ``iterations`` at the latest. Raises InvalidArgument.
    """

    end: End = field(default_factory=End)
    bounds: Mapping[str, tuple[float | None, float | None]] = field(default_factory=dict)
    guess: Mapping[str, Any] = field(default_factory=dict)
    segments: int | None = None
    iterations: int = 500
    tolerance: float = 1e-8

    def __post_init__(self) -> None:
        if self.segments is not None:
            whole(self.segments, "segments", 1, sys.maxsize)
        whole(self.iterations, "iterations", 1, MAX_ITERATIONS)
        object.__setattr__(self, "tolerance", real(self.tolerance, "/tolerance"))
        if not 0 < self.tolerance < 1:
            code = "greater-than" if self.tolerance <= 0 else "less-than"
            message = f"'tolerance' must lie between 0 and 1, found {self.tolerance:g}"
            raise InvalidArgument.at("/tolerance", code, message)


class ShootingProgram:
    """The nonlinear program. Variables: controls (nodes, m), then the starts of all segments but the first."""

    def __init__(self, model: Model, problem: ControlProblem, wanted: Demands) -> None:
        self.model, self.problem, self.wanted, self.size = model, problem, wanted, 2 * model.dof
        self.S = wanted.segments or max(k for k in range(1, SEGMENTS + 1) if problem.intervals % k == 0)
        if problem.intervals % self.S:
            message = f"{self.S} segments do not divide {problem.intervals} intervals"
            raise InvalidArgument.at("/segments", "not-a-divisor", message)
        self.demands = [*_demanded(model, wanted.end.q, "q", 0), *_demanded(model, wanted.end.qd, "qd", model.dof)]
        self.first = initial_state(model, problem)
        self.bounds = _bounds(problem.controls, wanted)
        self.m = len(problem.controls)
        self.split = problem.nodes * self.m
        self.rows = (self.S - 1) * self.size + len(self.demands)
        size = self.split + (self.S - 1) * self.size + self.rows
        if size > MAX_VARIABLES:
            message = (
                f"{size:,} variables and conditions; the limit is {MAX_VARIABLES:,}: take fewer intervals or segments"
            )
            raise InvalidArgument.at("/intervals", "too-large", message)
        self.shooting = Shooting(model, problem, (), self.S)
        self._at: tuple[bytes, Rollout, Slope] | None = None

    def guess(self) -> Array:
        """Controls that were given; starts of segments on a line from the first state to the demanded one."""
        controls = np.clip(per_node(self.problem, self.wanted.guess, "guess"), *self.bounds)
        end = self.first.copy()
        for i, value in self.demands:
            end[i] = value
        # s_k = x_0 + k/S (x_end - x_0)
        share = np.arange(1, self.S)[:, None] / self.S
        return np.concatenate([controls.ravel(), (self.first + share * (end - self.first)).ravel()])

    def parts(self, z: Array) -> tuple[Array, Array]:
        """Starts (S, 2 n) and controls (nodes, m)."""
        starts = np.concatenate([self.first, z[self.split :]]).reshape(self.S, self.size)
        return starts, z[: self.split].reshape(-1, self.m)

    def evaluated(self, z: Array) -> tuple[Rollout, Slope]:
        """The motion, and the derivatives of the cost (row 0) and of every end state (other rows)."""
        key = z.tobytes()
        if self._at is None or self._at[0] != key:
            run = self.shooting.run(*self.parts(z))
            unit = (
                np.concatenate([np.zeros((1, self.size)), np.eye(self.size)]) if self.rows else np.zeros((1, self.size))
            )
            ends = np.repeat(unit[:, None], self.S, axis=1)
            slope = self.shooting.pullback(run, ends, np.eye(len(unit))[0])
            self._at = key, run, slope
        return self._at[1], self._at[2]

    def cost(self, z: Array) -> tuple[float, Array]:
        """J and its gradient."""
        run, slope = self.evaluated(z)
        gradient = np.concatenate([slope.controls[0].ravel(), slope.start[0, 1:].ravel()])
        if not (np.isfinite(run.cost) and np.isfinite(gradient).all()):
            return BEYOND, np.zeros_like(z)
        return run.cost, gradient

    def residual(self, z: Array) -> Array:
        """What must vanish: gaps between segments, and the demands."""
        run, _ = self.evaluated(z)
        starts, _ = self.parts(z)
        # end_k - s_(k+1), and end_last less what is demanded
        demanded = [run.end[-1, i] - value for i, value in self.demands]
        gaps = (run.end[:-1] - starts[1:]).ravel()
        return np.nan_to_num(np.concatenate([gaps, demanded]), nan=BEYOND, posinf=BEYOND, neginf=-BEYOND)

    def jacobian(self, z: Array) -> Array:
        """Derivatives of the residual, (rows, variables)."""
        _, slope = self.evaluated(z)
        result = np.zeros((self.rows, len(z)))
        kept = [range(self.size)] * (self.S - 1) + [[i for i, _ in self.demands]]
        at, per = 0, slope.parts.shape[2] - 1
        for s, indices in enumerate(kept):
            for i in indices:
                # d end_(s,i)/du: the nodes of segment s alone
                own = slope.parts[1 + i, s].ravel()
                first = s * per * self.m
                own = own[: self.split - first]
                result[at, first : first + len(own)] = own
                # d end_(s,i)/ds_s, and -1 for s_(s+1)
                if s:
                    before = self.split + (s - 1) * self.size
                    result[at, before : before + self.size] = slope.start[1 + i, s]
                if s < self.S - 1:
                    result[at, self.split + s * self.size + i] = -1
                at += 1
        return np.nan_to_num(result, nan=0.0, posinf=0.0, neginf=0.0)

    def limits(self) -> tuple[Array, Array]:
        """Bounds of all variables."""
        free = np.full((self.S - 1) * self.size, np.inf)
        low, high = (np.broadcast_to(b, (self.problem.nodes, self.m)).ravel() for b in self.bounds)
        return np.concatenate([low, -free]), np.concatenate([high, free])

    def progress(self, z: Array) -> tuple[float, float]:
        """Cost, and largest residual."""
        return self.cost(z)[0], float(np.abs(self.residual(z)).max(initial=0))


def _demanded(model: Model, given: Any, field: str, offset: int) -> list[tuple[int, float]]:
    """(index in (q, q'), value) of every demand. Raises InvalidArgument."""
    pointer = f"/end/{field}"
    if not isinstance(given, Mapping):
        if len(given) != model.dof:
            raise InvalidArgument.at(pointer, "wrong-length", f"{len(given)} values for {model.dof} coordinates")
        given = dict(zip(model.coordinates, given, strict=True))
    for name in given:
        if name not in model.coordinates:
            message = f"unknown coordinate '{name[:80]}'{among(name, model.coordinates)}"
            raise InvalidArgument.at(f"{pointer}/{escape(name)}", "unknown-coordinate", message)
    pairs = ((a, given.get(name)) for a, name in enumerate(model.coordinates))
    return [(offset + a, float(numeric(x, pointer))) for a, x in pairs if x is not None]


def _bounds(controls: Sequence[str], wanted: Demands) -> tuple[Array, Array]:
    """Least and largest values of the controls, (m,). Raises InvalidArgument."""
    low, high = np.full(len(controls), -np.inf), np.full(len(controls), np.inf)
    for name, (least, most) in wanted.bounds.items():
        pointer = f"/bounds/{escape(name)}"
        if name not in controls:
            message = f"'{name[:80]}' is not one of the controls{among(name, controls)}"
            raise InvalidArgument.at(pointer, "unknown-input", message)
        i = controls.index(name)
        low[i], high[i] = -np.inf if least is None else least, np.inf if most is None else most
        if not low[i] <= high[i]:
            raise InvalidArgument.at(pointer, "empty", f"no number lies between {least} and {most}")
    return low, high
