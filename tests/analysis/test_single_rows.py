"""Closures of one row, whose Jacobian has the condition 1 wherever it vanishes: partition, dead centres."""

from __future__ import annotations

import numpy as np
import pytest
from closed_trees import parallelogram, slides

from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import ClosedMotion, simulate

from .closed_motions import METHODS, right


@pytest.mark.parametrize("method", METHODS)
def test_a_mass_on_a_rod_goes_round_with_constant_speed(method: str) -> None:
    """x = cos 2t, y = sin 2t, through the positions where x, then y, says nothing about the other."""
    motion = simulate(slides(), [1, 0], (0, 4), qd=[0, 2], kind=ClosedMotion(reduction=method))
    right(motion)
    expected = np.stack([np.cos(2 * motion.t), np.sin(2 * motion.t)], axis=1)
    np.testing.assert_allclose(motion.q, expected, atol=1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_the_dead_centre_of_a_parallelogram_is_not_passed(method: str) -> None:
    """Stretched out both derivatives of the rod's length are zero, and the cranks may go on in opposite directions."""
    motion = simulate(parallelogram(), [-0.5, -0.5], (0, 1), qd=[2, 2], kind=ClosedMotion(reduction=method))
    assert motion.status == "failed"
    assert "dead centre" in motion.message
    np.testing.assert_allclose(motion.t[-1], 0.25, atol=1e-3)


@pytest.mark.parametrize("angle", [0, 1e-10, 1e-9])
def test_beside_a_dead_centre_a_single_row_has_no_rank(angle: float) -> None:
    place = loop_state(parallelogram(), [angle, angle]).mobility
    assert (place.rank, place.singular) == (0, True)
    bent = loop_state(parallelogram(), [0.4, 0.4]).mobility
    assert (bent.rank, bent.singular) == (1, False)
