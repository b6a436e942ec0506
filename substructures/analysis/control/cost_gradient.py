"""The cost of a motion under given controls, and its gradient by the adjoint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from substructures.analysis.arguments import positive
from substructures.analysis.control.closed_start import start_state
from substructures.analysis.control.problem import (
    ERROR_LIMIT,
    ControlProblem,
    per_node,
    require_solvable,
)
from substructures.analysis.control.rollout import Rollout, Slope
from substructures.analysis.control.shooting import Shooting
from substructures.analysis.control.step_error import gradient_checks
from substructures.analysis.given import require_known
from substructures.analysis.motion.judges.balls import reached_in_rates, with_lengths
from substructures.analysis.motion.limits import with_limits
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.verdict import Check, verdict
from substructures.array import Array
from substructures.quantities.numbers.defaults import input_defaults
from substructures.quantities.numbers.quaternions import by_displacements
from substructures.tree.model import Model

FAILED = (
    "the motion is not finite from here on: take more 'steps', smaller controls or a shorter 'horizon', "
    "and check that the metric is positive definite"
)
COARSE = "cost, motion or gradient are not as accurate as 'error_limit' asks for: take more 'steps'"
ROUGH = (
    "the motion is finite, its gradient is not: a cost or load is not smooth where the motion passes (a square root of "
    "zero, a spring of no length); change the cost, the load or the state at the start"
)


@dataclass(frozen=True, repr=False)
class CostGradient:
    """J and its derivatives: dJ/du ``controls`` (nodes, m) in the order of ``names``; by the state at the start dJ/dq
    ``q`` and dJ/dq' ``qd`` (n,), of ball joints by displacements and rotation vectors as rates are; dJ/dp
    ``parameters`` by name. ``trajectory``: the motion with the series ``controls``, ``costates`` and ``hamiltonian``.

    ``status`` failed: the motion left the range of numbers, or the derivatives did; ``message`` says what to change,
    also where they are not accurate.
    """

    cost: float
    names: tuple[str, ...]
    controls: Array
    q: Array
    qd: Array
    parameters: Mapping[str, float]
    trajectory: Trajectory
    status: Literal["finished", "failed"] = "finished"
    message: str = ""

    @property
    def is_right(self) -> bool | None:
        """Whether cost, motion and gradient have the accuracy asked for; None where the status is ``failed``."""
        return verdict(self.checks, self.status == "finished")

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of the trajectory."""
        return self.trajectory.checks

    def __repr__(self) -> str:
        sizes = f"controls={len(self.names)}, nodes={len(self.controls)}, parameters={len(self.parameters)}"
        largest = float(np.abs(self.controls).max(initial=0))
        finding = f"cost {self.cost:.6g}, its largest derivative by a control {largest:.6g}"
        found = f"failed: {self.message}" if self.status == "failed" else f"{finding}, is_right={self.is_right}"
        return f"CostGradient({sizes})\n{found}"


def cost_gradient(
    model: Model,
    problem: ControlProblem,
    *,
    values: Mapping[str, Any] | None = None,
    vary: Sequence[str] = (),
    error_limit: float = ERROR_LIMIT,
) -> CostGradient:
    """J of a motion under given controls, and dJ by them, by the start and by parameters.

        J = integral of l(q, q', u, t, p) dt + phi(q, q', t, p) at the end,        g q'' + Gamma q' q' = Q

    ``values``: by control one number, or one for each node [N m, N], default 0: nodes are the ends of the intervals of
    the ``problem`` (``hold``: linear, intervals + 1 of them) or the intervals (constant). ``vary``: parameters by which
    the cost is differentiated. The gradient is that of the discrete adjoint of the Runge-Kutta scheme, exact to
    rounding, for about three times the run. A second run with steps half as long judges them: its relative differences,
    the stated errors of cost, motion and gradient, may reach ``error_limit``; with it all takes three times as long. A
    motion that leaves the range of numbers is a result with status ``failed``. Raises InvalidInput (``/controls/i``,
    ``/cost/running``, ``/values/name``, ``/vary/i``, ...) and MissingValue.
    Source: W. W. Hager, Numerische Mathematik 87, 2000; notation.md, section 7.
    """
    require_solvable(model, problem)
    require_known("vary", "parameter", vary, model.parameters)
    own = {name: x for name, x in input_defaults(model.inputs).items() if name in problem.controls}
    return _gradient(model, problem, {**own, **(values or {})}, tuple(vary), positive(error_limit, "error_limit"))


def _gradient(
    model: Model, problem: ControlProblem, values: Mapping[str, Any], vary: tuple[str, ...], limit: float
) -> CostGradient:
    controls = per_node(problem, values, "values")
    # x_0 = (q, q') and dJ/dx_0 = lambda_0
    start = start_state(model, problem, {f"/vary/{i}": name for i, name in enumerate(vary)})
    shooting = Shooting(model, problem, start, vary)
    run = shooting.run(start.x[None], controls)
    # W = 1: of the cost alone, no end state
    slope = shooting.pullback(run, np.zeros((1, 1, shooting.size)), np.ones(1))
    judged = replace(trajectory(shooting, run, slope), checks=gradient_checks(shooting, run, slope, limit))
    motion = with_limits(model, problem.parameters, judged)
    m, by_parameter = shooting.m, dict(zip(vary, slope.parameters[0].tolist(), strict=True))
    by_q = slope.start[0, 0, :m]
    if model.balls:
        by_q = by_q @ np.linalg.pinv(by_displacements(model.positions, model.coordinates, model.balls, start.x[:m]))
    result = CostGradient(
        run.cost,
        tuple(problem.controls),
        slope.controls[0],
        by_q,
        slope.start[0, 0, m:],
        by_parameter,
        motion,
    )
    if motion.status == "failed":
        return replace(result, status="failed", message=motion.message)
    finite = all(np.isfinite(x).all() for x in (result.controls, result.q, result.qd, slope.parameters))
    if not finite:
        return replace(result, status="failed", message=ROUGH)
    return result if result.is_right else replace(result, message=COARSE)


def trajectory(shooting: Shooting, run: Rollout, slope: Slope) -> Trajectory:
    """The motion before every step and at the end, up to where it is finite; ``slope``: of the cost, W = 1.

    Series: ``controls`` (K, m), ``costates`` (K, 2 n) (of all numbers of q, then of q'), ``hamiltonian`` (K,).
    """
    model, m, states, lam = shooting.model, shooting.m, run.states, slope.costates[0]
    costates = np.concatenate([lam[:-1].swapaxes(0, 1).reshape(-1, shooting.size), lam[-1:, -1]])
    series = {
        "controls": shooting.controls_at_steps(run.controls),
        "costates": costates,
        "hamiltonian": shooting.hamiltonians(run, lam),
    }
    # t_j = t_0 + j h
    t = np.asarray(shooting.problem.t + shooting.h * np.arange(len(states)), dtype=np.float64)
    finite = np.isfinite(states).all(axis=1)
    good = len(states) if finite.all() else int(np.argmin(finite))
    fine = bool(finite.all() and np.isfinite(run.cost))
    return Trajectory(
        model.coordinates,
        t[:good],
        with_lengths(model, states[:good, :m]),
        states[:good, m:],
        {name: x[:good] for name, x in series.items()},
        status="finished" if fine else "failed",
        message="" if fine else FAILED,
        steps=max(good - 1, 0),
        reached=reached_in_rates(model, t[:good], states[:good]) if model.balls else None,
        positions=model.positions if model.balls else (),
    )
