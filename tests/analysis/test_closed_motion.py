"""Motions with closures against published values and closed forms; failures with advice and the motion up to there."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import (
    SQUEEZER,
    at,
    bricard,
    closed_entry,
    four_bar,
    governor,
    slider_crank,
    stewart,
    stewart_points,
    tree_model,
)
from random_trees import Plain

from substructures import InvalidDocument, Model, catalogue
from substructures.analysis.loops import analyse_loops
from substructures.analysis.simulate import simulate
from substructures.analysis.simulate_closed import simulate_closed
from substructures.analysis.simulate_tree import simulate_tree
from substructures.analysis.trajectory import Trajectory
from substructures.evaluation import evaluate

METHODS = ["projection", "partitioning"]

#: F. Mazzia, F. Iavernaro, C. Magherini, Test Set for IVP Solvers; IFToMM benchmark A03: start, and values at 0.03 s
START = [-0.0617138900142764496, 0, 0.455279819163070380, 0.222668390165885885, 0.487364979543842550]
START += [-0.222668390165885885, 1.23054744454982119]
END = [15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304]
END += [0.5347301163226948, 1.048080741042263]


def squeezer_in_one_piece() -> tuple[Model, Plain, np.ndarray, np.ndarray]:
    """The catalogue entry with its loops closed; request, start and end in its coordinates."""
    pins = [{"name": f"pin{k}", "type": "pin", "from": "x.end2", "to": f"x.end{k}"} for k in (3, 4, 6)]
    model = closed_entry("andrews-squeezer", pins)
    start, end = (at(model, **dict(zip(SQUEEZER, x, strict=True))) for x in (START, END))
    return model, {}, start, end


def squeezer_from_parts() -> tuple[Model, Plain, np.ndarray, np.ndarray]:
    """Three catalogue arms of two links (K1 K2, K5 K4, K7 K6) and the lever K3 with its spring, coupled and closed.

    Arms of the catalogue have everything on the first axis: the angles of K4, K6 and K7 differ by a right angle.
    """
    whole = catalogue.load("andrews-squeezer")
    lever = next(body for body in whole["bodies"] if body["name"] == "K3")
    lever = lever | {"joint": {"type": "revolute", "coordinate": "gamma"}}
    spring = whole["loads"][1] | {"to": {"body": "base", "at": ["xc - xb", "yc - yb", 0]}}
    names = ("m3", "I3", "xb", "yb", "xc", "yc", "c0", "l0", "ss", "sa", "sb", "sc", "sd")
    parameters = {name: whole["parameters"][name] for name in names}
    end3 = {"name": "end", "body": "K3", "position": [0, "-ss", 0]}
    k3 = {"name": "lever", "parameters": parameters, "bodies": [lever], "ports": [end3], "loads": [spring]}
    arms: Plain = {
        "k12": {"l1": "rr", "c1": "ra", "l2": "-d", "c2": "-da", "m1": "m1", "m2": "m2", "I1": "I1", "I2": "I2"},
        "k54": {"l1": "zt", "c1": "sqrt(ta^2 + tb^2)", "l2": "e", "c2": "e - ea"}
        | {"m1": "m5", "m2": "m4", "I1": "I5", "I2": "I4"},
        "k76": {"l1": "u", "c1": "sqrt(ua^2 + ub^2)", "l2": "zf", "c2": "zf - fa"}
        | {"m1": "m7", "m2": "m6", "I1": "I7", "I2": "I6"},
    }
    shared = {n: p for n, p in whole["parameters"].items() if n not in ("mom", "c0", "l0")}
    places = {"k12": [0, 0, 0], "k54": ["xa", "ya", 0], "k76": ["xa", "ya", 0]}
    instances = [
        {"name": k, "substructure": "planar-2r", "placement": {"position": places[k]}, "parameters": arms[k]}
        for k in arms
    ]
    instances.append({"name": "k3", "substructure": "lever", "placement": {"position": ["xb", "yb", 0]}})
    ends = {"k3": "k3.end", "k54": "k54.flange", "k76": "k76.flange"}
    pins = [{"name": k, "type": "pin", "from": "k12.flange", "to": end} for k, end in ends.items()]
    document = {"parameters": shared, "instances": instances, "closures": pins}
    model = tree_model(document, {"planar-2r": catalogue.load("planar-2r"), "lever": k3})

    def arranged(x: list[float]) -> np.ndarray:
        be, th, ga, phi, de, om, ep = x
        right = np.pi / 2
        return np.array([be, th, de, phi - right, ep - right, om + right, ga])

    return model, {"inputs": {"tau.k12.q1": 0.033}}, arranged(START), arranged(END)


@pytest.mark.parametrize("build", [squeezer_in_one_piece, squeezer_from_parts])
def test_andrews_squeezer(build: Any) -> None:
    model, request, start, end = build()
    first = analyse_loops(model, request | {"q": start})
    assert first.mobility.degrees_of_freedom == 1
    expected = np.zeros(7)
    expected[:2] = 14222.4439199541138, -10666.8329399655854
    np.testing.assert_allclose(first.qdd, expected, rtol=1e-9, atol=1e-6)
    motion = simulate_closed(model, request | {"q": start, "span": [0, 0.03], "count": 4})
    right(motion)
    np.testing.assert_allclose(motion.q[-1], end, rtol=1e-7)


def right(motion: Trajectory) -> None:
    """Finished, and all checks hold."""
    assert motion.status == "finished", motion.message
    assert motion.is_right, motion.checks
    assert motion.series["position_residual"].max() < 1e-9
    assert motion.series["velocity_residual"].max() < 1e-9


@pytest.mark.parametrize("method", METHODS)
def test_four_bar(method: str) -> None:
    """The angles along the motion obey Freudenstein's equation (Trans. ASME 77, 1955); the energy stays."""
    model = four_bar((0, -9.81, 0))
    request = {"q": at(model, crank=0.7, coupler=0.2, rocker=1.2), "qd": at(model, crank=9), "fixed": ["x.crank"]}
    motion = simulate_closed(model, request | {"span": [0, 0.5], "reduction": method})
    right(motion)
    l0, l1, l2, l3 = 0.4, 0.1, 0.35, 0.25
    crank, _, rocker = motion.q.T
    assert np.ptp(crank) > 2
    left = l0 / l1 * np.cos(rocker) - l0 / l3 * np.cos(crank) + (l1**2 - l2**2 + l3**2 + l0**2) / (2 * l1 * l3)
    np.testing.assert_allclose(left, np.cos(crank - rocker), atol=1e-11)


@pytest.mark.parametrize("method", METHODS)
def test_large_mechanisms(method: str) -> None:
    """A thousand times as large, where rounding is, too."""
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    model = closed_entry("four-bar", [pin], (0, -9.81, 0), l0=400, l1=100, l2=350, l3=250)
    request = {"q": at(model, crank=0.7, coupler=0.2, rocker=1.2), "qd": at(model, crank=0.3), "fixed": ["x.crank"]}
    right(simulate_closed(model, request | {"span": [0, 5], "count": 11, "reduction": method}))


def piston(a: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, dx/da, d2x/da2 of a slider-crank with r = 0.04, l = 0.14."""
    r, length = 0.04, 0.14
    root = np.sqrt(length**2 - (r * np.sin(a)) ** 2)
    droot = -(r**2) * np.sin(a) * np.cos(a) / root
    ddroot = -(r**2) * np.cos(2 * a) / root - droot**2 / root
    return r * np.cos(a) + root, -r * np.sin(a) + droot, -r * np.cos(a) + ddroot


def crank_inertia(a: np.ndarray) -> np.ndarray:
    """J(a) with T = J a'^2 / 2: crank, rod (its angle from sin b = -r sin a / l) and piston."""
    r, length, c = 0.04, 0.14, 0.045
    _, dx, _ = piston(a)
    db = -r * np.cos(a) / np.sqrt(length**2 - (r * np.sin(a)) ** 2)
    b = np.arcsin(-r * np.sin(a) / length)
    vx, vy = -r * np.sin(a) - c * np.sin(b) * db, r * np.cos(a) + c * np.cos(b) * db
    crank = 0.005 + 2 * 0.01**2
    return crank + 0.5 * (vx**2 + vy**2) + 0.0015 * db**2 + 0.4 * dx**2


def slope(f: Any, a: np.ndarray, h: float = 1e-3) -> np.ndarray:
    return np.asarray((8 * (f(a + h) - f(a - h)) - (f(a + 2 * h) - f(a - 2 * h))) / (12 * h))


@pytest.mark.parametrize("method", METHODS)
def test_slider_crank(method: str) -> None:
    """Position, velocity and acceleration of the piston, and J a'' + J' a'^2 / 2 = torque."""
    model = slider_crank()
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=40), "fixed": ["x.crank"]}
    motion = simulate_closed(
        model, request | {"span": [0, 0.3], "reduction": method, "inputs": {"tau.x.crank": "2*sin(20*t)"}}
    )
    right(motion)
    a, w, dw = motion.q[:, 0], motion.qd[:, 0], motion.series["qdd"][:, 0]
    x, dx, ddx = piston(a)
    np.testing.assert_allclose(motion.q[:, 2], x, atol=1e-12)
    np.testing.assert_allclose(motion.qd[:, 2], dx * w, atol=1e-10)
    np.testing.assert_allclose(motion.series["qdd"][:, 2], dx * dw + ddx * w**2, atol=1e-8)
    torque = crank_inertia(a) * dw + 0.5 * slope(crank_inertia, a) * w**2
    np.testing.assert_allclose(torque, 2 * np.sin(20 * motion.t), atol=1e-8)


@pytest.mark.parametrize("kind", ["expression", "table"])
def test_prescribed_crank(kind: str) -> None:
    """The torque that a given motion of the crank needs."""
    model, t = slider_crank(), np.linspace(0, 0.1, 101)
    given: Any = "30*t + 0.2*sin(25*t)"
    if kind == "table":
        given = {"times": t, "values": 30 * t + 0.2 * np.sin(25 * t)}
    request = {"q": at(model, piston=0.18), "prescribed": {"x.crank": given}, "span": [0, 0.1], "count": 51}
    motion = simulate_closed(model, request)
    right(motion)
    a = 30 * motion.t + 0.2 * np.sin(25 * motion.t)
    w, dw = 30 + 5 * np.cos(25 * motion.t), -125 * np.sin(25 * motion.t)
    size = 1e-9 if kind == "expression" else 1e-7
    np.testing.assert_allclose(motion.q[:, 0], a, atol=size)
    torque = crank_inertia(a) * dw + 0.5 * slope(crank_inertia, a) * w**2
    np.testing.assert_allclose(motion.series["actuation"][:, 0], torque, atol=1e-8 if kind == "expression" else 1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_bricard(method: str) -> None:
    """A redundant mechanism, through the positions where its independent coordinate turns back."""
    model, a = bricard(), 1.9
    b = np.arccos(-np.cos(a) / (1 + np.cos(a)))
    motion = simulate_closed(model, {"q": [a, b, a, b, a], "span": [0, 2.5], "count": 51, "reduction": method})
    right(motion)
    cos = np.cos(motion.q[:, :2])
    np.testing.assert_allclose(cos.sum(axis=1) + cos.prod(axis=1), 0, atol=1e-11)
    assert np.ptp(motion.q[:, 1]) > 1


def lift(angle: float) -> tuple[float, float, float]:
    """Lift of the sleeve over the angle of the arms, and two derivatives: rods of length 0.25 at 0.15 m on the arms."""
    a, length, h = 0.15, 0.25, 0.4
    s = np.sqrt(length**2 - (a * np.sin(angle)) ** 2)
    ds = -(a**2) * np.sin(angle) * np.cos(angle) / s
    dds = -(a**2) * np.cos(2 * angle) / s - ds**2 / s
    return h - a * np.cos(angle) - s, a * np.sin(angle) - ds, a * np.cos(angle) - dds


def governor_accelerations(angle: float, rate: float, spin: float) -> tuple[float, float]:
    """Of the arms and of the spindle, from T = (I(a) W^2 + M(a) a'^2) / 2 and V(a)."""
    r, length, ball, sleeve, k, g = 0.03, 0.3, 1.0, 0.8, 500.0, 9.81
    z, dz, ddz = lift(angle)
    reach, dreach = r + length * np.sin(angle), length * np.cos(angle)
    inertia, dinertia = 0.011 + 2 * ball * reach**2, 4 * ball * reach * dreach
    mass, half = 2 * ball * length**2 + sleeve * dz**2, sleeve * dz * ddz
    slope = 2 * ball * g * length * np.sin(angle) + (sleeve * g + k * z) * dz
    return (0.5 * dinertia * spin**2 - half * rate**2 - slope) / mass, -dinertia * rate * spin / inertia


@pytest.mark.parametrize(("angle", "rate", "spin"), [(0.6, 0, 7.0), (0.4, 1.5, 9.0), (0.9, -2.0, 3.0)])
def test_governor_accelerations(angle: float, rate: float, spin: float) -> None:
    model = governor()
    start = at(model, right=angle, left=angle, lift=lift(angle)[0])
    speeds = at(model, right=rate, left=rate, lift=lift(angle)[1] * rate, turn=spin)
    found = analyse_loops(model, {"q": start, "qd": speeds})
    assert (found.mobility.degrees_of_freedom, found.mobility.redundant) == (2, False)
    np.testing.assert_allclose(found.consistent.q, start, atol=1e-12)
    arms, spindle = governor_accelerations(angle, rate, spin)
    np.testing.assert_allclose(found.qdd[[1, 2, 0]], [arms, arms, spindle], rtol=1e-10, atol=1e-10)


def test_governor_keeps_its_speed_and_its_angular_momentum() -> None:
    """At the speed of steady motion nothing moves; disturbed, energy and angular momentum about the spindle stay."""
    model, angle = governor(), 0.6
    low, high = governor_accelerations(angle, 0, 0)[0], governor_accelerations(angle, 0, 1)[0]
    steady = np.sqrt(-low / (high - low))
    start = at(model, right=angle, left=angle, lift=lift(angle)[0])
    motion = simulate_closed(model, {"q": start, "qd": at(model, turn=steady), "span": [0, 0.5], "count": 3})
    right(motion)
    np.testing.assert_allclose(motion.q[-1][1:], start[1:], atol=1e-9)
    motion = simulate_closed(model, {"q": start, "qd": at(model, turn=1.2 * steady), "span": [0, 1.5], "count": 51})
    right(motion)
    arms = motion.q[:, model.coordinates.index("x.right")]
    momentum = (0.011 + 2 * (0.03 + 0.3 * np.sin(arms)) ** 2) * motion.qd[:, 0]
    assert np.ptp(arms) > 0.05
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-9)


def test_stewart_platform() -> None:
    """Six legs of the catalogue under a plate: 24 coordinates, 6 degrees of freedom; the legs are as long as the
    distance of their ends, at the start and while it sinks.
    """
    model = stewart()
    pose = {"x": 0.05, "y": -0.03, "z": 1.1, "yaw": 0.1, "pitch": 0.05, "roll": -0.04}
    lift = {f"tau.leg{k}.extension": 200 for k in range(6)}
    request: Plain = {"q": at(model, **pose), "fixed": [f"top.{name}" for name in pose], "inputs": lift}
    found = analyse_loops(model, request)
    assert (found.mobility.degrees_of_freedom, found.mobility.redundant) == (6, False)
    np.testing.assert_allclose(found.consistent.q[:6], list(pose.values()))
    motion = simulate_closed(model, request | {"span": [0, 0.3], "count": 4})
    right(motion)
    assert abs(motion.q[-1, 2] - 1.1) > 0.1
    feet, joints = stewart_points()
    for q in motion.q:
        where = evaluate(model, {"quantities": ["kinematics"], "q": q})["kinematics"]
        plate = model.frames.index("top.plate")
        ends = where["position"][plate] + joints @ where["rotation"][plate].T
        lengths = np.linalg.norm(ends - feet, axis=1)
        extensions = [x for x, name in zip(q, model.coordinates, strict=True) if name.endswith("extension")]
        np.testing.assert_allclose(extensions, lengths - 1.2, atol=1e-11)


def test_both_methods_agree() -> None:
    model, _, start, _ = squeezer_in_one_piece()
    ends = [simulate_closed(model, {"q": start, "span": [0, 0.01], "reduction": method}).q[-1] for method in METHODS]
    np.testing.assert_allclose(*ends, rtol=1e-8, atol=1e-10)


def test_events_and_progress() -> None:
    model = slider_crank()
    events = [
        {"name": "dead_centre", "quantity": "x.piston'", "action": "record"},
        {"name": "turned", "quantity": "x.crank/(2*pi)", "level": 1, "direction": "rising"},
    ]
    request: Plain = {
        "q": at(model, crank=0.3, piston=0.17),
        "qd": at(model, crank=40),
        "fixed": ["x.crank"],
        "span": [0, 1],
    }
    told: list[float] = []
    motion = simulate_closed(model, request | {"events": events}, lambda share: told.append(share) is None)
    assert (motion.status, "'turned'" in motion.message) == ("stopped", True)
    np.testing.assert_allclose(motion.q[-1, 0], 2 * np.pi, atol=1e-10)
    assert [event.name for event in motion.events][-1] == "turned"
    assert len(motion.events) in (2, 3)
    dead = next(event for event in motion.events if event.name == "dead_centre")
    np.testing.assert_allclose(np.sin(dead.q[0]), 0, atol=1e-9)
    assert told == sorted(told)
    cancelled = simulate_closed(model, request, lambda share: share < 0.2)
    assert cancelled.status == "stopped"
    assert 0.2 <= cancelled.t[-1] + 0.01 < 0.5


def test_a_locked_motion_fails_with_the_motion_up_to_there() -> None:
    """A crank longer than its rod cannot be turned further than where both are in line with the wrist."""
    wrist = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    model = closed_entry("slider-crank", [wrist], r=0.2)
    request = {"q": at(model, rod=0.3, piston=0.3), "prescribed": {"x.crank": "2*t"}, "span": [0, 1], "count": 101}
    motion = simulate_closed(model, request)
    assert motion.status == "failed"
    locked = np.arcsin(0.14 / 0.2) / 2
    assert locked - 0.001 < motion.t[-1] < locked
    assert "dead centre" in motion.message or "relative_tolerance" in motion.message


def test_open_loops_singular_starts_and_long_spans_fail_with_advice() -> None:
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    open_loop = simulate_closed(closed_entry("four-bar", [pin], l0=5), {"q": [0, 0, 0], "span": [0, 1]})
    assert (open_loop.status, len(open_loop.t)) == ("failed", 1)
    assert "cannot be met" in open_loop.message
    flat = closed_entry("four-bar", [pin], l0=0.3, l1=0.2, l2=0.3, l3=0.2)
    singular = simulate_closed(flat, {"q": [0, 0, 0], "qd": [1, -1, 1], "span": [0, 1]})
    assert (singular.status, "singular" in singular.message) == ("failed", True)
    model = four_bar()
    request = {"q": [0.7, 0.2, 1.2], "qd": [9, 0, 0], "fixed": ["x.crank"], "span": [0, 100], "max_steps": 20}
    long = simulate_closed(model, request)
    assert (long.status, long.steps) == ("failed", 20)
    assert "max_steps" in long.message
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
    motion = simulate_closed(flat, request | {"span": [0, 1], "reduction": method, "count": 5})
    assert motion.status == "failed"
    assert "singular" in motion.message or "dead centre" in motion.message
    assert 0 < motion.t[-1] < 0.2
    assert motion.q[-1, 0] > -1e-6
    before = simulate_closed(flat, request | {"span": [0, 0.1], "reduction": method, "count": 5})
    right(before)


@pytest.mark.parametrize("method", METHODS)
def test_inputs_that_jump_and_inputs_that_depend_on_the_state(method: str) -> None:
    """The integrator begins anew where a table jumps: exact energy, few steps. A damper may be an input."""
    model = slider_crank()
    held = {"times": [0, 0.1, 0.2, 0.3], "values": [2, -3, 5, 0], "interpolation": "hold"}
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=20), "fixed": ["x.crank"]}
    request |= {"span": [0, 0.3], "reduction": method}
    motion = simulate_closed(model, request | {"inputs": {"tau.x.crank": held}, "times": [0.1, 0.2, 0.3]})
    right(motion)
    a, w = motion.q[:, 0], motion.qd[:, 0]
    kinetic = 0.5 * crank_inertia(a) * w**2
    np.testing.assert_allclose(np.diff(kinetic), [-3 * (a[1] - a[0]), 5 * (a[2] - a[1])], rtol=1e-7)
    assert motion.steps < 120
    damped = simulate_closed(model, request | {"inputs": {"tau.x.crank": "-x.crank'/100"}, "series": {"w": "x.crank'"}})
    right(damped)
    np.testing.assert_allclose(damped.series["tau.x.crank"], -damped.series["w"] / 100)
    assert damped.series["work"][-1] < 0


def test_one_entry_for_all_models() -> None:
    model = slider_crank()
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "span": [0, 0.01], "fixed": ["x.crank"], "count": 3}
    assert "multipliers" in simulate(model, request).series
    wrist = {"constraints": [{"name": "wrist", "type": "closure"}], "independent": ["x.crank"]}
    closed = simulate_closed(model, request)
    rolling = simulate(model, wrist | {"q": closed.q[0], "span": [0, 0.01]})
    assert "constraints" in rolling.series
    blade = {"constraints": [{"name": "c", "type": "linear", "expression": "x.crank'"}], "q": closed.q[0]}
    for call in (
        lambda: simulate(model, blade | {"span": [0, 1]}),
        lambda: simulate_tree(model, {"q": [0, 0, 0], "span": [0, 1]}),
    ):
        with pytest.raises(InvalidDocument, match="closure"):
            call()


def test_nothing_that_has_mass() -> None:
    massless = dict.fromkeys(("x.m1", "x.m2", "x.m3"), 0)
    motion = simulate_closed(four_bar(), {"q": [0.7, 0.2, 1.2], "parameters": massless, "span": [0, 1]})
    assert motion.status == "failed"
    assert "metric is singular" in motion.message


BAD: list[tuple[Plain, str, str]] = [
    ({"reduction": "magic"}, "/reduction", "literal-error"),
    ({"reduction": ["projection"]}, "/reduction", "literal-error"),
    ({"count": 5, "step": 0.1}, "", "one-grid"),
    ({"span": [0, 0]}, "", "empty-span"),
    ({"span": None}, "/span", "tuple-type"),
    ({"count": 1}, "/count", "greater-than-equal"),
    ({"times": [0, 0]}, "", "not-increasing"),
    ({"relative_tolerance": -1}, "/relative_tolerance", "greater-than-equal"),
    ({"events": [{"name": "x"}]}, "/events/0/quantity", "missing"),
    ({"events": [{"name": "x", "quantity": "u + 1"}]}, "/events/0/quantity", "unknown-name"),
    (
        {"prescribed": {"x.crank": {"times": [0, 1], "values": [0, 1]}}, "span": [0, 2]},
        "/prescribed/x.crank/times",
        "not-covered",
    ),
    ({"velocity": 1}, "/velocity", "extra-forbidden"),
]


@pytest.mark.parametrize(("change", "pointer", "code"), BAD)
def test_bad_requests(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        simulate_closed(SLIDER, {"q": [0, 0, 0.18], "span": [0, 1]} | change)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


SLIDER = slider_crank()
