"""The cost of a motion under given controls, and its gradient by the adjoint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from pydantic import Field

from substructures.analysis.control.problem import ControlProblem, initial_state, per_node, read_problem
from substructures.analysis.control.shooting import Rollout, Shooting, Slope
from substructures.analysis.motion.trajectory import Trajectory
from substructures.array import Array
from substructures.errors import Fault, InvalidDocument
from substructures.tree.model import Model

FAILED = (
    "the motion is not finite from here on: take more 'steps', smaller controls or a shorter 'horizon', "
    "and check that the metric is positive definite"
)
ROUGH = (
    "the motion is finite, its gradient is not: a cost or load is not smooth where the motion passes (a square root of "
    "zero, a spring of no length); change the cost, the load or the state at the start"
)


class GradientRequest(ControlProblem):
    """A problem with controls."""

    values: dict[str, Any] = Field({}, description="by control: one number, or one for each node; default: zero")
    vary: tuple[str, ...] = Field((), description="parameters by which the cost is differentiated")


@dataclass(frozen=True)
class CostGradient:
    """J and its derivatives: ``controls`` (nodes, m) in the order of ``names``, ``q`` and ``qd`` (n,) by the state at
    the start, ``parameters`` by name. ``trajectory``: the motion with ``controls``, ``costates`` and ``hamiltonian``.

    ``status`` failed: the motion left the range of numbers, or the derivatives did; ``message`` says what to change.
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


def cost_gradient(model: Model, request: Mapping[str, Any]) -> CostGradient:
    """The gradient of the cost by the discrete adjoint of the Runge-Kutta scheme, for about three times the run.

    ``request``: the fields of GradientRequest. Raises InvalidDocument with pointers, and MissingValue.
    """
    problem = read_problem(GradientRequest, model, request)
    faults = [
        Fault(f"/vary/{i}", "unknown-parameter", f"unknown parameter '{name[:80]}'")
        for i, name in enumerate(problem.vary)
        if name not in model.parameters
    ]
    if faults:
        raise InvalidDocument(faults)
    controls = per_node(problem, problem.values, "values")
    start = initial_state(model, problem)
    shooting = Shooting(model, problem, problem.vary)
    run = shooting.run(start[None], controls)
    slope = shooting.pullback(run, np.zeros((1, 1, 2 * model.dof)), np.ones(1))
    motion = trajectory(shooting, run, slope)
    n, by_parameter = model.dof, dict(zip(problem.vary, slope.parameters[0].tolist(), strict=True))
    result = CostGradient(
        run.cost,
        problem.controls,
        slope.controls[0],
        slope.start[0, 0, :n],
        slope.start[0, 0, n:],
        by_parameter,
        motion,
    )
    if motion.status == "failed":
        return replace(result, status="failed", message=motion.message)
    finite = all(np.isfinite(x).all() for x in (result.controls, result.q, result.qd, slope.parameters))
    return result if finite else replace(result, status="failed", message=ROUGH)


def trajectory(shooting: Shooting, run: Rollout, slope: Slope) -> Trajectory:
    """The motion before every step and at the end, up to where it is finite; ``slope``: of the cost, W = 1.

    Series: ``controls`` (K, m), ``costates`` (K, 2 n) (of q, then of q'), ``hamiltonian`` (K,), the last one repeated.
    """
    n, states, lam = shooting.model.dof, run.states, slope.costates[0]
    costates = np.concatenate([lam[:-1].swapaxes(0, 1).reshape(-1, 2 * n), lam[-1:, -1]])
    H = shooting.hamiltonians(run, lam)
    series = {
        "controls": shooting.controls_at_steps(run.controls),
        "costates": costates,
        "hamiltonian": np.append(H, H[-1:]),
    }
    t = np.asarray(shooting.problem.t + shooting.h * np.arange(len(states)), dtype=np.float64)
    finite = np.isfinite(states).all(axis=1)
    if finite.all() and np.isfinite(run.cost):
        return Trajectory(shooting.model.coordinates, t, states[:, :n], states[:, n:], series, steps=len(states) - 1)
    good = len(states) if finite.all() else int(np.argmin(finite))
    some = {name: x[:good] for name, x in series.items()}
    return Trajectory(
        shooting.model.coordinates,
        t[:good],
        states[:good, :n],
        states[:good, n:],
        some,
        status="failed",
        message=FAILED,
        steps=max(good - 1, 0),
    )
