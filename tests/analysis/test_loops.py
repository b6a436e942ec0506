"""Closed loops at a state: any joint may be cut; redundancy, reactions, consistent starts, an independent engine."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import at, bricard, closed_entry, four_bar, slider_crank, tree_model
from random_trees import GRAVITY, Plain, add_inertia, number, vector

from substructures import Definition, InvalidDocument, TreeSpec, couple, derive
from substructures.analysis.loops import analyse_loops
from substructures.evaluation import evaluate
from substructures.skeleton import CHAINS

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional

KINDS = ("revolute", "prismatic", "spherical", "fixed", "cylindrical", "universal", "planar")


def angles(rotation: np.ndarray) -> list[float]:
    """Yaw, pitch and roll of a rotation Rz Ry Rx."""
    x, y, z = rotation
    return [np.arctan2(y[0], x[0]), -np.arcsin(z[0]), np.arctan2(z[1], z[2])]


def cut(rng: np.random.Generator, kind: str) -> tuple[Plain, Plain]:
    """A chain of three bodies whose second joint is of this kind; and the same with that joint cut: a free body."""
    bodies: list[Plain] = []
    for name, parent, joint in (("b1", "base", "revolute"), ("b2", "b1", kind), ("b3", "b2", "prismatic")):
        place = {"position": vector(rng), "rpy": [number(rng) for _ in range(3)]}
        bodies.append({"name": name, "parent": parent, "joint": {"type": joint, "placement": place}})
        add_inertia(rng, bodies[-1], True)
    seat = bodies[1]["joint"]["placement"]
    port = {"name": "seat", "body": "b1", "position": seat["position"], "rotation": {"rpy": seat["rpy"]}}
    free = {**bodies[1], "parent": "base", "joint": {"type": "free"}}
    load = {"type": "force", "body": "b3", "vector": [1, 2, 3], "frame": "world"}
    whole = {"name": "whole", "bodies": bodies, "ports": [port], "loads": [load]}
    return whole, whole | {"bodies": [bodies[0], free, bodies[2]]}


@pytest.mark.parametrize("kind", KINDS)
def test_any_joint_may_be_cut(kind: str) -> None:
    """A free body that a closure ties to its old place moves like the chain it was cut from."""
    rng = np.random.default_rng(KINDS.index(kind))
    whole, parted = cut(rng, kind)
    chain = tree_model({"gravity": list(GRAVITY), "instances": [{"name": "x", "substructure": "w"}]}, {"w": whole})
    closure = {"name": "c", "type": kind, "from": "x.seat", "to": "x.b2"}
    document = {"gravity": list(GRAVITY), "instances": [{"name": "x", "substructure": "w"}], "closures": [closure]}
    closed = tree_model(document, {"w": parted})
    n = len(CHAINS[kind])
    q, qd = rng.uniform(-0.6, 0.6, chain.dof), rng.uniform(-1, 1, chain.dof)
    answer = evaluate(chain, {"quantities": ["kinematics", "forward_dynamics"], "q": q, "qd": qd})
    b2 = chain.frames.index("x.b2")
    pose = answer["kinematics"]["position"][b2], answer["kinematics"]["rotation"][b2]
    start = np.concatenate((q[:1], pose[0], angles(pose[1]), q[1 + n :]))
    speeds = np.concatenate((qd[:1], np.zeros(6), qd[1 + n :]))
    rates = slopes(chain, q, qd, b2)
    speeds[1:7] = rates
    found = analyse_loops(closed, {"q": start, "qd": speeds})
    assert found.message == ""
    assert found.mobility.degrees_of_freedom == chain.dof
    assert not found.mobility.redundant
    np.testing.assert_allclose(found.consistent.q, start, atol=1e-11)
    np.testing.assert_allclose(found.consistent.qd, speeds, atol=1e-6)
    again = analyse_loops(closed, {"q": found.consistent.q, "qd": speeds})
    expected = answer["forward_dynamics"]
    np.testing.assert_allclose(again.qdd[[0, -1]], expected[[0, -1]], rtol=1e-6, atol=1e-6 * np.abs(expected).max())


def slopes(chain: Any, q: np.ndarray, qd: np.ndarray, frame: int, h: float = 1e-4) -> np.ndarray:
    """Rates of position and angles of a frame, by differences of fourth order."""
    result = np.zeros(6)
    for k, c in ((1, 8), (-1, -8), (2, -1), (-2, 1)):
        x = evaluate(chain, {"quantities": ["kinematics"], "q": q + k * h * qd})["kinematics"]
        result += c / (12 * h) * np.concatenate((x["position"][frame], angles(x["rotation"][frame])))
    return result


@pytest.mark.parametrize("kind", ["spherical", "fixed"])
def test_independent_engine(kind: str) -> None:
    """Accelerations of a chain tied to the world against Pinocchio's constraint dynamics."""
    rng = np.random.default_rng(11)
    bodies: list[Plain] = []
    for k in range(8):
        place = {"position": [0.4, 0.1 * (k % 3), 0.1], "rpy": vector(rng, 2)}
        joint = {"type": "revolute", "coordinate": f"q{k}", "placement": place}
        bodies.append({"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint})
        add_inertia(rng, bodies[-1], True)
    tip = {"name": "tip", "body": "b7", "position": [0.3, 0, 0.1]}
    definition = {"name": "chain", "bodies": bodies, "ports": [tip]}
    document: Plain = {"gravity": list(GRAVITY), "instances": [{"name": "x", "substructure": "d"}]}
    start = rng.uniform(-0.5, 0.5, 8)
    chain = tree_model(document, {"d": definition})
    x = evaluate(chain, {"quantities": ["kinematics"], "q": start})["kinematics"]
    where, turned = x["position"][-1], x["rotation"][-1]
    seat = {"position": [float(v) for v in where], "rpy": [float(v) for v in reversed(angles(turned))]}
    closure = {"name": "c", "type": kind, "from": "x.tip", "to": "world", "placement": seat}
    model = tree_model(document | {"closures": [closure]}, {"d": definition})
    found = analyse_loops(model, {"q": start, "qd": rng.uniform(-1, 1, 8)})
    assert found.message == ""
    engine = engine_of(definition, GRAVITY)
    j1, p1 = engine.frames["tip"]
    p2 = pin.SE3(turned, where)
    contact = pin.ContactType.CONTACT_3D if kind == "spherical" else pin.ContactType.CONTACT_6D
    constraint = pin.RigidConstraintModel(contact, engine.model, j1, p1, 0, p2, pin.ReferenceFrame.LOCAL)
    data, settings = engine.model.createData(), pin.ProximalSettings(1e-14, 1e-14, 1000)
    models, datas = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    models.append(constraint)
    datas.append(constraint.createData())
    pin.initConstraintDynamics(engine.model, data, models, datas)
    state = found.consistent.q, found.consistent.qd, np.zeros(8)
    a = pin.constraintDynamics(engine.model, data, *state, models, datas, settings)
    np.testing.assert_allclose(found.qdd, a, rtol=0, atol=1e-7 * np.abs(a).max())


def test_planar_pin_is_redundant_but_harmless() -> None:
    """Three of the five rows of a pin say nothing in a planar mechanism; counting is wrong, the rank is right."""
    for model in (four_bar(), slider_crank()):
        found = analyse_loops(model, {"q": [0.7, 0.2, 0.1], "fixed": [model.coordinates[0]]})
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
    found = analyse_loops(tree_model(document, {"d": part}), {"q": [0.3]})
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
    found = analyse_loops(model, {"q": start, "qd": rates})
    qdd = -2 * 9.81 * 0.5 * np.sin(q) / (0.1 + 2 * 0.25)
    np.testing.assert_allclose(found.qdd[2], qdd, rtol=1e-12)
    # on the bob, along and across the bar: m (a - g); the closure's force acts on the world
    along, across = 2 * (0.5 * w**2 + 9.81 * np.cos(q)), 2 * (0.5 * qdd + 9.81 * np.sin(q))
    np.testing.assert_allclose(found.reactions[0].force, [-across, -along, 0], rtol=1e-10, atol=1e-10)


def test_consistent_start_keeps_fixed_coordinates() -> None:
    """Slider-crank in closed form: x = r cos a + sqrt(l^2 - r^2 sin^2 a)."""
    model, a, w = slider_crank(), 0.9, 12.0
    request: Plain = {"q": at(model, crank=a, piston=0.1), "qd": at(model, crank=w), "fixed": ["x.crank"]}
    state = analyse_loops(model, request).consistent
    r, length = 0.04, 0.14
    root = np.sqrt(length**2 - (r * np.sin(a)) ** 2)
    np.testing.assert_allclose(state.q[0], a)
    np.testing.assert_allclose(state.q[2], r * np.cos(a) + root, rtol=1e-12)
    np.testing.assert_allclose(state.qd[2], -r * np.sin(a) * w * (1 + r * np.cos(a) / root), rtol=1e-12)


def test_loops_that_cannot_close_say_why() -> None:
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    model = closed_entry("four-bar", [pin], l0=5)
    found = analyse_loops(model, {"q": [0.3, 0.1, 0.2]})
    assert not found.consistent.found
    assert "pin." in found.message
    assert "change the lengths" in found.message
    crank = slider_crank()
    request = {
        "q": at(crank, crank=0.9, rod=-0.2, piston=0.16),
        "qd": [1.0, 0, 0],
        "fixed": list(crank.coordinates[:1]),
    }
    stuck = analyse_loops(
        crank, request | {"fixed": list(crank.coordinates), "q": analyse_loops(crank, request).consistent.q}
    )
    assert "velocities cannot be met" in stuck.message


def test_a_weld_must_not_close_upside_down() -> None:
    """Two bars that face each other: their dot products vanish, too, but a weld holds directions."""
    body = {"name": "b", "parent": "base", "joint": {"type": "revolute"}, "mass": 1, "inertia": {"xx": 1, "zz": 1}}
    part = {"name": "p", "bodies": [body]}
    closure = {"name": "seam", "type": "weld", "from": "x.b", "to": "world"}
    document = {"instances": [{"name": "x", "substructure": "p"}], "closures": [closure]}
    model = tree_model(document, {"p": part})
    assert analyse_loops(model, {"q": [0.2]}).message == ""
    turned = analyse_loops(model, {"q": [3.0]})
    assert "'seam' is closed with axes in opposite directions" in turned.message


def test_plain_answer() -> None:
    """What a service sends: names, lists and numbers."""
    answer = analyse_loops(SLIDER, {"q": at(SLIDER, crank=0.4, piston=0.17)}).plain()
    assert {"q", "qd", "qdd", "multipliers", "actuation", "mobility", "reactions", "message"} <= answer.keys()
    assert answer["mobility"]["degrees_of_freedom"] == 1
    assert [r["closure"] for r in answer["reactions"]] == ["wrist"]


def test_a_dead_centre_is_singular() -> None:
    """A parallelogram stretched out may go on as parallelogram or antiparallelogram."""
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    model = closed_entry("four-bar", [pin], l0=0.3, l1=0.2, l2=0.3, l3=0.2)
    assert analyse_loops(model, {"q": [0, 0, 0]}).mobility.singular
    assert "singular" in analyse_loops(model, {"q": [0, 0, 0]}).message
    bent = analyse_loops(model, {"q": [0.4, -0.4, 0.4]})
    assert not bent.mobility.singular


def test_bricard_moves_although_it_should_not() -> None:
    """Five rows, five coordinates, one degree of freedom. With twists of 90 degrees the threefold-symmetric linkage has
    cos a + cos b + cos a cos b = 0 (Y. Chen, Z. You, T. Tarnai, Int. J. Solids Struct. 42, 2005, equation 10).
    """
    model = bricard()
    a = 1.9
    b = np.arccos(-np.cos(a) / (1 + np.cos(a)))
    found = analyse_loops(model, {"q": [a, b, a, b, a], "fixed": ["l0.q"]})
    assert found.message == ""
    np.testing.assert_allclose(found.consistent.q, [a, b, a, b, a], atol=1e-9)
    place = found.mobility
    assert (place.counted, place.rank, place.degrees_of_freedom) == (0, 4, 1)
    assert len(place.dependent) == 1
    assert not place.singular


BAD: list[tuple[Plain, str, str]] = [
    ({"fixed": ["x.c"]}, "/fixed/0", "unknown-coordinate"),
    ({"fixed": "x.crank"}, "/fixed", "tuple-type"),
    ({"inputs": {"tau.x.crank": "2*u"}}, "/inputs/tau.x.crank", "unknown-name"),
    ({"inputs": {"tau.y": 1}}, "/inputs/tau.y", "unknown-input"),
    ({"inputs": {"tau.x.crank": {"times": [0, 0], "values": [1, 2]}}}, "/inputs/tau.x.crank", "not-increasing"),
    ({"inputs": {"tau.x.crank": {"times": [0, 1]}}}, "/inputs/tau.x.crank/values", "missing"),
    ({"prescribed": {"x.c": "t"}}, "/prescribed/x.c", "unknown-coordinate"),
    ({"prescribed": {"x.crank": "sin(x)"}}, "/prescribed/x.crank", "unknown-name"),
    ({"q": [0, 1]}, "/q", "wrong-length"),
    ({"speed": 1}, "/speed", "extra-forbidden"),
    ({"t": [1, 2]}, "/t", "number-expected"),
    ({"prescribed": {"x.crank": [1, 2]}}, "/prescribed/x.crank", "number-expected"),
    ({"prescribed": ["x.crank"]}, "/prescribed", "dict-type"),
    ({"parameters": {"m": 1}}, "/parameters/m", "unknown-parameter"),
]


@pytest.mark.parametrize(("change", "pointer", "code"), BAD)
def test_bad_requests(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        analyse_loops(SLIDER, {"q": [0, 0, 0.18]} | change)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


SLIDER = slider_crank()


def test_inputs_may_be_numbers_expressions_and_tables() -> None:
    """At t = 0.5 all three are the same torque; numbers may come from numpy."""
    table = {"times": np.array([0, 1.0]), "values": [0, 4]}
    given: list[Any] = [2, np.float64(2.0), "8*t^2", table, table | {"interpolation": "cubic"}]
    given.append({"times": [0, 0.4, 1], "values": [1, 2, 3], "interpolation": "hold"})
    request: Plain = {"q": at(SLIDER, crank=0.4, piston=0.17), "t": 0.5, "fixed": ["x.crank"]}
    found = [analyse_loops(SLIDER, request | {"inputs": {"tau.x.crank": x}}).qdd for x in given]
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
    found = analyse_loops(model, {"q": [0.0]})
    np.testing.assert_allclose(found.qdd, [-9.81])
    driven = analyse_loops(model, {"q": [0.0], "prescribed": {"x.q_b": "t^2/2"}})
    np.testing.assert_allclose(driven.qdd, [1.0])
    np.testing.assert_allclose(driven.actuation["x.q_b"], 1 + 9.81)
