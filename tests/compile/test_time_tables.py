"""Tables of the time in machine code: the piece at a time and its value, to the bit as in Python."""

from __future__ import annotations

import numpy as np
import pytest

from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.signals import Curve, Table
from substructures.array import Array
from substructures.compile import target
from substructures.compile.motion import CompiledRates, CompiledRun
from substructures.compile.tables import TimeTables

pytestmark = pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")


def at(tables: TimeTables, times: Array) -> Array:
    """Their values at these times, (times, tables)."""
    rates = CompiledRates((), np.zeros(1), np.zeros((1, 2)), np.zeros((1, 1)), None, tables=tables)
    run, found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)), []
    for t in times.tolist():
        for value in tables.values:
            value.fill(np.nan)
        run.begin(t, np.zeros(2), t, 1.0)
        run.advance(0)
        found.append(np.concatenate(tables.values))
    return np.array(found)


@pytest.mark.parametrize("knots", [2, 3, 4, 7, 8, 9, 40])
def test_values_of_tables(knots: int) -> None:
    rng = np.random.default_rng(knots)
    times = np.cumsum(rng.uniform(0.1, 1.0, knots))
    curves = [
        Curve(Table(times.tolist(), rng.standard_normal(knots).tolist(), how))
        for how in ("hold", "linear", "cubic", "quintic")
        if knots > 3 or how in ("hold", "linear")
    ]
    arrays = [(np.array(curve.times), np.array(curve.pieces)) for curve in curves]
    tables = TimeTables([*np.zeros((len(curves), 1))], arrays)
    wanted = np.sort(np.r_[times, rng.uniform(times[0] - 0.1, times[-1] + 0.1, 60)])
    np.testing.assert_array_equal(at(tables, wanted), [[curve(t) for curve in curves] for t in wanted.tolist()])
    start, end = times[-2:].tolist()
    for k, curve in enumerate(curves):
        curve.enter(start, end)
        tables.take(k, *curve.taken)
    np.testing.assert_array_equal(at(tables, wanted), [[curve(t) for curve in curves] for t in wanted.tolist()])
