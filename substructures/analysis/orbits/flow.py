"""The flow of a tree and of its linear neighbourhood: x' = f(t, x), S' = f_x S, x = (q, q'); with closures or velocity
constraints x = (q, v) with quasi-velocities v. S has the coordinates of :mod:`.charts`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.nonholonomic.positions import at_rest
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.analysis.equations.nonholonomic.solved import RATES_VARIATION, VARIATION
from substructures.analysis.equations.perturbation import require_smooth
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.parameter_sensitivity import sensitivities, variation_of
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.kinds import usual_kind
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.outputs import SensitivityOutputs
from substructures.analysis.motion.rolling import RollingProblem, simulate_rolling
from substructures.analysis.motion.simulation import simulate_tree
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.motion.variation import variational
from substructures.analysis.orbits.charts import chart_of
from substructures.array import Array
from substructures.tree.document import require_undriven
from substructures.tree.model import Model


class EndsEarlyError(ArithmeticError):
    """A motion does not come to its end, and why."""


def moved(problem: TreeProblem) -> Trajectory:
    """The motion of any tree: of one with closures or velocity constraints in quasi-velocities. Raises InvalidInput
    (pointers start with names of arguments of ``simulate``), MissingValue.
    """
    kind = usual_kind(problem.model, None)
    if kind is not None:
        given = {name: getattr(problem, name) for name in ("model", "start", "times", "integrator", "events", "series")}
        return simulate_rolling(RollingProblem(**given, kind=kind))
    return simulate_tree(problem)


def require_steady_ties(model: Model, what: str) -> None:
    """Raises InvalidDocument (``has-driven``) for closures and velocity constraints that may move with drives."""
    require_undriven(model.driven if model.closures or model.velocity_constraints else (), f"leave '{what}' out")


class Flow:
    """``start`` (size,); ``is_forced``: inputs depend on the time. Raises InvalidInput, MissingValue."""

    def __init__(self, problem: TreeProblem, what: str = "periodic-orbits") -> None:
        model = problem.model
        require_moving(model, what)
        require_smooth(model)
        require_steady_ties(model, what)
        self._f = variation_of(problem, (), True, None)
        self.problem, self.conditions, self.choice = problem, self._f.conditions, problem.integrator
        self.model, self.n, self.equations = model, model.dof, self._f.equations
        self.start = self._f.first
        self.chart = chart_of(model, self.equations, self.conditions.values | {"t": 0.0}, self.conditions.q)
        source = variational(model, ()) if self.equations is None else self.equations.program
        symbols = (*self.conditions.expressions.symbols, *source.symbols)
        self.is_forced = bool(self.conditions.curves) or any(symbol.kind == "time" for symbol in symbols)

    def begun(self, x: Array, _period: float) -> Array:
        """Where the search begins."""
        return x

    def run(self, x: Array, times: OutputTimes, events: Sequence[Event]) -> Trajectory:
        """The motion from x."""
        q, qd = self.split(x)
        start = replace(self.problem.start, q=q.tolist(), qd=qd.tolist())
        return moved(replace(self.problem, start=start, times=times, events=events))

    def motion(self, x: Array, period: float, count: int) -> tuple[Trajectory, Array]:
        """The motion over a period at so many times, with its checks, and the monodromy matrix (width, width)."""
        (q, qd), start = self.split(x), self.problem.start
        motion = sensitivities(
            self.model,
            q,
            (0.0, period),
            qd=qd,
            inputs=start.inputs,
            parameters=start.parameters,
            integrator=self.choice,
            outputs=SensitivityOutputs(of_start=True, count=count),
        )
        without = replace(motion, series={name: s for name, s in motion.series.items() if name != "d.start"})
        if self.equations is None:
            return without, motion.series["d.start"][-1]
        return without, self.move(x, np.eye(self.chart.width), (0.0, period), np.array([0.0, period]))[1][-1]

    def split(self, x: Array) -> tuple[Array, Array]:
        """q and q' of a state."""
        m = len(self.model.positions)
        if self.equations is None:
            return x[:m], x[m:]
        T, given = self._velocities(self.equations, x[None, :m])
        return x[:m], T[0] @ x[m:] + given[0]

    def states(self, q: Array, qd: Array) -> Array:
        """x (K, size) of coordinates and velocities (K, n)."""
        if self.equations is None:
            return np.column_stack((q, qd))
        T, given = self._velocities(self.equations, q)
        return np.column_stack((q, np.einsum("kpn,kn->kp", np.linalg.pinv(T), qd - given)))

    def by_state(self, x: Array, slopes: Array) -> Array:
        """The derivatives (size,) by x of what has the ``slopes`` (2n,) by q and q'."""
        if self.equations is None:
            return slopes
        by_rates = self._rates(0.0, x, np.eye(self.chart.size))[1:, : self.n]
        found: Array = np.append(slopes[: self.n], np.zeros(self.chart.size - self.n)) + by_rates @ slopes[self.n :]
        return found

    def _velocities(self, equations: QuasiVelocities, q: Array) -> tuple[Array, Array]:
        """T (K, n, p) and r (K, n) of q' = T v + r."""
        found = at_rest(equations, self.conditions.values | {"t": 0.0}, q, ["T", "rates"])
        return found["T"], found["rates"]

    def volume(self, motion: Trajectory) -> float:
        """det M = exp of the integral of the divergence; by the trapezoidal rule of a periodic function."""
        states = self.states(motion.q, motion.qd)
        return float(np.exp(np.trapezoid(self.divergence(motion.t, states), motion.t)))

    def rate(self, t: float, x: Array) -> Array:
        """x' in coordinates of the chart (width,) at t."""
        found: Array = self.chart.along(x) @ self.full_rate(t, x)
        return found

    def full_rate(self, t: float, x: Array) -> Array:
        """x' (size,) at t."""
        return self._rates(t, x, np.zeros((0, self.chart.size)))[0]

    def _rates(self, t: float, x: Array, rows: Array) -> Array:
        """x', and S' of rows (k, size)."""
        found = self._f(t, self._filled(x, rows)).reshape(-1, self.chart.size)
        return np.asarray(found[: 1 + len(rows)])

    def _filled(self, x: Array, rows: Array) -> Array:
        """x, and rows as many as are integrated."""
        found = np.zeros((1 + self._f.columns, self.chart.size))
        found[0], found[1 : 1 + len(rows)] = x, rows
        return found.ravel()

    def move(self, x: Array, directions: Array, span: tuple[float, float], times: Array) -> tuple[Array, Array]:
        """States (K, size) at the times, and S (K, width, k) from the ``directions`` (width, k) at the start on.

        Raises EndsEarlyError.
        """
        start, k = self._filled(x, directions.T @ self.chart.ways(x)), directions.shape[1]
        settings = IntegratorSettings(self.choice.stepper(), self.choice.max_steps)
        breaks = self.conditions.breaks(span)
        motion = integrate(self._f, start, span, times, settings, breaks=breaks, enter=self._f.inputs.enter)
        self._f.inputs.leave()
        if motion.status != "finished":
            raise EndsEarlyError(motion.message)
        rows = np.array(motion.x).reshape(len(times), -1, self.chart.size)
        slopes = [self.chart.along(some[0]) @ some[1 : 1 + k].T for some in rows]
        return rows[:, 0], np.array(slopes)

    def divergence(self, t: Array, x: Array) -> Array:
        """tr f_x (K,), the rate at which volumes of the state space grow, at times (K,) and states (K, size)."""
        m, free = len(self.model.positions), self.chart.free
        # q' = v leaves d q'/dq at zero, quaternions turn: only closures and rates that are no derivatives have some
        seeds = [self.chart.ways(state) if free else np.eye(self.chart.size)[m:] for state in x]
        k, names = len(seeds[0]), self._f.names
        values = self.conditions.values | {"t": np.repeat(t, k)}
        given = self.conditions.inputs_at(t, np.zeros((len(t), m + self.n)))
        values |= {name: np.repeat(u, k) for name, u in given.items()}
        columns = [(names, np.repeat(x, k, axis=0)), ([f"d.{name}" for name in names], np.concatenate(seeds))]
        kernel = program_kernel(self._f.source)
        wanted = [VARIATION, *([RATES_VARIATION] if free else [])]
        slopes = {
            name: y.reshape(len(t), k, -1) for name, y in kernel.evaluate(values, wanted, columns=columns).items()
        }
        found: Array = np.einsum("kaa->k", slopes[VARIATION][:, len(free) :])
        return found + np.einsum("kaa->k", slopes[RATES_VARIATION][:, : len(free), free]) if free else found
