"""Simulation of a model: a request as plain data in, a judged trajectory out."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.first_integrals import FirstIntegrals, first_integrals
from substructures.analysis.fixed_step import march
from substructures.analysis.formulas import require_motion
from substructures.analysis.integrate import Motion, Progress, Settings, Watch, integrate, scipy_stepper
from substructures.analysis.judges import States, integral_series, judge
from substructures.analysis.known import program_kernel
from substructures.analysis.requests import TAYLOR, SimulationRequest
from substructures.analysis.right_hand_side import RightHandSide, is_definite
from substructures.analysis.taylor import require_taylor, taylor_stepper
from substructures.analysis.time_inputs import Curve, break_times, constants, expressions, formulas_of, read_curves
from substructures.analysis.trajectory import Crossing, Trajectory
from substructures.definition import escape
from substructures.errors import Fault, InvalidDocument
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.model import Model
from substructures.states import read_states, symbol_values

Array = NDArray[np.float64]
#: told (time reached - start) / span; False stops
Report = Callable[[float], bool | None]
DIRECTION = {"rising": 1, "falling": -1, "both": 0}
DYNAMICS = ("metric", "bias", "forces", "potential_energy")
#: names of series and arrays that every trajectory may have
RESERVED = frozenset(("t", "q", "qd", "coordinates", "energy", "power", "work"))
SINGULAR = (
    "the metric is singular or not positive definite at the start: a massless body, or a joint at a singular angle "
    "(spherical and free joints: pitch = +-pi/2); change masses, inertias or the start"
)


@dataclass(frozen=True)
class Setup:
    """A simulation that was read: numbers of all symbols but state, time and varying inputs."""

    model: Model
    request: SimulationRequest
    start: Array
    values: dict[str, float]
    zero: frozenset[str]
    curves: dict[str, Curve]
    source: Program

    @property
    def varying(self) -> tuple[str, ...]:
        """Names of the inputs that change over time."""
        return (*formulas_of(self.request), *self.curves)

    def watched(self, t: Array, x: Array, names: Iterable[str]) -> dict[str, Array]:
        """Outputs of the expressions along states (K, 2n)."""
        values = self.values | _by_name(self.model, x) | {"t": t}
        return interpret_in_blocks(self.source, values, list(names), len(t))


def simulate(
    model: Model, request: Mapping[str, Any], progress: Report | None = None, folder: Path | None = None
) -> Trajectory:
    """The motion of a model from a start over a span of time, with the drift of all its first integrals.

    ``request``: see SimulationRequest; ``q`` and ``qd`` as in ``evaluate``, for one state. ``progress`` is told the
    finished share of the span and stops the integration by False. ``folder``: where compiled kernels are kept.
    ``series`` of the result: ``energy``, momenta and other first integrals, ``power``, ``work``, varying inputs under
    their names, and what the request asks for. What goes wrong on the way is a trajectory with status ``failed``,
    advice, and the motion up to there. Raises InvalidDocument (pointers into the request) and MissingValue.
    """
    setup = read_setup(model, SimulationRequest.read(request))
    try:
        formulas = (setup.source, formulas_of(setup.request))
        f = RightHandSide(model, setup.values, setup.zero, formulas, setup.curves, folder)
    except InvalidDocument as error:
        if any(fault.code == "singular-metric" for fault in error.faults):
            return _failed(setup, str(error))
        raise
    x = np.concatenate([setup.start, np.zeros(f.size - 2 * f.n)])
    acceleration, pivots, _ = f.evaluate(setup.request.span[0], x)
    if not is_definite(pivots):
        return _failed(setup, SINGULAR)
    if not np.isfinite(acceleration).all():
        message = "a force is not finite at the start: look at springs of length 0 and roots or divisions in loads"
        return _failed(setup, message)
    return _judged(setup, f, *_moved(setup, f, x, progress, folder))


def read_setup(model: Model, request: SimulationRequest) -> Setup:
    """Check a request against a model. Raises InvalidDocument and MissingValue."""
    require_motion(model)
    states = read_states(model, {"q": request.q, "qd": request.qd}, 1)
    curves, source = read_curves(model, request), expressions(model, request)
    fixed = constants(request)
    if request.method == TAYLOR and request.fixed_step is None:
        require_taylor(list(curves))
    faults = _faults(model, request)
    if faults:
        raise InvalidDocument(faults)
    given = {"parameters": request.parameters, "inputs": fixed}
    found = symbol_values(model, given, states, DYNAMICS)
    values = {n: float(np.ravel(v)[0]) for n, v in found.items()}
    for name in (*model.coordinates, *(f"{n}'" for n in model.coordinates), "t", *formulas_of(request), *curves):
        values.pop(name, None)
    inputs = {s.name for s in model.program.symbols if s.kind == "input"} | set(model.parameters)
    zero = frozenset(name for name, x in values.items() if x == 0 and name in inputs)
    return Setup(model, request, np.concatenate([states.q[0], states.qd[0]]), values, zero, curves, source)


def _faults(model: Model, request: SimulationRequest) -> list[Fault]:
    faults = [
        Fault(f"/parameters/{escape(name)}", "unknown-parameter", f"unknown parameter '{name[:80]}'")
        for name in request.parameters
        if name not in model.parameters
    ]
    faults += [
        Fault(f"/series/{name}", "reserved-name", f"'{name}' is a series of every trajectory: take another name")
        for name in request.series
        if name in RESERVED
    ]
    if request.fixed_step is not None and request.events:
        message = "steps of a fixed size do not stop for events: leave 'events' or 'fixed_step' out"
        faults.append(Fault("/events", "not-supported", message))
    return faults


def _moved(
    setup: Setup, f: RightHandSide, x: Array, progress: Report | None, folder: Path | None
) -> tuple[Motion, dict[str, float]]:
    request = setup.request
    begin = perf_counter()
    start, end = request.span
    told: Progress | None = None
    if progress is not None:
        report = progress

        def told(t: float) -> bool | None:
            return report((t - start) / (end - start))

    figures: dict[str, float] = {}
    outputs = request.outputs()
    if request.fixed_step is not None:
        motion, pace = march(f, f.n, x, request.span, outputs, request.fixed_step, request.max_steps, told)
        figures |= {"real_time_factor": pace.factor, "longest_step": pace.longest}
    else:
        settings = Settings(_stepper(setup, f), request.max_steps)
        breaks = break_times(setup.curves, request.span)
        watches = _watches(setup, folder)
        motion = integrate(f, x, request.span, outputs, settings, watches, breaks, told, f.enter)
        f.leave()
    return motion, figures | {"evaluations": motion.evaluations, "seconds": perf_counter() - begin}


def _stepper(setup: Setup, f: RightHandSide) -> Callable[..., Any]:
    request, formulas = setup.request, (setup.source, formulas_of(setup.request))
    if request.method == TAYLOR:
        return taylor_stepper(setup.model, setup.values, setup.zero, formulas, request.relative_tolerance, f.has_power)
    return scipy_stepper(request.method, request.relative_tolerance, request.absolute_tolerance)


def _watches(setup: Setup, folder: Path | None) -> list[Watch]:
    """The events as functions of (t, x)."""
    model, request = setup.model, setup.request
    if not request.events:
        return []
    t, x, found = np.zeros(1), np.zeros((1, 2 * model.dof)), np.zeros((1, len(request.events)))
    names = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    kernel = program_kernel(setup.source, folder)
    run = kernel.bind({"events": found}, setup.values | {"t": t}, columns=[(names, x)])

    def level(k: int) -> Callable[[float, Array], float]:
        def g(at: float, state: Array) -> float:
            t[0] = at
            x[0] = state[: 2 * model.dof]
            run()
            return float(found[0, k]) - request.events[k].level

        return g

    return [Watch(level(k), DIRECTION[e.direction], e.action == "stop") for k, e in enumerate(request.events)]


def _judged(setup: Setup, f: RightHandSide, motion: Motion, figures: Mapping[str, float]) -> Trajectory:
    model, request = setup.model, setup.request
    given = [n for n in request.inputs if n not in setup.zero]
    integrals = first_integrals(model, given, setup.zero & set(model.parameters))
    at_steps = _states(setup, f, motion.step_t, motion.step_x)
    at_outputs = _states(setup, f, motion.t, motion.x)
    checks = judge(model, integrals, at_steps, request.drift_limit)
    n = model.dof
    return Trajectory(
        model.coordinates,
        at_outputs.t,
        at_outputs.q,
        at_outputs.qd,
        _series(setup, f, integrals, at_outputs),
        checks,
        motion.status,
        motion.message,
        motion.steps,
        tuple(Crossing(request.events[k].name, t, x[:n], x[n : 2 * n]) for k, t, x in motion.found),
        figures,
    )


def _states(setup: Setup, f: RightHandSide, times: list[float], rows: list[Array]) -> States:
    n = f.n
    t, x = np.array(times, dtype=np.float64), np.array(rows, dtype=np.float64).reshape(len(rows), f.size)
    values: dict[str, float | Array] = dict(setup.values)
    if formulas_of(setup.request):
        inputs = setup.watched(t, x[:, : 2 * n], ["inputs"])["inputs"]
        values |= {name: inputs[:, k] for k, name in enumerate(formulas_of(setup.request))}
    values |= {name: np.array([curve(at) for at in times]) for name, curve in setup.curves.items()}
    work = x[:, 2 * n] if f.has_power else np.zeros(len(t))
    return States(t, x[:, :n], x[:, n : 2 * n], values, work)


def _series(setup: Setup, f: RightHandSide, integrals: FirstIntegrals, states: States) -> dict[str, Array]:
    request = setup.request
    series = integral_series(setup.model, integrals, states)
    if f.has_power and "energy" in series:
        series["work"] = states.work
    series |= {name: np.asarray(states.values[name]) for name in setup.varying}
    if request.series:
        found = setup.watched(states.t, np.concatenate([states.q, states.qd], axis=1), ["series"])["series"]
        series |= {name: found[:, k] for k, name in enumerate(request.series)}
    return series


def _failed(setup: Setup, message: str) -> Trajectory:
    """Only the start."""
    n = setup.model.dof
    q, qd = setup.start[None, :n], setup.start[None, n:]
    t = np.array([setup.request.span[0]])
    return Trajectory(setup.model.coordinates, t, q, qd, status="failed", message=message)


def _by_name(model: Model, x: Array) -> dict[str, Array]:
    n = model.dof
    values = {name: x[:, a] for a, name in enumerate(model.coordinates)}
    return values | {f"{name}'": x[:, n + a] for a, name in enumerate(model.coordinates)}
