"""Which of several modes comes first, and the sign of their shapes, where rounding must not decide."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from substructures.analysis.stability.vibrations import modes

#: matrices M, D, K with ties: +-k of a saddle beside vibrations, gyroscopes, equal frequencies, critical damping
TIES: dict[str, tuple[Any, Any, Any, list[complex]]] = {
    "saddle": (np.eye(2), [[0, 0], [0, 0]], [[-4, 1], [-1, 1]], []),
    "two saddles": (np.diag([1, 2]), np.zeros((2, 2)), [[-4, 0.5], [-0.5, -9]], []),
    "gyroscope": (np.eye(2), [[0, 1], [-1, 0]], [[-4, 0], [0, -1]], []),
    "damped beside a saddle": (np.eye(3), np.diag([0, 0, 0.5]), np.diag([-4, 4, 4]), []),
    "critical damping": (np.eye(1), [[2]], [[1]], [-1, -1]),
    "free": (np.eye(2), np.diag([0, 1.0]), np.diag([0, 5.0]), []),
}


@pytest.mark.parametrize("name", TIES)
def test_the_order_of_modes_does_not_hang_on_rounding(name: str) -> None:
    """The same kinds of eigenvalues in the same order after relative changes of 1e-15 in all matrices."""
    M, D, K, expected = TIES[name]
    rng = np.random.default_rng(7)
    seen = set()
    for _ in range(60):
        given = [np.asarray(x, dtype=float) * (1 + 1e-15 * rng.uniform(-1, 1, np.shape(x))) for x in (M, D, K)]
        values = [mode.eigenvalue for mode in modes((given[0] + given[0].T) / 2, given[1], given[2])]
        seen.add(tuple((round(z.real, 5) + 0.0, round(z.imag, 5) + 0.0) for z in values))
        sizes = [abs(z) for z in values]
        np.testing.assert_allclose(sizes, sorted(sizes), rtol=1e-8, atol=1e-6)
    assert len(seen) == 1, seen
    (found,) = seen
    assert not expected or [complex(*z) for z in found] == expected


def test_opposite_eigenvalues_are_in_the_order_of_their_real_parts() -> None:
    """x'' = 4 x beside y'' = -4 y - y'/2, turned by a rotation: -2, then 2; the same without the damper."""
    c, s = 0.6, 0.8
    turn = np.array([[c, s], [-s, c]])
    for damper in (0.0, 0.5):
        D, K = (turn @ np.diag(x) @ turn.T for x in ((0, damper), (-4, 4)))
        real = [round(mode.eigenvalue.real, 6) for mode in modes(np.eye(2), D, K)]
        assert real == ([-2, 0, 2] if not damper else [-2, -0.25, 2])


def test_the_first_of_the_largest_elements_of_a_shape_is_one() -> None:
    """Two pendulums with a spring between them swing together, or against each other."""
    rng = np.random.default_rng(3)
    for _ in range(30):
        K = np.array([[3, -1], [-1, 3]]) + 1e-15 * rng.uniform(-1, 1, (2, 2))
        together, apart = modes(np.eye(2), np.zeros((2, 2)), (K + K.T) / 2)
        np.testing.assert_allclose(together.shape, [1, 1], atol=1e-12)
        np.testing.assert_allclose(apart.shape, [1, -1], atol=1e-12)
