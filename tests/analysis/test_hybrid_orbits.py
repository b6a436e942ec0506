"""Orbits through events that act: balls in closed form, and the walking machine with its published gaits."""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from analysis_models import walker

from substructures import Definition, Event, InvalidArgument, Model, Outputs, TreeSpec, couple, derive, simulate
from substructures.analysis.orbits import hybrid
from substructures.analysis.orbits.orbit import Orbit
from substructures.analysis.orbits.periodic import Section, Shooting, periodic_orbits

G = 9.81
BALL = {
    "name": "ball",
    "bodies": [{"name": "body", "parent": "base", "joint": {"type": "prismatic", "coordinate": "z"}, "mass": 2}],
}


@pytest.fixture(scope="module")
def ball() -> Model:
    tree = {
        "name": "tree",
        "gravity": [0, 0, -G],
        "parameters": {"e": {"value": 0.7}, "A": {"value": 0.01}, "w": {"value": 30}},
        "instances": [{"name": "b", "substructure": "x"}],
        "loads": [{"type": "joint", "name": "no", "coordinate": "b.z", "force": "0*e*A*w"}],
    }
    return couple(TreeSpec.read(tree), {"b": derive(Definition.read(BALL))})


def test_an_elastic_ball_bounces_for_ever(ball: Model) -> None:
    """From h: T = 2 sqrt(2 h/g), and dT/dh makes neighbours part, but not exponentially."""
    floor = Event("floor", "b.z", direction="falling", reset={"b.z'": "-b.z'"})
    (orbit,) = periodic_orbits(ball, [1], Shooting(0.9, hold=("b.z", "b.z'")), events=[floor]).found
    assert (orbit.status, orbit.is_right, orbit.stability) == ("finished", True, "neutral")
    assert orbit.period == pytest.approx(2 * math.sqrt(2 / G), rel=1e-10)
    assert np.abs(orbit.multipliers) == pytest.approx([1, 1], abs=1e-4)
    assert {check.name for check in orbit.checks} >= {"return", "product", "return-map"}


def bounced(e: float, A: float, w: float, guess: tuple[float, float]) -> tuple[Any, Any]:
    """A ball on a table A sin(w t) that comes back once in a period of it: when it bounces, and the multipliers of the
    map of (t, v) from one bounce to the next, by hand and differences of it."""
    T = 2 * math.pi / w

    def following(t: float, v: float) -> tuple[float, float]:
        at = A * math.sin(w * t)

        def gap(s: float) -> float:
            return at + v * (s - t) - G * (s - t) ** 2 / 2 - A * math.sin(w * s)

        s = scipy.optimize.brentq(gap, t + 0.3 * T, t + 1.7 * T, xtol=1e-15)
        return s, -e * (v - G * (s - t)) + (1 + e) * A * w * math.cos(w * s)

    def again(x: Any) -> Any:
        s, v = following(*x)
        return [s - T - x[0], v - x[1]]

    t, v = scipy.optimize.fsolve(again, guess, xtol=1e-14)
    h = 1e-6
    sides = [(following(t + a, v + b), following(t - a, v - b)) for a, b in ((h, 0), (0, h))]
    columns = [np.subtract(above, below) / (2 * h) for above, below in sides]
    return t, np.linalg.eigvals(np.array(columns).T)


@pytest.mark.parametrize("A", [0.005, 0.0065])
def test_a_ball_on_a_table_that_swings(ball: Model, A: float) -> None:
    """Forced, with an event that depends on the time: the multipliers of the map of bounces; their product is e^2."""
    e, w = 0.7, 30.0
    T = 2 * math.pi / w
    # v = g T/2 after each bounce, so that (1 - e)/(1 + e) g T/2 is the speed of the table there
    phase = math.acos((1 - e) / (1 + e) * G * T / 2 / (A * w)) if A > 0.0061 else None
    table = Event("table", "b.z - A*sin(w*t)", direction="falling", reset={"b.z'": "-e*b.z' + (1 + e)*A*w*cos(w*t)"})
    if phase is None:
        (lost,) = periodic_orbits(ball, [0.05], Shooting(T), parameters={"A": A}, events=[table]).found
        assert lost.status == "failed"
        return
    t0, multipliers = bounced(e, A, w, (phase / w, G * T / 2))
    height, speed = A * math.sin(w * t0), G * T / 2
    q, qd = height + speed * (T - t0) - G * (T - t0) ** 2 / 2, speed - G * (T - t0)
    (orbit,) = periodic_orbits(ball, [q + 1e-3], Shooting(T), qd=[qd], parameters={"A": A}, events=[table]).found
    assert (orbit.status, orbit.is_right, orbit.message) == ("finished", True, "")
    assert orbit.q[0] == pytest.approx(q, abs=1e-9)
    assert orbit.period == T
    (bounce,) = orbit.trajectory.events
    assert bounce.t == pytest.approx(t0, abs=1e-9)
    assert sorted(orbit.multipliers, key=np.imag) == pytest.approx(sorted(multipliers, key=np.imag), abs=1e-6)
    assert np.prod(orbit.multipliers).real == pytest.approx(e**2, rel=1e-9)
    assert orbit.stability == "stable"


#: M. Garcia, A. Chatterjee, A. Ruina, M. Coleman, The simplest walking model, J. Biomech. Eng. 120 (1998) 281-288: the
#: gait of period one at the slope 0.009, and that it is stable up to slopes of about 0.015, where it doubles its period
START = (0.2003109, -0.1998325)
STEP = Event(
    "step", "w.psi + 2*w.theta", direction="falling",
    reset={
        "w.theta": "-w.theta", "w.psi": "2*w.theta", "w.theta'": "cos(2*w.theta)*w.theta'",
        "w.psi'": "-cos(2*w.theta)*(1 - cos(2*w.theta))*w.theta'",
    },
)  # fmt: skip


def gait(slope: float, theta: float, rate: float) -> Orbit:
    q, qd = [theta, -2 * theta], [rate, -(1 - math.cos(2 * theta)) * rate]
    (found,) = periodic_orbits(walker(slope), q, Shooting(3.88), qd=qd, events=[STEP]).found
    return found


def test_the_simplest_walker_is_stable_as_published() -> None:
    orbit = gait(0.009, *START)
    assert (orbit.status, orbit.is_right, orbit.stability) == ("finished", True, "stable")
    (step,) = orbit.trajectory.events
    assert step.after is not None
    assert (step.after[0][0], step.after[1][0]) == pytest.approx(START, abs=2e-7)
    # one along the motion; two that the impact forgets; with the step's own theta and theta' two are left
    sizes = np.abs(orbit.multipliers)
    assert abs(orbit.multipliers - 1).min() < 1e-5
    assert np.sort(sizes)[0] < 1e-4


@pytest.mark.parametrize("quantity", ["w.theta", STEP.quantity])
def test_the_step_of_the_walker_takes_as_long_as_the_return(quantity: str) -> None:
    """Unknown before, from upright legs or from the strike; the published gait on the way."""
    theta, rate = START
    q, qd = [theta, -2 * theta], [rate, -(1 - math.cos(2 * theta)) * rate]
    section = Section(quantity, direction="falling")
    (orbit,) = periodic_orbits(walker(0.009), q, Shooting(None, section=section), qd=qd, events=[STEP]).found
    assert (orbit.status, orbit.is_right, orbit.stability) == ("finished", True, "stable")
    assert orbit.period == pytest.approx(gait(0.009, *START).period, rel=1e-9)
    (step,) = orbit.trajectory.events
    assert step.after is not None
    assert (step.after[0][0], step.after[1][0]) == pytest.approx(START, abs=2e-7)
    if quantity == "w.theta":
        assert orbit.q[0] == pytest.approx(0, abs=1e-12)


def test_counts_of_crossings_go_on_through_resets(ball: Model) -> None:
    """The third fall through half the height, after two bounces."""
    floor = Event("floor", "b.z", direction="falling", reset={"b.z'": "-b.z'"})
    half = Event("half", "b.z", 0.5, direction="falling", count=3)
    motion = simulate(ball, [1], (0, 9), outputs=Outputs(events=[floor, half]))
    whole = 2 * math.sqrt(2 / G)
    assert [event.name for event in motion.events] == ["half", "floor"] * 2 + ["half"]
    assert motion.events[-1].t == pytest.approx(2 * whole + math.sqrt(1 / G))


@pytest.mark.deep
def test_the_gait_doubles_its_period_where_it_does() -> None:
    """Followed from slope to slope: a real multiplier leaves the unit circle through -1 between 0.0145 and 0.0155."""
    theta, rate, leaving = *START, {}
    for slope in np.linspace(0.009, 0.0165, 16):
        orbit = gait(float(slope), theta, rate)
        assert (orbit.status, orbit.is_right) == ("finished", True), slope
        (step,) = orbit.trajectory.events
        assert step.after is not None
        theta, rate = step.after[0][0], step.after[1][0]
        leaving[round(float(slope), 5)] = orbit.stability, orbit.multipliers.real.min()
    assert leaving[0.0145][0] == "stable"
    assert leaving[0.0155][0] == "unstable"
    assert leaving[0.0145][1] > -1 > leaving[0.0155][1]


def test_a_planted_fault_is_found(ball: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """Jacobians of the reset in place of the saltation matrix."""
    floor = Event("floor", "b.z", direction="falling", reset={"b.z'": "-b.z'"})

    monkeypatch.setattr(hybrid.HybridFlow, "saltation", lambda _self, _event: np.diag([1.0, -1.0]))
    (orbit,) = periodic_orbits(ball, [1], Shooting(0.9, hold=("b.z", "b.z'")), events=[floor]).found
    assert orbit.is_right is not True


def test_events_of_orbits_act(ball: Model) -> None:
    for event, pointer in (
        (Event("floor", "b.z"), "/events/0/reset"),
        (Event("floor", "b.y", direction="falling", reset={"b.z'": 1}), "/events/0/quantity"),
    ):
        with pytest.raises(InvalidArgument) as caught:
            periodic_orbits(ball, [1], Shooting(0.9), events=[event])
        assert caught.value.faults[0].pointer == pointer
