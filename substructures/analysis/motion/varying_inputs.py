"""Inputs that vary along a motion, in arrays that a compiled kernel reads: formulas by a kernel, tables by code of
their own, so that whole steps can be machine code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.motion.conditions import Conditions
from substructures.analysis.motion.corners import Laws
from substructures.array import Array
from substructures.compile.arguments import NamedColumns
from substructures.compile.tables import TimeTables


class VaryingInputs:
    """``columns``: names of inputs, and arrays (1, k) of their values; ``moving``: names of those with formulas, which
    are ``laws``. Not for several threads at a time.
    """

    def __init__(
        self,
        conditions: Conditions,
        t: Array,
        state: Sequence[NamedColumns],
        folder: Path | None,
        others: Sequence[tuple[Array, tuple[Array, Array]]] = (),
    ) -> None:
        """``t`` (1,), ``state``: where time, coordinates and their rates are written before :meth:`fill`; ``others``:
        arrays (1,) for the values of other tables without breaks, which are no inputs, in machine code.
        """
        self._t = t
        self._curves = dict(conditions.curves)
        found, self._table = np.zeros((1, len(conditions.formulas))), np.zeros((1, len(self._curves)))
        self.columns = [(list(conditions.formulas), found), (list(self._curves), self._table)]
        self.moving = conditions.formulas
        self.laws: tuple[Laws, ...] = ()
        if conditions.formulas:
            kernel = program_kernel(conditions.expressions, folder)
            source = conditions.expressions.select(["inputs"])
            self.laws = (Laws(source, kernel, {"inputs": found}, conditions.values | {"t": t}, list(state)),)
        curves = [(np.array(c.times), np.array(c.pieces, dtype=np.float64)) for c in self._curves.values()]
        tables = [*zip(self._table[0, :, None], curves, strict=True), *others]
        #: in machine code
        self.tables = TimeTables([x for x, _ in tables], [curve for _, curve in tables]) if tables else None
        self.has_breaks, self._is_entered = any(curve.breaks for curve in self._curves.values()), False

    def runs(self) -> list[Callable[[], None]] | None:
        """What computes all inputs but tables, by kernels or otherwise, until a break; None where tables have breaks,
        before :meth:`enter`.
        """
        return None if self.has_breaks and not self._is_entered else [laws.run for laws in self.laws]

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
        self._take(is_entered=True)

    def leave(self) -> None:
        """Any time again."""
        for curve in self._curves.values():
            curve.leave()
        self._take(is_entered=False)

    def _take(self, is_entered: bool) -> None:
        self._is_entered = is_entered
        if self.tables is not None:
            for k, curve in enumerate(self._curves.values()):
                self.tables.take(k, *curve.taken)
