"""Closed mechanisms of any size: the same angles, whatever the unit of length."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import at, bricard, closed_entry
from random_trees import Plain
from simulated import simulated

from substructures import Model
from substructures.analysis.closed.loops import loop_state

from .closed_motions import METHODS, right

LENGTHS = {"l0": 0.4, "l1": 0.1, "l2": 0.35, "l3": 0.25}
PIN: Plain = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}


def four_bar(size: float) -> Model:
    return closed_entry("four-bar", [PIN], **{name: x * size for name, x in LENGTHS.items()})


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [1e-9, 1e-4, 1e3])
def test_a_four_bar_of_nanometres(method: Any, size: float) -> None:
    """Freudenstein's equation (Trans. ASME 77, 1955) holds as well as for metres: residuals count beside lengths."""
    model = four_bar(size)
    request = {"qd": at(model, crank=9), "fixed": ["x.crank"], "reduction": method}
    motion = simulated(model, at(model, crank=0.7, coupler=0.2, rocker=1.2), (0, 0.2), count=11, **request)
    right(motion)
    l0, l1, l2, l3 = LENGTHS.values()
    crank, _, rocker = motion.q.T
    left = l0 / l1 * np.cos(rocker) - l0 / l3 * np.cos(crank) + (l1**2 - l2**2 + l3**2 + l0**2) / (2 * l1 * l3)
    np.testing.assert_allclose(left, np.cos(crank - rocker), atol=1e-11)


@pytest.mark.parametrize("size", [1e-10, 1e-4])
def test_a_small_spatial_loop_has_the_rank_of_a_large_one(size: float) -> None:
    """Rows in metres beside rows of directions: one degree of freedom and one redundant row."""
    a = 1.9
    b = np.arccos(-np.cos(a) / (1 + np.cos(a)))
    found, large = (loop_state(bricard(size=x), [a, b, a, b, a], fixed=["l0.q"]) for x in (size, 1.0))
    assert found.message == ""
    assert found.mobility == large.mobility
    # m l^2 q'' = m g l: accelerations go with 1/l, forces stay, moments go with l
    np.testing.assert_allclose(found.qdd * size, large.qdd, rtol=1e-6, atol=1e-6)
    np.testing.assert_allclose(found.consistent.q, large.consistent.q, atol=1e-9)
