"""Sensitivities to parameters: of g, Gamma and Q as formulas, and of trajectories by their variational equations.

With x = (q, q') and x' = f(x, p, t): S = dx/dp obeys S' = f_x S + f_p, S(0) = 0; the columns of S that belong to the
start, dx/dx_0, obey S' = f_x S, S(0) = 1. f_x S + f_p is one directional derivative of the accelerations, a formula.
(E. Hairer, S. P. Norsett, G. Wanner, Solving ordinary differential equations I, section I.14.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path

import numpy as np

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.formulas import ModelFormulas, require_tree
from substructures.analysis.equations.kernels import Known, program_kernel
from substructures.analysis.equations.perturbation import require_smooth
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.integrators.integration import IntegratedMotion, IntegratorSettings, integrate
from substructures.analysis.motion.integrators.progress import ProgressReport, share_of
from substructures.analysis.motion.judges import MotionStates, integral_series, judge
from substructures.analysis.motion.limits import with_limits
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.outputs import SensitivityOutputs
from substructures.analysis.motion.problems.problem import TAYLOR, Integrator, MotionProblem, Start, StateVector
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.second_run import accurate, halves, second_run
from substructures.analysis.motion.simulation import tree_conditions
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.certificate.derived.perturbed import by_parameters, varied
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.differentiate import directional
from substructures.expr.graph import Expr
from substructures.expr.program import Formulas, Program, array, program
from substructures.expr.replay import replay
from substructures.quantities.certificate import certified
from substructures.tree.model import Model

DEFAULT, PLAIN = Integrator(), SensitivityOutputs()
QUANTITIES = ("metric", "christoffel", "forces")


def sensitivity_formulas(model: Model, parameters: Sequence[str], quantities: Sequence[str] = QUANTITIES) -> Program:
    """Partial derivatives of outputs of the model by parameters: an output ``<quantity>:<parameter>`` for every pair,
    with shape and symmetry of the quantity.

    Raises InvalidInput for unknown parameters (``/parameters/i``) and quantities, and forces without derivative.
    """
    _require_parameters(model, parameters, "parameters")
    known = list(model.program.outputs)
    faults = [
        Fault(f"/quantities/{i}", "unknown-quantity", f"unknown quantity '{str(name)[:80]}'{among(name, known, i)}")
        for i, name in enumerate(quantities)
        if name not in known
    ]
    if faults:
        raise InvalidArgument(faults)
    require_smooth(model)
    f = ModelFormulas(model)
    outputs = {}
    for quantity, formulas in replay(model.program, f.graph, {}, list(quantities)).items():
        roots = [x for x in formulas.entries.values() if isinstance(x, Expr)]
        for name in parameters:
            # d(quantity)/dp: derivative along dp = 1
            slopes = directional(roots, {name: f.graph.one})
            entries = dict(zip(formulas.entries, slopes, strict=True))
            outputs[f"{quantity}:{name}"] = Formulas(formulas.shape, entries, formulas.symmetry)
    result = program(f.graph, outputs, f.symbols)
    return certified(result, model, by_parameters(parameters, quantities), "parameter_sensitivity", needs=quantities)


def _require_parameters(model: Model, names: Sequence[str], argument: str) -> None:
    """Raises InvalidArgument for names that are no parameters of the model."""
    faults = [
        Fault(
            f"/{argument}/{i}",
            "unknown-parameter",
            f"unknown parameter '{str(name)[:80]}'{among(name, model.parameters)}",
        )
        for i, name in enumerate(names)
        if name not in model.parameters
    ]
    if faults:
        raise InvalidArgument(faults)


def variational(model: Model, parameters: Sequence[str]) -> Program:
    """``acceleration`` (n,) and its ``variation`` (n,) along the symbols ``d.<name>`` of coordinates, velocities and
    the given parameters. Raises InvalidInput for closures and for a metric that is always singular.
    """
    require_tree(model, "sensitivities")
    return _variational(Known(model.program.digest, model), tuple(parameters))


@lru_cache(maxsize=32)
def _variational(known: Known, parameters: tuple[str, ...]) -> Program:
    f = ModelFormulas(known.source)
    names = [*(str(x.value) for x in (*f.q, *f.rates)), *parameters]
    seeds = {name: f.graph.symbol(f"d.{name}") for name in names}
    acceleration = f.acceleration
    # q''(q, q', p): sum over all named z of (dq''/dz) d.z
    variation = directional(acceleration, seeds)
    symbols = f.symbols | {f"d.{name}": replace(f.symbols[name], name=f"d.{name}") for name in names}
    outputs = {
        "acceleration": array((f.n,), lambda a: acceleration[a]),
        "variation": array((f.n,), lambda a: variation[a]),
    }
    return certified(program(f.graph, outputs, symbols), f.model, varied(parameters), "variation of the motion")


def sensitivities(
    model: Model,
    q: StateVector | None,
    span: tuple[float, float],
    by: Sequence[str] = (),
    *,
    qd: StateVector | None = None,
    inputs: Mapping[str, Signal] | None = None,
    parameters: Mapping[str, float] | None = None,
    integrator: Integrator = DEFAULT,
    outputs: SensitivityOutputs = PLAIN,
) -> Trajectory:
    """The motion of a tree and its derivatives by the parameters ``by``: series ``d.<parameter>`` (K, 2n), dx/dp of
    x = (q, q') [rad, m, rad/s, m/s; per unit of the parameter].

    With ``outputs.of_start`` also the series ``d.start`` (K, 2n, 2n), dx/dx_0. The other arguments are those of
    :func:`substructures.analysis.simulate.simulate`; inputs are numbers, tables or expressions in t alone, the method
    is any but Taylor and FixedStep.

    Checks: first integrals of the motion, and a second run with tighter tolerances and shorter steps, whose relative
    difference is the stated error of the motion and of each derivative and may reach ``drift_limit``; both runs take
    about three times as long as one. Raises InvalidInput (pointers start with names of arguments) and MissingValue.
    """
    _require_parameters(model, by, "by")
    require_smooth(model)
    problem = MotionProblem(
        model=model,
        start=Start(q, qd, parameters or {}, inputs or {}),
        times=OutputTimes(span, outputs),
        integrator=integrator,
    )
    conditions = tree_conditions(problem)
    require_plain(conditions, integrator)
    variation = Variation(conditions, by, outputs.of_start, integrator.folder)
    return _varied(problem, variation, by, integrator.progress)


def require_plain(conditions: Conditions, integrator: Integrator) -> None:
    """Raises InvalidArgument for what has no place in the variational equations."""
    faults = []
    if integrator.method == TAYLOR or integrator.fixed_step is not None:
        faults.append(Fault("/method", "not-supported", "sensitivities are computed by the other methods"))
    named = {s.name for s in conditions.expressions.symbols if s.kind != "time"}
    if named:
        culprits = ", ".join(f"'{name}'" for name in sorted(named))
        faults.append(Fault("/inputs", "not-supported", f"inputs may depend on t only here, not on {culprits}"))
    if faults:
        raise InvalidArgument(faults)


def _varied(problem: MotionProblem, f: Variation, by: Sequence[str], progress: ProgressReport | None) -> Trajectory:
    begun, ending = halves(progress)
    motion = _integrated(f, problem.span, problem.times.grid(), problem.integrator, begun)
    runs = second_run(motion, problem.integrator, partial(_integrated, f, progress=ending))
    n, k = f.n, len(by)
    x = np.array(motion.x).reshape(len(motion.x), f.columns + 1, 2 * n)
    # rows x, S_1, ..., S_k; the columns of dx/dx_0 were integrated as rows
    series = {f"d.{name}": x[:, 1 + i] for i, name in enumerate(by)}
    if f.of_start:
        series["d.start"] = np.swapaxes(x[:, 1 + k :], 1, 2)
    found = Trajectory(
        problem.model.coordinates,
        np.array(motion.t),
        x[:, 0, :n],
        x[:, 0, n:],
        series,
        (*accurate(runs, _groups(f, by), problem.drift_limit), *_integrals(problem, f, motion)),
        motion.status,
        motion.message,
        motion.steps,
        figures={"evaluations": float(motion.evaluations)},
        cancelled=motion.cancelled,
    )
    return with_limits(problem.model, problem.start.parameters, found)


def _integrated(
    f: Variation,
    span: tuple[float, float],
    times: Array,
    choice: Integrator,
    progress: ProgressReport | None = None,
) -> IntegratedMotion:
    return integrate(
        f,
        f.start(),
        span,
        times,
        IntegratorSettings(choice.stepper(), choice.max_steps),
        breaks=f.conditions.breaks(span),
        progress=share_of(span, progress),
        enter=f.inputs.enter,
    )


def _groups(f: Variation, by: Sequence[str]) -> dict[str, tuple[slice, str, slice]]:
    """What the second run is compared in: coordinates and velocities of the motion and of every derivative."""
    n, groups = f.n, {}
    rows = [("", "rad, m", "rad/s, m/s"), *((f" of d.{name}", "", "") for name in by)]
    for i, (about, unit, rate) in enumerate(rows):
        start, middle, end = 2 * n * i, 2 * n * i + n, 2 * n * (i + 1)
        groups[f"q{about}"] = slice(start, middle), unit, slice(start, end)
        groups[f"qd{about}"] = slice(middle, end), rate, slice(start, end)
    if f.of_start:
        rest = slice(2 * n * len(rows), None)
        groups["d.start"] = rest, "", rest
    return groups


def _integrals(problem: MotionProblem, f: Variation, motion: IntegratedMotion) -> tuple[Check, ...]:
    """The first integrals of the motion itself; its derivatives have none that are known."""
    model, conditions, n = problem.model, f.conditions, f.n
    acting = [name for name in problem.start.inputs if name not in conditions.zero]
    integrals = first_integrals(model, acting, conditions.zero & set(model.parameters))
    t, x, _ = motion.judged()
    values: dict[str, float | Array] = {**conditions.values, **conditions.inputs_at(t, x[:, : 2 * n])}
    states = MotionStates(t, x[:, :n], x[:, n : 2 * n], values, None)
    return judge(model, integrals, states, integral_series(model, integrals, states), problem.drift_limit)


class Variation:
    """The right-hand side for rows x, S_1, ..., S_k: all directions at once, as a batch of the kernel.

    ``columns`` = k: those of the parameters, and with ``of_start`` 2n that are 1 at the start.
    """

    def __init__(self, conditions: Conditions, parameters: Sequence[str], of_start: bool, folder: Path | None) -> None:
        model, n = conditions.model, conditions.model.dof
        self.conditions, self.n, self.of_start = conditions, n, of_start
        self.columns = len(parameters) + (2 * n if of_start else 0)
        batch = max(self.columns, 1)
        self.t, self.x = np.zeros(1), np.zeros((1, 2 * n))
        self.d = np.zeros((batch, 2 * n))
        self.out = {"acceleration": np.zeros((batch, n)), "variation": np.zeros((batch, n))}
        names = state_names(model)
        self.inputs = VaryingInputs(conditions, self.t, self.x, folder)
        columns = [(names, self.x), ([f"d.{name}" for name in names], self.d), *self.inputs.columns]
        # dp_i = 1 in the i-th direction, 0 in all others
        seeds = {f"d.{name}": np.eye(1, batch, i)[0] for i, name in enumerate(parameters)}
        kernel = program_kernel(variational(model, parameters), folder)
        self.run = kernel.bind(self.out, conditions.values | {"t": self.t} | seeds, columns=columns)

    def start(self) -> Array:
        """The start, S = 0 for parameters and S = 1 for the start itself."""
        rows = np.zeros((self.columns + 1, 2 * self.n))
        # x(0) = x_0, S(0) = 0 for parameters, dx/dx_0 = 1
        rows[0] = self.conditions.start
        if self.of_start:
            rows[-2 * self.n :] = np.eye(2 * self.n)
        return rows.ravel()

    def __call__(self, t: float, flat: Array) -> Array:
        """x', S_1', ..., S_k' at t, as they stand in ``flat``."""
        rows = flat.reshape(self.columns + 1, 2 * self.n)
        n = self.n
        self.t[0], self.x[0] = t, rows[0]
        self.d[: self.columns] = rows[1:]
        self.inputs.fill()
        self.run()
        result = np.empty_like(rows)
        # rows x, S_1, ..., S_k: (q, q')' = (q', q''), (dq, dq')' = (dq', variation of q'')
        result[:, :n] = rows[:, n:]
        result[0, n:] = self.out["acceleration"][0]
        result[1:, n:] = self.out["variation"][: self.columns]
        return result.ravel()
