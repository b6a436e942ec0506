"""Events that act: a bouncing ball in closed form, the simplest walking machine, and what is no event that acts."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from analysis_models import walker

from substructures import (
    Definition,
    Event,
    FixedStep,
    Integrator,
    InvalidArgument,
    Linear,
    Model,
    Outputs,
    TreeSpec,
    couple,
    derive,
    simulate,
)
from substructures.analysis.motion import resets
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import ConstrainedMotion, TreeMotion
from substructures.array import Array

G, E = 9.81, 0.8
BALL = {
    "name": "ball",
    "bodies": [{"name": "body", "parent": "base", "joint": {"type": "prismatic", "coordinate": "z"}, "mass": 2}],
}
FLOOR = Event("floor", "b.z", direction="falling", reset={"b.z'": f"-{E}*b.z'"})


def of(name: str, definition: Any, gravity: list[Any], **more: Any) -> Model:
    spec = TreeSpec.read(
        {"name": "tree", "gravity": gravity, "instances": [{"name": name, "substructure": "x"}], **more}
    )
    return couple(spec, {name: derive(Definition.read(definition))})


@pytest.fixture(scope="module")
def ball() -> Model:
    return of("b", BALL, [0, 0, -G])


def bounces(count: int) -> Array:
    """When a ball that falls from 1 m touches the floor."""
    first = math.sqrt(2 / G)
    return first + np.cumsum([0, *(2 * first * E**k for k in range(1, count))])


def test_a_ball_bounces_as_it_does(ball: Model) -> None:
    motion = simulate(ball, [1], (0, 3), outputs=Outputs(events=[FLOOR], count=301))
    times = bounces(20)
    times = times[times < 3]
    assert [event.t for event in motion.events] == pytest.approx(times, abs=1e-12)
    assert (motion.status, motion.is_right, len(motion.t)) == ("finished", True, 301)
    edges = [0.0, *times, 3.0]
    for k, (start, end) in enumerate(pairwise(edges)):
        inside = (motion.t > start) & (motion.t <= end)
        t = motion.t[inside] - start
        speed = 0.0 if k == 0 else E**k * math.sqrt(2 * G)
        height = (1.0 if k == 0 else 0.0) + speed * t - G * t * t / 2
        assert motion.q[inside, 0] == pytest.approx(height, abs=1e-11)


def test_an_event_may_happen_where_a_result_is_wanted(ball: Model) -> None:
    """Within rounding: between the two is no step that could be done again."""
    first = math.sqrt(2 / G)
    for beside in (0, 1, -1, 3):
        when = first + beside * np.spacing(first)
        motion = simulate(ball, [1], (0, 1), outputs=Outputs(events=[FLOOR], times=[0, when, 1]))
        assert (motion.status, motion.is_right) == ("finished", True)


def test_what_events_do_to_the_energy_is_told(ball: Model) -> None:
    motion = simulate(ball, [1], (0, 3), outputs=Outputs(events=[FLOOR]))
    for k, event in enumerate(motion.events):
        assert event.after is not None
        assert event.after[0] == pytest.approx(event.q)
        assert event.after[1] == pytest.approx(-E * event.qd)
        assert event.energy_change == pytest.approx(2 * G * E ** (2 * k) * (E * E - 1))
    energy, lost = motion.series["energy"], sum(event.energy_change for event in motion.events)
    assert energy[-1] - energy[0] == pytest.approx(lost)
    told = motion.summary()["events"][0]
    assert set(told) == {"name", "t", "q", "qd", "after", "energy_change"}


def test_bounces_that_accumulate_stop_the_motion(ball: Model) -> None:
    motion = simulate(ball, [1], (0, 10), outputs=Outputs(events=[FLOOR]))
    assert (motion.status, motion.is_right) == ("stopped", True)
    assert "(Zeno)" in motion.message
    assert motion.t[-1] == pytest.approx(math.sqrt(2 / G) * (1 + E) / (1 - E), abs=1e-4)
    assert np.abs([*motion.q[-1], *motion.qd[-1]]).max() < 1e-4
    assert len(motion.t) == len(motion.series["energy"])
    assert motion.series["energy"][-1] == pytest.approx(motion.qd[-1, 0] ** 2 + 2 * G * motion.q[-1, 0], abs=1e-15)
    late = simulate(ball, [1], (0, 10), outputs=Outputs(events=[FLOOR], times=[9]))
    assert (late.status, len(late.t), late.t[-1]) == ("stopped", 1, motion.t[-1])
    assert len(motion.events) < 100


@pytest.mark.parametrize("share", [0.2, 0.35, 0.5, 0.65, 0.8])
def test_what_is_slowed_down_where_it_passes_is_slowed_down_once(ball: Model, share: float) -> None:
    """z falls through 0 at t = sqrt(2 h/g), and goes on with a share of its speed."""
    sheet = Event("sheet", "b.z", direction="falling", reset={"b.z'": f"{share}*b.z'"})
    for h in (0.3, 0.7, 1.0, 1.9):
        motion = simulate(ball, [h], (0, 1), outputs=Outputs(events=[sheet], times=[1]))
        first = math.sqrt(2 * h / G)
        left = 1 - first
        assert [event.t for event in motion.events] == pytest.approx([first], abs=1e-12)
        assert motion.q[-1, 0] == pytest.approx(-share * G * first * left - G * left**2 / 2, abs=1e-11)


def test_what_does_not_bounce_at_all_does_not_fall_through(ball: Model) -> None:
    """At rest on the floor, or on one that is moved, the motion ends; what is drawn away from it goes on."""
    stays = replace(FLOOR, reset={"b.z'": "0"})
    motion = simulate(ball, [1], (0, 10), outputs=Outputs(events=[stays]))
    assert (motion.status, motion.is_right, len(motion.events)) == ("stopped", True, 1)
    assert "of a body at rest" in motion.message
    moved = replace(FLOOR, quantity="b.z - 0.1*sin(3*t)", reset={"b.z'": "0.3*cos(3*t)"})
    assert simulate(ball, [1], (0, 3), outputs=Outputs(events=[moved])).status == "stopped"
    motion = simulate(ball, [1], (0, 2), inputs={"tau.b.z": "40*t"}, outputs=Outputs(events=[stays]))
    assert (motion.status, len(motion.events)) == ("finished", 1)


@pytest.mark.parametrize(("gravity", "height"), [("9.81e-8", 1e-3), ("9.81e9", 1e-6)])
def test_what_does_not_bounce_is_seen_however_slow_or_quick_it_is(gravity: str, height: float) -> None:
    falling = of("b", BALL, [0, 0, f"-{gravity}"])
    first = math.sqrt(2 * height / float(gravity))
    stays = replace(FLOOR, reset={"b.z'": "0"})
    motion = simulate(falling, [height], (0, 9 * first), outputs=Outputs(events=[stays]))
    assert (motion.status, len(motion.events)) == ("stopped", 1)
    assert motion.t[-1] == pytest.approx(first, rel=1e-8)


def test_positions_jump_and_other_events_are_noted_on_the_way(ball: Model) -> None:
    up = Event("half", "b.z", level=0.5, action="record")
    gate = Event("gate", "b.z", direction="falling", reset={"b.z": "b.z + 1", "b.z'": "b.z' - 0.1*t"})
    motion = simulate(ball, [1], (0, 1), outputs=Outputs(events=[up, gate]))
    assert [event.name for event in motion.events][:3] == ["half", "gate", "half"]
    first = motion.events[1]
    assert first.after is not None
    assert first.after[0] == pytest.approx(first.q + 1)
    assert first.after[1] == pytest.approx(first.qd - 0.1 * first.t)
    last = Event("third", "b.z'", level=-6, direction="falling")
    stopped = simulate(ball, [1], (0, 2), outputs=Outputs(events=[gate, last]))
    assert (stopped.status, stopped.events[-1].name) == ("stopped", "third")


def test_work_goes_on_over_events() -> None:
    drag = {"type": "joint", "name": "air", "coordinate": "b.z", "force": "-0.5*b.z'"}
    motion = simulate(of("b", BALL, [0, 0, -G], loads=[drag]), [1], (0, 2), outputs=Outputs(events=[FLOOR]))
    assert motion.is_right
    energy, work = motion.series["energy"], motion.series["work"]
    lost = [sum(event.energy_change for event in motion.events if event.t < t) for t in motion.t]
    assert energy - work - np.array(lost) == pytest.approx(energy[0])
    assert (np.diff(work) <= 0).all()


def test_a_wrong_verdict_of_a_piece_is_that_of_the_motion(ball: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    """A planted fault: in the third piece the energy is said to drift."""
    whole, pieces = resets._joined, []

    def joined(found: list[Trajectory]) -> Trajectory:
        pieces.append(found)
        return whole(found)

    monkeypatch.setattr(resets, "_joined", joined)
    simulate(ball, [1], (0, 2), outputs=Outputs(events=[FLOOR]))
    (found,) = pieces
    broken = [type(check)(**{**vars(check), "time": 1.5}) for check in found[2].checks]
    bad = type(found[2])(**{**vars(found[2]), "checks": tuple(broken)})
    assert whole([*found[:2], bad, *found[3:]]).is_right is False


@pytest.mark.parametrize(
    ("event", "pointer", "message"),
    [
        ({"reset": {"b.z'": 1}}, "/events/0/direction", "needs its direction"),
        ({"direction": "falling", "reset": {"b.y": 1}}, "/events/0/reset/b.y", "did you mean 'b.z'"),
        ({"direction": "falling", "reset": {"b.z'": "b.w"}}, "/events/0/reset/b.z'", "b.w"),
    ],
)
def test_bad_resets_are_refused(ball: Model, event: Any, pointer: str, message: str) -> None:
    with pytest.raises(InvalidArgument, match=message) as caught:
        simulate(ball, [1], (0, 1), outputs=Outputs(events=[Event("e", "b.z", **event)]))
    assert caught.value.faults[0].pointer == pointer


def test_where_no_events_act(ball: Model) -> None:
    still = ConstrainedMotion([Linear("still", "b.z'")])
    with pytest.raises(InvalidArgument, match="leave 'reset' out"):
        simulate(ball, [1], (0, 1), kind=still, outputs=Outputs(events=[FLOOR]))
    with pytest.raises(InvalidArgument, match="steps of a fixed size"):
        simulate(ball, [1], (0, 1), integrator=Integrator(FixedStep(0.01)), outputs=Outputs(events=[FLOOR]))
    with pytest.raises(InvalidArgument, match="a second event 'floor'"):
        simulate(ball, [1], (0, 1), outputs=Outputs(events=[FLOOR, FLOOR]))
    nowhere = Event("floor", "b.z", direction="falling", reset={"b.z'": "exp(800 + b.z)"})
    lost = simulate(ball, [1], (0, 3), outputs=Outputs(events=[nowhere]))
    assert (lost.status, lost.is_right) == ("failed", None)
    assert "leads to no finite state" in lost.message


def test_a_slide_with_exact_friction_is_thrown_back() -> None:
    """On the flat with mu g = 1 N/kg from 2 m/s a wall at 1 m halves its speed; then it slides back and stays."""
    joint = {**BALL["bodies"][0]["joint"], "friction": {"coulomb": 2, "velocity": 0.001}}
    block = {**BALL, "bodies": [{**BALL["bodies"][0], "joint": joint}]}
    model = of("b", block, [0, 0, 0])
    wall = Event("wall", "b.z", level=1, direction="rising", reset={"b.z'": "-b.z'/2"})
    motion = simulate(model, [0], (0, 3), qd=[2], kind=TreeMotion(friction="exact"), outputs=Outputs(events=[wall]))
    hit, stop = motion.events
    assert hit.qd == pytest.approx([math.sqrt(2)])
    assert (stop.name, stop.kind) == ("b.z", "stick")
    assert (motion.status, motion.is_right) == ("finished", True)
    assert motion.q[-1] == pytest.approx([1 - 0.25])
    assert motion.qd[-1] == pytest.approx([0], abs=1e-12)


def test_a_start_without_accelerations_fails_as_without_events() -> None:
    light = {**BALL, "bodies": [{**BALL["bodies"][0], "mass": 0}]}
    motion = simulate(of("b", light, [0, 0, -G]), [1], (0, 1), outputs=Outputs(events=[FLOOR]))
    assert (motion.status, motion.reached, motion.is_right) == ("failed", None, None)


def test_an_event_at_the_end_finishes_the_motion(ball: Model) -> None:
    whole = simulate(ball, [1], (0, 1), outputs=Outputs(events=[FLOOR]))
    motion = simulate(ball, [1], (0, whole.events[0].t), outputs=Outputs(events=[FLOOR]))
    assert (motion.status, motion.message) == ("finished", "")
    assert motion.t[-1] == whole.events[0].t


def test_progress_is_that_of_the_whole(ball: Model) -> None:
    told: list[float] = []

    def report(share: float) -> bool:
        told.append(share)
        return len(told) < 5

    motion = simulate(ball, [1], (0, 3), integrator=Integrator(progress=report), outputs=Outputs(events=[FLOOR]))
    assert motion.cancelled
    assert told == sorted(told)


#: M. Garcia, A. Chatterjee, A. Ruina, M. Coleman, The simplest walking model, J. Biomech. Eng. 120 (1998) 281-288: at
#: the slope 0.009 the long period-one gait starts at theta = 0.2003109, theta' = -0.1998325 (l = g = M = 1, no mass of
#: feet, which is 1e-9 here)
SLOPE, START = 0.009, (0.2003109, -0.1998325)


def test_the_simplest_walker_walks_as_published() -> None:
    """The gait repeats itself; that the foot scuffs on the way, rising through the ground, is no step."""
    theta, rate = START
    model = walker(SLOPE)
    q = [theta, -2 * theta]  # psi = -phi turns the swing leg against the stance leg
    qd = [rate, -(1 - math.cos(2 * theta)) * rate]
    step = Event(
        "step", "w.psi + 2*w.theta", direction="falling",
        reset={
            "w.theta": "-w.theta", "w.psi": "2*w.theta", "w.theta'": "cos(2*w.theta)*w.theta'",
            "w.psi'": "-cos(2*w.theta)*(1 - cos(2*w.theta))*w.theta'",
        },
    )  # fmt: skip
    motion = simulate(model, q, (0, 4), qd=qd, outputs=Outputs(events=[step]))
    assert [event.name for event in motion.events] == ["step"]
    (first,) = motion.events
    assert first.after is not None
    assert first.t == pytest.approx(3.88, abs=0.01)
    assert (first.after[0][0], first.after[1][0]) == pytest.approx(START, abs=3e-6)


def test_an_event_that_acts_has_its_name_alone(ball: Model) -> None:
    """Else it would act where the other one stops the motion."""
    half = Event("floor", "b.z-1/2", direction="falling")
    for events in ([FLOOR, half], [half, FLOOR]):
        with pytest.raises(InvalidArgument, match="/events/1/name: a second event 'floor'"):
            simulate(ball, [1], (0, 3), outputs=Outputs(events=events))


#: a block on the flat that needs 2 N to slip
ROUGH = {**BALL["bodies"][0]["joint"], "friction": {"coulomb": 2, "velocity": 0.001}}


def test_what_friction_holds_at_a_wall_stays_there() -> None:
    """On the flat with mu g = 1 N/kg from 2 m/s to a wall at 1 m that takes its speed: pushed by less than 2 N it stays
    there, by more the motion ends there, at the wall or where the push has grown.
    """
    block = {**BALL, "bodies": [{**BALL["bodies"][0], "joint": ROUGH}]}
    model, stays = of("b", block, [0, 0, 0]), {"b.z'": 0}
    wall = Event("wall", "b.z", level=1, direction="rising", reset=stays)
    given: dict[str, Any] = {"qd": [2], "kind": TreeMotion(friction="exact"), "outputs": Outputs(events=[wall])}
    held = simulate(model, [0], (0, 3), inputs={"tau.b.z": 1}, **given)
    # 4 - 2 (2 - tau)/m = v^2 at the wall
    assert (held.status, len(held.events), held.events[0].qd) == ("finished", 1, pytest.approx([math.sqrt(3)]))
    assert held.q[-1] == pytest.approx([1], abs=1e-12)
    pushed = simulate(model, [0], (0, 3), inputs={"tau.b.z": 3}, **given)
    assert (pushed.status, len(pushed.events)) == ("stopped", 1)
    later = simulate(model, [0], (0, 3), inputs={"tau.b.z": "t"}, **given)
    assert (later.status, [each.name for each in later.events]) == ("stopped", ["wall", "b.z", "wall"])
    assert (later.t[-1], later.q[-1, 0]) == (pytest.approx(2, abs=1e-3), pytest.approx(1, abs=1e-9))
    assert later.is_right


@pytest.mark.parametrize("turn", [(1, 0, 0, 0), (0.8, 0, 0.6, 0)])
def test_what_floats_does_not_fall_through_either(turn: tuple[float, ...]) -> None:
    """Its centre comes to rest on the floor at any attitude: v = 0 in the axes of the body."""
    v, w = [f"v{k}" for k in "xyz"], [f"w{k}" for k in "xyz"]
    joint = {"type": "floating", "velocities": [*v, *w]}
    body = {**BALL["bodies"][0], "joint": joint, "inertia": {"xx": 1, "yy": 1, "zz": 1}}
    model = of("b", {**BALL, "bodies": [body]}, [0, 0, -G])
    height = model.positions[2]
    floor = Event("floor", height, direction="falling", reset={f"b.{name}'": 0 for name in v})
    motion = simulate(model, [0, 0, 1, *turn], (0, 1), outputs=Outputs(events=[floor]))
    assert (motion.status, len(motion.events), motion.is_right) == ("stopped", 1, True)
    assert motion.t[-1] == pytest.approx(math.sqrt(2 / G), abs=1e-10)
    # thrown up instead, at a share of the speed along its own axes
    thrown = replace(floor, reset={f"b.{name}'": f"-b.{name}'/2" for name in v})
    back = simulate(model, [0, 0, 1, *turn], (0, 0.7), outputs=Outputs(events=[thrown], times=[0.7]))
    left = 0.7 - math.sqrt(2 / G)
    assert back.q[-1, 2] == pytest.approx(math.sqrt(2 * G) / 2 * left - G * left**2 / 2, abs=1e-10)
