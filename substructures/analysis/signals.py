"""Functions of time in requests: a number, an expression in t, or a table; with two derivatives by time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly, make_interp_spline

from substructures.compile import compile_program
from substructures.errors import Fault, InvalidDocument
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import ExpressionError, parse
from substructures.expr.program import Symbol, array, program
from substructures.states import numeric

Array = NDArray[np.float64]
TIME = Symbol("t", "time", "s")
#: value, rate and acceleration at a time
Motion = Callable[[float], Any]


class Signals:
    """Several functions of time, evaluated together. ``values[k]``: value, first and second derivative of the k-th."""

    def __init__(self, given: Sequence[Any], pointers: Sequence[str], smooth: bool) -> None:
        """``smooth``: tables are interpolated by splines of degree five and hold within their times only; otherwise
        linearly, with the first and last value before and after.

        Raises InvalidDocument.
        """
        self.values = np.zeros((len(given), 3))
        self._tables: list[tuple[int, Motion]] = []
        #: the common time span of the tables that end [s]
        self.span = (-np.inf, np.inf)
        formulas: dict[int, Expr] = {}
        graph = Graph()
        for k, (one, pointer) in enumerate(zip(given, pointers, strict=True)):
            if isinstance(one, str):
                formulas[k] = _expression(graph, one, pointer)
            elif isinstance(one, Mapping):
                self._add_table(k, one, pointer, smooth)
            else:
                self.values[k, 0] = scalar(one, pointer)
        self._time = np.zeros((1, 1))
        self._places = list(formulas)
        self._found = np.zeros((1, len(formulas), 3))
        self._run = self._compiled(graph, list(formulas.values())) if formulas else None

    def _add_table(self, k: int, one: Mapping[str, Any], pointer: str, smooth: bool) -> None:
        times, values = _columns(one, pointer)
        self._tables.append((k, _spline(times, values) if smooth else _polygon(times, values)))
        if smooth:
            self.span = (max(self.span[0], times[0]), min(self.span[1], times[-1]))

    def _compiled(self, graph: Graph, formulas: Sequence[Expr]) -> Callable[[], None]:
        rows = []
        for x in formulas:
            rate = derivative(x, "t")
            rows.append((x, rate, derivative(rate, "t")))
        p = program(graph, {"motion": array((len(rows), 3), lambda k, i: rows[k][i])}, {"t": TIME})
        kernel = compile_program(p, ["motion"])
        return kernel.bind({"motion": self._found}, {}, columns=[(["t"], self._time)])

    def at(self, t: float) -> Array:
        """``values`` at a time; the array is used again by the next call."""
        if self._run is not None:
            self._time[0, 0] = t
            self._run()
            self.values[self._places] = self._found[0]
        for k, table in self._tables:
            self.values[k] = table(t)
        return self.values


def _expression(graph: Graph, text: str, pointer: str) -> Expr:
    try:
        return parse(graph, text, {"t": graph.symbol("t")}.get)
    except ExpressionError as error:
        raise InvalidDocument.at(pointer, "bad-expression", f"{error}; expressions in 't' are allowed") from None


def scalar(given: Any, pointer: str) -> float:
    """One finite number. Raises InvalidDocument."""
    value = numeric(given, pointer)
    if value.ndim:
        raise InvalidDocument.at(pointer, "number-expected", "one number is needed")
    return float(value)


def _columns(given: Mapping[str, Any], pointer: str) -> tuple[Array, Array]:
    """``times`` (K,), rising, and ``values`` (K,)."""
    faults = [Fault(f"{pointer}/{key}", "unknown-field", f"unknown field '{key}'") for key in given]
    faults = [f for f in faults if f.pointer not in (f"{pointer}/times", f"{pointer}/values")]
    faults += [Fault(f"{pointer}/{k}", "missing", f"a table has '{k}'") for k in ("times", "values") if k not in given]
    if faults:
        raise InvalidDocument(faults)
    times, values = (numeric(given[key], f"{pointer}/{key}") for key in ("times", "values"))
    if times.ndim != 1 or len(times) < 2 or (np.diff(times) <= 0).any():
        raise InvalidDocument.at(f"{pointer}/times", "not-rising", "two or more rising times are needed")
    if values.shape != times.shape:
        raise InvalidDocument.at(f"{pointer}/values", "wrong-length", f"{len(times)} values are needed")
    return times, values


def _spline(times: Array, values: Array) -> Motion:
    """A spline of degree five (less for few points) and its derivatives as one piecewise polynomial."""
    spline = PPoly.from_spline(make_interp_spline(times, values, k=min(5, len(times) - 1)))
    terms = [spline, spline.derivative(1), spline.derivative(2)]
    stacked = np.zeros((*spline.c.shape, 3))
    for i, term in enumerate(terms):
        stacked[len(spline.c) - len(term.c) :, :, i] = term.c
    return PPoly(stacked, spline.x)


def _polygon(times: Array, values: Array) -> Motion:
    return lambda t: (float(np.interp(t, times, values)), 0.0, 0.0)
