"""Inputs over time, events and followed quantities: numbers, tables, and expressions in state, parameters and time."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from decimal import Decimal

import numpy as np
from scipy.interpolate import CubicSpline

from substructures.analysis.expressions import Given, read_expressions
from substructures.analysis.requests import SimulationRequest, Table
from substructures.definition import escape
from substructures.errors import InvalidDocument
from substructures.expr.program import Program
from substructures.model import Model


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


def read_curves(model: Model, request: SimulationRequest) -> dict[str, Curve]:
    """The inputs that are tables. Raises InvalidDocument for unknown inputs, and tables that end too early."""
    known = {s.name for s in model.program.symbols if s.kind == "input"}
    known |= {f"tau.{name}" for name in model.coordinates}
    curves = {}
    for name, given in request.inputs.items():
        pointer = f"/inputs/{escape(name)}"
        if name not in known:
            raise InvalidDocument.at(pointer, "unknown-input", f"unknown input '{name[:80]}'")
        if isinstance(given, Table):
            if given.times[0] > request.span[0] or given.times[-1] < request.span[1]:
                message = f"the table covers {given.times[0]:g} s to {given.times[-1]:g} s, less than the span"
                raise InvalidDocument.at(f"{pointer}/times", "not-covered", message)
            curves[name] = Curve(given)
    return curves


def expressions(model: Model, request: SimulationRequest) -> Program:
    """Inputs that are expressions, events and series as one program with outputs ``inputs``, ``events``, ``series``.

    Raises InvalidDocument with a pointer to every fault.
    """
    groups: dict[str, Given] = {
        "inputs": [(request.inputs[name], f"/inputs/{escape(name)}") for name in formulas_of(request)],
        "events": [(e.quantity, f"/events/{i}/quantity") for i, e in enumerate(request.events)],
        "series": [(x, f"/series/{escape(name)}") for name, x in request.series.items()],
    }
    return read_expressions(model, groups)


def constants(request: SimulationRequest) -> dict[str, int | Decimal]:
    """The inputs that are numbers."""
    return {name: x for name, x in request.inputs.items() if not isinstance(x, (Table, str))}


def formulas_of(request: SimulationRequest) -> tuple[str, ...]:
    """Names of the inputs that are expressions, in the order of the output ``inputs``."""
    return tuple(name for name, x in request.inputs.items() if isinstance(x, str))


def break_times(curves: Mapping[str, Curve], span: tuple[float, float]) -> list[float]:
    """Inner times where an input or its slope jumps: the integrator begins anew there."""
    return sorted({t for curve in curves.values() for t in curve.breaks if span[0] < t < span[1]})
