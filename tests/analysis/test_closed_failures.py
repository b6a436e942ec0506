"""Closed motions that cannot be, end early or are called wrongly: advice, and the motion up to there."""

from __future__ import annotations

import numpy as np
import pytest
from closed_trees import at, closed_entry, four_bar, slider_crank
from random_trees import Plain
from simulated import simulated

from substructures import InvalidInput
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.simulation import simulate_tree
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.simulate import Closed, Event, Linear, Table, simulate

from .closed_motions import METHODS, right


def test_a_locked_motion_fails_with_the_motion_up_to_there() -> None:
    """A crank longer than its rod cannot be turned further than where both are in line with the wrist."""
    wrist = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    model = closed_entry("slider-crank", [wrist], r=0.2)
    request = {"q": at(model, rod=0.3, piston=0.3), "prescribed": {"x.crank": "2*t"}, "span": [0, 1], "count": 101}
    motion = simulated(model, **request)
    assert motion.status == "failed"
    locked = np.arcsin(0.14 / 0.2) / 2
    assert locked - 0.001 < motion.t[-1] < locked
    assert "dead centre" in motion.message or "relative_tolerance" in motion.message


def test_open_loops_singular_starts_and_long_spans_fail_with_advice() -> None:
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    open_loop = simulate(closed_entry("four-bar", [pin], l0=5), [0, 0, 0], (0, 1))
    assert (open_loop.status, len(open_loop.t)) == ("failed", 1)
    assert "cannot be met" in open_loop.message
    flat = closed_entry("four-bar", [pin], l0=0.3, l1=0.2, l2=0.3, l3=0.2)
    singular = simulate(flat, [0, 0, 0], (0, 1), qd=[1, -1, 1])
    assert (singular.status, "singular" in singular.message) == ("failed", True)
    model = four_bar()
    request = {"q": [0.7, 0.2, 1.2], "qd": [9, 0, 0], "fixed": ["x.crank"], "span": [0, 100], "max_steps": 20}
    long = simulated(model, **request)
    assert (long.status, long.steps) == ("failed", 20)
    assert "max_steps" in long.message
    assert long.events == ()
    assert 0 < long.t[-1] < 100


@pytest.mark.parametrize("tolerance", [1e-10, 1e-5, 1e-2])
@pytest.mark.parametrize("method", METHODS)
def test_a_singular_position_between_two_steps_is_noticed(method: str, tolerance: float) -> None:
    """A parallelogram that swings through the position where all its links are in line could go on as a kite."""
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    flat = closed_entry("four-bar", [pin], l0=0.3, l1=0.2, l2=0.3, l3=0.2)
    request: Plain = {
        "q": at(flat, crank=0.5, coupler=-0.5, rocker=0.5),
        "qd": at(flat, crank=-3),
        "fixed": ["x.crank"],
    }
    request |= {"relative_tolerance": tolerance, "absolute_tolerance": tolerance / 100}
    motion = simulated(flat, **request, span=(0, 1), reduction=method, count=5)
    assert motion.status == "failed"
    assert "singular" in motion.message or "dead centre" in motion.message
    assert 0 < motion.t[-1] < 0.2
    assert motion.q[-1, 0] > -1e-6
    (lost,) = motion.events
    assert (lost.name, lost.kind, lost.t) == ("lost-rank", "lost-rank", motion.t[-1])
    # in line: sin(crank - coupler) = 0
    np.testing.assert_allclose(lost.q, 0, atol=1e-2)
    before = simulated(flat, **request, span=(0, 0.1), reduction=method, count=5)
    right(before)
    assert before.events == ()


def test_one_entry_for_all_models() -> None:
    model = slider_crank()
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "span": [0, 0.01], "fixed": ["x.crank"], "count": 3}
    assert "multipliers" in simulated(model, **request).series
    wrist = {"constraints": [Closed("wrist")], "independent": ["x.crank"]}
    closed = simulated(model, **request)
    rolling = simulated(model, **wrist, q=closed.q[0], span=(0, 0.01))
    assert "constraints" in rolling.series
    blade = {"constraints": [Linear("c", "x.crank'")], "q": closed.q[0]}
    for call in (
        lambda: simulated(model, **blade, span=(0, 1)),
        lambda: simulate_tree(TreeProblem(model=model, start=Start([0, 0, 0]), times=OutputTimes((0, 1)))),
    ):
        with pytest.raises(InvalidInput, match="closure"):
            call()


def test_nothing_that_has_mass() -> None:
    massless = dict.fromkeys(("x.m1", "x.m2", "x.m3"), 0)
    motion = simulate(four_bar(), [0.7, 0.2, 1.2], (0, 1), parameters=massless)
    assert motion.status == "failed"
    assert "metric is singular" in motion.message


BAD: list[tuple[Plain, str, str]] = [
    ({"reduction": "magic"}, "/reduction", "literal-error"),
    ({"reduction": ["projection"]}, "/reduction", "literal-error"),
    ({"count": 5, "step": 0.1}, "/step", "one-grid"),
    ({"span": [0, 0]}, "/span", "empty-span"),
    ({"span": None}, "/span", "number-expected"),
    ({"count": 1}, "/count", "greater-than-equal"),
    ({"times": [0, 0]}, "/times", "not-increasing"),
    ({"relative_tolerance": -1}, "/relative_tolerance", "greater-than-equal"),
    ({"events": [Event("x", "u + 1")]}, "/events/0/quantity", "unknown-name"),
    (
        {"prescribed": {"x.crank": Table([0, 1], [0, 1])}, "span": [0, 2]},
        "/prescribed/x.crank/times",
        "not-covered",
    ),
    ({"velocities": {"u": "x.crank'"}}, "/velocities", "not-supported"),
]


@pytest.mark.parametrize(("change", "pointer", "code"), BAD)
def test_bad_arguments(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        simulated(SLIDER, **{"q": [0, 0, 0.18], "span": [0, 1]} | change)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


SLIDER = slider_crank()
