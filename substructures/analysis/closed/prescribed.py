"""Prescribed motions of coordinates: functions of time with two derivatives, evaluated together."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy

from substructures.analysis.arguments import exact, require_read
from substructures.analysis.closed.kinks import require_finite, require_smooth, require_smooth_table
from substructures.analysis.motion.problems.signals import Signal, Table, polynomials, require_covered
from substructures.array import Array
from substructures.compile import compile_program
from substructures.documents import escape
from substructures.errors import among
from substructures.expr.calculus.corners import corners, inner, rates
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Symbol, array, program
from substructures.expr.walk import reachable
from substructures.loads.scope import Scope
from substructures.tree.model import Model

TIME = Symbol("t", "time", "s")
#: how far beside a place where pieces of a law meet rates are taken, as a part of max(1, t)
BESIDE = 2.0**-40


class Prescribed:
    """Coordinates whose motion is given. ``index``: which they are; ``values[k]``: value, first and second derivative
    of the k-th. Numbers and expressions in t are exact; tables are splines of degree five, or what they say.
    """

    def __init__(self, model: Model, given: Mapping[str, Signal], span: tuple[float, float]) -> None:
        """Raises InvalidArgument (``/prescribed/name``): unknown coordinates, bad expressions, tables that do not cover
        the span, motions with a kink in it.
        """
        self.values, self._middle = np.zeros((len(given), 3)), sum(span) / 2
        self._tables: list[tuple[int, Any]] = []
        self._meeting = np.ones((1, 0))
        scope = Scope(Graph())
        time = {"t": scope.graph.symbol("t")}
        formulas: dict[int, Expr] = {}
        unit_of = model.state_units["q"].get
        for k, (name, one) in enumerate(given.items()):
            pointer = f"/prescribed/{escape(name)}"
            if name not in model.coordinates:
                message = f"unknown coordinate '{name[:80]}'{among(name, model.coordinates, k)}"
                scope.fault(pointer, "unknown-coordinate", message)
            elif isinstance(one, Table):
                require_covered(one, span, pointer)
                curve = polynomials(one, "quintic")
                self._tables.append((k, _rates(require_smooth_table(curve, span, pointer, unit_of(name, "")))))
            else:
                formulas[k] = scope.read(exact(one, pointer), pointer, time.get)
        require_read(scope)
        self.index = tuple(model.coordinates.index(name) for name in given)
        self._time = np.zeros(1)
        self._places = list(formulas)
        self._found = np.zeros((1, len(formulas), 3))
        rows = [(x, *rates(x, "t")) for x in formulas.values()]
        names = list(given)
        for k, row in zip(formulas, rows, strict=True):
            _require_smooth(row, span, f"/prescribed/{escape(names[k])}", unit_of(names[k], ""))
        self._graph, self._rows = scope.graph, dict(zip(formulas, rows, strict=True))
        self._second = np.zeros((1, len(self._tables)))
        self._run = self._compiled(scope.graph, rows)

    def _compiled(self, graph: Graph, rows: Sequence[tuple[Expr, Expr, Expr]]) -> Callable[[], None] | None:
        """Expressions in t as machine code; constants are put in place at once."""
        if not rows:
            return None
        meeting = [inner(node) for node in corners(row[0] for row in rows)]
        motion = array((len(rows), 3), lambda k, i: rows[k][i])
        p = program(graph, {"motion": motion, "meeting": array((len(meeting),), lambda k: meeting[k])}, {"t": TIME})
        self._meeting = np.ones((1, len(meeting)))
        out = {"motion": self._found, "meeting": self._meeting}
        run = compile_program(p, list(out), single=True).bind(out, {"t": self._time})
        run()
        self.values[self._places] = self._found[0]
        return run if p.symbols else None

    @property
    def tables(self) -> list[tuple[Array, tuple[Array, Array]]]:
        """Arrays (1,) for the second derivatives of tables, which :meth:`bound` reads, and what these are: times, and
        coefficients of every piece, highest power first.
        """
        curves = [(x.x.copy(), np.ascontiguousarray(x.c[:, :, 2].T)) for _, x in self._tables]
        return list(zip(self._second[0, :, None], curves, strict=True))

    def bound(self, t: Array, c: Array) -> tuple[Callable[[], None], ...] | None:
        """Calls that write c = -s'' (1, k) at the time ``t`` (1,), of tables from their second derivatives; None where
        pieces of expressions meet.
        """
        if self._run is None and not self._tables:
            return ()
        if self._meeting.size:
            return None
        second = {k: row[2] for k, row in self._rows.items()}
        names = [f"table.{k}" for k, _ in self._tables]
        second |= {k: self._graph.symbol(name) for (k, _), name in zip(self._tables, names, strict=True)}
        symbols = {"t": TIME} | {name: Symbol(name, "input", "") for name in names}
        p = program(self._graph, {"c": array((len(self.index),), lambda k: -second[k])}, symbols)
        kernel = compile_program(p, ["c"], single=True)
        return (kernel.bind({"c": c}, {"t": t}, columns=[(names, self._second)] if names else []),)

    def at(self, t: float) -> Array:
        """``values`` at a time; the array is used again by the next call."""
        if self._run is not None:
            self._time[0] = t
            self._run()
            self.values[self._places] = self._found[0]
            if not self._meeting.all():
                self._beside(t, self._run)
        for k, table in self._tables:
            self.values[k] = table(t)
        return self.values

    def _beside(self, t: float, run: Callable[[], None]) -> None:
        """The rates at a time where pieces meet, as they are beside it within the span: kinks were refused."""
        self._time[0] = t + (BESIDE if t < self._middle else -BESIDE) * max(1.0, abs(t))
        run()
        self.values[self._places, 1:] = self._found[0, :, 1:]


def _require_smooth(row: tuple[Expr, Expr, Expr], span: tuple[float, float], pointer: str, unit: str) -> None:
    """Raises InvalidArgument where an expression has a kink, or no finite value."""
    found = [inner(node) for node in corners(row[:1])]
    divisors = [node.args[1] for node in reachable(row[:1]) if node.op == "div"]
    outputs = {
        "motion": array((3,), lambda i: row[i]),
        "places": array((len(found),), lambda k: found[k]),
        "divisors": array((len(divisors),), lambda k: divisors[k]),
    }
    p = program(row[0].graph, outputs, {"t": TIME})

    def columns(name: str) -> Callable[[Array], Array]:
        """An output at times."""
        return lambda t: np.broadcast_to(interpret(p, {"t": t}, [name])[name], (len(t), *outputs[name].shape))

    if found:
        require_smooth(columns("motion"), columns("places"), span, pointer, unit)
    require_finite(columns("motion"), columns("divisors"), span, pointer)


def _rates(curve: Any) -> Any:
    """A piecewise polynomial and two derivatives as one."""
    terms = [curve, curve.derivative(1), curve.derivative(2)]
    stacked = np.zeros((*curve.c.shape, 3))
    for i, term in enumerate(terms):
        stacked[len(curve.c) - len(term.c) :, :, i] = term.c
    return scipy.interpolate.PPoly(stacked, curve.x)
