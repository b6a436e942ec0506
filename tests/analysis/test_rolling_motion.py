"""Motions of rolling bodies and knife edges against their textbook solutions; events, failures, bad arguments."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_trees import Plain
from rolling_bodies import BLADE, FLOOR, FORWARD, A, C, M, R, disc, single, sleigh
from scipy.integrate import solve_ivp
from simulated import simulated

from substructures import InvalidArgument, InvalidInput
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.reduced_motion import FORMS, ReducedMotion
from substructures.analysis.motion.rolling import NEEDS
from substructures.analysis.simulate import (
    Closed,
    ConstrainedMotion,
    Event,
    KnifeEdge,
    Linear,
    Outputs,
    Rolling,
    Table,
    simulate,
)
from substructures.compile import target
from substructures.compile.motion import CompiledRun


@pytest.mark.parametrize("form", FORMS)
def test_skate_on_an_inclined_plane(form: str) -> None:
    """Released at rest with a spin w it does not slide down but goes along a cycloid: x = g sin(i) / (2 w^2) sin^2 wt
    down the slope, y = g sin(i) / (4 w^2) (2 wt - sin 2wt) across (Neimark and Fufaev 1972; Bloch 2003, section 1.6).
    """
    slope, w = 9.81 * 0.28, 1.7
    model = sleigh((slope, 0, -9.81 * 0.96))
    request = {"constraints": [BLADE], "velocities": FORWARD, "parameters": {"s.a": 0}, "q": [0, 0, 0], "v": {"w": w}}
    motion = simulated(model, **request, span=(0, 5), form=form)
    assert motion.status == "finished"
    assert motion.is_right, motion.checks
    wt = w * motion.t
    np.testing.assert_allclose(motion.q[:, 0], slope / (2 * w**2) * np.sin(wt) ** 2, atol=1e-9)
    np.testing.assert_allclose(motion.q[:, 1], slope / (4 * w**2) * (2 * wt - np.sin(2 * wt)), atol=1e-9)


def test_rolling_disc_in_steady_motion_and_beyond() -> None:
    """th, psi', ph' stay where the first equation holds with th'' = 0; any motion keeps energy and contact."""
    th, dpsi = 1.2, 1.5
    mr2 = M * R**2
    w3 = (A * dpsi**2 * np.sin(th) * np.cos(th) - M * 9.81 * R * np.cos(th)) / ((C + mr2) * dpsi * np.sin(th))
    request: Plain = {"constraints": [FLOOR], "q": [0, 0, R * np.sin(th), 0.2, th, 0], "span": [0, 3]}
    steady = simulated(disc(), **request, v=[dpsi, 0, w3 - dpsi * np.cos(th)])
    assert steady.is_right
    np.testing.assert_allclose(steady.q[:, 4], th, atol=1e-9)
    # the centre goes along a circle of radius r |w3 / psi'|
    period = 2 * np.pi / dpsi
    whole = steady.q[steady.t <= period][:, :2]
    np.testing.assert_allclose(np.ptp(whole[:, 0]) / 2, R * abs(w3 / dpsi), rtol=5e-3)
    wild = simulated(disc(), **request, v={"s.psi'": 1.0, "s.th'": 0.5, "s.ph'": 6.0})
    assert (wild.status, [c.holds for c in wild.checks]) == ("finished", [True] * 4)
    assert np.ptp(wild.q[:, 4]) > 0.1
    again = simulated(disc(), **request, qd=wild.qd[0], form="boltzmann-hamel")
    np.testing.assert_allclose(again.q[-1], wild.q[-1], atol=1e-8)


def test_sphere_on_an_inclined_plane() -> None:
    """It accelerates by 5/7 g sin(i)."""
    joint = {"type": "free", "coordinate": ["x", "y", "z", "a", "b", "c"]}
    inertia = dict.fromkeys(("xx", "yy", "zz"), "2/5*m*r^2")
    body = {"name": "ball", "parent": "base", "joint": joint, "mass": "m", "inertia": inertia}
    parameters = {"m": {"value": 3}, "r": {"value": 0.2}}
    model = single({"name": "ball", "parameters": parameters, "bodies": [body]}, [0, 0, -9.81])
    tilt = 0.35
    normal = [round(float(np.sin(tilt)), 12), 0, round(float(np.cos(tilt)), 12)]
    floor = Rolling("slope", "s.ball", "s.r", shape="sphere", normal=normal)
    motion = simulate(
        model, [0, 0, 0, 0, 0, 0], (0, 0.5), kind=ConstrainedMotion(constraints=[floor]), outputs=Outputs(count=11)
    )
    assert motion.is_right
    down = motion.q[:, 0] * np.cos(tilt) - motion.q[:, 2] * np.sin(tilt)
    np.testing.assert_allclose(down, 5 / 14 * 9.81 * np.sin(tilt) * motion.t**2, atol=1e-10)


def test_other_quasi_velocities_describe_the_same_motion() -> None:
    request: Plain = {"constraints": [BLADE], "q": [0, 0, 0.4], "span": [0, 0.8], "inputs": {"tau.s.f": "sin(t)"}}
    one = simulated(sleigh(), **request, velocities=FORWARD, v={"u": 1.0, "w": 0.5})
    two = simulated(sleigh(), **request, independent=["s.x", "s.f"], qd=one.qd[0])
    assert one.is_right
    assert two.is_right
    np.testing.assert_allclose(two.q, one.q, atol=1e-8)
    assert np.abs(one.series["work"]).max() > 0.01


def test_rolling_motions_have_events_series_and_inputs_of_all_kinds() -> None:
    """A sleigh that is damped along by an input of its velocities, pushed by a table, and stopped by an event."""
    push = Table([0, 0.5, 9], [1, 0, 0], "hold")
    request: Plain = {"constraints": [BLADE], "velocities": FORWARD, "q": [0, 0, 0], "v": {"u": 0.1}, "span": [0, 9]}
    request |= {"inputs": {"tau.s.x": "-s.x'/2", "tau.s.f": push}, "series": {"speed": "sqrt(s.x'^2 + s.y'^2)"}}
    event = Event("turned", "s.f", level=0.4)
    motion = simulated(sleigh(), **request, events=[event])
    assert (motion.status, [e.name for e in motion.events]) == ("stopped", ["turned"])
    assert motion.is_right, motion.checks
    np.testing.assert_allclose(motion.q[-1, 2], 0.4, atol=1e-10)
    np.testing.assert_allclose(motion.series["tau.s.x"], -motion.qd[:, 0] / 2)
    np.testing.assert_allclose(motion.series["speed"], np.hypot(motion.qd[:, 0], motion.qd[:, 1]))


def test_a_force_that_depends_on_time() -> None:
    """s'' = cos t on a slide that a second one follows: s = (1 - cos t)/2."""
    slides: list[Plain] = [
        {"name": x, "parent": "base", "joint": {"type": "prismatic", "coordinate": x}, "mass": 1} for x in "ab"
    ]
    loads = [{"type": "joint", "coordinate": "a", "force": "cos(t)"}]
    model = single({"name": "two", "bodies": slides, "loads": loads}, [0, 0, 0])
    tied = [Linear("tie", "s.a' - s.b'")]
    motion = simulate(model, [0, 0], (0, 2), kind=ConstrainedMotion(constraints=tied), outputs=Outputs(count=5))
    np.testing.assert_allclose(motion.q, np.outer((1 - np.cos(motion.t)) / 2, [1, 1]), atol=1e-9)
    assert motion.is_right


def test_a_span_that_cannot_be_finished_fails_with_advice() -> None:
    request = {"constraints": [BLADE], "velocities": FORWARD, "q": [0, 0, 0.4], "v": [0.5, 1.0], "span": [0, 100]}
    motion = simulated(sleigh(), **request, max_steps=10)
    assert (motion.status, motion.steps) == ("failed", 10)
    assert "max_steps" in motion.message
    assert 0 < motion.t[-1] < 100
    assert simulated(sleigh(), **request, progress=lambda share: share < 0.1).status == "stopped"


def test_constraints_that_leave_no_velocity_free() -> None:
    """The sleigh held by three rows rests where it is."""
    held = [Linear(name, f"s.{name}'") for name in ("x", "y", "f")]
    motion = simulate(sleigh(), [0.1, 0.2, 0.3], (0, 1), kind=ConstrainedMotion(constraints=held))
    assert (motion.status, motion.is_right) == ("finished", True)
    np.testing.assert_array_equal(motion.q[-1], [0.1, 0.2, 0.3])


def test_nothing_that_has_mass() -> None:
    request = {"constraints": [BLADE], "velocities": FORWARD, "q": [0, 0, 0.4], "v": [0.5, 1.0], "span": [0, 1]}
    motion = simulated(sleigh(), **request, parameters={"s.m": 0, "s.I": 0})
    assert (motion.status, len(motion.t)) == ("failed", 1)
    assert "check masses" in motion.message


def test_a_disc_that_falls_flat() -> None:
    """Its contact is not determined any more; that is said, or the checks say that the numbers are wrong."""
    request = {"constraints": [FLOOR], "q": [0, 0, R * np.sin(1.0), 0, 1.0, 0], "v": [0, 0, 0], "span": [0, 2]}
    motion = simulated(disc(), **request, max_steps=5000)
    assert motion.status == "failed" or not motion.is_right


BAD: list[tuple[Plain, str, str]] = [
    ({"constraints": [BLADE, BLADE]}, "/constraints/1/name", "duplicate-name"),
    ({"constraints": [KnifeEdge("blade", "s.c")]}, "/constraints/0/frame", "unknown-frame"),
    (
        {"constraints": [Linear("c", "s.x'*s.y'")]},
        "/constraints/0/expression",
        "not-linear",
    ),
    (
        {"constraints": [Linear("c", "t*s.x'")]},
        "/constraints/0/expression",
        "not-linear",
    ),
    ({"constraints": [Linear("c", "s.x - 1")]}, "/constraints/0/expression", "not-linear"),
    ({"velocities": {"u": "s.x' + 1", "w": "s.f'"}}, "/velocities/u", "not-linear"),
    (
        {"constraints": [Linear("c", "s.q'")]},
        "/constraints/0/expression",
        "unknown-name",
    ),
    ({"constraints": [Linear("c", "tau.s.x*s.x'")]}, "/constraints/0/expression", "unknown-name"),
    ({"constraints": [Closed("c")]}, "/constraints/0/name", "unknown-closure"),
    ({"velocities": {"u": "s.x'"}}, "/velocities", "wrong-length"),
    ({"velocities": {"u": "s.x'", "w": "s.x'"}}, "/velocities", "dependent"),
    ({"independent": ["s.x", "s.z"]}, "/independent/1", "unknown-coordinate"),
    ({"v": [1]}, "/v", "wrong-length"),
    ({"v": {"u": 1}}, "/v", "unknown-velocity"),
    ({"qd": [1, 1, 0]}, "/qd", "violated"),
    ({"v": [0, 0], "qd": [0, 0, 0]}, "/v", "two-velocities"),
    ({"independent": ["s.x", "s.f"], "q": [0, 0, "pi/2"]}, "/q/2", "number-expected"),
    ({"independent": ["s.y", "s.f"], "qd": [0, 0, 1]}, "/q", "singular-start"),
    ({"form": "lagrange"}, "/form", "literal-error"),
    (
        {"constraints": [Rolling("c", "s.b", 1)]},
        "/constraints/0/frame",
        "flat-disc",
    ),
]


@pytest.mark.parametrize(("change", "pointer", "code"), BAD)
def test_bad_arguments(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        simulated(SLEIGH, **{"constraints": [BLADE], "q": [0, 0, 0], "span": [0, 1]} | change)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


SLEIGH = sleigh()


def test_reactions_are_those_of_the_constraints_of_the_tree() -> None:
    """Others do not act on the bodies that reactions are formed of."""
    transmitted: Any = object()
    with pytest.raises(InvalidArgument, match="make the constraints part of the tree"):
        simulate(
            sleigh(),
            [0, 0, 0],
            (0, 1),
            kind=ConstrainedMotion(constraints=[BLADE]),
            outputs=Outputs(reactions=transmitted),
        )


TORQUE = 1.0


def turning_sleigh(**request: Any) -> Any:
    """A sleigh of 2 kg, 0.4 m from its blade to the mass centre, turned by 1 N m for 30 s from 1 m/s on."""
    inertia = {"xx": 0.1, "yy": 0.3, "zz": 0.3}
    joint = {"type": "planar", "coordinate": ["x", "y", "h"]}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": 2, "com": [0.4, 0, 0], "inertia": inertia}
    model = single({"name": "sleigh", "bodies": [body]}, [0, 0, -9.81])
    common: Plain = {"constraints": [KnifeEdge("k", "s.b")], "inputs": {"tau.s.h": TORQUE}, "count": 7}
    return simulated(model, [0, 0, 0], (0, 30), **common, **request)


@pytest.mark.parametrize("method", ["DOP853", "Radau", "LSODA"])
def test_velocities_that_were_chosen_are_changed_on_the_way(method: str) -> None:
    """v' = a w^2, (J + m a^2) w' = tau - m a v w: no velocities of coordinates describe more than a half turn."""

    def rates(_: float, y: np.ndarray) -> list[float]:
        v, w = y[:2]
        return [0.4 * w**2, (TORQUE - 2 * 0.4 * v * w) / (0.3 + 2 * 0.16), w]

    own = solve_ivp(rates, (0, 30), [1, 0, 0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    np.testing.assert_allclose(own[2], 13.87525280966, atol=1e-9)
    loose = {} if method == "DOP853" else {"relative_tolerance": 1e-8, "absolute_tolerance": 1e-10}
    motion = turning_sleigh(qd=[1, 0, 0], method=method, drift_limit=1e-7 if method == "DOP853" else 1e-3, **loose)
    assert motion.is_right, motion.checks
    assert motion.message == ""
    np.testing.assert_allclose(motion.q[-1, 2], own[2], atol=1e-8 if method == "DOP853" else 1e-3)
    # the series v is of the velocities of the start all along, here x' and h'
    np.testing.assert_allclose(motion.series["v"], motion.qd[:, [0, 2]], atol=1e-12)
    if method == "DOP853":
        given = turning_sleigh(v={"v": 1, "w": 0}, velocities={"v": "s.x'*cos(s.h)+s.y'*sin(s.h)", "w": "s.h'"})
        np.testing.assert_allclose(motion.q, given.q, atol=1e-8)
        np.testing.assert_allclose(motion.series["multipliers"], given.series["multipliers"], atol=1e-7)
        np.testing.assert_allclose(motion.series["kinetic_energy"], given.series["kinetic_energy"], rtol=1e-8)
        assert given.message == ""


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
@pytest.mark.parametrize("form", FORMS)
def test_steps_in_quasi_velocities_are_machine_code(form: str) -> None:
    """y' of a disc as in Python, with a torque that depends on time, place and velocity."""
    model = disc()
    inputs = {f"tau.{model.coordinates[4]}": "sin(3*t) + s.th*s.ph'/10"}
    conditions = read_conditions(model, Start([0, 0, 0.9 * R, 0.2, 1.2, 0], inputs=inputs), (0, 1), NEEDS)
    motion = ReducedMotion(quasi_velocity_equations(model, [FLOOR]), conditions, form, None)
    y = np.array([0.1, 0.2, 0.9 * R, 0.3, 1.1, 0.4, 1.0, 0.5, 6.0, 0.0])
    rates = motion.compiled()
    assert rates is not None
    found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)).rates(0.7, y)
    np.testing.assert_allclose(found, motion.rates(0.7, y), rtol=1e-12, atol=1e-12)
    assert np.abs(found[-4:]).min() > 0


def test_events_are_found_in_changed_velocities() -> None:
    """The heading passes 5 rad beyond the first change."""
    events = [Event("there", "s.h", 5, action="record"), Event("stop", "s.h", 9)]
    motion = turning_sleigh(qd=[1, 0, 0], events=events)
    assert motion.status == "stopped"
    assert [(each.name, round(float(each.q[2]), 9)) for each in motion.events] == [("there", 5), ("stop", 9)]


def test_velocities_that_were_given_and_fail_on_the_way_are_named() -> None:
    motion = turning_sleigh(qd=[1, 0, 0], independent=["s.x", "s.h"])
    assert motion.is_right is False
    assert motion.message.startswith("the velocities s.x', s.h' describe the motion badly where -cos(h) is near zero")


def test_where_they_fail_is_printed_when_it_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """For people: to lay out the determinant took longer than the equations of a bicycle."""
    equations = quasi_velocity_equations(sleigh(), [BLADE], independent=["s.x", "s.f"])
    assert equations.singular == "-cos(f)"
    monkeypatch.setattr("substructures.printers.render.readable", None)
    assert turning_sleigh(qd=[1, 0, 0]).is_right


@pytest.mark.parametrize("form", ["voronets", "boltzmann-hamel"])
def test_a_ball_on_a_table_that_turns(form: str) -> None:
    """Its centre goes round at 2/7 of the table's rate, for a homogeneous ball on any circle (R. H. Romer, Motion of a
    sphere on a tilted turntable, Am. J. Phys. 49, 1981); the energy changes by what the table does.
    """
    joints: list[Plain] = [{"type": "prismatic", "coordinate": x, "placement": {}} for x in "xy"]
    for joint, axis in zip(joints, ([1, 0, 0], [0, 1, 0]), strict=True):
        joint["axis"] = axis
    joints.append({"type": "spherical", "coordinate": ["a", "b", "c"], "placement": {"position": [0, 0, 0.1]}})
    names = ["base", "px", "py", "ball"]
    bodies = [{"name": names[k + 1], "parent": names[k], "joint": joint} for k, joint in enumerate(joints)]
    bodies[2] |= {"mass": 1, "inertia": dict.fromkeys(("xx", "yy", "zz"), 0.004)}
    table = 2
    rows = [
        f"s.x' - 0.1*(cos(s.a)*s.b' + sin(s.a)*cos(s.b)*s.c') + {table}*s.y",
        f"s.y' + 0.1*(-sin(s.a)*s.b' + cos(s.a)*cos(s.b)*s.c') - {table}*s.x",
    ]
    motion = simulated(
        single({"name": "ball", "bodies": bodies}, [0, 0, -9.81]),
        q=[0.3, 0, 0, 0, 0],
        span=[0, 11],
        count=12,
        constraints=[Linear("along", rows[0]), Linear("across", rows[1])],
        independent=["s.x", "s.y", "s.a"],
        v={"s.x'": 0, "s.y'": 0.2, "s.a'": 0},
        form=form,
    )
    w = 2 / 7 * table
    assert motion.is_right
    assert np.ptp(motion.series["kinetic_energy"]) > 0.02
    np.testing.assert_allclose(motion.q[:, 0], 0.3 + 0.2 * (np.cos(w * motion.t) - 1) / w, atol=1e-9)
    np.testing.assert_allclose(motion.q[:, 1], 0.2 * np.sin(w * motion.t) / w, atol=1e-9)
