"""End stops at joint limits: a one-sided spring and damper with a potential, beyond the limits only."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_trees import Plain, model_of

from substructures import Model
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.problem import ControlProblem, Cost
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.motion.parameter_sensitivity import sensitivities
from substructures.analysis.motion.problems.outputs import SensitivityOutputs
from substructures.analysis.simulate import ClosedMotion, Event, Outputs, simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.limits import Limits


def slide(stops: Plain, gravity: float = 0, **joint: Any) -> Model:
    """A mass of 2 kg on the vertical between -1 and 3."""
    ends = {"type": "prismatic", "coordinate": "x", "limits": [-1, 3], "limits_act": stops}
    body: Plain = {"name": "b", "parent": "base", "mass": 2, "joint": ends | joint}
    return model_of({"name": "a", "bodies": [body]}, (0, 0, -gravity))


def test_the_force_of_the_stops() -> None:
    """(k + c p') p against what is beyond, nothing in between, and V with the force as its gradient."""
    model = slide({"stiffness": 100, "damping": 7})
    q, qd = np.array([[-1.5], [-0.9], [2.9], [3.2]]), np.array([[-2.0], [5.0], [5.0], [0.5]])
    found = evaluate(model, ["forces", "potential_energy"], q=q, qd=qd)
    np.testing.assert_allclose(found["forces"][:, 0], [(100 + 14) * 0.5, 0, 0, -(100 + 3.5) * 0.2])
    np.testing.assert_allclose(found["potential_energy"], [12.5, 0, 0, 2.0])


def test_a_mass_bounces_back() -> None:
    """2 m/s onto a stop of 50 N/m: half a period pi sqrt(m/k) in contact, deepest at v sqrt(m/k)."""
    contact = np.pi * np.sqrt(2 / 50)
    events = [Event("top", "x.x'", action="record")]
    motion = simulate(
        slide({"stiffness": 50}), [2.0], (0, 0.5 + contact + 0.3), qd=[2.0], outputs=Outputs(count=2, events=events)
    )
    assert motion.is_right
    assert [c.rule for c in motion.checks] == ["constant", "accurate"]
    np.testing.assert_allclose(motion.q[-1], 3 - 2 * 0.3, atol=1e-7)
    np.testing.assert_allclose(motion.qd[-1], -2, atol=1e-7)
    np.testing.assert_allclose(motion.events[0].q, 3 + 2 * np.sqrt(2 / 50), atol=1e-7)


def test_how_high_a_ball_bounces() -> None:
    """m v dv/dp = -(k + c v) p in contact, so that with b = c/k the function v/b - ln(1 + b v)/b^2 + k p^2/(2 m) is
    constant: it is the same of the speed in and minus the speed out, whatever the stiffness (Hunt and Crossley 1975).
    """
    k, c, speed = 400.0, 300.0, 1.5
    events = [Event("leaves", "x.x", 3, "falling", "stop")]
    motion = simulate(
        slide({"stiffness": 400, "damping": 300}), [2.7], (0, 5), qd=[speed], outputs=Outputs(events=events)
    )
    assert motion.is_right, motion.checks
    out, b = -float(motion.qd[-1, 0]), c / k

    def kept(v: float) -> float:
        return float(v / b - np.log1p(b * v) / b**2)

    assert 0.3 * speed < out < 0.7 * speed
    np.testing.assert_allclose(kept(-out), kept(speed), rtol=1e-8)
    # what is lost is the work of the stop
    lost = 2 * (out**2 - speed**2) / 2
    np.testing.assert_allclose(motion.series["work"][-1], lost, rtol=1e-8)
    np.testing.assert_allclose(np.diff(motion.series["energy"][[0, -1]]), lost, rtol=1e-8)


def test_damping_takes_energy_and_never_feeds_it_in() -> None:
    """A ball between two stops with gravity: the energy falls, and it comes to rest on the lower one at m g/k."""
    model = slide({"stiffness": 500, "damping": 2000}, 9.81)
    (energy,) = (i for i in first_integrals(model).integrals if i.kind == "energy")
    assert energy.rule == "falling"
    motion = simulate(model, [2.5], (0, 8), qd=[3.0], outputs=Outputs(count=200))
    assert motion.is_right, motion.checks
    assert {c.rule for c in motion.checks} == {"constant", "falling", "accurate"}
    np.testing.assert_allclose(motion.q[-1], -1 - 2 * 9.81 / 500, atol=1e-3)


def test_rest_between_and_on_the_stops() -> None:
    """Between them as if there were none; pressed onto one by gravity at the depth m g/k."""
    free = equilibria(slide({"stiffness": 500, "damping": 3}, stiffness=4), reach=0.8)
    assert [(e.q.tolist(), e.verdict) for e in free.found] == [([0.0], "stable")]
    pressed = equilibria(slide({"stiffness": 500}, 9.81), reach=2.0)
    assert [e.verdict for e in pressed.found] == ["stable"]
    np.testing.assert_allclose(pressed.found[0].q, -1 - 2 * 9.81 / 500)


def test_stops_of_a_compound_joint_that_begin_at_zero() -> None:
    """One for each coordinate, with parameters; a start at the corner of the force does not end the search."""
    joint: Plain = {
        "type": "cylindrical",
        "coordinate": ["turn", "rise"],
        "limits": [[0, 1], [0, "h"]],
        "limits_act": [{"stiffness": 10}, {"stiffness": "k"}],
    }
    body: Plain = {"name": "b", "parent": "base", "mass": 2, "inertia": {"xx": 1, "yy": 1, "zz": 1}, "joint": joint}
    parameters = {"h": {"value": 2}, "k": {"value": 100}}
    model = model_of({"name": "a", "bodies": [body], "parameters": parameters}, (0, 0, -1))
    found = evaluate(model, ["forces"], q=[[-0.1, 2.5], [1.2, -0.25]])["forces"]
    np.testing.assert_allclose(found, [[1, -52], [-2, 23]], atol=1e-12)
    resting = equilibria(model, count=20).found
    assert resting
    np.testing.assert_allclose([e.q[1] for e in resting], -0.02, atol=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_both_stops_are_alike(sign: float) -> None:
    model = slide({"stiffness": 20, "damping": 1}, limits=[-2, 2])
    motion = simulate(model, [0.5 * sign], (0, 3), qd=[4.0 * sign], outputs=Outputs(count=5))
    other = simulate(model, [0.5], (0, 3), qd=[4.0], outputs=Outputs(count=5))
    np.testing.assert_allclose(motion.q * sign, other.q, atol=1e-9)


def test_limits_without_stops_are_warned_of() -> None:
    """A mass that is thrown up and turns beyond its limit between two results; the same, held by a stop."""
    joint: Plain = {"type": "prismatic", "coordinate": "x", "limits": [-1, "h"]}
    body: Plain = {"name": "b", "parent": "base", "mass": 2, "joint": joint}
    definition = {"name": "a", "bodies": [body], "parameters": {"h": {"value": 3}}}
    model = model_of(definition, (0, 0, -10))
    motion = simulate(model, [0.0], (0, 2), qd=[10.0], outputs=Outputs(count=2))
    assert motion.is_right
    assert motion.limits == {"x.x": [-1.0, 3.0]}
    assert motion.reached is not None
    np.testing.assert_allclose(motion.reached[1], 5, rtol=1e-9)
    (warning,) = motion.summary()["warnings"]
    assert warning["code"] == "limits-left"
    assert warning["pointer"] == "/q/x.x"
    assert "goes up to 5 m" in warning["message"]
    assert simulate(model, [0.0], (0, 2), qd=[10.0], parameters={"h": 5.5}, outputs=Outputs(count=2)).warnings == ()
    both = simulate(model, [0.0], (0, 2.5), qd=[10.0], outputs=Outputs(count=2)).warnings
    assert "down to -6.25 m and up to 5 m" in both[0]["message"]
    still = Limits(("x.x",), "P", np.array([-1.0]), np.array([3.0])).warnings(np.array([4.0]), np.array([4.0]))
    assert "goes up to 4 m" in still[0]["message"]


def test_every_kind_of_motion_tells_of_its_limits() -> None:
    """Sensitivities, prescribed motions and cost gradients warn alike; a limit without value is told."""
    joint: Plain = {"type": "prismatic", "coordinate": "x", "limits": [0, "h"]}
    body: Plain = {"name": "b", "parent": "base", "mass": 2, "joint": joint}
    definition: Plain = {"name": "a", "bodies": [body], "parameters": {"h": {}}}
    model, given = model_of(definition, (0, 0, -10)), {"h": 1.0}
    motions = [
        sensitivities(model, [0.5], (0, 1), parameters=given, outputs=SensitivityOutputs(of_start=True)),
        simulate(model, [0.5], (0, 1), parameters=given, kind=ClosedMotion(prescribed={"x.x": "1/2 - t"})),
        cost_gradient(
            model,
            ControlProblem(
                controls=["tau.x.x"], horizon=1.0, intervals=9, q=[0.5], cost=Cost(running="x.x^2"), parameters=given
            ),
        ).trajectory,
    ]
    for motion in motions:
        assert motion.limits == {"x.x": [0.0, 1.0]}
        assert [w["code"] for w in motion.warnings] == ["limits-left"]
    unknown = simulate(model, [0.5], (0, 0.1), qd=[0.0])
    assert [w["code"] for w in unknown.warnings] == ["limits-unknown"]
