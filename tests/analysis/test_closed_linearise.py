"""Linearisation of closed loops: differences of the constrained motion, closed forms, other cuts, small vibrations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from closed_trees import bricard, closed_entry, four_bar, governor, slider_crank, stewart, tree_model
from random_trees import Plain

from substructures import Model
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.linearise_closed import ClosedLinearisation

G = 9.81
DOWN = (0, -G, 0)
PARALLELOGRAM = {"x.l0": 0.4, "x.l2": 0.4, "x.l1": 0.3, "x.l3": 0.3}
STEP = 1e-4


def closed(model: Model, request: Plain) -> ClosedLinearisation:
    found = linearise(model, **request)
    assert isinstance(found, ClosedLinearisation)
    assert found.status == "finished", found.message
    return found


def rates(model: Model, at: ClosedLinearisation, y: np.ndarray, speed: np.ndarray, inputs: Plain) -> np.ndarray:
    """y'' at other y, y', q from the closures."""
    q, qd = at.q.copy(), at.qd.copy()
    index = [model.coordinates.index(name) for name in at.independent]
    q[index], qd[index] = y, speed
    found = loop_state(model, q, qd=qd, fixed=list(at.independent), inputs=inputs)
    assert not found.message
    return found.qdd[index]


def difference(f: Callable[[float], np.ndarray]) -> np.ndarray:
    """The derivative at 0 by differences of fourth order."""
    return np.asarray(8 * (f(STEP) - f(-STEP)) - (f(2 * STEP) - f(-2 * STEP))) / (12 * STEP)


#: of no effect, but states that a certificate draws depend on which there are
UNUSED = {
    "k16": "0.0295^2",
    "k17": 0.1201,
    "k18": -0.08825,
    "k19": -0.0048,
    "k2": 0.2726,
    "k20": -0.0453,
    "k22": 0.51445,
    "k23": 3.7963,
    "k24": -0.0462,
    "k25": 0.0811,
    "k26": 0.1428,
    "k27": 0.1292,
    "k28": 0.1935,
    "k29": 0.024,
    "k3": -0.0211,
    "k30": "0.0156^2",
    "k31": 0.0319,
    "k33": -1.5793,
    "k34": 0.6879,
    "k35": 0.0651,
    "k4": -0.238,
    "k5": 0.0753,
    "k6": -0.1085,
    "k7": -0.1425,
    "k8": 0.1105,
    "k9": -0.0274,
}


def sprung(mass: float = 1.0) -> Model:
    """A port kept in a plane of the world, with a damped spring between a body and the base."""
    inertia = {"mass": mass, "inertia": dict.fromkeys(("xx", "yy", "zz"), 0.1 * mass)} if mass else {}
    joints: list[Plain] = [
        {"type": "revolute", "coordinate": "q0", "d": "sqrt(k0)"},
        {"type": "fixed"},
        {"type": "cylindrical", "coordinate": ["q1", "q2"]},
        {"type": "revolute", "coordinate": "q3"},
    ]
    bodies = [
        {"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint} | inertia
        for k, joint in enumerate(joints)
    ]
    spring = {"type": "spring", "stiffness": "k36", "damping": "k37 + 0.01*sin(k14)^2/2", "length": "2*(k38 + 0.1)"}
    spring |= {
        "from": {"body": "base", "at": [-0.5251, 1.1, -0.4992]},
        "to": {"body": "b2", "at": [0.2423, 0, -0.0891]},
    }
    values = UNUSED | {"k0": "0.0497^2", "k14": 0.0029, "k32": 0.3845, "k37": 0.8319, "k38": 0.01365}
    part: Plain = {"name": "sprung", "bodies": bodies, "loads": [spring], "inputs": {"f1": {}}}
    part["parameters"] = {name: {"value": value} for name, value in sorted(values.items())} | {"k36": {}}
    part["ports"] = [{"name": "p0", "body": "b3", "position": ["k32", -0.3804, 0]}]
    instance = {"name": "i0", "substructure": "sprung", "parameters": {"k36": 22.4785}}
    closures = [{"name": "c0", "type": "planar", "from": "i0.p0"}]
    document = {"gravity": [0, 0, 0], "instances": [instance], "closures": closures}
    return tree_model(document, {"sprung": part})


MECHANISMS: list[Callable[[], Model]] = [
    lambda: four_bar(DOWN),
    lambda: slider_crank(DOWN),
    bricard,
    governor,
    stewart,
    sprung,
]


@pytest.mark.parametrize("make", MECHANISMS)
def test_state_space_against_differences_of_the_motion(make: Callable[[], Model]) -> None:
    """A and B in states of motion; what N, N' and N'' bring in, and the curvature of the closures."""
    model = make()
    rng = np.random.default_rng(4)
    inputs = {f"tau.{name}": float(rng.uniform(-1, 1)) for name in model.coordinates}
    q, qd = rng.uniform(-0.4, 0.4, model.dof), rng.uniform(-1, 1, model.dof)
    q = q + np.array([2, 0, 2, 0, 2]) if make is bricard else q
    columns = [f"tau.{model.coordinates[0]}"]
    at = closed(model, {"q": q, "qd": qd, "inputs": inputs, "of_inputs": columns})
    index = [model.coordinates.index(name) for name in at.independent]
    y, v, one = at.q[index], at.qd[index], np.eye(len(index))
    by_y = [difference(lambda h, e=e: rates(model, at, y + h * e, v, inputs)) for e in one]
    by_v = [difference(lambda h, e=e: rates(model, at, y, v + h * e, inputs)) for e in one]
    expected = np.array([*by_y, *by_v]).T
    r = len(index)
    np.testing.assert_allclose(at.A[:r], np.eye(r, 2 * r, r))
    np.testing.assert_allclose(at.A[r:], expected, rtol=0, atol=2e-6 * (1 + np.abs(expected).max()))
    more = difference(lambda h: rates(model, at, y, v, inputs | {columns[0]: inputs[columns[0]] + h}))
    np.testing.assert_allclose(at.B[r:, 0], more, rtol=0, atol=1e-6 * (1 + np.abs(more).max()))
    assert np.abs(at.residual).max() < 1e-9 * (1 + np.abs(at.multipliers).max())
    np.testing.assert_allclose(at.tangent[index], one)


def test_outputs_of_other_coordinates() -> None:
    """C of a dependent coordinate is its row of N, and of its velocity its rows of N' and N."""
    model = four_bar(DOWN)
    outputs = {"y": "2*x.rocker", "v": "x.rocker'", "u": "x.crank + tau.x.crank"}
    at = closed(model, {"q": [0.7, 0.2, 1.2], "qd": [3, 0, 0], "outputs": outputs, "of_inputs": ["tau.x.crank"]})
    rocker = model.coordinates.index("x.rocker")
    np.testing.assert_allclose(at.C[0], [2 * at.tangent[rocker, 0], 0], atol=1e-14)
    np.testing.assert_allclose(at.C[1, 1], at.tangent[rocker, 0])
    y = model.coordinates.index(at.independent[0])

    def speed(h: float) -> np.ndarray:
        q = at.q.copy()
        q[y] += h
        fixed = {"q": q, "qd": at.qd, "fixed": list(at.independent)}
        return loop_state(model, **fixed).consistent.qd[rocker : rocker + 1]

    np.testing.assert_allclose(at.C[1, :1], difference(speed), rtol=1e-7)
    np.testing.assert_allclose(at.Dy[:, 0], [0, 0, 1])


def test_a_hanging_parallelogram() -> None:
    """The coupler does not turn: w^2 = g/l ((m1 + m3)/2 + m2) / ((m1 + m3)/3 + m2)."""
    model = four_bar(DOWN)
    down = np.pi / 2
    at = closed(model, {"q": [-down, down, -down], "parameters": PARALLELOGRAM})
    cranks, coupler = 0.5 + 1, 1.4
    exact = np.sqrt(G / 0.3 * (cranks / 2 + coupler) / (cranks / 3 + coupler))
    assert [mode.frequency for mode in at.modes] == pytest.approx([exact], rel=1e-12)
    np.testing.assert_allclose(at.modes[0].shape / at.modes[0].shape[0], [1, -1, 1], atol=1e-12)
    assert at.stability is not None
    assert at.stability.verdict == "stable"
    assert "Dirichlet" in at.stability.reason


def test_a_third_crank_closes_it_once_more() -> None:
    """A redundant closure (which holds for these lengths only) adds its crank, and nothing else."""
    rod = {"parent": "base", "mass": 1, "com": [0.15, 0, 0], "inertia": {"yy": "0.3^2/12", "zz": "0.3^2/12"}}
    bodies: list[Plain] = [
        rod | {"name": f"c{k}", "joint": {"type": "revolute", "coordinate": f"c{k}", "d": f"{k}/5"}} for k in range(3)
    ]
    joint = {"type": "revolute", "coordinate": "table", "d": 0.3}
    bodies.append({"name": "table", "parent": "c0", "mass": 2, "com": [0.2, 0, 0], "joint": joint})
    ports = [{"name": f"e{k}", "body": f"c{k}", "position": [0.3, 0, 0]} for k in (1, 2)]
    ports += [{"name": f"t{k}", "body": "table", "position": [f"{k}/5", 0, 0]} for k in (1, 2)]
    pins = [{"name": f"pin{k}", "type": "pin", "from": f"x.t{k}", "to": f"x.e{k}"} for k in (1, 2)]
    document = {"gravity": [0, -G, 0], "instances": [{"name": "x", "substructure": "p"}], "closures": pins}
    model = tree_model(document, {"p": {"name": "p", "bodies": bodies, "ports": ports}})
    down = np.pi / 2
    at = closed(model, {"q": {"x.c0": -down, "x.c1": -down, "x.c2": -down, "x.table": down}})
    assert len(at.independent) == 1
    assert at.modes[0].frequency == pytest.approx(np.sqrt(G / 0.3 * (3 / 2 + 2) / (3 / 3 + 2)), rel=1e-12)


def test_a_bob_on_a_rod() -> None:
    """w^2 = g/L comes from the curvature of the closure alone: x, z have no restoring force of their own."""
    slides = [
        {"name": name, "parent": parent, "joint": {"type": "prismatic", "coordinate": name}}
        for name, parent in (("x", "base"), ("z", "x"))
    ]
    slides[0]["joint"] |= {"placement": {"position": [0, 0, 0]}, "axis": [1, 0, 0]}
    slides[1] |= {"mass": 3}
    slides[1]["joint"] |= {"placement": {"position": [0, 0, 0]}, "axis": [0, 0, 1]}
    rod = {"name": "rod", "type": "rod", "from": "p.z", "to": "world", "length": 0.7}
    document = {"gravity": [0, 0, -G], "instances": [{"name": "p", "substructure": "b"}], "closures": [rod]}
    model = tree_model(document, {"b": {"name": "b", "bodies": slides}})
    at = closed(model, {"q": [0, -0.7]})
    assert at.modes[0].frequency == pytest.approx(np.sqrt(G / 0.7), rel=1e-12)
    assert at.constraints == ("rod.length",)
    np.testing.assert_allclose(np.abs(at.multipliers), [3 * G])
    upright = closed(model, {"q": [0, 0.7]})
    assert upright.stability is not None
    assert upright.stability.verdict == "unstable"


def test_a_double_pendulum_whose_tip_is_bound() -> None:
    """By a rod across: the tip cannot move sideways, the two turn against each other; w^2 = g/l (m1 + 2 m2)/m1."""
    rod = {"name": "rod", "type": "rod", "from": "x.bob", "to": "world", "length": 5}
    rod["placement"] = {"position": [5, 0, -2]}
    model = closed_entry("double-pendulum", [rod], (0, 0, -G))
    at = closed(model, {"q": [0, 0]})
    assert at.modes[0].frequency == pytest.approx(np.sqrt(3 * G), rel=1e-12)
    np.testing.assert_allclose(at.modes[0].shape[1] / at.modes[0].shape[0], -2)


def test_a_damped_spring_in_a_closed_tree_without_masses_is_a_failure_with_advice() -> None:
    """Not an error of its certificate, in which nothing but G is followed along the motion."""
    found = linearise(sprung(0), [0.8182828909154267, -1.3985267257072653, 0.6119959511984628, 1.259634079907978])
    assert found.status == "failed"
    assert "check masses and inertias" in found.message
