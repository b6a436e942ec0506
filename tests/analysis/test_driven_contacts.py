"""Contacts with planes whose motion is given: a shaken plate, a belt, a plane that turns, in closed form."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from closed_trees import tree_model
from contact_models import BALL, PLACED, G, on_moving_plate
from contact_models import point as space_point

from substructures import Contact, InvalidInput, Model, Outputs, TreeMotion, simulate
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.contacts.contact_motion import SLIP, STICK, ContactMotion
from substructures.analysis.motion.contacts.deciding import DecidedContacts
from substructures.analysis.motion.problems.contacts import contacts_of
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.trajectory import Trajectory
from substructures.compile import target

A, W = 0.05, 20.0
GIVEN = {"input": True}


def floor(kind: str, axis: list[int]) -> dict[str, Any]:
    """A plane that moves, or turns, about or along an axis."""
    joint = {"type": kind, "coordinate": "s", "axis": axis, **PLACED}
    bodies = [{"name": "plate", "parent": "base", "joint": joint, "mass": 1}]
    return {"name": "floor", "bodies": bodies, "ports": [{"name": "top", "body": "plate"}]}


def point() -> dict[str, Any]:
    """2 kg in the plane of x and z."""
    slide = {"type": "prismatic", **PLACED}
    bodies = [
        {"name": "across", "parent": "base", "joint": {**slide, "coordinate": "x", "axis": [1, 0, 0]}},
        {"name": "body", "parent": "across", "joint": {**slide, "coordinate": "z", "axis": [0, 0, 1]}, "mass": 2},
    ]
    return {"name": "point", "bodies": bodies}


def on(plane: dict[str, Any], motion: Any, what: dict[str, Any]) -> Model:
    instances = [{"name": "f", "substructure": "floor"}, {"name": "b", "substructure": what["name"]}]
    tree = {"gravity": [0, 0, -G], "instances": instances, "driven": {"f.s": motion}}
    return tree_model(tree, {"floor": plane, what["name"]: what})


def move(model: Model, q: Any, qd: Any, end: float, contact: Contact, inputs: Any = None) -> Trajectory:
    motion = simulate(
        model, q, (0, end), qd=qd, inputs=inputs, kind=TreeMotion(contacts=[contact]), outputs=Outputs(count=101)
    )
    assert (motion.status, motion.is_right) == ("finished", True), motion
    return motion


@pytest.mark.parametrize("given", [f"{A}*sin({W}*t)", GIVEN])
def test_a_ball_leaves_a_shaken_plate_where_it_falls_faster(given: Any) -> None:
    """It lies with m (g - A w^2 sin wt), leaves where that is 0, and comes down again."""
    inputs = {"f.s": f"{A}*sin({W}*t)", "f.s'": f"{A * W}*cos({W}*t)", "f.s''": f"-{A * W * W}*sin({W}*t)"}
    contact = Contact("plate", "b.body", "f.top", restitution=0.5)
    motion = move(
        on(floor("prismatic", [0, 0, 1]), given, BALL), [0], [A * W], 0.3, contact, inputs if given is GIVEN else None
    )
    off, hit = motion.events[:2]
    start = math.asin(G / (A * W**2)) / W
    assert (off.kind, hit.kind) == ("lift_off", "impact")
    assert off.t == pytest.approx(start, abs=1e-8)
    lying = motion.t < start
    loads = motion.series["contact_forces"][lying, 0, 0]
    assert loads == pytest.approx(2 * (G - A * W**2 * np.sin(W * motion.t[lying])), abs=1e-6)

    def flight(t: float) -> tuple[float, float]:
        """The gap and its rate."""
        s, v, dt = A * math.sin(W * start), A * W * math.cos(W * start), t - start
        return s + v * dt - G * dt**2 / 2 - A * math.sin(W * t), v - G * dt - A * W * math.cos(W * t)

    there = scipy.optimize.brentq(lambda t: flight(t)[0], start + 0.05, 0.3)
    assert hit.t == pytest.approx(there, abs=1e-8)
    assert hit.after is not None
    assert hit.after[1][0] == pytest.approx(A * W * math.cos(W * there) - 0.5 * flight(there)[1], abs=1e-6)


def test_a_belt_takes_a_point_along() -> None:
    """It slips for v/(mu g), and sticks to the belt from there on; friction works with its own velocity."""
    belt = on(floor("prismatic", [1, 0, 0]), "2*t", point())
    motion = move(belt, [0, 0], [0, 0], 1, Contact("belt", "b.body", "f.top", type="point_line", friction=0.4))
    stop = 2 / (0.4 * G)
    assert [event.kind for event in motion.events] == ["stick"]
    assert motion.events[0].t == pytest.approx(stop, abs=1e-9)
    assert motion.q[-1] == pytest.approx([2 * (1 - stop) + stop, 0], abs=1e-9)
    assert motion.qd[-1] == pytest.approx([2, 0], abs=1e-9)


def test_a_plate_that_circles_takes_a_point_along_until_it_breaks_away() -> None:
    """The way of slip turns until it ends: u' = -mu g u/|u| - a of the plate, and it holds while |a| < mu g."""
    model = on_moving_plate("0.04*sin(8*t)", "0.05*cos(7*t)")
    motion = simulate(model, [0, 0, 0], (0, 0.4872), qd=[0.4, 0.2, 0])
    mu = 0.3 * G

    def plate(t: float) -> tuple[Any, Any]:
        """Its velocity and acceleration."""
        phi, psi = 8 * t, 7 * t
        return (
            np.array([0.32 * np.cos(phi), -0.35 * np.sin(psi)]),
            np.array([-2.56 * np.sin(phi), -2.45 * np.cos(psi)]),
        )

    def ends(_: float, u: Any) -> float:
        return math.hypot(*u) - 1e-8

    ends.terminal = True  # type: ignore[attr-defined]
    found = scipy.integrate.solve_ivp(
        lambda t, u: -mu * u / math.hypot(*u) - plate(t)[1], (0, 0.4), [0.4 - 0.32, 0.2], "DOP853", events=ends,
        rtol=1e-12, atol=1e-13,
    )  # fmt: skip
    stick, slip = motion.events
    assert (stick.kind, slip.kind) == ("stick", "slip")
    assert stick.t == pytest.approx(found.t[-1], abs=2e-8)
    assert stick.qd[:2] == pytest.approx(plate(stick.t)[0], abs=1e-7)
    away = scipy.optimize.brentq(lambda t: math.hypot(*plate(t)[1]) - mu, stick.t, 0.5)
    assert slip.t == pytest.approx(away, abs=1e-7)
    assert motion.is_right


def test_a_point_slides_out_on_a_plane_that_turns() -> None:
    """r'' = w^2 r - g sin wt along a plane that rises with wt, whose pressure is m (g cos wt + 2 w r')."""
    w, r = 2.0, 0.5
    plane = on(floor("revolute", [0, -1, 0]), f"{w}*t", point())
    motion = move(plane, [r, 0], [0, r * w], 0.5, Contact("plane", "b.body", "f.top"))
    t = motion.t
    rate = -G / (2 * w)  # of the free part, so that r' = 0 at the start
    out = r * np.cosh(w * t) + rate / w * np.sinh(w * t) + G / (2 * w * w) * np.sin(w * t)
    speed = r * w * np.sinh(w * t) + rate * np.cosh(w * t) + G / (2 * w) * np.cos(w * t)
    assert motion.q == pytest.approx(np.stack([out * np.cos(w * t), out * np.sin(w * t)], axis=1), abs=1e-7)
    loads = motion.series["contact_forces"][:, 0, 0]
    assert loads == pytest.approx(2 * (G * np.cos(w * t) + 2 * w * speed), abs=1e-5)


def test_a_point_that_nothing_moves_is_none() -> None:
    plate = on(floor("prismatic", [0, 0, 1]), f"{A}*sin({W}*t)", BALL)
    with pytest.raises(InvalidInput, match=r"no coordinate moves 'f.top' towards 'world'") as found:
        move(plate, [1], [0], 1, Contact("plate", "f.top"))
    assert [(fault.pointer, fault.code) for fault in found.value.faults] == [("/contacts/0", "immovable")]


@pytest.mark.parametrize(("w", "stays"), [(2.0, True), (3.5, False)])
def test_a_turntable_holds_a_point_while_friction_can(w: float, stays: bool) -> None:
    """At r = 0.5 m with mu = 0.5 up to w^2 = mu g / r; the friction is m w^2 r inwards, or all of mu m g."""
    joints = [{"type": "prismatic", "coordinate": name, **PLACED} for name in "xyz"]
    axes = ([1, 0, 0], [0, 1, 0], [0, 0, 1])
    bodies = [
        {"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint | {"axis": axes[k]}}
        for k, joint in enumerate(joints)
    ]
    bodies[2] |= {"name": "body", "mass": 2}
    table = on(floor("revolute", [0, 0, 1]), f"{w}*t", {"name": "free", "bodies": bodies})
    motion = move(table, [0.5, 0, 0], [0, 0.5 * w, 0], 1, Contact("table", "b.body", "f.top", friction=0.5))
    held = min(w**2 * 0.5, 0.5 * G)
    assert motion.series["contact_forces"][0, 0] == pytest.approx([2 * G, -2 * held, 0], abs=1e-8)
    radius = np.linalg.norm(motion.q[:, :2], axis=1)
    assert bool(np.abs(radius - 0.5).max() < 1e-8) is stays


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
@pytest.mark.parametrize("mode", [STICK, SLIP])
def test_steps_on_given_motions_are_machine_code(mode: int) -> None:
    """A mass on an arm whose turning about an oblique axis is given, on the ground: as in Python."""
    arm = {**floor("revolute", [0.6, 0, 0.8]), "ports": [{"name": "tip", "body": "plate", "position": [0.3, 0.1, 0]}]}
    instances = [
        {"name": "f", "substructure": "floor"},
        {"name": "b", "substructure": "point", "at": "f.tip"},
    ]
    contact = {"name": "c", "point": "b.body", "friction": "0.3"}
    tree = {"gravity": [0, 0, -G], "instances": instances, "driven": {"f.s": "0.5*sin(3*t)"}, "contacts": [contact]}
    model = tree_model(tree, {"floor": arm, "point": space_point()})
    x = np.array([0, 0.2, 0.1, 0.5, 0.1, 0.3, 0.0])
    conditions = read_conditions(model, Start(x[:3], x[3:6]), (0, 1), ["metric", "bias", "forces"])
    f = DecidedContacts(model, conditions.values, conditions.zero, conditions, contacts_of(model))
    f.begin()
    f.look(0.3, x)
    f.modes[0] = [mode, 1, 0, f.yields(np.arange(1))[0]]
    assert f.compiled() is not None
    second, _, power = f.evaluate(0.3, x)
    found = [*second, power, *f.force.ravel()]
    second, _, power = ContactMotion.evaluate(f, 0.3, x)
    np.testing.assert_allclose(found, [*second, power, *f.force.ravel()], atol=1e-12)
