"""Inputs that vary along a motion, in arrays that a compiled kernel reads.

A table that has one polynomial between two breaks, as those that hold or are linear, is computed by a kernel, too: then
whole steps can be machine code.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.conditions import Conditions, state_names
from substructures.analysis.motion.corners import Laws
from substructures.array import Array
from substructures.expr.graph import Graph
from substructures.expr.operations import Symbol
from substructures.expr.program import Program, array, program


class VaryingInputs:
    """``columns``: names of inputs, and arrays (1, k) of their values; ``moving``: names of those with formulas, which
    are ``laws``. Not for several threads at a time.
    """

    def __init__(self, conditions: Conditions, t: Array, x: Array, folder: Path | None) -> None:
        """``t`` (1,), ``x`` (1, 2n): where the state is written before :meth:`fill`."""
        self._t = t
        self._curves = dict(conditions.curves)
        found, self._table = np.zeros((1, len(conditions.formulas))), np.zeros((1, len(self._curves)))
        self.columns = [(list(conditions.formulas), found), (list(self._curves), self._table)]
        self.moving = conditions.formulas
        self.laws: tuple[Laws, ...] = ()
        if conditions.formulas:
            columns = [(state_names(conditions.model), x)]
            kernel = program_kernel(conditions.expressions, folder)
            source = conditions.expressions.select(["inputs"])
            self.laws = (Laws(source, kernel, {"inputs": found}, conditions.values | {"t": t}, columns),)
        self._pieces: Array = np.zeros(0)
        self._table_run: Callable[[], None] | None = None
        if self._curves and all(curve.is_cut for curve in self._curves.values()):
            degree = max(len(piece) for curve in self._curves.values() for piece in curve.pieces) - 1
            self._pieces = np.full((len(self._curves), degree + 2), np.nan)
            polynomials = _polynomials(*self._pieces.shape)
            values = {f"c {k} {j}": self._pieces[k, j : j + 1] for k, j in np.ndindex(self._pieces.shape)} | {"t": t}
            self._table_run = program_kernel(polynomials, folder).bind({"table": self._table}, values)

    def runs(self) -> list[Callable[[], None]] | None:
        """What computes all inputs, by kernels or otherwise, until a break; None where no such calls do, and of tables
        before :meth:`enter`.
        """
        if self._curves and (self._table_run is None or np.isnan(self._pieces).any()):
            return None
        return [*([] if self._table_run is None else [self._table_run]), *(laws.run for laws in self.laws)]

    def fill(self) -> None:
        """Evaluate at the present state and time."""
        # u_k = s_k(t) of tables, then u = u(q, q', t) of expressions, in place
        for k, curve in enumerate(self._curves.values()):
            self._table[0, k] = curve(self._t[0])
        for laws in self.laws:
            laws.run()

    def enter(self, start: float, end: float) -> None:
        """Times are between two breaks of the tables until the next call."""
        for curve in self._curves.values():
            curve.enter(start, end)
        if self._table_run is not None:
            for row, curve in zip(self._pieces, self._curves.values(), strict=True):
                begin, piece = curve.piece((start + end) / 2)
                row[:] = [begin, *[0.0] * (len(row) - 1 - len(piece)), *piece]

    def leave(self) -> None:
        """Any time again."""
        for curve in self._curves.values():
            curve.leave()
        self._pieces.fill(np.nan)


@cache
def _polynomials(count: int, length: int) -> Program:
    """Output ``table`` (count,): polynomials of t from ``c k 0`` on, coefficients ``c k j``, highest power first."""
    graph = Graph()
    t = graph.symbol("t")
    symbols = {"t": Symbol("t", "time", "s")}
    found = []
    for k in range(count):
        names = [f"c {k} {j}" for j in range(length)]
        begin, first, *rest = map(graph.symbol, names)
        symbols |= {name: Symbol(name, "parameter") for name in names}
        value = first
        for c in rest:
            value = value * (t - begin) + c
        found.append(value)
    return program(graph, {"table": array((count,), lambda k: found[k])}, symbols)
