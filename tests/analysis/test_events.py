"""Events: all crossings of a level, also two in one step, at their times in closed form; trees, loops, skates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis_models import oscillator
from closed_trees import slides
from random_trees import Plain, model_of
from rolling_bodies import BLADE, FORWARD, sleigh
from simulated import simulated

from substructures.analysis.simulate import ClosedMotion, Event, Outputs, simulate

from .closed_motions import METHODS as REDUCTIONS

G, V = 9.81, 10.0
#: by how much levels are below the top [m]; the others know the height less well
BELOW = dict.fromkeys(("DOP853", "RK45", "Radau"), (4.0, 1e-2, 1e-6))
BELOW |= dict.fromkeys(("RK23", "BDF", "LSODA"), (4.0, 1e-2))


def times(motion: Any, name: str = "e") -> list[float]:
    return [event.t for event in motion.events if event.name == name]


def passing(quantity: Any, level: float = 0.0, **more: Any) -> list[Event]:
    return [Event("e", quantity, level, **{"action": "record", **more})]


def thrown(events: list[Event], **more: Any) -> Any:
    """A mass that is thrown up: s = 10 t - g t^2 / 2, exact for every method in a few large steps."""
    return simulated(model_of(oscillator(), (0, 0, -G)), [0], (0, 2.5), qd=[V], events=events, **more)


@pytest.mark.parametrize(("method", "below"), [(name, x) for name, some in BELOW.items() for x in some])
def test_up_and_down_through_a_level_below_the_top(method: str, below: float) -> None:
    found = times(thrown(passing("x.s", V**2 / (2 * G) - below), method=method))
    half = np.sqrt(2 * below / G)
    np.testing.assert_allclose(found, [V / G - half, V / G + half], atol=1e-7 if len(BELOW[method]) > 2 else 1e-4)


def test_a_level_above_the_top_and_ways_through() -> None:
    top = V**2 / (2 * G)
    assert not thrown(passing("x.s", top + 1e-6)).events
    rise, fall = (V - np.sqrt(2 * G * 0.01)) / G, (V + np.sqrt(2 * G * 0.01)) / G
    level = top - 0.01
    np.testing.assert_allclose(times(thrown(passing("x.s", level, direction="rising"))), [rise], atol=1e-9)
    np.testing.assert_allclose(times(thrown(passing("x.s", level, direction="falling"))), [fall], atol=1e-9)
    stopped = thrown(passing("x.s", level, action="stop"))
    assert stopped.status == "stopped"
    np.testing.assert_allclose([*times(stopped), stopped.t[-1]], [rise, rise], atol=1e-9)
    # of two events in one step the earlier one stops
    both = [Event("late", "x.s", level, "falling"), Event("early", "x.s", level + 0.005, "falling")]
    np.testing.assert_allclose(thrown(both).t[-1], (V + np.sqrt(2 * G * 0.005)) / G, atol=1e-9)


@pytest.mark.parametrize("speed", [1.0, 37.0])
def test_a_quantity_that_swings_while_the_motion_is_smooth(speed: float) -> None:
    """s = speed t without forces is one step; sin(10 s) passes 0.5 at (pi/6, 5 pi/6) + 2 pi k."""
    motion = simulate(
        model_of(oscillator(), (0, 0, 0)), [0], (0, 2), qd=[speed], outputs=Outputs(events=passing("sin(10*x.s)", 0.5))
    )
    turns = np.arange(int(20 * speed / (2 * np.pi)) + 1)
    expected = np.sort(np.concatenate([np.pi / 6 + 2 * np.pi * turns, 5 * np.pi / 6 + 2 * np.pi * turns]))
    expected = expected[expected < 20 * speed] / (10 * speed)
    np.testing.assert_allclose(times(motion), expected, rtol=1e-9)


def test_a_quantity_with_a_kink() -> None:
    """|s - 1| passes 0.001 twice around s = 1."""
    motion = simulate(
        model_of(oscillator(), (0, 0, 0)),
        [0],
        (0, 3),
        qd=[1],
        outputs=Outputs(events=passing("sqrt((x.s - 1)^2)", 0.001)),
    )
    np.testing.assert_allclose(times(motion), [0.999, 1.001], atol=1e-9)


@pytest.mark.parametrize("reduction", REDUCTIONS)
def test_on_closures(reduction: Any) -> None:
    """x = cos 2t: 0.9999 is passed on both sides of t = pi; y' = 2 cos 2t falls through 0 and rises."""
    events = [*passing("x.x", 0.9999), Event("turns", "x.y'", action="record")]
    motion = simulate(
        slides(), [1, 0], (0, 4), qd=[0, 2], kind=ClosedMotion(reduction=reduction), outputs=Outputs(events=events)
    )
    a = np.arccos(0.9999) / 2
    np.testing.assert_allclose(times(motion), [a, np.pi - a, np.pi + a], atol=1e-8)
    np.testing.assert_allclose(times(motion, "turns"), np.pi * np.array([1, 3, 5]) / 4, atol=1e-8)


@pytest.mark.parametrize("form", ["voronets", "boltzmann-hamel"])
def test_with_velocity_constraints(form: Any) -> None:
    """A skate on a slope: x = s/(2 w^2) sin^2 wt just below its greatest value, and the heading w t (Bloch 2003)."""
    slope, w = G * 0.28, 1.7
    request: Plain = {"constraints": [BLADE], "velocities": FORWARD, "parameters": {"s.a": 0}, "q": [0, 0, 0]}
    top = slope / (2 * w**2)
    events = [*passing("s.x", top * (1 - 1e-5)), Event("u", "s.x'*cos(s.f) + s.y'*sin(s.f)", 0.5, action="record")]
    request |= {"v": {"w": w}, "span": (0, 3), "form": form, "events": events}
    motion = simulated(sleigh((slope, 0, -G * 0.96)), **request)
    a = np.arccos(np.sqrt(1 - 1e-5))
    at = np.array([np.pi / 2 - a, np.pi / 2 + a, 3 * np.pi / 2 - a, 3 * np.pi / 2 + a]) / w
    np.testing.assert_allclose(times(motion), at[at < 3], atol=1e-7)
    # u = slope/w sin wt
    b = np.arcsin(0.5 * w / slope)
    np.testing.assert_allclose(times(motion, "u"), np.array([b, np.pi - b]) / w, atol=1e-8)
