"""Periodic orbits by the time of their return to a section, beside closed forms and SciPy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from substructures.analysis.orbits.periodic import Section, Shooting, periodic_orbits
from substructures.errors import InvalidInput
from substructures.tree.model import Model

from .orbit_trees import slider, tree_of

G = 9.81


@pytest.fixture(scope="module")
def pendulum() -> Model:
    return tree_of("simple-pendulum")


@pytest.mark.parametrize("hold", [(), ("p.q1",)])
def test_the_time_of_return_of_a_pendulum(pendulum: Model, hold: tuple[str, ...]) -> None:
    """T = 4 sqrt(l/g) K(sin^2(a/2)) from where it turns; at the second return twice as long."""
    expected = 4 * np.sqrt(1 / G) * ellipk(np.sin(0.5) ** 2)
    for count in (1, 2):
        section = Section("p.q1'", direction="falling", count=count)
        (orbit,) = periodic_orbits(pendulum, [1.0], Shooting(None, hold=hold, section=section)).found
        assert orbit.is_right
        assert orbit.period == pytest.approx(count * expected, rel=1e-9)
        np.testing.assert_allclose([*orbit.q, *orbit.qd], [1, 0], atol=1e-9)
        assert "section" in [check.name for check in orbit.checks]


def test_a_limit_cycle_from_a_section() -> None:
    """Van der Pol's x'' - (1 - x^2) x' + x = 0 beside SciPy: its period, amplitude, multiplier exp int 1 - x^2 dt."""
    parameters = {"u": {"value": 1, "unit": "N/m"}, "m": {"value": 1, "unit": "N s/m"}}
    parameters |= {"l": {"value": 1, "unit": "m"}}
    bodies = [{**slider("x", "base", [1, 0, 0]), "mass": 1}]
    loads = [{"type": "joint", "coordinate": "x", "force": "m*(1 - (x/l)^2)*x' - u*x"}]
    model = tree_of({"name": "cycle", "parameters": parameters, "bodies": bodies, "loads": loads})
    section = Section("p.x'", direction="falling")
    (orbit,) = periodic_orbits(model, [1.5], Shooting(None, section=section)).found

    def rate(_: float, z: Any) -> Any:
        return [z[1], (1 - z[0] ** 2) * z[1] - z[0], 1 - z[0] ** 2]

    def crossed(_: float, z: Any) -> float:
        return float(z[1])

    crossed.direction = -1  # type: ignore[attr-defined]
    other = solve_ivp(rate, (0, 60), [2, 0, 0], method="DOP853", events=crossed, rtol=1e-12, atol=1e-14)
    before, last = other.y_events[0][-2:]
    assert (orbit.status, orbit.is_right, orbit.stability) == ("finished", True, "stable")
    assert orbit.period == pytest.approx(other.t_events[0][-1] - other.t_events[0][-2], rel=1e-9)
    np.testing.assert_allclose([*orbit.q, *orbit.qd], [last[0], 0], atol=1e-9)
    assert orbit.multipliers[1] == pytest.approx(np.exp(last[2] - before[2]), rel=1e-5)


def test_what_does_not_return(pendulum: Model) -> None:
    (orbit,) = periodic_orbits(pendulum, [0.4], Shooting(None, section=Section("p.q1", 1.0, duration=3))).found
    assert (orbit.status, orbit.is_right) == ("failed", None)
    assert "it meets the section 0 times where 2 are needed" in orbit.message
    section = Section("p.q1", -1.0, "falling", 1, 3)
    for bad, pointer in (({"level": np.nan}, "level"), ({"direction": "both"}, "direction"), ({"count": 0}, "count")):
        with pytest.raises(InvalidInput) as caught:
            replace(section, **bad)
        assert caught.value.faults[0].pointer == f"/section/{pointer}"
