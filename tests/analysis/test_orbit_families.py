"""Families of periodic orbits by arclength: the bent resonance of Duffing's oscillator."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from substructures.analysis.continuation import Continuation
from substructures.analysis.orbits.orbit import Family
from substructures.analysis.orbits.periodic import Shooting, periodic_orbits
from substructures.errors import InvalidInput
from substructures.tree.model import Model

from .orbit_trees import slider, tree_of

F, D = 0.1, 0.1


def forced(cubic: str) -> Model:
    """x'' + d x' + x + c x^3 = F cos(w t)"""
    parameters = {"d": {"value": "0.1", "unit": "N s/m"}, "w": {"value": "0.5", "unit": "rad/s"}}
    parameters |= {"k": {"value": 1, "unit": "N/m"}, "c": {"value": cubic, "unit": "N/m^3"}}
    bodies = [{**slider("x", "base", [1, 0, 0], damping="d"), "mass": 1}]
    loads = [
        {"type": "potential", "potential": "k*x^2/2 + c*x^4/4"},
        {"type": "joint", "coordinate": "x", "force": "0.1*cos(w*t)"},
    ]
    return tree_of({"name": "forced", "parameters": parameters, "bodies": bodies, "loads": loads})


@pytest.fixture(scope="module")
def bent() -> Family:
    given: Any = {"vary": "p.w", "between": (0.8, 1.8), "steps": 8}
    return periodic_orbits(forced("1"), [0.3], Shooting("2*pi/p.w"), **given)


def test_folds_of_duffings_oscillator(bent: Family) -> None:
    """A multiplier is +1 there; about where the amplitude a of one harmonic, (1 + 3/4 a^2 - w^2)^2 + d^2 w^2 =
    F^2 / a^2, is vertical over w (I. Kovacic and M. J. Brennan, The Duffing Equation, 2011, chapter 5).
    """
    assert (bent.message, bent.is_right) == ("", True)
    assert [one.kind for one in bent.bifurcations] == ["fold", "fold"]
    a = np.linspace(0.05, 1.2, 100_001)
    middle = 1 + 0.75 * a**2 - D**2 / 2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(F**2 / a**2 - D**2 * (1 + 0.75 * a**2 - D**2 / 4))
        branches = [w[np.isfinite(w)] for w in (np.sqrt(middle + root), np.sqrt(middle - root))]
    turns = [float(w[1:-1][extreme]) for w in branches for extreme in np.flatnonzero(np.diff(np.sign(np.diff(w))))]
    found = sorted(one.at.value or 0.0 for one in bent.bifurcations)
    np.testing.assert_allclose(found, sorted(turns), rtol=0.03)
    for one in bent.bifurcations:
        assert np.abs(one.at.multipliers - 1).min() < 1e-4
        assert np.prod(one.at.multipliers).real == pytest.approx(np.exp(-one.at.period * D), rel=1e-6)


def test_three_orbits_at_one_value(bent: Family) -> None:
    """Each comes back by SciPy; stable ones lie before the first and behind the second fold."""
    turned = [k for k in range(1, len(bent.found)) if bent.found[k].stability != bent.found[k - 1].stability]
    assert [bent.found[k].stability for k in (0, *turned)] == ["stable", "unstable", "stable"]
    values = np.array([orbit.value for orbit in bent.found], dtype=float)
    side = np.sign(values - np.mean([one.at.value or 0.0 for one in bent.bifurcations]))
    assert np.count_nonzero(np.diff(side)) == 3
    for orbit in bent.found[:: len(bent.found) // 5]:

        def rate(t: float, z: Any, w: float = orbit.value or 0.0) -> Any:
            return [z[1], F * np.cos(w * t) - D * z[1] - z[0] - z[0] ** 3]

        start = [*orbit.q, *orbit.qd]
        other = solve_ivp(rate, (0, orbit.period), start, method="DOP853", rtol=1e-12, atol=1e-13)
        np.testing.assert_allclose(other.y[:, -1], start, atol=1e-8)


def test_rest_that_is_shaken_awakes_with_twice_the_period() -> None:
    """x'' + d x' + (1 + 0.2 cos 2t) x = 0: a multiplier is -1 where it is of Mathieu's equation, near d = 0.1."""
    bodies = [{**slider("x", "base", [1, 0, 0], damping="d"), "mass": 1}]
    loads = [{"type": "potential", "potential": "(1 + s)*x^2/2"}]
    known = {"parameters": {"d": {"value": "0.2", "unit": "N s/m"}}, "inputs": {"s": {"unit": "N/m"}}}
    model = tree_of({"name": "mathieu", "bodies": bodies, "loads": loads, **known})
    given: Any = {"inputs": {"p.s": "0.2*cos(2*t)"}, "vary": "p.d", "between": (0.2, 0.05), "steps": 5}
    found = periodic_orbits(model, [0.0], Shooting(np.pi), **given)
    assert found.is_right
    np.testing.assert_allclose([orbit.value for orbit in found.found], np.linspace(0.2, 0.05, 6), rtol=1e-12)
    (doubled,) = found.bifurcations
    assert (doubled.kind, doubled.at.value) == ("period-doubling", pytest.approx(0.1, rel=1e-3))

    def beyond(d: float) -> float:
        """1 + tr M + det M, zero where an eigenvalue of the monodromy matrix M is -1."""
        rate: Any = lambda t, z: [z[1], -d * z[1] - (1 + 0.2 * np.cos(2 * t)) * z[0]]  # noqa: E731
        M = np.array([solve_ivp(rate, (0, np.pi), e, rtol=1e-12, atol=1e-13).y[:, -1] for e in np.eye(2)])  # noqa: N806
        return float(1 + np.trace(M) + np.linalg.det(M))

    assert doubled.at.value == pytest.approx(brentq(beyond, 0.09, 0.11), rel=1e-7)
    stable = [orbit.stability == "stable" for orbit in found.found]
    assert stable == [(orbit.value or 0.0) > doubled.at.value for orbit in found.found]


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
def test_bad_ranges(given: Any, pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        periodic_orbits(forced("1"), [0.3], Shooting(1), **given)
    assert caught.value.faults[0].pointer == pointer


@pytest.mark.parametrize("given", [{"between": (0.5, 1.5), "steps": 3}, {"values": [0.5, 0.9, 1.1, 1.5]}])
def test_resonance_over_the_frequency(given: Any) -> None:
    """The period follows: F / (k - w^2 + i d w) is the orbit, exp of the eigenvalues times the period multiply."""
    found = periodic_orbits(forced("0"), [0.1], Shooting("2*pi/p.w"), vary="p.w", **given)
    assert (found.is_right, found.message) == (True, "")
    assert found.found[-1].value == 1.5
    for orbit in found.found:
        w = orbit.value or 0.0
        assert orbit.period == pytest.approx(2 * np.pi / w, rel=1e-14)
        answer = F / (1 - w**2 + 1j * D * w)
        np.testing.assert_allclose([orbit.q[0], orbit.qd[0]], [answer.real, -w * answer.imag], atol=1e-9)
        expected = np.exp(np.roots([1, D, 1]) * orbit.period)
        np.testing.assert_allclose(np.sort_complex(orbit.multipliers), np.sort_complex(expected), atol=1e-8)


@pytest.mark.parametrize("period", ["2*pi/p.x", "2*pi/q", "-p.w", "2*"])
def test_bad_periods(period: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        periodic_orbits(forced("0"), [0.1], Shooting(period))
    assert caught.value.faults[0].pointer == "/period"


@pytest.mark.parametrize("period", ["2*p.w", "p.w", "pi/p.k", "1 + p.d/p.k^2"])
def test_a_period_that_is_no_time_is_refused(period: str) -> None:
    """Whole numbers and pi have no unit; 6.3 may be metres."""
    with pytest.raises(InvalidInput, match="is no time") as caught:
        periodic_orbits(forced("0"), [0.1], Shooting(period))
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/period", "unit-mismatch")
    for some in ("2*pi/p.w", "6.3*p.w", "2*pi*sqrt(1/p.k)*3.0001", "12"):
        assert Shooting(some).period_at(forced("0"), {}) is not None


def test_changes_are_placed_by_few_equations() -> None:
    """s = x^3 - x + 1/2 turns back at x = -+1/sqrt(3), where an integer changes, too: each place is looked for once."""
    asked: list[np.ndarray] = []

    def equations(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        asked.append(u)
        return np.array([u[0] ** 3 - u[0] + 0.5 - u[1]]), np.array([[3 * u[0] ** 2 - 1, -1.0]])

    curve = Continuation(equations, lambda u: (int(3 * u[0] ** 2 > 1),), 0.1)
    first, last = (np.roots([1, 0, -1, constant])[0].real for constant in (0.5, -0.5))
    points = list(curve.follow(np.array([first, 0.0]), np.array([0.0, 1.0])))
    np.testing.assert_allclose(points[-1][0], [last, 1], atol=1e-12)
    changes = [change for _, some in points for change in some]
    assert [change.which for change in changes] == [0, 1, 0, 1]
    assert all(change.is_placed for change in changes)
    np.testing.assert_allclose([change.u[0] for change in changes], np.repeat([-1, 1], 2) / np.sqrt(3), atol=1e-7)
    # 24 halvings of two places by two equations, and five for a point; 723 where each was found from the tangent
    assert len(asked) < 24 * 2 * 3 + 8 * len(points)
