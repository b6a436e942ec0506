"""Motions along which all first integrals are constant, and which are wrong: single steps done again see it."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from analysis_models import shipped
from closed_trees import at, slider_crank
from random_trees import Plain
from rolling_bodies import FLOOR, R, disc
from simulated import simulated

from substructures.analysis.closed import simulation as closed
from substructures.analysis.motion import rolling, simulation, single_steps
from substructures.analysis.motion.integrators import fixed_step, integration
from substructures.analysis.motion.integrators.fixed_step import StepMethod
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import ClosedMotion, ConstrainedMotion, FixedStep, Integrator, Outputs, simulate
from substructures.compile.motion import CompiledRates

CRANK = slider_crank()
MOTIONS: dict[str, tuple[Any, Callable[[], Trajectory]]] = {
    "tree": (simulation, lambda: simulate(shipped("acrobot"), [1.2, 0], (0, 3))),
    "closed": (
        closed,
        lambda: simulate(
            CRANK,
            at(CRANK, crank=0.3, piston=0.17),
            (0, 0.2),
            qd=at(CRANK, crank=20),
            kind=ClosedMotion(fixed=["x.crank"]),
        ),
    ),
    "rolling": (
        rolling,
        lambda: simulate(
            disc(),
            [0, 0, R * np.sin(1.2), 0.2, 1.2, 0],
            (0, 2),
            kind=ConstrainedMotion(constraints=[FLOOR], v=[1.0, 0.5, 6.0]),
        ),
    ),
}


def failed(motion: Trajectory) -> list[str]:
    return [check.name for check in motion.checks if check.holds is False]


def fast(reduction: Any, calls: list[Any]) -> Any:
    """The reduction of closed loops, of which the first one is too fast."""

    class Fast(reduction):  # type: ignore[misc]
        def __init__(self, *arguments: Any) -> None:
            super().__init__(*arguments)
            calls.append(self)

        def rates(self, t: float, x: Any) -> Any:
            return super().rates(t, x) * (1.001 if self is calls[0] else 1)

        def compiled(self) -> Any:
            return None if self is calls[0] else super().compiled()

    return Fast


@pytest.mark.parametrize("kind", MOTIONS)
def test_steps_that_are_too_long(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """x' = 1.001 f(t, x): the same orbits, with the same energy, gone through too fast."""
    module, run = MOTIONS[kind]
    assert run().is_right
    calls: list[Any] = []
    if kind == "closed":
        monkeypatch.setitem(closed.REDUCTIONS, "projection", fast(closed.REDUCTIONS["projection"], calls))

    def integrate(f: Any, *arguments: Any, **named: Any) -> Any:
        calls.append(f)
        g = (lambda t, x: 1.001 * f(t, x)) if len(calls) == 1 else f
        return integration.integrate(g, *arguments, **named)

    if kind != "closed":
        monkeypatch.setattr(module, "integrate", integrate)
    wrong = run()
    assert failed(wrong) == ["steps"]
    assert wrong.is_right is False
    (check,) = (check for check in wrong.checks if check.name == "steps")
    done, _, ways = map(int, re.findall(r"\d+", check.reason)[:3])
    assert 1 < done + ways <= single_steps.STEPS + single_steps.RESULTS
    # steps of a tree, with closures or not, are done by one stepper; a reduction of its own is made for them
    number = {"tree": (1, 1), "closed": (2, 2), "rolling": (3, 1 + done + ways)}[kind]
    assert number[0] <= len(calls) <= number[1]


@pytest.mark.parametrize("count", [2, 101])
def test_no_more_steps_are_told_of_than_there_are(count: int) -> None:
    motion = simulate(shipped("simple-pendulum"), [0.5], (0, 0.1), outputs=Outputs(count=count))
    (check,) = (check for check in motion.checks if check.name == "steps")
    done, of, ways = map(int, re.findall(r"\d+", check.reason)[:3])
    assert f"{done} of the {of} steps, and {ways} ways from one to a result, done again" in check.reason
    assert 0 < done <= of
    assert done <= single_steps.STEPS
    assert ways <= single_steps.RESULTS


def test_steps_of_a_fixed_size_that_are_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    request: Plain = {"q": [0.5], "span": (0, 1), "fixed_step": FixedStep(0.001)}
    assert simulated(shipped("simple-pendulum"), **request).is_right
    right = fixed_step.rk4_of

    def wrong(rates: CompiledRates | None) -> StepMethod:
        """Steps a little too long, in machine code or not."""
        step = right(rates)
        return lambda f, t, x, h: step(f, t, x, 1.001 * h)

    monkeypatch.setattr(fixed_step, "rk4_of", wrong)
    assert failed(simulated(shipped("simple-pendulum"), **request)) == ["steps"]


def test_they_are_done_more_carefully() -> None:
    """With a tenth of the tolerances, or ten times them where smaller ones are out of reach; at full order at once."""
    tight = single_steps.careful(Integrator(relative_tolerance=1e-8, absolute_tolerance=1e-9))
    assert (tight.method, tight.relative_tolerance, tight.absolute_tolerance) == pytest.approx(("DOP853", 1e-9, 1e-10))
    loose = single_steps.careful(Integrator(method="BDF", relative_tolerance=1e-13, absolute_tolerance=1e-14), 0.4)
    assert (loose.method, loose.max_step) == ("Radau", 0.2)
    assert loose.relative_tolerance == pytest.approx(1e-12)


def test_a_step_that_cannot_be_done_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(single_steps, "MOST", 1)
    motion = simulate(shipped("simple-pendulum"), [0.5], (0, 1))
    assert motion.is_right is None
    (left,) = (check for check in motion.checks if not check.made)
    assert "could not be done again" in left.reason
