"""What a request gives along a motion: inputs (numbers, tables, expressions in state and time), events, series."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

from substructures.analysis.equations.expressions import Given, read_expressions
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.integration import Watch
from substructures.analysis.motion.request_fields import Event, Signal, Table
from substructures.analysis.motion.requests import SpanRequest, StateRequest
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import Fault, InvalidDocument
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.quantities.states import read_states, symbol_values
from substructures.tree.model import Model

DIRECTION = {"rising": 1, "falling": -1, "both": 0}
#: names of series and arrays that trajectories have by themselves
RESERVED = frozenset(
    ("t", "q", "qd", "qdd", "v", "coordinates", "energy", "power", "work", "multipliers", "actuation", "constraints")
) | {"kinetic_energy", "potential_energy", "position_residual", "velocity_residual", "gaps"}


class Curve:
    """A table as piecewise polynomial of the time."""

    def __init__(self, table: Table) -> None:
        self.times = list(table.times)
        self.pieces = _pieces(table)
        #: where the curve, or its slope, jumps
        self.breaks = [] if table.interpolation == "cubic" else self.times[1:-1]
        self._piece: int | None = None

    def enter(self, start: float, end: float) -> None:
        """Until the next call times lie between two breaks: at both the value is the limit from inside."""
        self._piece = self._at((start + end) / 2) if self.breaks else None

    def leave(self) -> None:
        """Any time again."""
        self._piece = None

    def _at(self, t: float) -> int:
        return min(max(bisect_right(self.times, t) - 1, 0), len(self.pieces) - 1)

    def __call__(self, t: float) -> float:
        """The value at t, in the table's range."""
        k = self._at(t) if self._piece is None else self._piece
        x, value = t - self.times[k], 0.0
        for c in self.pieces[k]:
            value = value * x + c
        return value


def _pieces(table: Table) -> list[list[float]]:
    """Coefficients of every piece, highest power first."""
    t, y = np.array(table.times), np.array(table.values)
    if table.interpolation == "cubic":
        rows = CubicSpline(t, y).c.T
    elif table.interpolation == "linear":
        rows = np.stack([np.diff(y) / np.diff(t), y[:-1]], axis=1)
    else:
        rows = y[:-1, None]
    pieces: list[list[float]] = rows.tolist()
    return pieces


def require_covered(table: Table, span: tuple[float, float], pointer: str) -> None:
    """Raises InvalidDocument (``not-covered``) for a table that holds in a part of the span only."""
    if table.times[0] > span[0] or table.times[-1] < span[1]:
        message = f"the table covers {table.times[0]:g} s to {table.times[-1]:g} s, less than the span"
        raise InvalidDocument.at(f"{pointer}/times", "not-covered", message)


@dataclass(frozen=True)
class Along:
    """What was read of a request: the start (2n,), numbers of all symbols but state, time and varying inputs; names of
    inputs and parameters that are zero; tables; the program of all expressions (``inputs``, ``events``, ``series``).
    """

    model: Model
    start: Array
    values: dict[str, float]
    zero: frozenset[str]
    formulas: tuple[str, ...]
    curves: Mapping[str, Curve]
    events: tuple[Event, ...]
    series: tuple[str, ...]
    source: Program

    @property
    def q(self) -> Array:
        """Coordinates at the start."""
        return self.start[: self.model.dof]

    @property
    def qd(self) -> Array:
        """Velocities at the start."""
        return self.start[self.model.dof :]

    def breaks(self, span: tuple[float, float]) -> list[float]:
        """Inner times where an input or its slope jumps: the integrator begins anew there."""
        return sorted({t for curve in self.curves.values() for t in curve.breaks if span[0] < t < span[1]})

    def watched(self, t: Array, x: Array, names: Sequence[str]) -> dict[str, Array]:
        """Outputs of the expressions along states (K, 2n)."""
        n = self.model.dof
        values = self.values | {"t": t} | {name: x[:, a] for a, name in enumerate(self.model.coordinates)}
        values |= {f"{name}'": x[:, n + a] for a, name in enumerate(self.model.coordinates)}
        return interpret_in_blocks(self.source, values, list(names), len(t))

    def inputs_at(self, t: Array, x: Array) -> dict[str, Array]:
        """The varying inputs along states (K, 2n), (K,) each."""
        found = self.watched(t, x, ["inputs"])["inputs"] if self.formulas else np.zeros((len(t), 0))
        values = {name: found[:, k] for k, name in enumerate(self.formulas)}
        return values | {name: np.array([curve(at) for at in t.tolist()]) for name, curve in self.curves.items()}

    def series_at(self, t: Array, x: Array) -> dict[str, Array]:
        """The quantities that are followed along states (K, 2n), and the varying inputs, (K,) each."""
        found = self.watched(t, x, ["series"])["series"] if self.series else np.zeros((len(t), 0))
        return self.inputs_at(t, x) | {name: found[:, k] for k, name in enumerate(self.series)}

    def watches(self, state: Callable[[float, Array], Array], folder: Path | None) -> list[Watch]:
        """The events as functions of (t, y); ``state``: (q, q') of y."""
        if not self.events:
            return []
        names = state_names(self.model)
        t, x, found = np.zeros(1), np.zeros((1, len(names))), np.zeros((1, len(self.events)))
        kernel = program_kernel(self.source, folder)
        run = kernel.bind({"events": found}, self.values | {"t": t}, columns=[(names, x)])

        def level(k: int) -> Callable[[float, Array], float]:
            def g(at: float, y: Array) -> float:
                t[0], x[0] = at, state(at, y)
                run()
                return float(found[0, k]) - self.events[k].level

            return g

        return [Watch(e.name, level(k), DIRECTION[e.direction], e.action == "stop") for k, e in enumerate(self.events)]


class VaryingInputs:
    """The varying inputs in arrays that a compiled kernel reads: ``columns``. Not for several threads at a time."""

    def __init__(self, along: Along, t: Array, x: Array, folder: Path | None) -> None:
        """``t`` (1,), ``x`` (1, 2n): where the state is written before :meth:`fill`."""
        self._t = t
        self._curves = dict(along.curves)
        found, self._table = np.zeros((1, len(along.formulas))), np.zeros((1, len(self._curves)))
        self.columns = [(list(along.formulas), found), (list(self._curves), self._table)]
        self._run: Callable[[], None] | None = None
        if along.formulas:
            columns = [(state_names(along.model), x)]
            kernel = program_kernel(along.source, folder)
            self._run = kernel.bind({"inputs": found}, along.values | {"t": t}, columns=columns)

    def fill(self) -> None:
        """Evaluate at the present state and time."""
        for k, curve in enumerate(self._curves.values()):
            self._table[0, k] = curve(self._t[0])
        if self._run is not None:
            self._run()

    def enter(self, start: float, end: float) -> None:
        """Times are between two breaks of the tables until the next call."""
        for curve in self._curves.values():
            curve.enter(start, end)

    def leave(self) -> None:
        """Any time again."""
        for curve in self._curves.values():
            curve.leave()


def state_names(model: Model) -> list[str]:
    """Coordinates, then velocities."""
    return [*model.coordinates, *(f"{name}'" for name in model.coordinates)]


def read_along(model: Model, request: StateRequest, span: tuple[float, float], needs: Sequence[str]) -> Along:
    """Check a request against a model; ``needs``: outputs whose symbols must have values.

    Raises InvalidDocument and MissingValue.
    """
    states = read_states(model, {"q": request.q, "qd": request.qd}, 1)
    events = request.events if isinstance(request, SpanRequest) else ()
    series = request.series if isinstance(request, SpanRequest) else {}
    curves = _curves(model, request.inputs, span)
    formulas = tuple(name for name, x in request.inputs.items() if isinstance(x, str))
    groups: dict[str, Given] = {
        "inputs": [(request.inputs[name], f"/inputs/{escape(name)}") for name in formulas],
        "events": [(e.quantity, f"/events/{i}/quantity") for i, e in enumerate(events)],
        "series": [(x, f"/series/{escape(name)}") for name, x in series.items()],
    }
    source = read_expressions(model, groups)
    _check_names(model, request.parameters, series)
    fixed = {name: x for name, x in request.inputs.items() if not isinstance(x, (Table, str))}
    found = symbol_values(model, {"parameters": request.parameters, "inputs": fixed}, states, needs)
    values = {n: float(np.ravel(v)[0]) for n, v in found.items()}
    for name in (*state_names(model), "t", *formulas, *curves):
        values.pop(name, None)
    inputs = {s.name for s in model.program.symbols if s.kind == "input"} | set(model.parameters)
    zero = frozenset(name for name, x in values.items() if x == 0 and name in inputs)
    start = np.concatenate([states.q[0], states.qd[0]])
    return Along(model, start, values, zero, formulas, curves, events, tuple(series), source)


def _curves(model: Model, given: Mapping[str, Signal], span: tuple[float, float]) -> dict[str, Curve]:
    known = {s.name for s in model.program.symbols if s.kind == "input"}
    known |= {f"tau.{name}" for name in model.coordinates}
    curves = {}
    for name, one in given.items():
        pointer = f"/inputs/{escape(name)}"
        if name not in known:
            raise InvalidDocument.at(pointer, "unknown-input", f"unknown input '{name[:80]}'")
        if isinstance(one, Table):
            require_covered(one, span, pointer)
            curves[name] = Curve(one)
    return curves


def _check_names(model: Model, parameters: Mapping[str, float], series: Mapping[str, object]) -> None:
    faults = [
        Fault(f"/parameters/{escape(name)}", "unknown-parameter", f"unknown parameter '{name[:80]}'")
        for name in parameters
        if name not in model.parameters
    ]
    faults += [
        Fault(f"/series/{name}", "reserved-name", f"'{name}' is a series of every trajectory: take another name")
        for name in series
        if name in RESERVED
    ]
    if faults:
        raise InvalidDocument(faults)
