"""Functions of time of a request, evaluated together, with two derivatives by time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PPoly, make_interp_spline

from substructures.analysis.closed_requests import Signal, Table
from substructures.compile import compile_program
from substructures.definition import escape
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Symbol, array, program
from substructures.scope import Scope

Array = NDArray[np.float64]
TIME = Symbol("t", "time", "s")
#: value, rate and acceleration at a time, (3,)
Motion = Callable[[float], Array]


class Signals:
    """``values[k]``: value, first and second derivative of the k-th function; ``names``: their names."""

    def __init__(self, given: Mapping[str, Signal], pointer: str, smooth: bool) -> None:
        """``smooth``: tables are splines of degree five that hold within their times only; otherwise they are
        interpolated as they say, with the first and last value before and after.

        Raises InvalidDocument with ``pointer/name``.
        """
        self.names = tuple(given)
        self.values = np.zeros((len(given), 3))
        self._tables: list[tuple[int, Motion]] = []
        #: the common time span of smooth tables [s]
        self.span = (-np.inf, np.inf)
        formulas: dict[int, Expr] = {}
        scope = Scope(Graph())
        time = {"t": scope.graph.symbol("t")}
        for k, (name, one) in enumerate(given.items()):
            if isinstance(one, Table):
                self._add_table(k, one, smooth)
            else:
                formulas[k] = scope.read(one, f"{pointer}/{escape(name)}", time.get)
        scope.finish()
        self._time = np.zeros((1, 1))
        self._places = list(formulas)
        self._found = np.zeros((1, len(formulas), 3))
        self._run = self._compiled(scope.graph, list(formulas.values()))

    def _add_table(self, k: int, table: Table, smooth: bool) -> None:
        times, values = np.array(table.times), np.array(table.values)
        self._tables.append((k, _smooth(times, values) if smooth else _curve(times, values, table.interpolation)))
        if smooth:
            self.span = (max(self.span[0], times[0]), min(self.span[1], times[-1]))

    def _compiled(self, graph: Graph, formulas: Sequence[Expr]) -> Callable[[], None] | None:
        """Expressions in t as machine code; constants are put in place at once."""
        rows = []
        for x in formulas:
            rate = derivative(x, "t")
            rows.append((x, rate, derivative(rate, "t")))
        p = program(graph, {"motion": array((len(rows), 3), lambda k, i: rows[k][i])}, {"t": TIME})
        if not rows:
            return None
        run = compile_program(p, ["motion"]).bind({"motion": self._found}, {}, columns=[(["t"], self._time)])
        run()
        self.values[self._places] = self._found[0]
        return run if p.symbols else None

    def at(self, t: float) -> Array:
        """``values`` at a time; the array is used again by the next call."""
        if self._run is not None:
            self._time[0, 0] = t
            self._run()
            self.values[self._places] = self._found[0]
        for k, table in self._tables:
            self.values[k] = table(t)
        return self.values


def _smooth(times: Array, values: Array) -> Motion:
    """A spline of degree five (less for few points) and its derivatives as one piecewise polynomial."""
    spline = PPoly.from_spline(make_interp_spline(times, values, k=min(5, len(times) - 1)))
    terms = [spline, spline.derivative(1), spline.derivative(2)]
    stacked = np.zeros((*spline.c.shape, 3))
    for i, term in enumerate(terms):
        stacked[len(spline.c) - len(term.c) :, :, i] = term.c
    return PPoly(stacked, spline.x)


def _curve(times: Array, values: Array, interpolation: str) -> Motion:
    """The value of a table, its derivatives left out."""
    if interpolation == "cubic":
        spline = CubicSpline(times, values)
        return lambda t: np.array([float(spline(min(max(t, times[0]), times[-1]))), 0.0, 0.0])
    if interpolation == "hold":
        return lambda t: np.array([values[max(int(np.searchsorted(times, t, side="right")) - 1, 0)], 0.0, 0.0])
    return lambda t: np.array([np.interp(t, times, values), 0.0, 0.0])
