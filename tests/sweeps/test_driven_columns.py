"""Columns of trees with given motions: what drives need, and what no column can be of."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from substructures import Outputs, simulate
from substructures.ensembles.columns import MotionColumn
from substructures.ensembles.ensemble import simulate_ensemble
from substructures.errors import InvalidInput
from substructures.quantities.sources import Sources
from substructures.sweeps.optimum import optimal_parameters
from tests.sweeps.test_optimum import aim, sources_of

PART: dict[str, Any] = {
    "name": "lift",
    "bodies": [
        {"name": "deck", "parent": "base", "mass": 2, "joint": {"type": "prismatic", "coordinate": "z"}},
        {"name": "rod", "parent": "deck", "mass": 1, "com": [0, 1, 0],
         "joint": {"type": "revolute", "coordinate": "q", "theta": "-pi/2"}},
    ],
    "ports": [{"name": "tip", "body": "rod", "position": [0, 1, 0]}],
}  # fmt: skip


def shaken(motion: Any = "A*sin(w*t)") -> Sources:
    tree = {
        "name": "t",
        "gravity": [0, 0, -10],
        "parameters": {"A": {"value": 0.1}, "w": {"value": 2}},
        "instances": [{"name": "a", "substructure": "lift"}],
        "driven": {"a.z": motion},
    }
    return sources_of(tree, PART)


def at(quantity: str, of: Any, t: float = np.pi / 4) -> dict[str, Any]:
    return {"quantity": quantity, "of": of, "over": {"q": [0], "qdd": [0], "t": t}}


def test_forces_of_drives_are_placed() -> None:
    """m (g + s'') = 3 (10 - 4 A) at the top, hanging; Gamma_a00 and g_00 of the same motion."""
    columns = {"lift": at("drive_forces", "a.z"), "own": at("Gamma_a00", "a.q"), "twice": at("g_00", None, 0)}
    found = optimal_parameters(shaken(), aim("(lift - 27)^2", {"A": (0, 1)}, columns))
    assert found.is_right
    assert found.parameters["A"] == pytest.approx(0.25, rel=1e-6)
    assert found.columns["twice"] == pytest.approx(3 * (0.25 * 2) ** 2, rel=1e-6)


def test_reach_is_of_what_drives_do_not_change() -> None:
    own = {"r": {"analysis": "reach", "of": "a.tip", "about": "a.deck"}}
    for motion in ("A*sin(w*t)", {"input": True}):
        found = optimal_parameters(shaken(motion), aim("r + A", {"A": (0.5, 1)}, own))
        assert (found.value, found.is_right) == (pytest.approx(1.5), True)
        with pytest.raises(InvalidInput, match="'driven'") as caught:
            optimal_parameters(shaken(motion), aim("r", {"A": (0.5, 1)}, {"r": {"analysis": "reach", "of": "a.tip"}}))
        assert [(f.pointer, f.code) for f in caught.value.faults] == [("/columns/r/of", "not-steady")]


@pytest.mark.parametrize(
    ("columns", "more", "pointer", "code"),
    [
        ({"x": {"quantity": "closure.residual", "over": {"q": [0]}}}, {}, "/columns/x/quantity", "not-of-tree"),
        ({"x": {"quantity": "limits"}}, {}, "/columns/x/quantity", "not-of-tree"),
        ({"x": "1", "pi": "2*A"}, {}, "/columns/pi", "reserved-name"),
        ({"x": "A"}, {"B/1": 3}, "/parameters/B~11", "unknown-parameter"),
    ],
)
def test_bad_input(columns: dict[str, Any], more: dict[str, float], pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        optimal_parameters(shaken(), aim("x", {"A": (0, 1)}, columns), more)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


def test_bounds_are_not_too_far_apart() -> None:
    with pytest.raises(InvalidInput, match="too far apart"):
        optimal_parameters(shaken(), aim("A", {"A": (-1e308, 1e308)}, {"mass": "mass"}))


def test_members_have_quantities_of_drives() -> None:
    columns = {"more": MotionColumn(quantity="g_00", take="largest"), "none": MotionColumn(quantity="limits", of="a.q")}
    found = simulate_ensemble(shaken(), [[0.1], [0.2]], (0, 1), columns={"more": columns["more"]})
    assert found.columns["more"] == pytest.approx([3 * 0.04] * 2, rel=1e-6)
    with pytest.raises(InvalidInput) as caught:
        simulate_ensemble(shaken(), [[0.1], [0.2]], (0, 1), columns=columns)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [("/columns/none/quantity", "not-of-tree")]


def test_members_have_forces_of_drives() -> None:
    """At the accelerations of the motion."""
    columns = {
        name: MotionColumn(quantity="drive_forces", of="a.z", take=take)
        for name, take in (("first", "largest"), ("last", "end"))
    }
    found = simulate_ensemble(shaken("t^2"), [[0.0], [np.pi]], (0, 1), columns=columns)
    # hangs, or stands: 3 (g + s'')
    assert found.columns["first"] == pytest.approx([36.0, 36.0], rel=1e-8)
    turned = simulate_ensemble(shaken("t^2"), [[0.3]], (0, 0.5), columns=columns)
    alone = simulate(shaken("t^2").model, [0.3], (0, 0.5), outputs=Outputs(count=2))
    q, qd = alone.q[-1, 0], alone.qd[-1, 0]
    # m_2 at z - cos q: (m_1 + m_2)(g + s'') + m_2 (sin q q'' + cos q q'^2), q'' = -(g + s'') sin q
    expected = 36 - 12 * np.sin(q) ** 2 + np.cos(q) * qd**2
    assert turned.columns["last"] == pytest.approx([expected], rel=1e-6)
