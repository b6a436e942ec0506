"""Motion of trees with ball and floating joints: quaternions and rates together, judged by energy and norms.

x = (q, v, W) with the quaternions as they are in q (notation.md, section 14),

    g v' + Gamma~ v v = Q        Q' = 1/2 Q (0, w)        p' = R v        W' = Q_a v^a + V'

The equations hold for quaternions of any length, so that none is held at length 1 on the way: how far they leave it
tells how well they were integrated. Results have them at length 1.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.motion.conditions import Conditions, read_conditions, state_names
from substructures.analysis.motion.integrators.fixed_step import march, require_no_stops, semi_implicit_euler
from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.integration import IntegratorSettings, integrate
from substructures.analysis.motion.integrators.progress import ProgressReport, share_of
from substructures.analysis.motion.integrators.steppers import METHODS
from substructures.analysis.motion.judges.balls import (
    NORMS,
    reached_in_rates,
    with_lengths,
)
from substructures.analysis.motion.judges.integrals import AlongMotion, judge
from substructures.analysis.motion.judges.states import (
    MotionStates,
    energy_balance,
    unbalanced,
)
from substructures.analysis.motion.problems.kinds import TreeMotion
from substructures.analysis.motion.problems.problem import MotionProblem
from substructures.analysis.motion.resets import Accelerations, Resets, acting, simulate_with_resets
from substructures.analysis.motion.second_judges import computed_again
from substructures.analysis.motion.second_run import state_groups
from substructures.analysis.motion.trajectory import Trajectory, crossings
from substructures.analysis.motion.varying_inputs import VaryingInputs
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.certificate.derived.model_formulas import simulated_in_rates
from substructures.compile import Kernel, compile_program
from substructures.compile.machine import BoundCall
from substructures.compile.motion import CompiledRates
from substructures.errors import InvalidArgument
from substructures.expr.garbage import without_collections
from substructures.expr.known import Known
from substructures.expr.program import Program, array
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.quaternions import moved_on, quaternions_in
from substructures.tree.model import Model

NEEDS = ("metric", "bias", "forces", "potential_energy")
OUTPUTS = ("position_rates", "forward_dynamics", "power")
SINGULAR = "the accelerations are not determined at the start: look at masses, inertias and forces"


def equations_in_rates(model: Model, zero: Iterable[str] = ()) -> Program:
    """``position_rates`` (m,): changes of a state q; ``forward_dynamics`` (n,): v'; ``power``: Q_a v^a + V'.

    ``zero``: symbols that are 0. Raises InvalidInput for rates without inertia.
    """
    f = ModelFormulas(model, zero)
    moved, second = list(f.position_rates.values()), f.acceleration
    outputs = {
        "position_rates": array((len(moved),), lambda i: moved[i]),
        "forward_dynamics": array((f.n,), lambda a: second[a]),
        "power": array((), lambda: f.power),
    }
    expected = simulated_in_rates(model.positions, model.balls)
    return certified(f.program(outputs), model, expected, "equations of motion", zero=f.zero)


@lru_cache(maxsize=16)
@without_collections
def _program(model: Known, zero: frozenset[str]) -> Program:
    return equations_in_rates(model.source, zero)


@lru_cache(maxsize=16)
def _kernel(model: Known, zero: frozenset[str], folder: Path | None, single: bool) -> Kernel:
    return compile_program(_program(model, zero), OUTPUTS, folder, single=single)


def kernel_in_rates(
    model: Model, zero: frozenset[str] = frozenset(), folder: Path | None = None, single: bool = False
) -> Kernel:
    """The compiled equations_in_rates(model, zero), with the outputs OUTPUTS, ``single``: for one state at a time; the
    same object for the same model.
    """
    return _kernel(Known(model.program.digest, model), zero, folder, single)


class BallRates:
    """x' of x = (q, v, W), (m,), (n,) and one number. Not for several threads at a time."""

    def __init__(self, conditions: Conditions, folder: Path | None) -> None:
        model = conditions.model
        self.m, self.n = len(model.positions), model.dof
        self._t, self._x = np.zeros(1), np.zeros((1, self.m + self.n))
        self.inputs = VaryingInputs(conditions, self._t, [(state_names(model), self._x)], folder)
        self._rates, self._power, self._folder = np.zeros((1, self.m + self.n)), np.zeros(1), folder
        parts = self._rates[:, : self.m], self._rates[:, self.m :], self._power
        kernel = kernel_in_rates(model, conditions.zero, folder, single=True)
        columns = [(state_names(model), self._x), *self.inputs.columns]
        outputs = dict(zip(OUTPUTS, parts, strict=True))
        self._run = kernel.bind(outputs, conditions.values | {"t": self._t}, columns=columns)

    def __call__(self, t: float, x: Array) -> Array:
        """At a state; not finite where the metric is singular."""
        self._t[0], self._x[0] = t, x[:-1]
        self.inputs.fill()
        self._run()
        return np.concatenate((self._rates[0], self._power))

    def compiled(self) -> CompiledRates | None:
        """The function as calls of kernels; None where it is more than these."""
        runs = [*given, self._run] if (given := self.inputs.runs()) is not None else []
        calls = tuple(run for run in runs if isinstance(run, BoundCall))
        if not calls or len(calls) < len(runs):
            return None
        return CompiledRates(calls, self._t, self._x, self._rates, self._power, self._folder, tables=self.inputs.tables)


def simulate_balls(problem: MotionProblem, kind: TreeMotion) -> Trajectory:
    """The motion of a tree with ball joints from a start over a span of time.

    Series: ``kinetic_energy``, ``potential_energy``, ``energy``, ``work`` [J], momenta and other first integrals,
    varying inputs, and those of the problem. Checks: the balance of energy, all first integrals, and the norms of
    quaternions. What goes wrong on the way is a trajectory with status ``failed``. Raises InvalidInput (pointers start
    with names of arguments of ``simulate``), MissingValue.
    """
    _require_known(problem, kind)
    conditions = _conditions(problem)
    if acting(problem.events):
        resets = Resets(problem, conditions, partial(_accelerations, conditions, problem))
        return simulate_with_resets(problem, resets, lambda p: _simulate(p, _conditions(p)))
    return _simulate(problem, conditions)


def _conditions(problem: MotionProblem) -> Conditions:
    return read_conditions(problem.model, problem.start, problem.span, NEEDS, problem.events, problem.series)


def _accelerations(conditions: Conditions, problem: MotionProblem) -> Accelerations:
    """The function (t, x) -> v'."""
    f = BallRates(conditions, problem.integrator.folder)
    return lambda t, x: f(t, np.append(x, 0.0))[f.m : -1]


def _simulate(problem: MotionProblem, conditions: Conditions) -> Trajectory:
    """Without events that act."""
    start = problem.span[0]
    f = BallRates(conditions, problem.integrator.folder)
    f.inputs.enter(*problem.span)
    x, figures = np.append(conditions.start, 0.0), dict[str, float]()
    if np.isfinite(f(start, x)).all():
        motion, figures = _moved(conditions, f, problem, x, problem.integrator.progress)
    else:
        motion = IntegratedMotion([start], [x], [start], [x], status="failed", message=SINGULAR)
    found = _judged(conditions, f, problem, motion)
    quiet = replace(conditions, events=())

    def move(other: MotionProblem, y: Array, told: ProgressReport | None, _: bool) -> IntegratedMotion:
        """The motion once more."""
        return _moved(quiet, f, other, y, told)[0]

    is_whole = bool(conditions.varied_potential())
    again = computed_again(problem, motion, state_groups(f.m, f.n), move, is_whole=is_whole)
    return replace(found, checks=(*found.checks, *again), figures={**found.figures, **figures})


def _require_known(problem: MotionProblem, kind: TreeMotion) -> None:
    """Raises InvalidArgument for what is not known of a motion with ball joints."""
    integrator = problem.integrator
    known: dict[str, tuple[bool, str]] = {
        "method": (integrator.fixed_step is not None or integrator.method in METHODS, ", ".join(METHODS)),
        "friction": (kind.friction == "regularised", "regularised"),
    }
    for name, (is_known, instead) in known.items():
        if not is_known:
            message = f"with ball and floating joints '{name}' is one of: {instead}"
            raise InvalidArgument.at(f"/{name}", "not-supported", message)
    if integrator.fixed_step is not None:
        require_no_stops(problem.events)


def _moved(
    conditions: Conditions, f: BallRates, problem: MotionProblem, x: Array, progress: ProgressReport | None
) -> tuple[IntegratedMotion, dict[str, float]]:
    """The motion and its pace."""
    integrator, span, times = problem.integrator, problem.span, problem.times.grid()
    told = share_of(span, progress)
    if integrator.fixed_step is not None:
        states = problem.model.positions, problem.model.coordinates, problem.model.balls
        euler = semi_implicit_euler(f.n, f.m, partial(moved_on, *states))
        motion, pace = march(f, euler, x, span, times, integrator.fixed_step, integrator.max_steps, told)
        return motion, pace.figures
    settings = IntegratorSettings(integrator.stepper(), integrator.max_steps)
    watches = conditions.watches(lambda _, y: y[:-1], integrator.folder)
    breaks = conditions.breaks(span)
    f.inputs.enter(span[0], [*breaks, span[1]][0])
    motion = integrate(f, x, span, times, settings, watches, breaks, told, f.inputs.enter)
    f.inputs.leave()
    return motion, {}


def _judged(conditions: Conditions, f: BallRates, problem: MotionProblem, motion: IntegratedMotion) -> Trajectory:
    model, m = problem.model, f.m
    t, x, results = motion.judged()
    values: dict[str, Any] = {**conditions.values, **conditions.inputs_at(t, x[:, :-1])}
    v = x[:, m:-1]
    along = _along(conditions, problem, MotionStates(t, x[:, :m], v, values, x[:, -1]))
    series = {
        "kinetic_energy": np.einsum("kab,ka,kb->k", along.sizes["metric"], v, v) / 2,
        "potential_energy": along.sizes["potential_energy"],
        "work": x[:, -1],
    }
    varied, limit = conditions.varied_potential(), problem.drift_limit
    energy = unbalanced(varied) if varied else energy_balance(t, series, not x[:, -1].any(), limit)
    series = along.series | series | {"energy": series["kinetic_energy"] + series["potential_energy"]}
    others = (check for check in judge(along, limit) if check.name not in ("energy", "energy-balance"))
    norms = np.stack([np.linalg.norm(x[:, some], axis=1) for some in quaternions_in(model.positions, model.balls)])
    kept = Check.of(("quaternions", "zero", NORMS, ""), np.abs(norms - 1).max(axis=0), t, 1.0, limit)
    unit = partial(with_lengths, model)
    span = reached_in_rates(model, t, x)
    return Trajectory(
        model.coordinates,
        t[results],
        unit(x[results, :m]),
        v[results],
        {name: some[results] for name, some in series.items()} | conditions.series_at(t[results], x[results, :-1]),
        (energy, *others, kept),
        motion.status,
        motion.message,
        motion.steps,
        tuple(
            replace(each, q=unit(y[None, :m])[0], qd=y[m:-1])
            for each, (_, _, y) in zip(crossings(problem.events, motion.found, m), motion.found, strict=True)
        ),
        {"evaluations": float(motion.evaluations)},
        motion.cancelled,
        span,
        positions=model.positions,
    )


def _along(conditions: Conditions, problem: MotionProblem, states: MotionStates) -> AlongMotion:
    """All first integrals; inputs and parameters that are 0 all the time leave more constant."""
    model = problem.model
    acting = [name for name in problem.start.inputs if name not in conditions.zero]
    integrals = first_integrals(model, acting, conditions.zero & set(model.parameters))
    return AlongMotion.of(model, integrals, states)
