"""The flow of a tree and of its linear neighbourhood: x' = f(t, x), S' = f_x S, x = (q, q')."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.perturbation import require_smooth
from substructures.analysis.motion.conditions import state_names
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.parameter_sensitivity import require_plain, sensitivities
from substructures.analysis.motion.problems.outputs import SensitivityOutputs
from substructures.analysis.motion.problems.problem import MotionProblem
from substructures.analysis.motion.simulation import tree_conditions
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.variation import Variation, variational
from substructures.array import Array
from substructures.tree.given.ties import require_chains


class EndsEarlyError(ArithmeticError):
    """A motion does not come to its end, and why."""


class Flow:
    """``start`` (2n,); ``is_forced``: inputs depend on the time. Raises InvalidInput, MissingValue as sensitivities."""

    def __init__(self, problem: MotionProblem) -> None:
        require_chains(problem.model.balls)
        require_smooth(problem.model)
        self.problem, self.conditions, self.choice = problem, tree_conditions(problem), problem.integrator
        require_plain(self.conditions, self.choice)
        self.model, self.n = problem.model, problem.model.dof
        self._f = Variation(self.conditions, (), True, self.choice.folder)
        self.start = self.conditions.start
        symbols = (*self.conditions.expressions.symbols, *variational(self.model, ()).symbols)
        self.is_forced = bool(self.conditions.curves) or any(symbol.kind == "time" for symbol in symbols)

    def begun(self, x: Array, _period: float) -> Array:
        """Where the search begins."""
        return x

    def motion(self, x: Array, period: float, count: int) -> tuple[Trajectory, Array]:
        """The motion over a period at so many times, with its checks, and the monodromy matrix (2n, 2n)."""
        start, n = self.problem.start, self.n
        motion = sensitivities(
            self.model,
            x[:n],
            (0.0, period),
            qd=x[n:],
            inputs=start.inputs,
            parameters=start.parameters,
            integrator=self.choice,
            outputs=SensitivityOutputs(of_start=True, count=count),
        )
        without = {name: s for name, s in motion.series.items() if name != "d.start"}
        return replace(motion, series=without), motion.series["d.start"][-1]

    def volume(self, motion: Trajectory) -> float:
        """det M = exp of the integral of the divergence; by the trapezoidal rule of a periodic function."""
        states = np.column_stack([motion.q, motion.qd])
        return float(np.exp(np.trapezoid(self.divergence(motion.t, states), motion.t)))

    def rate(self, t: float, x: Array) -> Array:
        """x' (2n,) at t."""
        rows = np.zeros((self._f.columns + 1, 2 * self.n))
        rows[0] = x
        found: Array = self._f(t, rows.ravel())[: 2 * self.n]
        return found

    def move(self, x: Array, directions: Array, span: tuple[float, float], times: Array) -> tuple[Array, Array]:
        """States (K, 2n) at the times, and S (K, 2n, 2n) with the ``directions`` (2n, 2n) as columns at the start.

        Raises EndsEarlyError.
        """
        start = np.vstack([x, directions.T]).ravel()
        settings = IntegratorSettings(self.choice.stepper(), self.choice.max_steps)
        breaks = self.conditions.breaks(span)
        motion = integrate(self._f, start, span, times, settings, breaks=breaks, enter=self._f.inputs.enter)
        if motion.status != "finished":
            raise EndsEarlyError(motion.message)
        rows = np.array(motion.x).reshape(len(times), -1, 2 * self.n)
        return rows[:, 0], np.swapaxes(rows[:, 1:], 1, 2)

    def divergence(self, t: Array, x: Array) -> Array:
        """tr f_x (K,), the rate at which volumes of the state space grow, at times (K,) and states (K, 2n)."""
        n, names = self.n, state_names(self.model)
        kernel = program_kernel(variational(self.model, ()))
        # d q''^a / d q'^a, a = 1 ... n
        seeds = np.tile(np.eye(2 * n)[n:], (len(t), 1))
        values = self.conditions.values | {"t": np.repeat(t, n)}
        values |= {name: np.repeat(v, n) for name, v in self.conditions.inputs_at(t, x).items()}
        columns = [(names, np.repeat(x, n, axis=0)), ([f"d.{name}" for name in names], seeds)]
        slopes = kernel.evaluate(values, ["variation"], columns=columns)["variation"].reshape(len(t), n, n)
        found: Array = np.einsum("kaa->k", slopes)
        return found
