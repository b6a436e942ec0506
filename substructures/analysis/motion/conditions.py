"""What is given along a motion in numbers and compiled formulas: its start, inputs, events, series."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from substructures.analysis.arguments import NumberOrExpression
from substructures.analysis.equations.expressions import Given, read_expressions, vector
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.integrators.zeros import Watch
from substructures.analysis.motion.problems.events import DIRECTIONS, Event
from substructures.analysis.motion.problems.signals import Curve, Signal, Table, require_covered
from substructures.analysis.motion.problems.start import Start
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program, program
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.quantities.quantity import POWERS, REACTIONS, outputs_of
from substructures.tree.model import Model

#: names of series and arrays that trajectories have by themselves
RESERVED = frozenset(
    ("t", "q", "qd", "qdd", "v", "coordinates", "energy", "power", "work", "multipliers", "actuation", "constraints")
) | {"kinetic_energy", "potential_energy", "position_residual", "velocity_residual", "gaps", "friction"}
RESERVED |= {"contact_forces", POWERS, *outputs_of(REACTIONS)}
#: what the equations of motion of a tree are made of
DYNAMICS = ("metric", "bias", "forces", "potential_energy")
NO_EXPRESSIONS = program(Graph(), {name: vector(()) for name in ("inputs", "events", "series")}, {})


@dataclass(frozen=True)
class Conditions:
    """``start`` (2n,): x = (q, q') [rad, m; per s]; ``values``: numbers of all symbols but state, time and varying
    inputs; ``zero``: names of inputs and parameters that are 0.

    Inputs that vary are ``formulas`` (in state and time, by name) and ``curves`` (of the time); ``expressions`` has the
    outputs ``inputs`` (those formulas), ``events`` and ``series``, (k,) each, in the order of their names.
    """

    model: Model
    start: Array
    values: dict[str, float]
    zero: frozenset[str]
    formulas: tuple[str, ...]
    curves: Mapping[str, Curve]
    events: tuple[Event, ...]
    series: tuple[str, ...]
    expressions: Program

    @property
    def q(self) -> Array:
        """Coordinates at the start (n,)."""
        return self.start[: len(self.model.positions)]

    @property
    def qd(self) -> Array:
        """Velocities at the start (n,)."""
        return self.start[len(self.model.positions) :]

    def varied_potential(self) -> list[str]:
        """Inputs that vary and are part of the potential energy, which then changes by a power that is not known."""
        return self.in_potential([*self.formulas, *self.curves])

    def in_potential(self, inputs: Collection[str]) -> list[str]:
        """Those of the inputs that are part of the potential energy."""
        return [s.name for s in self.model.program.select(["potential_energy"]).symbols if s.name in inputs]

    def breaks(self, span: tuple[float, float]) -> list[float]:
        """Inner times where an input or its slope jumps [s]: the integrator begins anew there."""
        return sorted({t for curve in self.curves.values() for t in curve.breaks if span[0] < t < span[1]})

    def followed(self, t: Array, x: Array, names: Sequence[str]) -> dict[str, Array]:
        """Outputs of the expressions at times (K,) and states (K, 2n)."""
        values = self.values | {"t": t} | {name: x[:, a] for a, name in enumerate(state_names(self.model))}
        return interpret_in_blocks(self.expressions, values, list(names), len(t))

    def inputs_at(self, t: Array, x: Array) -> dict[str, Array]:
        """The varying inputs at times (K,) and states (K, 2n), (K,) each."""
        found = self.followed(t, x, ["inputs"])["inputs"] if self.formulas else np.zeros((len(t), 0))
        values = {name: found[:, k] for k, name in enumerate(self.formulas)}
        return values | {name: np.array([curve(at) for at in t.tolist()]) for name, curve in self.curves.items()}

    def series_at(self, t: Array, x: Array) -> dict[str, Array]:
        """The series that are asked for, and the varying inputs, at times (K,) and states (K, 2n), (K,) each."""
        found = self.followed(t, x, ["series"])["series"] if self.series else np.zeros((len(t), 0))
        return self.inputs_at(t, x) | {name: found[:, k] for k, name in enumerate(self.series)}

    def watches(self, state: Callable[[float, Array], Array], folder: Path | None) -> list[Watch]:
        """The events as functions of (t, y); ``state``: (q, q') of y. ``folder``: a cache of compiled kernels."""
        if not self.events:
            return []
        names = state_names(self.model)
        t, x, found = np.zeros(1), np.zeros((1, len(names))), np.zeros((1, len(self.events)))
        kernel = program_kernel(self.expressions, folder)
        run = kernel.bind({"events": found}, self.values | {"t": t}, columns=[(names, x)])

        def level(k: int) -> Callable[[float, Array], float]:
            """The function whose zeros are event k."""

            def g(at: float, y: Array) -> float:
                """quantity - level at (t, x)."""
                # g(t, y) = quantity(q, q', t) - level
                t[0], x[0] = at, state(at, y)
                run()
                return float(found[0, k]) - self.events[k].level

            return g

        return [
            Watch(e.name, level(k), DIRECTIONS[e.direction], e.action == "stop", e.level, count=e.count)
            for k, e in enumerate(self.events)
        ]


def state_names(model: Model) -> list[str]:
    """Coordinates, or positions of ball joints, then velocities."""
    return [*model.positions, *(f"{name}'" for name in model.coordinates)]


def read_conditions(
    model: Model,
    start: Start,
    span: tuple[float, float],
    needs: Sequence[str],
    events: Sequence[Event] = (),
    series: Mapping[str, NumberOrExpression] | None = None,
) -> Conditions:
    """Check what is given against a model; ``needs``: outputs of the model whose symbols must have values.

    Raises InvalidInput (pointers ``/q``, ``/inputs/name``, ``/events/i/quantity``, ...) and MissingValue.
    """
    followed = series or {}
    states = read_states(model, {"q": start.q, "qd": start.qd}, 1)
    curves = _curves(model, start.inputs, span)
    formulas = tuple(name for name, x in start.inputs.items() if isinstance(x, str))
    groups: dict[str, Given] = {
        "inputs": [(start.inputs[name], f"/inputs/{escape(name)}") for name in formulas],
        "events": [(e.quantity, f"/events/{i}/quantity") for i, e in enumerate(events)],
        "series": [(x, f"/series/{escape(name)}") for name, x in followed.items()],
    }
    # u = u(q, q', t), quantities of events and series: one program for all
    expressions = read_expressions(model, groups) if any(groups.values()) else NO_EXPRESSIONS
    _check_names(model, start.parameters, followed)
    _require_rates(model, start.inputs)
    constant = {name: x for name, x in start.inputs.items() if not isinstance(x, (Table, str))}
    found = symbol_values(model, {"parameters": start.parameters, "inputs": constant}, states, needs)
    values = {n: float(np.asarray(v).item(0)) for n, v in found.items()}
    # what moves is no constant of the kernels
    for name in (*state_names(model), "t", *formulas, *curves):
        values.pop(name, None)
    inputs = {*model.input_names, *model.parameters}
    zero = frozenset(name for name, x in values.items() if x == 0 and name in inputs)
    x = np.concatenate([states.q[0], states.qd[0]])
    return Conditions(model, x, values, zero, formulas, curves, tuple(events), tuple(followed), expressions)


def _curves(model: Model, given: Mapping[str, Signal], span: tuple[float, float]) -> dict[str, Curve]:
    known = model.input_names
    curves = {}
    for name, one in given.items():
        pointer = f"/inputs/{escape(name)}"
        if name not in known:
            raise InvalidArgument.at(pointer, "unknown-input", f"unknown input '{name[:80]}'{among(name, known)}")
        if isinstance(one, Table):
            require_covered(one, span, pointer)
            curves[name] = Curve(one)
    return curves


def _require_rates(model: Model, given: Mapping[str, Signal]) -> None:
    """Raises InvalidArgument (``/inputs/name``, ``missing``) for a driven coordinate that varies without its rate."""
    for name in [f"{name}{prime}" for name in model.driven for prime in ("", "'")]:
        rate = f"{name}'"
        if rate in model.input_names and isinstance(given.get(name), (Table, str)) and rate not in given:
            message = f"'{name}' moves a coordinate and varies: give its derivative by time, '{rate}', too"
            raise InvalidArgument.at(f"/inputs/{escape(rate)}", "missing", message)


def _check_names(model: Model, parameters: Mapping[str, float], series: Mapping[str, object]) -> None:
    unknown = [name for name in parameters if name not in model.parameters]
    faults = [
        Fault(
            f"/parameters/{escape(name)}",
            "unknown-parameter",
            f"unknown parameter '{name[:80]}'{among(name, model.parameters, k)}",
        )
        for k, name in enumerate(unknown)
    ]
    faults += [
        Fault(f"/series/{name}", "reserved-name", f"'{name}' is a series of every trajectory: take another name")
        for name in series
        if name in RESERVED
    ]
    if faults:
        raise InvalidArgument(faults)
