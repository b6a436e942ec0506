"""Families of periodic orbits by arclength: the bent resonance of Duffing's oscillator."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from orbit_trees import slider, tree_of
from scipy.integrate import solve_ivp

from substructures.analysis.orbits.orbit import Family
from substructures.analysis.orbits.periodic import Shooting, periodic_orbits
from substructures.errors import InvalidInput
from substructures.tree.model import Model

F, D = 0.1, 0.1


@pytest.fixture(scope="module")
def duffing() -> Model:
    """x'' + d x' + k x + x^3 = F cos t"""
    parameters = {"d": {"value": "0.1", "unit": "N s/m"}, "k": {"value": 1, "unit": "N/m"}}
    parameters |= {"w": {"value": 1, "unit": "N/m^3"}}
    bodies = [{**slider("x", "base", [1, 0, 0], damping="d"), "mass": 1}]
    loads = [{"type": "potential", "potential": "k*x^2/2 + w*x^4/4"}]
    return tree_of({"name": "duffing", "parameters": parameters, "bodies": bodies, "loads": loads})


@pytest.fixture(scope="module")
def bent(duffing: Model) -> Family:
    given: Any = {"inputs": {"tau.p.x": "0.1*cos(t)"}, "vary": "p.k", "between": (1.2, 0.1), "steps": 10}
    return periodic_orbits(duffing, [0.3], Shooting(2 * np.pi), **given)


def test_folds_of_duffings_oscillator(bent: Family) -> None:
    """A multiplier is +1 there; about where the amplitude a of one harmonic, ((k - 1 + 3/4 a^2)^2 + d^2) a^2 = F^2, is
    vertical over k (I. Kovacic and M. J. Brennan, The Duffing Equation, 2011, chapter 5).
    """
    assert (bent.message, bent.is_right) == ("", True)
    assert [one.kind for one in bent.bifurcations] == ["fold", "fold"]
    a = np.linspace(1e-3, F / D, 200_001)[:-1]
    branches = [1 - 0.75 * a**2 + side * np.sqrt((F / a) ** 2 - D**2) for side in (1, -1)]
    turns = [float(k[1:-1][extreme]) for k in branches for extreme in np.flatnonzero(np.diff(np.sign(np.diff(k))))]
    found = sorted(one.at.value or 0.0 for one in bent.bifurcations)
    np.testing.assert_allclose(found, sorted(turns), rtol=0.05)
    for one in bent.bifurcations:
        assert np.abs(one.at.multipliers - 1).min() < 1e-4
        assert np.prod(one.at.multipliers).real == pytest.approx(np.exp(-2 * np.pi * D), rel=1e-6)


def test_three_orbits_at_one_value(bent: Family) -> None:
    """Each comes back by SciPy; stable ones lie before the first and behind the second fold."""
    turned = [k for k in range(1, len(bent.found)) if bent.found[k].stability != bent.found[k - 1].stability]
    assert [bent.found[k].stability for k in (0, *turned)] == ["stable", "unstable", "stable"]
    values = np.array([orbit.value for orbit in bent.found], dtype=float)
    side = np.sign(values - np.mean([one.at.value or 0.0 for one in bent.bifurcations]))
    assert np.count_nonzero(np.diff(side)) == 3
    for orbit in bent.found[:: len(bent.found) // 5]:

        def rate(t: float, z: Any, k: float = orbit.value or 0.0) -> Any:
            return [z[1], F * np.cos(t) - D * z[1] - k * z[0] - z[0] ** 3]

        start = [*orbit.q, *orbit.qd]
        other = solve_ivp(rate, (0, 2 * np.pi), start, method="DOP853", rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(other.y[:, -1], start, atol=1e-8)


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({"vary": "p.k", "between": (1, 1)}, "/between"),
        ({"vary": "p.k", "between": (1, 2), "values": [1]}, "/between"),
        ({"vary": "p.k", "between": (1, 2), "steps": 1}, "/steps"),
        ({"vary": "p.x", "between": (1, 2)}, "/vary"),
        ({"between": (1, 2)}, "/vary"),
    ],
)
def test_bad_ranges(duffing: Model, given: Any, pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        periodic_orbits(duffing, [0.3], Shooting(1), **given)
    assert caught.value.faults[0].pointer == pointer
