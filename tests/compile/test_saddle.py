"""The equations with closures that machine code solves, against LAPACK."""

from __future__ import annotations

import numpy as np
import pytest

from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.array import Array
from substructures.compile import target
from substructures.compile.motion import CompiledRates, CompiledRun, SaddlePoint

pytestmark = pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")


def solved(saddle: SaddlePoint, *rows: list[int]) -> list[Array]:
    """q'' with these rows, one choice after the other."""
    n = len(saddle.forces)
    rates = CompiledRates((), np.zeros(1), np.zeros((1, 2 * n)), np.full((1, n), np.nan), None, None, saddle)
    run, found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)), []
    for chosen in rows:
        saddle.rows[:] = chosen
        run.begin(0.0, np.zeros(2 * n), 0.0, 1.0)
        run.advance()
        found.append(rates.written[0].copy())
    return found


@pytest.mark.parametrize(("n", "m", "r"), [(1, 0, 0), (1, 1, 1), (3, 5, 2), (7, 15, 6), (8, 8, 8), (24, 20, 18)])
def test_it_solves_as_lapack_does(n: int, m: int, r: int) -> None:
    """Also where as many directions as there are closures have no mass."""
    rng = np.random.default_rng(n)
    root, jacobian, c = rng.standard_normal((n, n)), rng.standard_normal((m, n)), rng.standard_normal(m)
    forces, bias = rng.standard_normal((2, n))
    rows = np.sort(rng.permutation(m)[:r])
    for metric in (root @ root.T, np.diag(np.r_[np.zeros(r), np.ones(n - r)])):
        left = np.block([[metric, jacobian[rows].T], [jacobian[rows], np.zeros((r, r))]])
        right = np.linalg.solve(left, np.r_[forces - bias, -c[rows]])[:n]
        found = solved(SaddlePoint(metric, jacobian, c, forces, bias, rows.copy(), np.arange(n)), rows.tolist())[0]
        limit = 1e-15 * float(np.linalg.cond(left)) * max(1.0, float(np.abs(right).max()))
        np.testing.assert_allclose(found, right, rtol=0, atol=limit)


def test_rows_may_change_and_what_has_no_solution_is_not_finite() -> None:
    jacobian, c = np.array([[1.0, 0.0], [0.0, 1.0], [0.0, 2.0]]), np.array([1.0, 2.0, 6.0])
    saddle = SaddlePoint(np.eye(2), jacobian, c, np.ones(2), np.zeros(2), np.zeros(2, dtype=np.int64), np.arange(2))
    first, other, dependent = solved(saddle, [0, 1], [0, 2], [1, 2])
    np.testing.assert_array_equal(first, [-1, -2])
    np.testing.assert_array_equal(other, [-1, -3])
    assert not np.isfinite(dependent).all()


@pytest.mark.parametrize("held", [[], [2], [0, 3, 5], list(range(6))])
def test_coordinates_that_are_held_have_no_acceleration(held: list[int]) -> None:
    """What is left moves by its own rows and columns."""
    rng = np.random.default_rng(5)
    root, jacobian, c = rng.standard_normal((6, 6)), rng.standard_normal((4, 6)), rng.standard_normal(4)
    forces, bias = rng.standard_normal((2, 6))
    moving = np.setdiff1d(np.arange(6), held)
    rows = np.array([1, 3])[: len(moving)]
    metric, some = root @ root.T, jacobian[np.ix_(rows, moving)]
    left = np.block([[metric[np.ix_(moving, moving)], some.T], [some, np.zeros((len(rows), len(rows)))]])
    right = np.zeros(6)
    right[moving] = np.linalg.solve(left, np.r_[(forces - bias)[moving], -c[rows]])[: len(moving)]
    found = solved(SaddlePoint(metric, jacobian, c, forces, bias, rows.copy(), moving), rows.tolist())[0]
    np.testing.assert_allclose(found, right, rtol=1e-12, atol=1e-12)
    assert not found[held].any()
