"""Motion under controls, and gradients of its cost by the discrete adjoint of the integration scheme.

The classical Runge-Kutta scheme of order 4 takes x = (q, q') over ``intervals`` times ``steps`` equal steps, and the
cost integral by the same weights. Its adjoint runs the same steps backwards with the exact derivative of each
(W. W. Hager, Runge-Kutta methods in optimal control and the transformed adjoint system, Numerische Mathematik 87,
2000): the gradient is that of the computed cost, exact to rounding, whatever the step size. As the steps
become small the multipliers are the costates of substructures.analysis.control.adjoint.

Time may be cut into ``segments`` of equally many intervals, each with a start of its own (multiple shooting, H. G.
Bock and K. J. Plitt, A multiple shooting algorithm for direct solution of optimal control problems, IFAC World
Congress 1984); all segments and all rows of a Jacobian are integrated in one batch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np

from substructures.analysis.control.adjoint import (
    ADJOINT,
    CHANGES,
    HORIZON,
    TERMINAL,
    WEIGHT,
    AdjointEquations,
    adjoint_equations,
)
from substructures.analysis.control.closed_start import StartState
from substructures.analysis.control.problem import ControlProblem
from substructures.analysis.control.rollout import Rollout, Slope
from substructures.analysis.equations.formulas import inputs_of
from substructures.array import Array
from substructures.compile import compile_program
from substructures.errors import MissingValue
from substructures.mechanics.accelerations import saddle_solve
from substructures.mechanics.state_names import resting_state
from substructures.quantities.numbers.defaults import with_input_defaults
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

#: c_i = a_(i, i-1) and b_i of the scheme
NODES = (0.0, 0.5, 0.5, 1.0)
WEIGHTS = (1 / 6, 1 / 3, 1 / 3, 1 / 6)


class Shooting:
    """The equations of a problem as compiled code. ``segments`` must divide ``problem.intervals``; ``start``: of it.

    HORIZON among ``varied`` stands for the horizon T: with h = T / steps and t_i = t_0 + s_i T, and the multipliers
    bar_i of the stages of the adjoint scheme,

        dJ/dT = sum_i (H(bar_i) / T + s_i dH/dt)

    Raises InvalidInput (see adjoint_equations) and MissingValue for a parameter without a value.
    """

    def __init__(
        self, model: Model, problem: ControlProblem, start: StartState, varied: Sequence[str] = (), segments: int = 1
    ) -> None:
        self.model, self.problem, self.segments, self.start = model, problem, segments, start
        self.equations = adjoint_equations(model, problem.controls, problem.cost, varied)
        self.values = _constants(model, problem, self.equations)
        source = self.equations.program
        self.free = HORIZON in varied
        self.motion = compile_program(source, self.equations.motion)
        self.adjoint = compile_program(source, (*ADJOINT, "hamiltonian") if self.free else ADJOINT)
        self.terminal = compile_program(source, TERMINAL)
        self.hamiltonian = compile_program(source, ("hamiltonian",))
        self.h = problem.horizon / (problem.intervals * problem.steps)
        self.count = problem.intervals // segments * problem.steps
        e = self.equations
        self.state_names = [*e.positions, *e.names(primes="'")]
        self.costate_names = [f"lambda.{name}" for name in self.state_names]
        #: of the numbers q, and of states (q, v)
        self.m, self.size = len(e.positions), len(self.state_names)

    def run(self, start: Array, controls: Array) -> Rollout:
        """Integrate from the starts of all segments (S, 2 n), of ball joints (S, m + n), under ``controls`` (nodes, m).

        Where the metric is singular or the motion leaves the range of numbers the result is not finite.
        """
        n, S, J, r = self.model.dof, self.segments, self.count, len(self.start.rows)
        stages, accelerations, cost = np.empty((J, 4, S, self.size)), np.empty((J, 4, S, n)), 0.0
        metrics, held, multipliers = (np.empty((J, 4, S, *x)) for x in ((n, n), (r, n), (len(self.equations.rows),)))
        x = np.array(start, dtype=np.float64).reshape(S, self.size)
        with np.errstate(all="ignore"):
            for j in range(J):
                rate, total = np.zeros_like(x), np.zeros_like(x)
                for i in range(4):
                    # X_i = x + h c_i x'_(i-1),  x'_i = (q', g^-1 (Q - Gamma q' q')),  x <- x + h sum b_i x'_i
                    stages[j, i] = X = x + (self.h * NODES[i]) * rate
                    found = self._motion(X, controls, j, i)
                    metrics[j, i], held[j, i] = found["metric"], self._rows(found)
                    accelerations[j, i], multipliers[j, i] = self._accelerated(found)
                    rate = np.concatenate([found.get(CHANGES, X[:, self.m :]), accelerations[j, i]], axis=1)
                    total += WEIGHTS[i] * rate
                    cost += self.h * WEIGHTS[i] * float(found["running_cost"].sum())
                x = x + self.h * total
            # + phi(x(T))
            cost += float(self._terminal(x[-1:], controls)["terminal_cost"][0])
        return Rollout(controls, stages, accelerations, metrics, held, multipliers, x, cost)

    def refined(self) -> Shooting:
        """The same problem in one piece with steps half as long; what was compiled is shared."""
        finer = copy(self)
        finer.problem = replace(self.problem, steps=2 * self.problem.steps)
        finer.segments, finer.h, finer.count = 1, self.h / 2, 2 * self.count * self.segments
        return finer

    def at(self, parameters: Mapping[str, float], horizon: float) -> Shooting:
        """The same problem for other values of parameters and another horizon; what was compiled is shared."""
        other = copy(self)
        other.problem = replace(self.problem, horizon=horizon)
        other.h = horizon / (self.problem.intervals * self.problem.steps)
        other.values = {**self.values, **parameters}
        return other

    def pullback(self, run: Rollout, ends: Array, costs: Array) -> Slope:
        """Derivatives of ``ends``_ws . end_s + ``costs``_w cost for (W, S, 2 n) and (W,), by one pass backwards."""
        W, S, _ = ends.shape
        last = self._terminal(run.end[-1:], run.controls)
        lam = np.array(ends, dtype=np.float64)
        lam[:, -1] += costs[:, None] * np.concatenate([last["terminal_q"][0], last["terminal_qd"][0]])
        parts = np.zeros((W, S, self.problem.intervals // S + 1, run.controls.shape[1]))
        shares = np.zeros((W, S, len(self.equations.varied)))
        shares[:, -1] = costs[:, None] * last["terminal_parameters"][0]
        costates = np.empty((W, self.count + 1, S, self.size))
        costates[:, -1] = lam
        with np.errstate(all="ignore"):
            for j in reversed(range(self.count)):
                before, total = np.zeros_like(lam), np.zeros_like(lam)
                for i in (3, 2, 1, 0):
                    # bar_i = h b_i lambda + h c_(i+1) before_(i+1),  before_i = (dx'/dx)^T bar_i + h b_i dl/dx
                    above = self.h * NODES[i + 1] * before if i < 3 else 0.0
                    bar = self.h * WEIGHTS[i] * lam + above
                    found = self._adjoint(run, j, i, bar, self.h * WEIGHTS[i] * costs)
                    before = -np.concatenate([found["adjoint_q"], found["adjoint_qd"]], axis=-1)
                    total += before
                    self._to_nodes(parts, found["control_gradient"], j, i)
                    shares += self._by_varied(found, j, i)
                # lambda_j = lambda_(j+1) + sum_i before_i
                lam = lam + total
                costates[:, j] = lam
        return Slope(lam, self._joined(parts), parts, shares, costates)

    def hamiltonians(self, run: Rollout, costates: Array) -> Array:
        """H before every step and at the last end, (S J + 1,), for the costates (J + 1, S, 2 n) of the cost."""
        e, n = self.equations, self.model.dof
        inner = run.accelerations[:, 0].swapaxes(0, 1).reshape(-1, n)
        # at the end there is no stage: q'' = g^-1 (Q - Gamma q' q') once more
        found = self._motion(run.end, run.controls, self.count - 1, 3)
        qdd = np.concatenate([inner, self._accelerated(found)[0][-1:]])
        lam = np.concatenate([costates[:-1].swapaxes(0, 1).reshape(-1, self.size), costates[-1, -1:]])
        last = (x[-1:] for x in self._controls(run.controls, self.count - 1, 3))
        u, t = (np.concatenate(x) for x in zip(*self._all_controls(run.controls), last, strict=True))
        columns = [(self.state_names, run.states), (e.names(primes="''"), qdd), (self.costate_names, lam)]
        values = {**self.values, "t": t, WEIGHT: 1.0}
        return self.hamiltonian.evaluate(values, columns=[*columns, (e.controls, u)])["hamiltonian"]

    def controls_at_steps(self, controls: Array) -> Array:
        """Controls just after the beginning of every step, and at the last end, (S J + 1, m)."""
        last = self._controls(controls, self.count - 1, 3)[0][-1:]
        return np.concatenate([*(u for u, _ in self._all_controls(controls)), last])

    def _all_controls(self, controls: Array) -> list[tuple[Array, Array]]:
        """(u, t) before every step, segment after segment."""
        pairs = [self._controls(controls, j, 0) for j in range(self.count)]
        return [(np.array([u[s] for u, _ in pairs]), np.array([t[s] for _, t in pairs])) for s in range(self.segments)]

    def _place(self, j: int, i: int) -> tuple[Any, float]:
        """The interval of every segment, and where in it the stage lies (0 to 1)."""
        steps, per = self.problem.steps, self.problem.intervals // self.segments
        return np.arange(self.segments) * per + j // steps, (j % steps + NODES[i]) / steps

    def _controls(self, controls: Array, j: int, i: int) -> tuple[Array, Array]:
        """u (S, m) and t (S,) of a stage."""
        interval, inside = self._place(j, i)
        # t = t_0 + (k + s) T/K for the place s in the interval k of K
        t = self.problem.t + (interval + inside) * (self.problem.horizon / self.problem.intervals)
        if self.problem.hold == "constant":
            return controls[interval], t
        # u = (1 - s) u_k + s u_(k+1)
        return (1 - inside) * controls[interval] + inside * controls[interval + 1], t

    def _to_nodes(self, parts: Array, bar: Array, j: int, i: int) -> None:
        """The adjoint of _controls."""
        _, inside = self._place(j, i)
        k = j // self.problem.steps
        if self.problem.hold == "constant":
            parts[:, :, k] += bar
        else:
            parts[:, :, k] += (1 - inside) * bar
            parts[:, :, k + 1] += inside * bar

    def _by_varied(self, found: dict[str, Array], j: int, i: int) -> Array:
        """Derivatives by what is varied at a stage, (W, S, r)."""
        result = found["parameter_gradient"]
        if self.free:
            # H(bar_i) / T + s_i dH/dt
            interval, inside = self._place(j, i)
            share, at = (interval + inside) / self.problem.intervals, self.equations.varied.index(HORIZON)
            result = result.copy()
            result[..., at] = share * result[..., at] + found["hamiltonian"] / self.problem.horizon
        return result

    def _joined(self, parts: Array) -> Array:
        """Derivatives by all nodes, (W, nodes, m)."""
        W, S, size, m = parts.shape
        result = np.zeros((W, S * (size - 1) + 1, m))
        for s in range(S):
            result[:, s * (size - 1) : (s + 1) * (size - 1) + 1] += parts[:, s]
        return result[:, : self.problem.nodes]

    def _motion(self, X: Array, controls: Array, j: int, i: int) -> dict[str, Array]:
        u, t = self._controls(controls, j, i)
        columns = [(self.state_names, X), (self.equations.controls, u)]
        return self.motion.evaluate({**self.values, "t": t}, columns=columns)

    def _rows(self, found: dict[str, Array]) -> Array:
        """The independent rows of closures (S, r, n)."""
        if not self.equations.rows:
            return np.zeros((self.segments, 0, self.model.dof))
        return found["closure.jacobian"][:, self.start.rows]

    def _accelerated(self, found: dict[str, Array]) -> tuple[Array, Array]:
        """q'' (S, n), and the multipliers of all rows of closures (S, k), 0 of dependent ones."""
        rows, G, multipliers = self.start.rows, self._rows(found), np.zeros((self.segments, len(self.equations.rows)))
        c = found["closure.acceleration"][:, rows] if self.equations.rows else np.zeros((self.segments, 0))
        # g q'' - G^T rho = Q - Gamma q' q',  G q'' = -c
        qdd, minus = saddle_solve(found["metric"], G, found["force"], -c)
        multipliers[:, rows] = -minus
        return qdd, multipliers

    def _terminal(self, x: Array, controls: Array) -> dict[str, Array]:
        t = self.problem.t + self.problem.horizon
        columns = [(self.state_names, x), (self.equations.controls, controls[-1:])]
        return self.terminal.evaluate({**self.values, "t": t}, columns=columns)

    def _adjoint(self, run: Rollout, j: int, i: int, bar: Array, weight: Array) -> dict[str, Array]:
        """dH/d(state, controls, parameters) at a stage for the costates ``bar`` (W, S, 2 n), with minus for states."""
        W, S, _ = bar.shape
        u, t = self._controls(run.controls, j, i)
        flat = bar.reshape(W * S, self.size)
        e, rows, nu = self.equations, self.start.rows, np.zeros((W * S, len(self.equations.rows)))
        # g mu + G^T nu = lambda_qd,  G mu = 0
        g, G = (np.tile(x[j, i], (W, 1, 1)) for x in (run.metrics, run.held))
        mu, nu[:, rows] = saddle_solve(g, G, flat[:, self.m :], np.zeros((W * S, len(rows))))
        columns = [
            (self.state_names, np.tile(run.stages[j, i], (W, 1))),
            (e.names(primes="''"), np.tile(run.accelerations[j, i], (W, 1))),
            (self.costate_names, flat),
            (e.names("mu."), mu),
            ([f"rho.{row}" for row in e.rows], np.tile(run.multipliers[j, i], (W, 1))),
            ([f"nu.{row}" for row in e.rows], nu),
            (e.controls, np.tile(u, (W, 1))),
        ]
        values = {**self.values, "t": np.tile(t, W), WEIGHT: np.repeat(weight, S)}
        found = self.adjoint.evaluate(values, columns=columns)
        return {name: x.reshape(W, S, *x.shape[1:]) for name, x in found.items()}


def _constants(model: Model, problem: ControlProblem, equations: AdjointEquations) -> dict[str, Any]:
    """Parameters and the inputs that are not controlled. Raises MissingValue."""
    inputs = with_input_defaults(model.inputs, problem.inputs or {})
    given = {"q": resting_state(model.positions, model.balls), "parameters": problem.parameters}
    known = symbol_values(model, given, read_states(model, given, None), ())
    values = {name: float(known[name]) for name in model.parameters if name in known}
    values |= {name: float(inputs.get(name, 0.0)) for name in inputs_of(model)}
    for symbol in equations.program.symbols:
        if symbol.kind == "parameter" and symbol.name not in values:
            raise MissingValue(symbol.name)
    return {name: x for name, x in values.items() if name not in equations.controls}
