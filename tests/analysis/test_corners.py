"""Corners of force laws: places and times where signs change are found, and motions are those of the pieces."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy
from simulated import simulated

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.analysis.motion import simulation
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import Event, Table


def cart(force: str) -> Model:
    """A mass of 1 kg on a line, x, with a force on it."""
    definition = {
        "name": "cart",
        "parameters": {"m": {"value": 1, "unit": "kg"}, "n": {"value": 1.5}},
        "inputs": {"u": {"unit": "N"}},
        "bodies": [{"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x"}, "mass": "m"}],
        "loads": [{"type": "joint", "coordinate": "x", "force": force}],
    }
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "c", "definition": definition}]})
    return couple(spec, {"c": derive(Definition.read(definition))})


def moved(model: Model, end: float, q: float = 1.0, qd: float = 0.0, **given: Any) -> Trajectory:
    return simulated(model, q=[q], qd=[qd], span=(0, end), **given)


#: a quarter of the period of x'' = -sign x from x = 1
QUARTER = np.sqrt(2)


def test_a_force_that_jumps() -> None:
    """Parabolas: after ten periods at the start again, at every time in between where they are."""
    times = np.linspace(0, 40 * QUARTER, 401)
    there = Event("there", "c.x", 0.0, "both", "record")
    found = moved(cart("-1*sign(x)"), times[-1], times=times, events=[there])
    np.testing.assert_allclose([each.t for each in found.events], QUARTER * np.arange(1, 40, 2), atol=1e-9)
    phase = times % (4 * QUARTER)
    first = 1 - phase**2 / 2
    second = -1 + (phase - 2 * QUARTER) ** 2 / 2
    last = 1 - (phase - 4 * QUARTER) ** 2 / 2
    expected = np.where(phase < QUARTER, first, np.where(phase < 3 * QUARTER, second, last))
    np.testing.assert_allclose(found.q[:, 0], expected, atol=1e-11)
    assert all(check.holds for check in found.checks)
    assert found.steps < 200


@pytest.mark.parametrize("law", ["max(0, -x)^1.5", "max(0, -x)^n", "(abs(x) - x)^1.5/2^1.5"])
def test_a_collision_by_the_law_of_hertz(law: str) -> None:
    """From rest at x = -h the force k (-x)^(3/2) acts for 2/5 B(2/5, 1/2) h/v and gives v^2 = 4/5 k h^(5/2)/m; at the
    wall it takes twice as long.
    """
    k, h, wall = 1000.0, 0.02, 0.05
    v = np.sqrt(0.8 * k * h**2.5)
    half = 0.4 * scipy.special.beta(0.4, 0.5) * h / v
    model = cart(f"{k}*{law} - {k}*max(0, x - {wall})^1.5")
    times = [half + wall / v / 2, 3 * half + 3 * wall / v / 2, 4 * half + 2 * wall / v]
    found = moved(model, times[-1], -h, times=[0, *times])
    assert found.is_right
    np.testing.assert_allclose(found.q[1:, 0], [wall / 2, wall / 2, -h], atol=1e-8)
    np.testing.assert_allclose(found.qd[1:, 0], [v, -v, 0], atol=1e-6)


def test_a_spring_with_play_and_an_event() -> None:
    """x'' = -k max(|x| - a, 0) sign x: harmonic in the spring, free in between; the event is where it has to be."""
    k, a = 100.0, 0.25
    model = cart(f"-{k}*max(x - {a}, 0) + {k}*max(-x - {a}, 0)")
    speed = 0.75 * np.sqrt(k)
    period = 4 * (np.pi / 2 / np.sqrt(k) + a / speed)
    middle = Event("middle", "c.x", 0.0, "both", "record")
    found = moved(model, 5 * period, times=[5 * period], events=[middle])
    np.testing.assert_allclose(found.q[-1, 0], 1, atol=1e-9)
    passed = [each.t for each in found.events]
    np.testing.assert_allclose(passed, period / 4 + np.arange(10) * period / 2, atol=1e-9)
    # results of the free flight, in the step that leads to the corner behind it
    free = period / 4 + np.linspace(-0.9, 0.9, 7) * a / speed
    flight = moved(model, period, times=free)
    np.testing.assert_allclose(flight.q[:, 0], -speed * (free - period / 4), atol=1e-9)


def test_a_linear_table() -> None:
    model = cart("-table(x; -1: -2, 0: 0, 1: 1, 2: 4)")
    fine = moved(model, 20, 1.8, times=[20], relative_tolerance=1e-13, absolute_tolerance=1e-14)
    found = moved(model, 20, 1.8, times=[20])
    np.testing.assert_allclose(found.q, fine.q, atol=1e-9)


def test_what_slides_goes_on() -> None:
    """Dry friction by a sign holds the mass where it stops: no corner is left there, and it stays."""
    found = moved(cart("-1*sign(x') - 5*x"), 5, times=[0, 4, 5])
    assert found.status == "finished"
    np.testing.assert_allclose(found.q[1:, 0], 0.2, atol=1e-3)


#: whose motion stays at a corner: from when on, and where. x'' = -5 from 1 until x + x' = 0; half a swing of
#: x'' = -2 sign x' - 4 x, which friction ends at -0.3; at rest from the start
SLIDES = {
    "-5*sign(x + x')": (1.0, 1 - 5 / 2 * ((35**0.5 - 5) / 5) ** 2, (35**0.5 - 5) / 5),
    "-2*sign(x') - 4*x": (1.3, -0.3, np.pi / 2),
    "3*t - 4*sign(x')": (0.0, 0.0, 0.0),
}


@pytest.mark.parametrize("method", ["DOP853", "Radau"])
@pytest.mark.parametrize(("law", "where"), SLIDES.items())
def test_what_a_jump_throws_back_from_both_sides_says_so_soon(
    law: str, where: tuple[float, float, float], method: str
) -> None:
    start, end, t = where
    found = moved(cart(law), 5, start, times=[5], method=method)
    assert (found.status, found.is_right, found.steps < 2500) == ("failed", None, True)
    assert "sliding mode" in found.message
    assert "tanh(x/w)" in found.message
    np.testing.assert_allclose([found.t[-1], found.q[-1, 0]], [t, end], atol=1e-6)
    # the way out: from there it slides as x' = -x
    if law == "-5*sign(x + x')":
        smooth = moved(cart("-5*tanh(1e5*(x + x'))"), 3, times=[3], method="Radau")
        np.testing.assert_allclose(smooth.q[-1, 0], end * np.exp(t - 3), rtol=1e-4)


def test_from_a_corner_on() -> None:
    """A start in a corner leaves it to a side, or stays in it."""
    thrown = moved(cart("-1*sign(x)"), 4.0, 0.0, 1.0, times=[1.0, 3.0, 4.0])
    np.testing.assert_allclose(thrown.q[:, 0], [0.5, -0.5, 0.0], atol=1e-12)
    resting = moved(cart("-1*sign(x)"), 4.0, 0.0, 0.0, times=[4.0])
    assert resting.q[-1, 0] == 0


def test_corners_of_tables_over_time_are_stepped_over() -> None:
    """What depends on such an input alone has no side; the motion is right to its tolerance."""
    given = {"c.u": Table([0, 3], [-1, 2])}
    found = moved(cart("abs(u) - x"), 3, 0.0, inputs=given, times=[3], max_step=0.05)
    # x'' + x = |t - 1|: x = |t - 1| - cos t + sin t, and sin(t - 1) twice from t = 1 on, less
    t = 3.0
    expected = abs(t - 1) - np.cos(t) + np.sin(t) - 2 * np.sin(t - 1)
    np.testing.assert_allclose(found.q[-1, 0], expected, atol=1e-5)


@pytest.mark.parametrize("method", ["Radau", "LSODA", "RK45"])
def test_every_method(method: str) -> None:
    found = moved(cart("-1*sign(x)"), 4 * QUARTER, times=[4 * QUARTER], method=method)
    np.testing.assert_allclose(found.q[-1, 0], 1, atol=1e-7)


def test_without_them_it_is_worse(monkeypatch: pytest.MonkeyPatch) -> None:
    """The check can fail: the integrator alone needs more steps, and is off."""
    monkeypatch.setattr(RightHandSide, "corners", lambda *_: [])
    assert simulation.RightHandSide is RightHandSide
    found = moved(cart("-1*sign(x)"), 40 * QUARTER, times=[40 * QUARTER])
    assert abs(found.q[-1, 0] - 1) > 1e-10
    assert found.steps > 400
