"""Prescribed motions of coordinates: functions of time with two derivatives, evaluated together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy

from substructures.analysis.arguments import exact, require_read
from substructures.analysis.motion.signals import Signal, Table, require_covered
from substructures.array import Array
from substructures.compile import compile_program
from substructures.documents import escape
from substructures.errors import among
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Symbol, array, program
from substructures.part.scope import Scope
from substructures.tree.model import Model

TIME = Symbol("t", "time", "s")


class Prescribed:
    """Coordinates whose motion is given. ``index``: which they are; ``values[k]``: value, first and second derivative
    of the k-th. Numbers and expressions in t are exact; tables are splines of degree five.
    """

    def __init__(self, model: Model, given: Mapping[str, Signal], span: tuple[float, float]) -> None:
        """Raises InvalidArgument (``/prescribed/name``): unknown coordinates, bad expressions, tables that do not cover
        the span.
        """
        self.values = np.zeros((len(given), 3))
        self._tables: list[tuple[int, Any]] = []
        scope = Scope(Graph())
        time = {"t": scope.graph.symbol("t")}
        formulas: dict[int, Expr] = {}
        for k, (name, one) in enumerate(given.items()):
            pointer = f"/prescribed/{escape(name)}"
            if name not in model.coordinates:
                message = f"unknown coordinate '{name[:80]}'{among(name, model.coordinates, k)}"
                scope.fault(pointer, "unknown-coordinate", message)
            elif isinstance(one, Table):
                require_covered(one, span, pointer)
                self._tables.append((k, _spline(np.array(one.times), np.array(one.values))))
            else:
                formulas[k] = scope.read(exact(one, pointer), pointer, time.get)
        require_read(scope)
        self.index = tuple(model.coordinates.index(name) for name in given)
        self._time = np.zeros(1)
        self._places = list(formulas)
        self._found = np.zeros((1, len(formulas), 3))
        self._run = self._compiled(scope.graph, list(formulas.values()))

    def _compiled(self, graph: Graph, formulas: Sequence[Expr]) -> Callable[[], None] | None:
        """Expressions in t as machine code; constants are put in place at once."""
        rows = []
        # s(t), s'(t), s''(t)
        for x in formulas:
            rate = derivative(x, "t")
            rows.append((x, rate, derivative(rate, "t")))
        if not rows:
            return None
        p = program(graph, {"motion": array((len(rows), 3), lambda k, i: rows[k][i])}, {"t": TIME})
        run = compile_program(p, ["motion"]).bind({"motion": self._found}, {"t": self._time})
        run()
        self.values[self._places] = self._found[0]
        return run if p.symbols else None

    def at(self, t: float) -> Array:
        """``values`` at a time; the array is used again by the next call."""
        if self._run is not None:
            self._time[0] = t
            self._run()
            self.values[self._places] = self._found[0]
        for k, table in self._tables:
            self.values[k] = table(t)
        return self.values


def _spline(times: Array, values: Array) -> Any:
    """A spline of degree five (less for few points) and two derivatives as one piecewise polynomial.

    The second derivative enters the equations of motion: of degree three, it is twice continuously differentiable.
    """
    of_degree = scipy.interpolate.make_interp_spline(times, values, k=min(5, len(times) - 1))
    spline = scipy.interpolate.PPoly.from_spline(of_degree)
    terms = [spline, spline.derivative(1), spline.derivative(2)]
    stacked = np.zeros((*spline.c.shape, 3))
    for i, term in enumerate(terms):
        stacked[len(spline.c) - len(term.c) :, :, i] = term.c
    return scipy.interpolate.PPoly(stacked, spline.x)
