"""Inputs and events along a motion against their integrals and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from analysis_models import FINE, oscillator
from random_trees import Plain, model_of
from simulated import simulated

from substructures.analysis.simulate import Event, FixedStep, Table


def test_constant_force_and_tables() -> None:
    """s'' = u: a number, an expression, a held, a linear and a cubic table against their integrals."""
    model = model_of(oscillator(), (0, 0, 0))
    times = np.linspace(0, 2, 5)
    held = Table([0, 1, 2], [1, -1, 0], "hold")
    for given, exact in (
        (3, 1.5 * times**2),
        ("6*t", times**3),
        (Table([0, 2], [0, 12]), times**3),
        (Table([0, 1, 2, 3], [0, 1, 4, 9], "cubic"), times**4 / 12),
        (held, np.where(times <= 1, times**2 / 2, 0.5 + (times - 1) - (times - 1) ** 2 / 2)),
    ):
        request = {"q": [0], "span": [0, 2], "times": times, "inputs": {"tau.x.s": given}, **FINE}
        motion = simulated(model, **request)
        np.testing.assert_allclose(motion.q[:, 0], exact, atol=1e-12)
        assert motion.is_right


def test_jumps_of_tables_cost_no_accuracy_and_few_steps() -> None:
    """The integrator begins anew at a jump, with the value from the side it is on."""
    held = Table([0, 0.3, 0.7, 1], [2, -3, 5, 0], "hold")
    base: Plain = {"q": [0], "span": [0, 1], "inputs": {"tau.x.s": held}, "count": 2, **FINE}
    motion = simulated(model_of(oscillator(), (0, 0, 0)), **base)
    # v = 0.6, -0.6, 0.9 at the ends of the pieces
    exact = 0.5 * 2 * 0.09 + (0.6 * 0.4 - 1.5 * 0.16) + (-0.6 * 0.3 + 2.5 * 0.09)
    assert motion.q[-1, 0] == pytest.approx(exact, abs=1e-14)
    assert motion.qd[-1, 0] == pytest.approx(0.9, abs=1e-14)
    assert motion.steps < 40


def test_jumps_outside_of_the_span_do_not_matter() -> None:
    """A table that is longer than the span on both sides: the integrator never leaves the span."""
    held = Table([-1, -0.5, 0.5, 1.5, 2], [7, 2, -2, 9, 0], "hold")
    told: list[float] = []
    model = model_of(oscillator(), (0, 0, 0))
    motion = simulated(model, [0], (0, 1), inputs={"tau.x.s": held}, count=2, progress=told.append, **FINE)
    assert told == sorted(told)
    assert (min(told) > 0, max(told)) == (True, 1)
    assert motion.q[-1, 0] == pytest.approx(0.5, abs=1e-14)


@pytest.mark.parametrize(("method", "place", "speed"), [("rk4", 1, 4), ("semi-implicit-euler", 0.75, 1.5)])
def test_fixed_steps_take_inputs_at_the_times_of_their_scheme(method: str, place: float, speed: float) -> None:
    """s'' = 12 t^2 in two steps: s = t^4 is exact for the order four; Euler has the force at the start of each step."""
    model, law = model_of(oscillator(), (0, 0, 0)), {"tau.x.s": "12*t^2"}
    motion = simulated(model, [0], (0, 1), count=2, inputs=law, fixed_step=FixedStep(0.5, method))
    assert motion.q[-1, 0] == pytest.approx(place, abs=1e-14)
    assert motion.qd[-1, 0] == pytest.approx(speed, abs=1e-14)


def test_feedback_as_an_expression() -> None:
    """A spring and a damper by an input; energy changes by their work."""
    law = {"tau.x.s": "-4*x.s - x.s'/2"}
    one = simulated(model_of(oscillator(), (0, 0, 0)), [1], (0, 3), inputs=law, **FINE)
    two = simulated(model_of(oscillator(stiffness=4, damping=0.5), (0, 0, 0)), [1], (0, 3), **FINE)
    np.testing.assert_allclose(one.q, two.q, atol=1e-12)
    assert one.is_right
    assert "work" in one.series


def test_events_are_found_in_order() -> None:
    """Of s = cos 2t: recorded crossings, directions, levels, and the stop."""
    model = model_of(oscillator(stiffness=4), (0, 0, 0))
    events = [
        Event("down", "x.s", direction="falling", action="record"),
        Event("half", "x.s", level=0.5, action="record"),
        Event("late", "t", level=4, action="stop"),
    ]
    motion = simulated(model, [1], (0, 100), step=0.5, events=events, **FINE)
    found = [(e.name, e.t) for e in motion.events]
    turns = [np.pi / 6, np.pi / 4, 5 * np.pi / 6, 7 * np.pi / 6, 5 * np.pi / 4, 4.0]
    assert [name for name, _ in found] == ["half", "down", "half", "half", "down", "late"]
    np.testing.assert_allclose([t for _, t in found], turns, atol=1e-11)
    assert motion.status == "stopped"
    assert motion.t[-1] == 4
