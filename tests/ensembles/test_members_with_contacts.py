"""Members with contacts and events: each is the motion that is simulated alone; one that fails is told by number."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from contact_models import BALL, G, block, of

from substructures import Model, simulate
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.motion.problems.outputs import Outputs
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.simulate import Contact, TreeMotion
from substructures.ensembles.ensemble import simulate_ensemble
from substructures.ensembles.motion_column import MotionColumn
from substructures.errors import InvalidArgument

FLOOR = Contact("floor", "b.body", restitution=0.8)
BOUNCE = Event("bounce", "b.z", direction="falling", reset={"b.z'": "-0.8*b.z'"})
HEIGHT = {"end": MotionColumn(expression="b.z"), "top": MotionColumn(expression="b.z", take="largest")}


@pytest.fixture(scope="module")
def ball() -> Model:
    return of("b", BALL, [0, 0, -G])


def test_members_are_the_motions_of_simulations() -> None:
    """Blocks that are thrown onto rough ground, with other masses, pushes and starts: impacts, slip and rest."""
    feet = [{"name": c, "point": f"b.{c}", "type": "point_line", "friction": "0.4"} for c in ("l", "r")]
    part = {**block(0.2, 0.1), "parameters": {"m": {"value": 2, "unit": "kg"}}}
    part["bodies"][-1]["mass"] = "m"
    model = of("b", part, [0, 0, -G], contacts=feet)
    q, qd = [[0, 0.3, 0.2], [0, 0.1, 0], [0, 0.15, -0.1]], [[1.0, 0, 0], [2.0, 0, 0], [0, 0, 0.5]]
    masses, push = [2.0, 3.0, 1.0], {"tau.b.x": "2*sin(5*t)"}
    found = simulate_ensemble(
        model, q, (0, 0.6), qd=qd, parameters={"b.m": masses}, inputs=push, grid=OutputGrid(None, 0.05)
    )
    assert found.q is not None
    assert found.qd is not None
    assert found.happened is not None
    assert (found.is_right, found.failed) == (True, 0)
    assert {check["name"] for check in found.checks} >= {"penetration", "contacts", "impact-energy", "impacts"}
    assert found.happened.impacts.tolist() == [3, 0, 4]
    for k in range(3):
        alone = simulate(
            model, q[k], (0, 0.6), qd=qd[k], parameters={"b.m": masses[k]}, inputs=push, outputs=Outputs(times=found.t)
        )
        assert np.abs(found.q[k] - alone.q).max() <= 1e-9
        assert np.abs(found.qd[k] - alone.qd).max() <= 1e-9
        hits = [event for event in alone.events if event.kind == "impact"]
        assert found.happened.impacts[k] == len(hits)
        assert found.happened.energy_change[k] == pytest.approx(sum(hit.energy_change for hit in hits), rel=1e-9)
        told = [(e["name"], e["kind"]) for e in found.happened.events if e["member"] == k]
        assert told == [(event.name, event.kind) for event in alone.events]


def test_what_impacts_take_is_what_is_missing(ball: Model) -> None:
    heights = [0.5, 1.0, 2.0]
    how = Integrator(relative_tolerance=1e-10)
    kind = TreeMotion(contacts=[FLOOR])
    found = simulate_ensemble(ball, [[h] for h in heights], (0, 6), kind=kind, integrator=how, columns=HEIGHT)
    assert found.happened is not None
    assert found.q is None
    np.testing.assert_allclose(found.columns["top"], heights)
    # they lie still in the end: m g h is gone
    np.testing.assert_allclose(found.columns["end"], 0, atol=1e-12)
    np.testing.assert_allclose(found.happened.energy_change, [-2 * G * h for h in heights], rtol=1e-7)
    assert (found.violation <= 1).all()
    assert found.summary()["one_by_one"] is True


def test_checks_count_the_members_that_violate_them() -> None:
    """The second member is pushed, which these tolerances follow only roughly; the first is a parabola."""
    how, kind = Integrator(relative_tolerance=1e-3, drift_limit=1e-12), TreeMotion(contacts=[FLOOR])
    push: dict[str, Any] = {"parameters": {"b.w": [0.0, 9.0]}, "inputs": {"tau.b.z": "sin(b.w*t)^3"}}
    model = of("b", {**BALL, "parameters": {"w": {"value": 0, "unit": "rad/s"}}}, [0, 0, -G])
    found = simulate_ensemble(model, [[2], [2]], (0, 0.5), kind=kind, integrator=how, **push)
    assert (found.is_right, found.violation[0] <= 1, found.violation[1] > 1) == (False, True, True)
    violated = {check["name"]: check["violated"] for check in found.checks}
    assert violated["steps"] == 1
    assert set(violated.values()) == {0, 1}


def test_a_member_that_fails_is_told_and_the_others_stay(ball: Model) -> None:
    below = simulate_ensemble(ball, [[1], [-1], [0.2]], (0, 1), kind=TreeMotion(contacts=[FLOOR]), columns=HEIGHT)
    (failure,) = below.failures
    assert (failure.member, below.failed, "below its plane" in failure.message) == (1, 1, True)
    assert np.isnan(below.columns["end"]).tolist() == np.isnan(below.violation).tolist() == [False, True, False]
    zeno = simulate_ensemble(ball, [[1], [10]], (0, 5), events=[BOUNCE])
    (failure,) = zeno.failures
    assert (failure.member, "Zeno" in failure.message) == (0, True)
    assert failure.t == pytest.approx(np.sqrt(2 / G) * (1 + 2 * 0.8 / 0.2), rel=1e-5)
    assert zeno.q is not None
    assert np.isnan(zeno.q[:, -1, 0]).tolist() == [True, False]
    assert zeno.is_right is None


def test_events_act_and_stop_in_each_member(ball: Model) -> None:
    stop = Event("up", "b.z'", direction="falling", action="stop")
    events = [BOUNCE, stop]
    found = simulate_ensemble(ball, [[1], [2]], (0, 5), events=events, columns=HEIGHT, states=True)
    assert found.happened is not None
    assert found.q is not None
    assert (found.is_right, found.failed) == (True, 0)
    # at the top of the first flight
    np.testing.assert_allclose(found.columns["end"], [0.64, 1.28], rtol=1e-9)
    np.testing.assert_allclose(found.happened.ends, [1.8 * np.sqrt(2 * h / G) for h in (1, 2)], rtol=1e-9)
    np.testing.assert_allclose(found.happened.energy_change, [-0.36 * 2 * G * h for h in (1, 2)], rtol=1e-9)
    for k, h in enumerate((1.0, 2.0)):
        alone = simulate(ball, [h], (0, 5), outputs=Outputs(times=found.t, events=events))
        kept = np.isfinite(found.q[k, :, 0])
        np.testing.assert_allclose(found.q[k, kept, 0], alone.q[: kept.sum(), 0], rtol=0, atol=1e-9)
        assert not np.isfinite(found.q[k, found.t > found.happened.ends[k]]).any()


def test_who_watches_may_have_enough(ball: Model) -> None:
    told = list[float]()

    def watch(share: float) -> bool:
        told.append(share)
        return share < 0.45

    how = Integrator(progress=watch)
    found = simulate_ensemble(ball, [[1]] * 5, (0, 2), kind=TreeMotion(contacts=[FLOOR]), integrator=how)
    assert (found.cancelled, found.count, found.is_right) == (True, 2, None)
    assert told == sorted(told)


@pytest.mark.parametrize(
    ("column", "place"),
    [
        ({"expression": "b.z", "take": "integral"}, "/columns/x/take"),
        ({"quantity": "forward_dynamics", "of": "b.z"}, "/columns/x/quantity"),
    ],
)
def test_what_is_not_followed_is_refused(ball: Model, column: dict[str, Any], place: str) -> None:
    with pytest.raises(InvalidArgument) as raised:
        simulate_ensemble(ball, [1], (0, 1), kind=TreeMotion(contacts=[FLOOR]), columns={"x": MotionColumn(**column)})
    assert raised.value.faults[0].pointer == place
