"""Optimal control by direct shooting with the adjoint gradient.

The nonlinear program of substructures.analysis.control.nonlinear_program is solved by sequential quadratic programming
(D. Kraft, A software package for sequential quadratic programming, DFVLR-FB 88-28, 1988), or by L-BFGS-B where only
bounds are demanded (both in SciPy). The horizon and parameters may be unknown beside the controls, or alone. One
segment is single shooting; more of them start from a guess of the motion and are better conditioned for long and
unstable motions (multiple shooting).

A result is judged by the necessary conditions of the optimum: the gradient of the Lagrangian vanishes in all free
variables, with multipliers of the right sign for bounds and limits that are reached (Karush, Kuhn and Tucker), all
demands hold, and, where l and the forces do not depend on time, the Hamiltonian is constant along the motion up to the
discretisation of the controls (L. S. Pontryagin); it is zero where the horizon is free and phi does not name the time.

Example, a cart pendulum swung up in two seconds by a force of at most 20 N::

    problem = ControlProblem(
        controls=["tau.x.q0"], cost=Cost("tau.x.q0^2"), horizon=2, intervals=40, steps=2, q={"x.q0": 0, "x.q1": math.pi}
    )
    optimal_control(model, problem, Demands(End([0, 0], [0, 0]), {"tau.x.q0": (-20, 20)}))
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import scipy

from substructures.analysis.arguments import positive
from substructures.analysis.control.cost_gradient import trajectory
from substructures.analysis.control.demands import Demands
from substructures.analysis.control.first_controls import first_variables
from substructures.analysis.control.nonlinear_program import BEYOND, ShootingProgram
from substructures.analysis.control.problem import ERROR_LIMIT, ControlProblem, require_solvable
from substructures.analysis.control.rollout import Rollout
from substructures.analysis.control.shooting import Shooting
from substructures.analysis.control.step_error import motion_checks
from substructures.analysis.motion.limits import with_limits
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.verdict import About, Check, verdict
from substructures.array import Array
from substructures.quantities.numbers.quaternions import by_displacements
from substructures.tree.model import Model

STEPS = "the motion is not as accurate as 'error_limit' asks for: take more 'steps' or 'intervals'"
#: no demands
FREE = Demands()
#: which of the variables
Flags = np.ndarray[Any, np.dtype[np.bool_]]
#: called with the number of an iteration, the cost and the violation
IterationReport = Callable[[int, float, float], None]
#: stationarity (relative to the largest derivative of the cost) that counts as an optimum
STATIONARY = 1e-3
#: distance of a limit along the path that counts as none, relative to the largest
REACHED = 1e-6
#: part of what the search took off the cost that counts as none: the least cost may be zero
NONE = 1e-6

ADVICE = {
    "optimal": "",
    "feasible": "all demands hold, but the cost can still fall: raise 'iterations' or lower 'tolerance'",
    "failed": "the demands are not met: give a better 'guess', more 'segments', a longer 'horizon' or wider 'bounds'",
}


@dataclass(frozen=True, repr=False)
class Optimum:
    """The best ``controls`` found (nodes, m) [N m, N], in the order of ``names``, with their cost and motion.

    ``status``: optimal; feasible (demands hold, not stationary yet); failed (they do not, or the motion is not
    accurate); ``message`` says what to change. ``horizon`` [s] and ``parameters``: those given, or found where they
    were unknown.
    ``stationarity``: largest derivative of the Lagrangian by a free variable, relative to that of the cost or, where it
    is larger, to the cost (at least a millionth of what the search took off it) over the largest variable;
    ``violation``: largest violation of a demand, over the largest change that is demanded where this is less than 1
    [rad, m], or of a limit along the path, over what such a change makes of it; ``hamiltonian_drift``: (max H - min
    H)/max |H| along the motion, None where H need not be constant. ``history``: (cost, violation) after every iteration
    (K, 2). ``trajectory`` has the series of substructures.analysis.control.cost_gradient, and the demands as its
    checks.
    """

    status: Literal["optimal", "feasible", "failed"]
    message: str
    cost: float
    names: tuple[str, ...]
    controls: Array
    horizon: float
    parameters: dict[str, float]
    trajectory: Trajectory
    stationarity: float
    violation: float
    hamiltonian_drift: float | None
    history: Array
    iterations: int

    @property
    def is_right(self) -> bool | None:
        """Whether all checks hold: an optimum that meets the demands, along an accurate motion."""
        return self.trajectory.is_right

    @property
    def checks(self) -> tuple[Check, ...]:
        """Those of the trajectory."""
        return self.trajectory.checks

    def __repr__(self) -> str:
        sizes = f"controls={len(self.names)}, nodes={len(self.controls)}, iterations={self.iterations}"
        judged = f"cost {self.cost:.6g}, violation {self.violation:.2g}, stationarity {self.stationarity:.2g}"
        return f"Optimum({sizes})\n{self.status}: {judged}, is_right={self.is_right}"


def optimal_control(
    model: Model,
    problem: ControlProblem,
    demands: Demands = FREE,
    *,
    error_limit: float = ERROR_LIMIT,
    progress: IterationReport | None = None,
) -> Optimum:
    """Controls of least cost J (see above) under demands on the end and bounds, by multiple shooting.

    ``progress`` is called after every iteration with its number, the cost and the violation; what it raises ends the
    search. The motion under the controls that were found is judged by a second run with steps half as long, from the
    start to the end in one piece: it may differ, and leave limits of the path, by ``error_limit``, relative. Demands
    that are not met are a result with status ``failed`` and advice. Raises InvalidInput (``/controls/i``, ``/end/q``,
    ``/bounds/name``, ``/path/expression``, ``/free_parameters/name``, ``/free_horizon``, ``/segments``, ...) and
    MissingValue. Source: see above.
    """
    require_solvable(model, problem)
    return _searched(ShootingProgram(model, problem, demands), positive(error_limit, "error_limit"), progress)


def _searched(search: ShootingProgram, limit: float, progress: IterationReport | None) -> Optimum:
    """The result of the search from the guess, or from where one can start."""
    history, iterations, met = list[tuple[float, float]](), 0, max(1e-6, 10 * search.wanted.tolerance)

    def note(x: Array) -> None:
        """Keep cost and violation of an iterate, and tell them."""
        history.append(search.progress(x))
        if progress is not None:
            progress(len(history) - 1, *history[-1])

    for z in first_variables(search):
        history.append(search.progress(z))
        found = _solve(search, z, note)
        iterations += int(found.nit)
        if search.violation(found.x) <= met:
            break
    return _judged(search, np.asarray(found.x, dtype=np.float64), np.array(history), iterations, limit, met)


def _solve(search: ShootingProgram, z: Array, note: Callable[[Array], None]) -> Any:
    """SLSQP; L-BFGS-B without conditions. In the units of the program, whatever those of controls and cost."""
    wanted, (unit, price) = search.wanted, search.units
    bounds = scipy.optimize.Bounds(*(limit / unit for limit in search.limits()))
    common: dict[str, Any] = {"jac": True, "bounds": bounds, "callback": lambda y: note(y * unit)}

    def cost(y: Array) -> tuple[float, Array]:
        """J and its gradient."""
        value, slope = search.cost(y * unit)
        return value / price, slope * unit / price

    options, conditions = {"maxiter": wanted.iterations, "ftol": wanted.tolerance}, list[dict[str, Any]]()
    if search.rows:
        sizes = search.row_sizes
        left, by_left = (lambda z: search.residual(z) / sizes), (lambda z: search.jacobian(z) / sizes[:, None])
        conditions.append(_scaled("eq", left, by_left, unit))
    if search.limits_on_path is not None:
        one, by = (lambda z: search.on_path(z)[0]), (lambda z: search.on_path(z)[1])
        conditions.append(_scaled("ineq", one, by, unit))
    if conditions:
        common |= {"method": "SLSQP", "constraints": conditions, "options": options}
    else:
        common |= {"method": "L-BFGS-B", "options": options | {"gtol": 1e-10}}
    found = scipy.optimize.minimize(cost, z / unit, **common)
    found.x = found.x * unit
    return found


def _scaled(kind: str, one: Callable[[Array], Array], by: Callable[[Array], Array], unit: Array) -> dict[str, Any]:
    """A condition and its derivatives by z/unit."""
    return {"type": kind, "fun": lambda y: one(y * unit), "jac": lambda y: by(y * unit) * unit}


def _judged(
    search: ShootingProgram, z: Array, history: Array, iterations: int, error_limit: float, limit: float
) -> Optimum:
    """The necessary conditions at z."""
    cost, _ = search.cost(z)
    costs = history[:, 0][history[:, 0] < BEYOND]
    least = NONE * float(costs.max(initial=cost) - cost)
    nu, stationarity = _multipliers(search, z, least)
    violation = search.violation(z)
    status: Literal["optimal", "feasible", "failed"] = "failed"
    if violation <= limit and cost < BEYOND:
        status = "optimal" if stationarity <= STATIONARY else "feasible"
    advice = ADVICE[status]
    run, _ = search.evaluated(z)
    shooting, (parameters, horizon) = search.shooting_at(z), search.found(z)
    motion, drift = _motion(search, shooting, run, nu)
    met: About = ("end", "zero", "the end state and the joints of segments are demanded", "")
    still: About = ("stationarity", "zero", "the gradient of the Lagrangian, relative to that of the cost", "1")
    end = float(motion.t[-1])
    necessary = Check.at(met, violation, end, 1.0, limit), Check.at(still, stationarity, end, 1.0, STATIONARY)
    accuracy = motion_checks(shooting, run, search.first, error_limit, search.limits_on_path, least)
    if not verdict(accuracy):
        # of a motion that is wrong nothing is optimal
        status, advice = "failed" if verdict(accuracy) is False else status, advice or STEPS
    return Optimum(
        status,
        advice,
        cost,
        tuple(search.problem.controls),
        run.controls,
        horizon,
        parameters,
        replace(motion, checks=(*necessary, *accuracy)),
        stationarity,
        violation,
        drift,
        history,
        iterations,
    )


def _multipliers(search: ShootingProgram, z: Array, least: float) -> tuple[Array, float]:
    """Multipliers nu of the equations, and |d(J + nu . residual - mu . path)/dz| in the free variables relative to
    |dJ/dz| (J/|z| where that is larger, J at ``least`` so much), with mu >= 0 of the limits that are reached; all in
    the units of the program.
    """
    unit, _ = search.units
    cost, gradient = search.cost(z)
    gradient, A = gradient * unit, search.jacobian(z) * unit
    low, high = search.limits()
    margin = 1e-9 * np.minimum(unit + np.abs(z), high - low)
    below, above = z <= low + margin, z >= high - margin
    free = ~(below | above)
    # A^T nu = -dJ/dz in the free variables, and dJ/dz + A^T nu is what is left (Karush, Kuhn and Tucker)
    nu = np.zeros(search.rows)
    if search.rows:
        nu[:] = np.linalg.lstsq(A[:, free].T, -gradient[free], rcond=None)[0]
    # without demands dJ/dz itself vanishes: the cost over the size of the variables is the measure then
    typical = max(abs(cost), least) / (1 + float(np.abs(z / unit).max(initial=0)))
    size = max(float(np.abs(gradient).max(initial=0)), typical) or 1.0
    largest = _left(gradient + A.T @ nu, below, above) / size
    values, by = search.on_path(z)
    reached = (by * unit)[values <= REACHED * max(float(np.abs(values).max(initial=0)), 1.0)]
    if largest <= STATIONARY or not (len(reached) or below.any() or above.any()):
        return nu, largest
    # dJ/dz + A^T nu - C^T mu - low + high = 0 with mu, low, high >= 0: they are not unique, least squares find some
    one = np.eye(len(z))
    columns = np.concatenate([A, -reached, -one[below], one[above]]).T
    lowest = np.zeros(columns.shape[1])
    lowest[: search.rows] = -np.inf
    found = scipy.optimize.lsq_linear(columns, -gradient, (lowest, np.inf), method="bvls").x
    signed, mu = found[: search.rows], found[search.rows : search.rows + len(reached)]
    left = _left(gradient + A.T @ signed - reached.T @ mu, below, above) / size
    return (signed, left) if left < largest else (nu, largest)


def _left(slope: Array, below: Flags, above: Flags) -> float:
    """The largest derivative that is not zero; at a lower bound the cost may rise, at an upper one fall."""
    slope = np.where(below, np.minimum(slope, 0), slope)
    return float(np.abs(np.where(above, np.maximum(slope, 0), slope)).max(initial=0))


def _motion(search: ShootingProgram, shooting: Shooting, run: Rollout, nu: Array) -> tuple[Trajectory, float | None]:
    """The trajectory with the costates of the Lagrangian, and the drift of the Hamiltonian."""
    # L = J + nu . (end - demand): nu are the costates at the ends of segments
    ends = np.zeros((search.S, search.size))
    gaps = (search.S - 1) * search.size
    ends[:-1] = nu[:gaps].reshape(search.S - 1, search.size)
    ends[-1] = nu[gaps:] @ search.wanted_rows
    motion = trajectory(shooting, run, shooting.pullback(run, ends[None], np.ones(1)))
    motion = with_limits(shooting.model, shooting.problem.parameters, motion)
    program = search.shooting.equations.program
    if any(s.name == "t" for s in program.select(["force", "running_cost"]).symbols) or motion.status == "failed":
        return motion, None
    # dH/dt = 0 along an optimal motion where neither l nor the forces depend on t
    H, model = motion.series["hamiltonian"], shooting.model
    # with a free horizon H is zero: lambda_q . q' is one of its terms
    moved = motion.qd
    if model.balls:
        states = model.positions, model.coordinates, model.balls
        pairs = zip(motion.q, motion.qd, strict=True)
        moved = np.array([np.linalg.pinv(by_displacements(*states, q)) @ v for q, v in pairs])
    terms = (motion.series["costates"][:, : shooting.m] * moved).sum(axis=1)
    return motion, float(np.ptp(H) / (max(float(np.abs(H).max()), float(np.abs(terms).max())) or 1.0))
