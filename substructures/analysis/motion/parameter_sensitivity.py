"""Sensitivities to parameters: of g, Gamma and Q as formulas, and of trajectories by their variational equations.

With x = (q, q') and x' = f(x, p, t): S = dx/dp obeys S' = f_x S + f_p, S(0) = 0; the columns of S that belong to the
start, dx/dx_0, obey S' = f_x S, S(0) = 1. f_x S + f_p is one directional derivative of the accelerations, a formula.
(E. Hairer, S. P. Norsett, G. Wanner, Solving ordinary differential equations I, section I.14.)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.formulas import ModelFormulas, require_moving
from substructures.analysis.equations.nonholonomic.positions import closed_positions, start_velocities
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.equations.perturbation import require_smooth
from substructures.analysis.given import require_known
from substructures.analysis.motion.conditions import DYNAMICS, Conditions, read_conditions
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.integrators.progress import ProgressReport, share_of
from substructures.analysis.motion.judges.balls import conditions_in_rates, reached_in_rates, with_lengths
from substructures.analysis.motion.judges.integrals import AlongMotion, judge
from substructures.analysis.motion.judges.states import MotionStates
from substructures.analysis.motion.limits import with_limits
from substructures.analysis.motion.problems.kinds import ConstrainedMotion, usual_kind
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.outputs import SensitivityOutputs
from substructures.analysis.motion.problems.problem import Integrator, MotionProblem
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import Start, StateVector
from substructures.analysis.motion.second_run import accurate, halves, second_run
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.variation import Variation, displaced
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.certificate.derived.perturbed import by_parameters
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.differentiate import directional, gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, program
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
    require_known("parameters", "parameter", parameters, model.parameters)
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
    kind: ConstrainedMotion | None = None,
) -> Trajectory:
    """The motion of a tree and its derivatives by the parameters ``by``: series ``d.<parameter>`` (K, 2n), dx/dp of
    x = (q, q') [rad, m, rad/s, m/s; per unit of the parameter].

    With ``outputs.of_start`` also the series ``d.start`` (K, 2n, 2n), dx/dx_0. The other arguments are those of
    :func:`substructures.analysis.simulate.simulate`; inputs are numbers, tables or expressions in t alone, the method
    is any but FixedStep.

    With ball joints x = (dq, dv) of derivatives are displacements and rotation vectors in the axes of bodies, by the
    names of rates, as of a linearisation.

    ``kind``: velocity constraints (default: those of the tree, and all closures). The start is (q, v) then, on the
    closures, with quasi-velocities (series ``v`` (K, p)); ``d.start`` is (K, 2n, n+p), dx/d(q_0, v_0).

    Checks: first integrals of the motion, and a second run with tighter tolerances and shorter steps, whose relative
    difference is the stated error of the motion and of each derivative and may reach ``drift_limit``; both runs take
    about three times as long as one. Raises InvalidInput (pointers start with names of arguments) and MissingValue.
    """
    require_known("by", "parameter", by, model.parameters)
    require_smooth(model)
    problem = MotionProblem(
        model=model,
        start=Start(q, qd, parameters or {}, inputs or {}),
        times=OutputTimes(span, outputs),
        integrator=integrator,
    )
    return _varied(problem, variation_of(problem, by, outputs.of_start, kind), by, integrator.progress)


def variation_of(
    problem: MotionProblem, by: Sequence[str], of_start: bool, kind: ConstrainedMotion | None
) -> Variation:
    """The variational equations of a motion by parameters, and by its start. Raises InvalidInput, MissingValue."""
    model, integrator, kind = problem.model, problem.integrator, usual_kind(problem.model, kind)
    require_moving(model, "sensitivities")
    conditions = read_conditions(model, problem.start, problem.span, DYNAMICS)
    require_plain(conditions, integrator)
    if kind is None:
        return Variation(conditions, by, of_start, integrator.folder)
    equations, conditions, v = _constrained(conditions, kind, problem, by)
    return Variation(conditions, by, of_start, integrator.folder, equations, v)


def _constrained(
    conditions: Conditions, kind: ConstrainedMotion, problem: MotionProblem, by: Sequence[str]
) -> tuple[QuasiVelocities, Conditions, Array]:
    """The equations, the start on the closures, and the quasi-velocities there. Raises InvalidInput (``/qd``, ``/v``,
    ``/q``, ``/by/i``).
    """
    model, values = conditions.model, conditions.values | {"t": problem.span[0]}
    place = values | dict(zip(model.coordinates, conditions.q.tolist(), strict=True))
    equations = quasi_velocity_equations(
        model, kind.constraints, velocities=kind.velocities, independent=kind.independent, near=place
    )
    _require_closed(equations, by)
    q = closed_positions(equations, values, conditions.q[None])[0]
    moved = replace(conditions, start=np.concatenate([q, conditions.qd]))
    qd = None if problem.start.qd is None else conditions.qd
    place = values | dict(zip(model.coordinates, q.tolist(), strict=True))
    return equations, moved, start_velocities(equations, place, qd, kind.v)


def _require_closed(equations: QuasiVelocities, by: Sequence[str]) -> None:
    """Raises InvalidArgument (``/by/i``) for parameters with which a start on the closures would open them."""
    closures = [f"{closure.name}.{row}" for closure in equations.model.closures for row in closure.rows]
    if not closures or not by:
        return
    graph = Graph()
    gaps = replay(equations.program, graph, {}, ["gaps"])["gaps"].entries
    rows = {equations.gaps[k]: graph.lift(x) for (k,), x in gaps.items() if equations.gaps[k] in closures}
    for label, slopes in zip(rows, gradient(list(rows.values()), by), strict=True):
        for i, slope in enumerate(slopes):
            if not slope.is_zero:
                message = (
                    f"the closure row '{label}' depends on '{by[i]}': the start would not stay closed; compare two"
                )
                raise InvalidArgument.at(f"/by/{i}", "opens-closure", f"{message} simulations")


def require_plain(conditions: Conditions, integrator: Integrator) -> None:
    """Raises InvalidArgument for what has no place in the variational equations."""
    faults = []
    if integrator.fixed_step is not None:
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
    t, rows = np.array(motion.t), np.array(motion.x).reshape(len(motion.x), f.columns + 1, f.size)
    x = f.full(t, rows)
    # rows x, S_1, ..., S_k; the columns of dx/dx_0 were integrated as rows
    slopes, balls = x[:, 1:], problem.model.balls
    if balls:
        slopes, x[:, 0, :n] = displaced(problem.model, x), with_lengths(problem.model, x[:, 0, :n])
    series = {f"d.{name}": slopes[:, i] for i, name in enumerate(by)}
    if f.of_start:
        series["d.start"] = np.swapaxes(slopes[:, k:], 1, 2)
    if f.equations is not None:
        series["v"] = rows[:, 0, n:]
    found = Trajectory(
        problem.model.coordinates,
        t,
        x[:, 0, :n],
        x[:, 0, n:],
        series,
        (*accurate(runs, _groups(f, by), problem.drift_limit), *_integrals(problem, f, motion)),
        motion.status,
        motion.message,
        motion.steps,
        figures={"evaluations": float(motion.evaluations)},
        cancelled=motion.cancelled,
        reached=reached_in_rates(problem.model, t, rows[:, 0]) if balls else None,
        positions=problem.model.positions if balls else (),
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
    n, size, groups = f.n, f.size, {}
    rows = [("", "rad, m", "rad/s, m/s"), *((f" of d.{name}", "", "") for name in by)]
    for i, (about, unit, rate) in enumerate(rows):
        start, middle, end = size * i, size * i + n, size * (i + 1)
        groups[f"q{about}"] = slice(start, middle), unit, slice(start, end)
        groups[f"{'qd' if f.equations is None else 'v'}{about}"] = slice(middle, end), rate, slice(start, end)
    if f.of_start:
        rest = slice(size * len(rows), None)
        groups["d.start"] = rest, "", rest
    return groups


def _integrals(problem: MotionProblem, f: Variation, motion: IntegratedMotion) -> tuple[Check, ...]:
    """The first integrals of the motion itself, of ball joints also norms; its derivatives have none that are known."""
    model, conditions, n = problem.model, f.conditions, f.n
    acting = [name for name in problem.start.inputs if name not in conditions.zero]
    integrals = first_integrals(model, acting, conditions.zero & set(model.parameters))
    t, rows, _ = motion.judged()
    x = f.full(t, rows.reshape(len(t), f.columns + 1, f.size))[:, 0]
    values: dict[str, float | Array] = {**conditions.values, **conditions.inputs_at(t, x)}
    states = MotionStates(t, x[:, :n], x[:, n:], values, None)
    found = judge(AlongMotion.of(model, integrals, states), problem.drift_limit)
    norms = conditions_in_rates(model, states, False) if model.balls else ()
    return (*found, *(Check.of(each.about, each.violation, t, 1.0, problem.drift_limit) for each in norms))
