"""Periodic orbits and Lyapunov exponents beside closed forms and published numbers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.special import ellipk

from substructures import couple, derive
from substructures.analysis.orbits import flow as flows
from substructures.analysis.orbits.lyapunov import lyapunov_exponents
from substructures.analysis.orbits.periodic import Shooting, periodic_orbits
from substructures.errors import InvalidInput
from substructures.tree.model import Model

G = 9.81


def slider(name: str, parent: str, axis: list[int], **more: Any) -> dict[str, Any]:
    joint = {"type": "prismatic", "coordinate": name, "placement": {"position": [0, 0, 0]}, "axis": axis, **more}
    return {"name": f"body_{name}", "parent": parent, "joint": joint}


def tree_of(part: dict[str, Any] | str) -> Model:
    instance = {"name": "p", "substructure": part if isinstance(part, str) else part["name"]}
    return couple({"name": "one", "gravity": [0, 0, "-9.81"], "instances": [instance]}, {"p": derive(part)})


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
    for orbit, amplitude in zip(found.found, amplitudes, strict=True):
        expected = 4 * np.sqrt(1 / G) * ellipk(np.sin(amplitude / 2) ** 2)
        assert (orbit.status, orbit.stability, orbit.is_right) == ("finished", "neutral", True), orbit
        assert orbit.period == pytest.approx(expected, rel=1e-9)
        np.testing.assert_allclose(orbit.multipliers, 1, atol=1e-3)


def test_a_whole_turn_of_a_pendulum(pendulum: Model) -> None:
    """It turns with the rate w_0 at the bottom: T = 2 k/w K(k^2) with k = 2 w/w_0, w = sqrt(g/l)."""
    w, rate = np.sqrt(G), 9.0
    shooting = Shooting(0.9, hold=("p.q1", "p.q1'"), turns={"p.q1": 1})
    (orbit,) = periodic_orbits(pendulum, [0.0], shooting, qd=[rate]).found
    k = 2 * w / rate
    assert orbit.period == pytest.approx(2 * k / w * ellipk(k**2), rel=1e-9)
    assert orbit.is_right


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


def test_exponents_add_up_to_the_damping(duffing: Model) -> None:
    found = lyapunov_exponents(duffing, [0.5], 200, inputs={"tau.p.x": "0.4*cos(t)"}, transient=20)
    assert found.exponents.sum() == pytest.approx(-0.25, abs=1e-6)
    assert found.is_right


def test_a_wrong_derivative_is_seen(duffing: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    right = flows.Variation.__call__

    def wrong(self: Any, t: float, flat: Any) -> Any:
        found = right(self, t, flat)
        found[3:] *= 1.01  # of S, not of x
        return found

    monkeypatch.setattr(flows.Variation, "__call__", wrong)
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
        (Shooting(-1), {}, "/period"),
        (Shooting(1), {"inputs": {"tau.p.q1": "p.q1"}}, "/inputs"),
        (Shooting(1), {"parameters": {"p.mass": 1}}, "/parameters/p.mass"),
    ],
)
def test_bad_input(pendulum: Model, shooting: Shooting, given: Any, pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        periodic_orbits(pendulum, [0.1], shooting, **given)
    assert caught.value.faults[0].pointer == pointer
