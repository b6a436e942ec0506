"""Motions with closures against closed forms, for both reductions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import at, bricard, closed_entry, four_bar, slider_crank, stewart, stewart_points
from random_trees import Plain
from simulated import simulated

from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import ClosedMotion, Event, Outputs, Table, simulate
from substructures.quantities.numbers.evaluation import evaluate

from .closed_motions import METHODS, crank_inertia, piston, right, slope


@pytest.mark.parametrize("method", METHODS)
def test_four_bar(method: str) -> None:
    """The angles along the motion obey Freudenstein's equation (Trans. ASME 77, 1955); the energy stays."""
    model = four_bar((0, -9.81, 0))
    request = {"q": at(model, crank=0.7, coupler=0.2, rocker=1.2), "qd": at(model, crank=9), "fixed": ["x.crank"]}
    motion = simulated(model, **request, span=(0, 0.5), reduction=method)
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
    right(simulated(model, **request, span=(0, 5), count=11, reduction=method))


@pytest.mark.parametrize("method", METHODS)
def test_slider_crank(method: str) -> None:
    """Position, velocity and acceleration of the piston, and J a'' + J' a'^2 / 2 = torque."""
    model = slider_crank()
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=40), "fixed": ["x.crank"]}
    motion = simulated(model, **request, span=(0, 0.3), reduction=method, inputs={"tau.x.crank": "2*sin(20*t)"})
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
        given = Table(t, 30 * t + 0.2 * np.sin(25 * t))
    request = {"q": at(model, piston=0.18), "prescribed": {"x.crank": given}, "span": [0, 0.1], "count": 51}
    motion = simulated(model, **request)
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
    motion = simulate(model, [a, b, a, b, a], (0, 2.5), kind=ClosedMotion(reduction=method), outputs=Outputs(count=51))
    right(motion)
    cos = np.cos(motion.q[:, :2])
    np.testing.assert_allclose(cos.sum(axis=1) + cos.prod(axis=1), 0, atol=1e-11)
    assert np.ptp(motion.q[:, 1]) > 1


def test_stewart_platform() -> None:
    """Six legs of the catalogue under a plate: 24 coordinates, 6 degrees of freedom; the legs are as long as the
    distance of their ends, at the start and while it sinks.
    """
    model = stewart()
    pose = {"x": 0.05, "y": -0.03, "z": 1.1, "yaw": 0.1, "pitch": 0.05, "roll": -0.04}
    lift = {f"tau.leg{k}.extension": 200 for k in range(6)}
    request: Plain = {"q": at(model, **pose), "fixed": [f"top.{name}" for name in pose], "inputs": lift}
    found = loop_state(model, **request)
    assert (found.mobility.degrees_of_freedom, found.mobility.redundant) == (6, False)
    np.testing.assert_allclose(found.consistent.q[:6], list(pose.values()))
    motion = simulated(model, **request, span=(0, 0.3), count=4)
    right(motion)
    assert abs(motion.q[-1, 2] - 1.1) > 0.1
    feet, joints = stewart_points()
    for q in motion.q:
        where = evaluate(model, ["kinematics"], q=q)["kinematics"]
        plate = model.frames.index("top.plate")
        ends = where["position"][plate] + joints @ where["rotation"][plate].T
        lengths = np.linalg.norm(ends - feet, axis=1)
        extensions = [x for x, name in zip(q, model.coordinates, strict=True) if name.endswith("extension")]
        np.testing.assert_allclose(extensions, lengths - 1.2, atol=1e-11)


def test_events_and_progress() -> None:
    model = slider_crank()
    events = [
        Event("dead_centre", "x.piston'", action="record"),
        Event("turned", "x.crank/(2*pi)", level=1, direction="rising"),
    ]
    request: Plain = {
        "q": at(model, crank=0.3, piston=0.17),
        "qd": at(model, crank=40),
        "fixed": ["x.crank"],
        "span": [0, 1],
    }
    told: list[float] = []
    motion = simulated(model, **request, events=events, progress=lambda share: told.append(share) is None)
    assert (motion.status, "'turned'" in motion.message) == ("stopped", True)
    np.testing.assert_allclose(motion.q[-1, 0], 2 * np.pi, atol=1e-10)
    assert [event.name for event in motion.events][-1] == "turned"
    assert len(motion.events) in (2, 3)
    dead = next(event for event in motion.events if event.name == "dead_centre")
    np.testing.assert_allclose(np.sin(dead.q[0]), 0, atol=1e-9)
    assert told == sorted(told)
    cancelled = simulated(model, **request, progress=lambda share: share < 0.2)
    assert cancelled.status == "stopped"
    assert 0.2 <= cancelled.t[-1] + 0.01 < 0.5


@pytest.mark.parametrize("method", METHODS)
def test_inputs_that_jump_and_inputs_that_depend_on_the_state(method: str) -> None:
    """The integrator begins anew where a table jumps: exact energy, few steps. A damper may be an input."""
    model = slider_crank()
    held = Table([0, 0.1, 0.2, 0.3], [2, -3, 5, 0], "hold")
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=20), "fixed": ["x.crank"]}
    request |= {"span": [0, 0.3], "reduction": method}
    motion = simulated(model, **request, inputs={"tau.x.crank": held}, times=[0.1, 0.2, 0.3])
    right(motion)
    a, w = motion.q[:, 0], motion.qd[:, 0]
    kinetic = 0.5 * crank_inertia(a) * w**2
    np.testing.assert_allclose(np.diff(kinetic), [-3 * (a[1] - a[0]), 5 * (a[2] - a[1])], rtol=1e-7)
    assert motion.steps < 120
    damped = simulated(model, **request, inputs={"tau.x.crank": "-x.crank'/100"}, series={"w": "x.crank'"})
    right(damped)
    np.testing.assert_allclose(damped.series["tau.x.crank"], -damped.series["w"] / 100)
    assert damped.series["work"][-1] < 0
