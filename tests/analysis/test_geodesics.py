"""Geodesics: motions without forces are straight lines where the metric is flat, and have a constant energy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from exported_models import tree_of

from substructures import Definition, TreeSpec, couple, derive
from substructures.analysis.simulate import Geodesic, simulate
from substructures.errors import InvalidArgument


def test_in_polar_coordinates_they_are_straight_lines() -> None:
    """A mass point on a slider that turns: the plane, whatever springs and gravity there are."""
    definition: dict[str, Any] = {
        "name": "polar",
        "parameters": {"m": {"value": 3, "unit": "kg"}},
        "bodies": [
            {"name": "arm", "parent": "base", "joint": {"type": "revolute", "coordinate": "phi"}, "mass": 0},
            {
                "name": "slider",
                "parent": "arm",
                "joint": {
                    "type": "prismatic",
                    "coordinate": "r",
                    "placement": {"position": [0, 0, 0]},
                    "axis": [1, 0, 0],
                },
                "mass": "m",
            },
        ],
        "loads": [{"type": "joint", "coordinate": "r", "force": "-9*r - 2*r'"}],
    }
    spec = TreeSpec.read(
        {"name": "t", "gravity": [0, "-9.81", 0], "instances": [{"name": "p", "definition": definition}]}
    )
    model = couple(spec, {"p": derive(Definition.read(definition))})
    found = simulate(model, [0.3, 1.0], (0, 2), qd=[0.5, -0.2], kind=Geodesic())
    phi, r = found.q.T
    place = r * np.exp(1j * phi)
    velocity = (found.qd[0, 1] + 1j * r[0] * found.qd[0, 0]) * np.exp(1j * phi[0])
    np.testing.assert_allclose(place, place[0] + velocity * found.t, atol=1e-9)
    assert found.is_right
    forced = simulate(model, [0.3, 1.0], (0, 2), qd=[0.5, -0.2])
    assert np.abs(forced.q[-1] - found.q[-1]).max() > 0.1


def test_faster_on_the_same_line() -> None:
    """A geodesic is a line of the space: twice as fast, it is at the same places in half of the time."""
    model = tree_of("scara")
    q, qd = [0.1, 0.4, -0.1, 0.2], np.array([0.5, -0.3, 0.1, 0.7])
    slow = simulate(model, q, (0, 2), qd=qd, kind=Geodesic())
    fast = simulate(model, q, (0, 1), qd=2 * qd, kind=Geodesic())
    np.testing.assert_allclose(fast.q, slow.q, atol=1e-8)
    energy = slow.series["energy"]
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)


def test_what_acts_is_refused() -> None:
    with pytest.raises(InvalidArgument, match="no forces"):
        simulate(tree_of("acrobot"), [0, 0], (0, 1), inputs={"tau.i0.q1": 1}, kind=Geodesic())
