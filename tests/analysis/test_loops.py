"""Closed loops at a state: redundancy, reactions, consistent starts, singular positions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model
from closed_trees import at, bricard, closed_entry, four_bar, slider_crank, tree_model
from random_trees import Plain

from substructures import Definition, InvalidInput, TreeSpec, couple, derive
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import ClosedMotion, Table, simulate
from substructures.quantities.numbers.evaluation import evaluate


def test_planar_pin_is_redundant_but_harmless() -> None:
    """Three of the five rows of a pin say nothing in a planar mechanism; counting is wrong, the rank is right."""
    for model in (four_bar(), slider_crank()):
        found = loop_state(model, [0.7, 0.2, 0.1], fixed=[model.coordinates[0]])
        place = found.mobility
        assert (place.rank, place.degrees_of_freedom, place.counted) == (2, 1, -2)
        assert {label.partition(".")[2] for label in place.dependent} == {"z", "rx", "ry"}
        assert found.reactions[0].not_unique == ("z", "rx", "ry")
        assert not place.singular


def test_two_hinges_of_a_door() -> None:
    """A bar on two hinges of one line: each carries a load, sums are unique, and the least ones are symmetric."""
    body = {"name": "door", "parent": "base", "joint": {"type": "revolute", "coordinate": "q", "theta": "pi/2"}}
    body |= {"mass": 2, "com": [0.5, 0, 0.5], "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}}
    ports = [{"name": f"h{z}", "body": "door", "position": [0, 0, z]} for z in (0, 1)]
    part = {"name": "door", "bodies": [body], "ports": ports}
    seats = [{"rpy": ["pi/2", 0, 0], "position": [0, -z, 0]} for z in (0, 1)]
    closures = [
        {"name": f"c{z}", "type": "pin", "from": f"x.h{z}", "to": "world", "placement": seats[z]} for z in (0, 1)
    ]
    document = {"gravity": [0, 0, -9.81], "instances": [{"name": "x", "substructure": "d"}], "closures": closures}
    found = loop_state(tree_model(document, {"d": part}), [0.3])
    assert (found.mobility.rank, found.mobility.degrees_of_freedom, found.mobility.redundant) == (0, 1, True)
    assert all(len(r.not_unique) == 5 for r in found.reactions)


def test_reactions_hold_the_parts_in_balance() -> None:
    """A weight on a bar that hangs by a pin from the world: the pin carries m (g - a) in the axes of its frame."""
    body = {"name": "bob", "parent": "base", "joint": {"type": "planar"}, "mass": 2, "inertia": {"xx": 0.1, "zz": 0.1}}
    part = {"name": "bob", "bodies": [body], "ports": [{"name": "pin", "body": "bob", "position": [0, 0.5, 0]}]}
    closure = {"name": "hook", "type": "pin", "from": "x.pin", "to": "world"}
    document = {"gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": "b"}], "closures": [closure]}
    model = tree_model(document, {"b": part})
    q, w = 0.4, 1.3
    # the mass centre is at 0.5 (sin q, -cos q)
    start = [0.5 * np.sin(q), -0.5 * np.cos(q), q]
    rates = [0.5 * np.cos(q) * w, 0.5 * np.sin(q) * w, w]
    found = loop_state(model, start, qd=rates)
    qdd = -2 * 9.81 * 0.5 * np.sin(q) / (0.1 + 2 * 0.25)
    np.testing.assert_allclose(found.qdd[2], qdd, rtol=1e-12)
    # on the bob, along and across the bar: m (a - g); the closure's force acts on the world
    along, across = 2 * (0.5 * w**2 + 9.81 * np.cos(q)), 2 * (0.5 * qdd + 9.81 * np.sin(q))
    np.testing.assert_allclose(found.reactions[0].force, [-across, -along, 0], rtol=1e-10, atol=1e-10)


AXES: list[tuple[str, Any]] = [("pin", None), ("weld", None), ("pin", [1, 0, 0]), ("pin", [1, 1, 1])]
AXES += [("slider", [1, 2, 0]), ("cylindrical", [0.6, 0, 0.8]), ("universal", [1, -1, 2]), ("planar", [0, 0.1, 1])]


@pytest.mark.parametrize(("kind", "axis"), AXES)
def test_reactions_are_in_the_axes_of_from(kind: str, axis: Any) -> None:
    """Newton and Euler in the world: weight less rate of momentum is what the closure lays on its frame `to` there,
    about whose origin moments are. An axis turns no component.
    """
    free = {"type": "free", "coordinate": ["x", "y", "z", "a", "b", "c"]}
    body = {"name": "b", "parent": "base", "joint": free, "mass": 2, "com": [0.3, -0.2, 0.5]}
    body |= {"inertia": {"xx": 1, "yy": 1, "zz": 1}}
    closure = {"name": "hook", "type": kind, "from": "x.b", "to": "world"} | ({"axis": axis} if axis else {})
    closure["placement"] = {"position": [0.1, 0.2, 0.3], "rpy": [0, 0, 0.7]}
    document = {"gravity": [0, 0, -9.81], "instances": [{"name": "x", "substructure": "b"}], "closures": [closure]}
    model = tree_model(document, {"b": {"name": "b", "bodies": [body]}})
    found = loop_state(model, [0.1, 0.2, 0.3, 0.7, 0, 0])
    assert found.message == ""
    place = evaluate(model, ["kinematics"], q=found.consistent.q)["kinematics"]
    rotation = place["rotation"][model.frames.index("x.b")]
    centre, alpha = rotation @ np.array([0.3, -0.2, 0.5]), _turning(found.consistent.q, found.qdd)
    # at rest: m (g - r'' - alpha x c), and c x that less Theta alpha, Theta = 1
    force = 2 * (np.array([0, 0, -9.81]) - found.qdd[:3] - np.cross(alpha, centre))
    np.testing.assert_allclose(found.consistent.q[:3], [0.1, 0.2, 0.3], atol=1e-12)
    np.testing.assert_allclose(rotation @ found.reactions[0].force, force, atol=1e-9)
    np.testing.assert_allclose(rotation @ found.reactions[0].moment, np.cross(centre, force) - alpha, atol=1e-9)
    assert np.abs(force).max() > 1


def _turning(q: np.ndarray, qdd: np.ndarray) -> np.ndarray:
    """Angular acceleration in the world at rest: yaw about z, pitch about the new y, roll about the new x."""
    yaw, pitch = q[3], q[4]
    y = np.array([-np.sin(yaw), np.cos(yaw), 0])
    x = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
    return qdd[3] * np.array([0, 0, 1]) + qdd[4] * y + qdd[5] * x


def test_consistent_start_keeps_fixed_coordinates() -> None:
    """Slider-crank in closed form: x = r cos a + sqrt(l^2 - r^2 sin^2 a)."""
    model, a, w = slider_crank(), 0.9, 12.0
    request: Plain = {"q": at(model, crank=a, piston=0.1), "qd": at(model, crank=w), "fixed": ["x.crank"]}
    state = loop_state(model, **request).consistent
    r, length = 0.04, 0.14
    root = np.sqrt(length**2 - (r * np.sin(a)) ** 2)
    np.testing.assert_allclose(state.q[0], a)
    np.testing.assert_allclose(state.q[2], r * np.cos(a) + root, rtol=1e-12)
    np.testing.assert_allclose(state.qd[2], -r * np.sin(a) * w * (1 + r * np.cos(a) / root), rtol=1e-12)


def test_loops_that_cannot_close_say_why() -> None:
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    model = closed_entry("four-bar", [pin], l0=5)
    found = loop_state(model, [0.3, 0.1, 0.2])
    assert not found.consistent.found
    assert "pin." in found.message
    assert "change the lengths" in found.message
    crank = slider_crank()
    request: Plain = {
        "q": at(crank, crank=0.9, rod=-0.2, piston=0.16),
        "qd": [1.0, 0, 0],
        "fixed": list(crank.coordinates[:1]),
    }
    closed = loop_state(crank, **request).consistent.q
    stuck = loop_state(crank, closed, qd=request["qd"], fixed=crank.coordinates)
    assert "velocities cannot be met" in stuck.message


def test_a_weld_must_not_close_upside_down() -> None:
    """Two bars that face each other: their dot products vanish, too, but a weld holds directions."""
    body = {"name": "b", "parent": "base", "joint": {"type": "revolute"}, "mass": 1, "inertia": {"xx": 1, "zz": 1}}
    part = {"name": "p", "bodies": [body]}
    closure = {"name": "seam", "type": "weld", "from": "x.b", "to": "world"}
    document = {"instances": [{"name": "x", "substructure": "p"}], "closures": [closure]}
    model = tree_model(document, {"p": part})
    assert loop_state(model, [0.2]).message == ""
    turned = loop_state(model, [3.0])
    assert "'seam' is closed with axes in opposite directions" in turned.message


def test_a_dead_centre_is_singular() -> None:
    """A parallelogram stretched out may go on as parallelogram or antiparallelogram."""
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    model = closed_entry("four-bar", [pin], l0=0.3, l1=0.2, l2=0.3, l3=0.2)
    assert loop_state(model, [0, 0, 0]).mobility.singular
    assert "singular" in loop_state(model, [0, 0, 0]).message
    bent = loop_state(model, [0.4, -0.4, 0.4])
    assert not bent.mobility.singular


def test_bricard_moves_although_it_should_not() -> None:
    """Five rows, five coordinates, one degree of freedom. With twists of 90 degrees the threefold-symmetric linkage has
    cos a + cos b + cos a cos b = 0 (Y. Chen, Z. You, T. Tarnai, Int. J. Solids Struct. 42, 2005, equation 10).
    """
    model = bricard()
    a = 1.9
    b = np.arccos(-np.cos(a) / (1 + np.cos(a)))
    found = loop_state(model, [a, b, a, b, a], fixed=["l0.q"])
    assert found.message == ""
    np.testing.assert_allclose(found.consistent.q, [a, b, a, b, a], atol=1e-9)
    place = found.mobility
    assert (place.counted, place.rank, place.degrees_of_freedom) == (0, 4, 1)
    assert len(place.dependent) == 1
    assert not place.singular


BAD: list[tuple[Plain, str, str]] = [
    ({"fixed": ["x.c"]}, "/fixed/0", "unknown-coordinate"),
    ({"inputs": {"tau.x.crank": "2*u"}}, "/inputs/tau.x.crank", "unknown-name"),
    ({"inputs": {"tau.y": 1}}, "/inputs/tau.y", "unknown-input"),
    ({"inputs": {"tau.x.crank": Table([0.1, 0.2], [1, 2])}}, "/inputs/tau.x.crank/times", "not-covered"),
    ({"prescribed": {"x.c": "t"}}, "/prescribed/x.c", "unknown-coordinate"),
    ({"prescribed": {"x.crank": "sin(x)"}}, "/prescribed/x.crank", "unknown-name"),
    ({"q": [0, 1]}, "/q", "wrong-length"),
    ({"t": [1, 2]}, "/t", "number-expected"),
    ({"prescribed": {"x.crank": [1, 2]}}, "/prescribed/x.crank", "number-expected"),
    ({"parameters": {"m": 1}}, "/parameters/m", "unknown-parameter"),
]


@pytest.mark.parametrize(("change", "pointer", "code"), BAD)
def test_bad_arguments(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        loop_state(SLIDER, **{"q": [0, 0, 0.18]} | change)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


SLIDER = slider_crank()


def test_inputs_may_be_numbers_expressions_and_tables() -> None:
    """At t = 0.5 all three are the same torque; numbers may come from numpy."""
    table = Table(np.array([0, 1.0]), [0, 4])
    given: list[Any] = [2, np.float64(2.0), "8*t^2", table, Table([0, 1], [0, 4], "cubic")]
    given.append(Table([0, 0.4, 1], [1, 2, 3], "hold"))
    request: Plain = {"q": at(SLIDER, crank=0.4, piston=0.17), "t": 0.5, "fixed": ["x.crank"]}
    found = [loop_state(SLIDER, **request, inputs={"tau.x.crank": x}).qdd for x in given]
    for qdd in found:
        np.testing.assert_allclose(qdd, found[0], rtol=1e-12)
    assert np.abs(found[0]).max() > 1


def test_a_tree_without_loops_is_the_special_case() -> None:
    part = {
        "name": "p",
        "bodies": [{"name": "b", "parent": "base", "joint": {"type": "revolute"}, "mass": 1, "com": [1, 0, 0]}],
    }
    spec = TreeSpec.read({"name": "t", "gravity": [0, -9.81, 0], "instances": [{"name": "x", "definition": part}]})
    model = couple(spec, {"x": derive(Definition.read(part))})
    found = loop_state(model, [0.0])
    np.testing.assert_allclose(found.qdd, [-9.81])
    driven = loop_state(model, [0.0], prescribed={"x.q_b": "t^2/2"})
    np.testing.assert_allclose(driven.qdd, [1.0])
    np.testing.assert_allclose(driven.actuation["x.q_b"], 1 + 9.81)
    two = {"x.q1": "sin(t)", "x.q2": "t^3"}
    held = loop_state(catalogue_model("double-pendulum"), [0.4, 0.1], prescribed=two, t=0.5)
    state = {"q": [np.sin(0.5), 0.125], "qd": [np.cos(0.5), 0.75], "qdd": [-np.sin(0.5), 3]}
    needed = evaluate(catalogue_model("double-pendulum"), ["inverse_dynamics"], **state)
    np.testing.assert_allclose(held.qdd, state["qdd"])
    np.testing.assert_allclose(list(held.actuation.values()), needed["inverse_dynamics"], rtol=1e-9)


def test_a_force_on_a_coordinate_whose_velocity_occurs_nowhere() -> None:
    """A mass of 2 kg on a slide, pushed by a force 3 t: no output of the model depends on its velocity."""
    slide = {"name": "m", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": 2}
    part = {"name": "p", "bodies": [slide], "loads": [{"type": "joint", "coordinate": "s", "force": "3*t"}]}
    model = tree_model({"instances": [{"name": "x", "substructure": "p"}]}, {"p": part})
    np.testing.assert_allclose(loop_state(model, [0.0], t=2).qdd, [3], rtol=1e-14)
    # s = t^2: the drive adds 2 s'' - 3 t, and both together do the work T = 2 (2 t)^2 / 2
    motion = simulate(model, [0.0], (0, 1), kind=ClosedMotion(prescribed={"x.s": "t^2"}))
    assert motion.is_right
    np.testing.assert_allclose(motion.series["actuation"][:, 0], 4 - 3 * motion.t, atol=1e-9)
    np.testing.assert_allclose(motion.series["work"], 4 * motion.t**2, atol=1e-9)


def test_a_loop_state_says_in_two_lines_what_it_is() -> None:
    first, second = repr(loop_state(SLIDER, [0.4, -0.1, 0.17], fixed=["x.crank"])).splitlines()
    assert first == "LoopState: 3 coordinates, 1 free; 2 independent rows, redundant: wrist.z, wrist.rx, wrist.ry"
    assert second.endswith("reactions: wrist; closed")
