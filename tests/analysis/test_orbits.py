"""Periodic orbits and Lyapunov exponents beside closed forms and published numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import ellipk

from substructures import couple, derive
from substructures.analysis.drawings import draw_section
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.variation import Variation
from substructures.analysis.orbits import search
from substructures.analysis.orbits.lyapunov import lyapunov_exponents
from substructures.analysis.orbits.periodic import Section, Shooting, periodic_orbits
from substructures.analysis.orbits.quadrature import period_by_quadrature
from substructures.analysis.orbits.sections import poincare_section
from substructures.errors import InvalidInput
from substructures.tree.model import Model

from .orbit_trees import slider, tree_of

G = 9.81


@pytest.fixture(scope="module")
def pendulum() -> Model:
    return tree_of("simple-pendulum")


@pytest.fixture(scope="module")
def henon_heiles() -> Model:
    """V = (x^2 + y^2)/2 + x^2 y - y^3/3 (M. Henon and C. Heiles, 1964), by masses in a horizontal plane."""
    energy = "u*(x^2 + y^2)/2 + w*(x^2*y - y^3/3)"
    parameters = {"u": {"value": 1, "unit": "N/m"}, "w": {"value": 1, "unit": "N/m^2"}}
    bodies = [slider("x", "base", [1, 0, 0]), {**slider("y", "body_x", [0, 1, 0]), "mass": 1}]
    loads = [{"type": "potential", "potential": energy}]
    return tree_of({"name": "galaxy", "parameters": parameters, "bodies": bodies, "loads": loads})


@pytest.fixture(scope="module")
def duffing() -> Model:
    """x'' + d x' - x + x^3 = F"""
    parameters = {"d": {"value": "0.25", "unit": "N s/m"}, "u": {"value": 1, "unit": "N/m"}}
    parameters |= {"w": {"value": 1, "unit": "N/m^3"}}
    bodies = [{**slider("x", "base", [1, 0, 0], damping="d"), "mass": 1}]
    loads = [{"type": "potential", "potential": "-u*x^2/2 + w*x^4/4"}]
    return tree_of({"name": "duffing", "parameters": parameters, "bodies": bodies, "loads": loads})


def test_periods_of_a_pendulum(pendulum: Model) -> None:
    """T = 4 sqrt(l/g) K(sin^2(a/2))"""
    amplitudes = [0.5, 1.0, 2.0, 2.6]
    shooting = Shooting(2.1, hold=("p.q1'",))
    found = periodic_orbits(pendulum, [0.5], shooting, vary="p.q1", values=amplitudes)
    assert (len(found), found[0]) == (4, found.found[0])
    for orbit, amplitude in zip(found, amplitudes, strict=True):
        expected = 4 * np.sqrt(1 / G) * ellipk(np.sin(amplitude / 2) ** 2)
        assert (orbit.status, orbit.stability, orbit.is_right) == ("finished", "neutral", True), orbit
        assert orbit.period == pytest.approx(expected, rel=1e-9)
        np.testing.assert_allclose(orbit.multipliers, 1, atol=1e-3)
        assert "quadrature" in [check.name for check in orbit.checks]


def test_a_whole_turn_of_a_pendulum(pendulum: Model) -> None:
    """It turns with the rate w_0 at the bottom: T = 2 k/w K(k^2) with k = 2 w/w_0, w = sqrt(g/l)."""
    w, rate = np.sqrt(G), 9.0
    shooting = Shooting(0.9, hold=("p.q1", "p.q1'"), turns={"p.q1": 1})
    (orbit,) = periodic_orbits(pendulum, [0.0], shooting, qd=[rate]).found
    k = 2 * w / rate
    assert orbit.period == pytest.approx(2 * k / w * ellipk(k**2), rel=1e-9)
    assert orbit.is_right
    assert "quadrature" in [check.name for check in orbit.checks]


def test_periods_of_duffings_oscillator(duffing: Model) -> None:
    """Without damping x = a cn about both wells, T = 4 K(k^2)/sqrt(a^2 - 1) with k^2 = a^2/(2 (a^2 - 1)), and a dn in
    one, T = 2 sqrt(2) K(k^2)/a with k^2 = 2 - 2/a^2 (I. Kovacic and M. J. Brennan, The Duffing Equation, 2011).
    """
    for a, guess in ((1.8, 4.5), (3.0, 2.7), (1.3, 4.7), (1.05, 4.45)):
        orbit = periodic_orbits(duffing, [a], Shooting(guess, hold=("p.x", "p.x'")), parameters={"p.d": 0}).found[0]
        about_both, in_one = (a**2 / (2 * (a**2 - 1)), 4 / np.sqrt(a**2 - 1)), (2 - 2 / a**2, 2 * np.sqrt(2) / a)
        m, factor = about_both if np.sqrt(2) < a else in_one
        assert orbit.period == pytest.approx(factor * ellipk(m), rel=1e-9)
        assert orbit.is_right
        by_energy = period_by_quadrature(duffing, {"p.d": 0, "p.u": 1, "p.w": 1, "t": 0}, orbit.trajectory)
        assert by_energy == pytest.approx(factor * ellipk(m), rel=1e-12)


def test_a_wrong_period_is_seen(pendulum: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the quadrature; a period of several swings is none."""
    shooting = Shooting(2.1, hold=("p.q1'", "p.q1"))
    (once,) = periodic_orbits(pendulum, [1.0], shooting).found
    (twice,) = periodic_orbits(pendulum, [1.0], replace(shooting, period=2 * once.period)).found
    assert twice.period == pytest.approx(2 * once.period, rel=1e-9)
    assert twice.is_right
    monkeypatch.setattr(search, "period_by_quadrature", lambda *_: once.period * (1 + 1e-6))
    (wrong,) = periodic_orbits(pendulum, [1.0], shooting).found
    assert wrong.is_right is False
    assert [check.name for check in wrong.checks if not check.holds] == ["quadrature"]


def test_forced_and_damped(duffing: Model) -> None:
    """A stable and an unstable orbit of the period of the force; det M = exp(-d T)."""
    force = {"tau.p.x": "0.1*cos(2*t)"}
    stable, unstable = (periodic_orbits(duffing, [x], Shooting(np.pi), inputs=force).found[0] for x in (1.0, 0.0))
    assert (stable.stability, unstable.stability) == ("stable", "unstable")
    for orbit in (stable, unstable):
        assert orbit.is_right
        assert orbit.period == np.pi
        assert np.prod(orbit.multipliers).real == pytest.approx(np.exp(-0.25 * np.pi), rel=1e-6)


def test_chaos_and_order_of_henon_and_heiles(henon_heiles: Model) -> None:
    """The largest exponent of the chaotic sea at E = 1/6 is about 0.13, and none at E = 1/12 (Benettin et al. 1976)."""
    found = {}
    for energy, y, duration in ((1 / 6, -0.15, 600), (1 / 12, 0.1, 1000)):
        speed = np.sqrt(2 * (energy - y**2 / 2 + y**3 / 3))
        found[energy] = lyapunov_exponents(henon_heiles, [0, y], duration, qd=[0.9 * speed, np.sqrt(0.19) * speed])
    wild, calm = found[1 / 6], found[1 / 12]
    assert (wild.character, calm.character) == ("chaotic", "regular")
    assert wild.is_right
    assert calm.is_right
    assert abs(wild.exponents[0] - 0.128) < 5 * wild.deviations[0] + 0.01
    for each in found.values():  # of a Hamiltonian system in pairs
        np.testing.assert_allclose(each.exponents + each.exponents[::-1], 0, atol=2 * each.deviations.max() + 1e-3)


def section_of(model: Model, energy: float, y: float, count: int) -> Any:
    """x = 0, x' > 0"""
    speed = np.sqrt(2 * (energy - y**2 / 2 + y**3 / 3))
    start: Any = {"qd": [0.9 * speed, np.sqrt(0.19) * speed], "count": count}
    return poincare_section(model, [0, y], "p.x", 20 * count, **start)


def test_a_section_of_henon_and_heiles(henon_heiles: Model) -> None:
    """Beside an integration by SciPy; all points have the energy."""
    found = section_of(henon_heiles, 1 / 12, 0.1, 10)
    assert (found.status, found.is_right, found.message) == ("finished", True, "")

    def rate(_: float, z: Any) -> Any:
        x, y, u, v = z
        return [u, v, -x - 2 * x * y, -y - x * x + y * y]

    def crossed(_: float, z: Any) -> float:
        return float(z[0])

    crossed.direction = 1  # type: ignore[attr-defined]
    speed = np.sqrt(2 * (1 / 12 - 0.1**2 / 2 + 0.1**3 / 3))
    start = [0, 0.1, 0.9 * speed, np.sqrt(0.19) * speed]
    options: Any = {"method": "DOP853", "events": crossed, "rtol": 1e-12, "atol": 1e-14}
    other = solve_ivp(rate, (0, found.t[-1] + 1e-3), start, **options)
    np.testing.assert_allclose(found.t, other.t_events[0][-10:], rtol=1e-8)
    np.testing.assert_allclose(np.hstack([found.q, found.qd]), other.y_events[0][-10:], atol=1e-7)


def test_what_a_section_holds_is_drawn_as_one_number(pendulum: Model) -> None:
    """Crossings of q = 0 are found up to rounding, of which no axis is made."""
    found = poincare_section(pendulum, [0.5], "p.q1", 20)
    assert 0 < np.ptp(found.q) < 1e-9
    drawn = draw_section(found, pendulum.joints)
    assert drawn.count("<circle") == len(found.t) > 3
    assert "e-1" not in drawn


def test_order_and_chaos_are_seen_in_sections(henon_heiles: Model) -> None:
    """A curve at E = 1/12, an area at E = 1/6 (M. Henon and C. Heiles, 1964, figures 4 and 6)."""
    boxes = []
    for energy, y in ((1 / 12, 0.1), (1 / 6, -0.15)):
        found = section_of(henon_heiles, energy, y, 300)
        assert found.is_right
        (x, y_), (u, v) = found.q.T, found.qd.T
        energies = (u**2 + v**2 + x**2 + y_**2) / 2 + x**2 * y_ - y_**3 / 3
        np.testing.assert_allclose(energies, energy, atol=1e-8)
        assert np.abs(x).max() < 1e-10
        assert u.min() > 0
        boxes.append(len({tuple(box) for box in np.floor(20 * np.column_stack([y_, v])).astype(int).tolist()}))
    assert boxes[0] < 60
    assert boxes[1] > 180


def test_once_a_period_of_a_driven_pendulum(pendulum: Model) -> None:
    """Its section comes to a point, which the linear response is near to."""
    forced: Any = {"inputs": {"tau.p.q1": "0.5*cos(2*t) - 1.5*p.q1'"}}
    found = poincare_section(pendulum, [0.4], "sin(2*t)", 100, **forced, count=25)
    np.testing.assert_allclose(found.t, np.pi * np.arange(1, 26), rtol=1e-10)
    np.testing.assert_allclose(found.q[-1], found.q[-2], atol=1e-8)
    # q'' + 1.5 q' + 9.81 q = 0.5 cos 2 t, but for terms of third order
    phase = 0.5 / (G - 4 + 3j)
    np.testing.assert_allclose(found.q[-1], phase.real, rtol=1e-2)
    assert found.is_right


def test_a_section_that_is_not_met(pendulum: Model) -> None:
    found = poincare_section(pendulum, [0.4], "p.q1", 3, level=1.0)
    assert (len(found.t), found.q.shape, found.status) == (0, (0, 1), "finished")
    assert found.message == "the section is met 0 times in 3 s"
    found = poincare_section(pendulum, [0.4], "p.q1", 3, direction="both")
    assert found.message == "the section is met 3 times in 3 s"
    for given, pointer in (({"count": 0}, "/count"), ({"direction": "up"}, "/direction"), ({"level": "x"}, "/level")):
        with pytest.raises(InvalidInput) as caught:
            poincare_section(pendulum, [0.4], "p.q1", 3, **given)
        assert caught.value.faults[0].pointer == pointer
    with pytest.raises(InvalidInput) as caught:
        poincare_section(pendulum, [0.4], "p.q7", 3)
    assert caught.value.faults[0].pointer == "/quantity"


def test_a_section_of_a_drifting_motion_is_not_right(henon_heiles: Model) -> None:
    rough = Integrator(relative_tolerance=1e-3, absolute_tolerance=1e-4)
    assert poincare_section(henon_heiles, [0, 0.1], "p.x", 100, qd=[0.3, 0.1], integrator=rough).is_right is False


def test_exponents_add_up_to_the_damping(duffing: Model) -> None:
    found = lyapunov_exponents(duffing, [0.5], 200, inputs={"tau.p.x": "0.4*cos(t)"}, transient=20)
    assert found.exponents.sum() == pytest.approx(-0.25, abs=1e-6)
    assert found.is_right


def test_a_wrong_derivative_is_seen(duffing: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    right = Variation.__call__

    def wrong(self: Any, t: float, flat: Any) -> Any:
        found = right(self, t, flat)
        found[3:] *= 1.01  # of S, not of x
        return found

    monkeypatch.setattr(Variation, "__call__", wrong)
    exponents = lyapunov_exponents(duffing, [0.5], 20, inputs={"tau.p.x": "0.4*cos(t)"})
    assert exponents.is_right is False
    (orbit,) = periodic_orbits(duffing, [1.0], Shooting(np.pi), inputs={"tau.p.x": "0.1*cos(2*t)"}).found
    assert orbit.is_right is not True


def test_what_is_no_orbit(pendulum: Model) -> None:
    (orbit,) = periodic_orbits(pendulum, [0.3], Shooting(0.2, is_fixed=True, hold=("p.q1",))).found
    assert (orbit.status, orbit.is_right, orbit.stability) == ("failed", None, "unknown")
    assert orbit.message


def test_rest_is_no_orbit() -> None:
    """Every time is a period of an equilibrium; the mass centre on the axis of symmetry makes no scale of rounding."""
    instance = {"name": "x", "substructure": "cart-pendulum"}
    model = couple({"name": "t", "gravity": [0, 0, -9.81], "instances": [instance]}, {"x": derive("cart-pendulum")})
    (orbit,) = periodic_orbits(model, [0, 0.3], Shooting(1.5, hold=("x.q0", "x.q0'", "x.q1'"))).found
    assert orbit.q[1] == pytest.approx(np.pi)
    assert (orbit.status, orbit.is_right, orbit.stability) == ("failed", None, "unknown")
    assert "comes to rest at an equilibrium" in orbit.message
    assert all(check.holds for check in orbit.checks)


@pytest.mark.parametrize(
    ("shooting", "given", "pointer"),
    [
        (Shooting(1, hold=("p.q9",)), {}, "/hold/0"),
        (Shooting(1, turns={"p.x": 1}), {}, "/turns/p.x"),
        (Shooting(1), {"vary": "p.mass"}, "/vary"),
        (Shooting(1), {"vary": "p.q1"}, "/values"),
        (Shooting(1), {"values": [1.0]}, "/vary"),
        (Shooting(-1), {}, "/period"),
        (Shooting(None), {}, "/period"),
        (Shooting(1, section=Section("p.q1")), {}, "/section"),
        (Shooting(None, True, section=Section("p.q1")), {}, "/fixed"),
        (Shooting(None, section=Section("p.q7")), {}, "/section/quantity"),
        (Shooting(None, section=Section("sin(t)")), {}, "/section/quantity"),
        (Shooting(None, section=Section("p.q1")), {"inputs": {"tau.p.q1": "sin(t)"}}, "/section"),
        (Shooting(1), {"inputs": {"tau.p.q1": "p.q1"}}, "/inputs"),
        (Shooting(1), {"parameters": {"p.mass": 1}}, "/parameters/p.mass"),
    ],
)
def test_bad_input(pendulum: Model, shooting: Shooting, given: Any, pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        periodic_orbits(pendulum, [0.1], shooting, **given)
    assert caught.value.faults[0].pointer == pointer


@pytest.mark.parametrize("rates", [[0.3], {"p.q1": 0.3}])
def test_orbits_over_a_held_state_begin_where_the_start_is(rates: Any, pendulum: Model) -> None:
    """As a list, or by name, it is the start that it is as an array."""
    given, array = (
        periodic_orbits(pendulum, [0.5], Shooting(2.1), qd=qd, vary="p.q1", values=[0.5]).found[0]
        for qd in (rates, np.array([0.3]))
    )
    np.testing.assert_array_equal(given.qd, array.qd)
    assert given.qd[0] > 0.1


def test_a_transient_is_a_time_that_passes(pendulum: Model) -> None:
    for wrong in (-1.0, "1"):
        with pytest.raises(InvalidInput, match="/transient"):
            lyapunov_exponents(pendulum, [0.5], 10.0, transient=wrong)  # type: ignore[arg-type]
