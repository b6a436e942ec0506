"""Steps that are taken together are those that are taken one by one, with the same results, to the last bit."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model
from simulated import simulated

from substructures.analysis.equations import kernels
from substructures.analysis.motion import simulation, single_steps
from substructures.analysis.motion.conditions import DYNAMICS, read_conditions
from substructures.analysis.motion.integrators import compiled_steps, integrated_motion, integration
from substructures.analysis.motion.integrators.at_once import taken_at_once
from substructures.analysis.motion.integrators.compiled_steps import EXPLICIT, CompiledStepper, compiled_stepper
from substructures.analysis.motion.integrators.steppers import roughly_within
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import Table
from substructures.compile import target

pytestmark = pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
START: dict[str, Any] = {"q": [1.2, 0.4], "qd": [2.0, -1.0]}


@pytest.fixture(autouse=True)
def by_kernels(monkeypatch: pytest.MonkeyPatch) -> None:
    """Series come from kernels, of the first motion, too: interpreted ones have other roundings."""
    monkeypatch.setattr(kernels, "COMPILED", -np.inf)


def both(monkeypatch: pytest.MonkeyPatch, **given: Any) -> tuple[Trajectory, Trajectory, int]:
    """A motion of the acrobot with steps together and one by one, and how often some were taken together."""
    calls = [0]

    def counted(*arguments: Any) -> Any:
        """What is found, counted."""
        found = together(*arguments)
        calls[0] += found is not None
        return found

    together = integration.taken_at_once
    with monkeypatch.context() as patch:
        patch.setattr(integration, "taken_at_once", counted)
        one = simulated(catalogue_model("acrobot"), **START, **given)
        patch.setattr(integration, "taken_at_once", lambda *_: None)
        two = simulated(catalogue_model("acrobot"), **START, **given)
    return one, two, calls[0]


def assert_same(one: Trajectory, two: Trajectory) -> None:
    """Times, states, series, checks, counts and messages."""
    for name, array in one.arrays().items():
        np.testing.assert_array_equal(array, two.arrays()[name])
    first, second = one.summary(), two.summary()
    for each in (first, second):
        each["figures"] = {name: x for name, x in each["figures"].items() if name == "evaluations"}
    assert first == second


@pytest.mark.parametrize("method", EXPLICIT)
@pytest.mark.parametrize(
    "outputs", [{"count": 2}, {"count": 301}, {"times": [0, 1e-7, 0.5, 0.5 + 1e-9, 1]}, {"times": []}]
)
def test_they_are_the_same(method: str, outputs: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    tolerances = {"relative_tolerance": 1e-7, "absolute_tolerance": 1e-9}
    one, two, calls = both(monkeypatch, span=[0, 1], method=method, **tolerances, **outputs)
    assert one.status == "finished"
    assert calls
    assert_same(one, two)


@pytest.mark.parametrize("change", [{"max_steps": 1}, {"max_steps": 40}, {"max_step": 1e-3}])
def test_limits_of_steps(change: dict[str, Any], monkeypatch: pytest.MonkeyPatch) -> None:
    one, two, _ = both(monkeypatch, span=[0, 5], **change)
    assert_same(one, two)
    assert one.status == ("failed" if "max_steps" in change else "finished")


def test_inputs_with_breaks(monkeypatch: pytest.MonkeyPatch) -> None:
    name = catalogue_model("acrobot").input_names[0]
    one, two, calls = both(monkeypatch, span=[0, 1], inputs={name: Table([0, 0.3, 0.7, 1], [0, 2, -1, 0])})
    assert calls >= 3
    assert_same(one, two)


def test_who_watches_ends_it_within_those_taken_together(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[list[float]] = []

    def progress(share: float) -> bool:
        """A motion begins where the share falls."""
        if not told or share < told[-1][-1]:
            told.append([])
        told[-1].append(share)
        return share < 0.4

    one, two, calls = both(monkeypatch, span=[0, 1], progress=progress)
    assert calls
    assert one.cancelled
    assert told[0] == told[-1]
    assert_same(one, two)


def test_those_kept_for_the_judges(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of many steps every second one is dropped, again and again, with others of the same call before and behind."""
    monkeypatch.setattr(integrated_motion, "KEPT", 10)
    monkeypatch.setattr(compiled_steps, "MOST", 7)
    one, two, calls = both(monkeypatch, span=[0, 5])
    assert calls
    assert one.steps > 40
    assert_same(one, two)


def test_a_result_that_is_not_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    """The steps are taken one by one then, up to the one within which it is, and the motion says where it ended."""

    def none(_: Any, ways: Any, states: Any, *_more: Any) -> Any:
        """No way is reached."""
        return states, np.zeros(len(ways), dtype=bool)

    monkeypatch.setattr(CompiledStepper, "reach", none)
    found = simulated(catalogue_model("acrobot"), **START, span=[0, 1], times=[0.5, 1])
    assert (found.status, len(found.t)) == ("failed", 1)
    assert "Required step size" in found.message
    assert 0.5 <= found.t[-1] < 0.6


def test_steps_that_bring_it_no_further_are_counted() -> None:
    found = simulated(catalogue_model("acrobot"), **START, span=[0, 1], max_step=1e-13, max_steps=1000)
    assert "200 steps brought it no further" in found.message


def stepper_of(method: str) -> CompiledStepper:
    """Of the acrobot, from the start to 1 s."""
    model = catalogue_model("acrobot")
    start = Start(**START).with_defaults(model)
    conditions = read_conditions(model, start, (0, 1), DYNAMICS)
    f = RightHandSide(model, conditions.values, conditions.zero, conditions)
    made: CompiledStepper = compiled_stepper(method, 1e-7, 1e-9)(f, 0.0, conditions.start, 1.0)
    return made


@pytest.mark.parametrize("method", EXPLICIT)
def test_states_within_a_step(method: str) -> None:
    """Many at once are those one by one, its ends among them."""
    solver = stepper_of(method)
    for _ in range(3):
        solver.step()
    times = np.linspace(solver.t_old, solver.t, 9)
    found, dense = solver.states_at(times), solver.dense_output()
    np.testing.assert_array_equal(found, [dense(t) for t in times.tolist()])
    np.testing.assert_array_equal(found[0], solver.y_old)
    np.testing.assert_allclose(found[-1], solver.y, rtol=1e-12)
    np.testing.assert_array_equal(roughly_within(solver)(times), found)


def test_steps_that_are_watched_are_taken_one_by_one() -> None:
    solver = stepper_of("RK45")
    assert taken_at_once(solver, [], 0, 0.0, 3, None) is not None
    assert solver.nfev > 0
    before = solver.t
    solver.is_watched = True
    assert taken_at_once(solver, [], 0, 0.0, 3, None) is None
    assert solver.t == before > 0


def test_steps_done_again_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """The judge takes them together, too, or one by one where the ends are not all reached."""
    model = catalogue_model("acrobot")
    one = simulated(model, **START, span=[0, 1])
    monkeypatch.setattr(simulation, "at_once", lambda f, choice: single_steps.one_by_one(f, choice.stepper(), f.enter))
    two = simulated(model, **START, span=[0, 1])
    assert next(c for c in one.checks if c.name == "steps").worst > 0
    assert [c.summary() for c in one.checks] == [c.summary() for c in two.checks]
