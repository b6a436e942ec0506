"""Potential energies: a reported potential has the force as its gradient, whatever way the force is given."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import seeds
from random_trees import Plain, model_of, number

from substructures import Definition, InvalidInput, Model, TreeSpec, couple, derive
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.evaluation import evaluate

NONE = (0, 0, 0)


def slide(*loads: Plain, **joint: Any) -> Model:
    """A mass of 1 kg on the vertical."""
    body = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"} | joint}
    return model_of({"name": "a", "bodies": [body], "loads": list(loads)}, NONE)


def plane(*loads: Plain, **more: Any) -> Model:
    """A mass point on two slides x and y, along the third and the first axis of the world."""
    joints: list[Plain] = [
        {"type": "prismatic", "coordinate": "x"},
        {"type": "prismatic", "coordinate": "y", "placement": {"rpy": [0, "pi/2", 0]}},
    ]
    bodies: list[Plain] = [
        {"name": "a", "parent": "base", "joint": joints[0], "mass": 1},
        {"name": "b", "parent": "a", "joint": joints[1], "mass": 2},
    ]
    return model_of({"name": "a", "bodies": bodies, "loads": list(loads)} | more, NONE)


def law(coordinate: str, force: str) -> Plain:
    return {"type": "joint", "coordinate": coordinate, "force": force}


def energy_and_forces(model: Model, q: Any, **more: Any) -> tuple[Any, Any]:
    found = evaluate(model, ["potential_energy", "forces"], q=q, **more)
    return found["potential_energy"], found["forces"]


def slope(model: Model, q: np.ndarray, **more: Any) -> np.ndarray:
    """dV/dq by central differences of fourth order at the states (N, n)."""
    h, columns = 1e-3, []
    for e in np.eye(model.dof):
        f = {k: energy_and_forces(model, q + k * h * e, **more)[0] for k in (-2, -1, 1, 2)}
        columns.append((8 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12 * h))
    return np.stack(columns, axis=-1)


#: potentials of x and y with both derivatives by hand
TERMS = [
    ("{c}*(x - y)^2", "2*{c}*(x - y)", "-2*{c}*(x - y)"),
    ("{c}*x^3*y^2", "3*{c}*x^2*y^2", "2*{c}*x^3*y"),
    ("{c}*cos(2*x + y)", "-2*{c}*sin(2*x + y)", "-{c}*sin(2*x + y)"),
    ("{c}*x^2*sin(y)", "2*{c}*x*sin(y)", "{c}*x^2*cos(y)"),
    ("{c}*y*sin(x)*cos(x)", "{c}*y*(cos(x)^2 - sin(x)^2)", "{c}*sin(x)*cos(x)"),
    ("{c}*k^2*x/(1 + k)", "{c}*k^2/(1 + k)", "0"),
]


def random_potential(rng: np.random.Generator) -> tuple[str, str, str]:
    chosen = rng.choice(len(TERMS), 3, replace=False)
    drawn = [(TERMS[i], number(rng, 0.2, 2)) for i in chosen]
    parts = [[text.format(c=c) for text in term] for term, c in drawn]
    return tuple(" + ".join(column) for column in zip(*parts, strict=True))  # type: ignore[return-value]


@pytest.mark.parametrize("seed", seeds(6, 30))
def test_forces_of_a_potential_are_recognised(seed: int) -> None:
    """V that was differentiated by hand is found from the forces, with dampers and inputs beside them."""
    V, dx, dy = random_potential(np.random.default_rng(seed))
    more: Plain = {"parameters": {"k": {"value": 1.7}}, "inputs": {"u": {}}}
    given = plane({"type": "potential", "potential": V}, **more)
    forces = plane(law("x", f"-({dx}) - 0.3*x' + u"), law("y", f"y'*x - ({dy}) + 2*sin(t)"), **more)
    q = np.random.default_rng(seed).uniform(-1.5, 1.5, (4, 2))
    expected, Q = energy_and_forces(given, q)
    found, same = energy_and_forces(forces, q, t=0.0)
    np.testing.assert_allclose(found - found[0], expected - expected[0], atol=1e-12)
    np.testing.assert_allclose(same, Q, atol=1e-12)
    np.testing.assert_allclose(slope(given, q), -Q, atol=1e-9)


def test_a_force_that_is_no_gradient_has_no_potential() -> None:
    """Circulatory forces: the curl is 2. What each has of its own coordinate alone still counts."""
    q = np.array([[0.3, -0.7]])
    V, _ = energy_and_forces(plane(law("x", "y"), law("y", "-x")), q)
    assert V[0] == 0
    V, _ = energy_and_forces(plane(law("x", "y - 4*x^3"), law("y", "-x")), q)
    np.testing.assert_allclose(V, 0.3**4)
    # as long as the torque acts on x alone the curl is not zero either
    V, _ = energy_and_forces(plane(law("x", "-y^2")), q)
    assert V[0] == 0


def test_what_varies_in_time_is_left_out() -> None:
    model = plane(law("x", "sin(t)^2 - 4*x"), law("y", "-u*y"), inputs={"u": {}})
    V, _ = energy_and_forces(model, [[0.5, 2.0]], t=0.4, inputs={"x.u": [3.0]})
    np.testing.assert_allclose(V, 0.5)


@pytest.mark.parametrize(
    ("text", "energy"),
    [
        ("-2*x + 2*sin(t)", lambda x: x**2),
        ("-2*(x + sin(t))", lambda x: x**2),
        ("-(x + t)^2", lambda x: x**3 / 3),
        ("-(x + sin(t))*(1 + x^2)/2", lambda x: x**2 / 4 + x**4 / 8),
        ("3*(t - 2*(x + u*t) - 2)", lambda x: 3 * x**2 + 6 * x),
        ("-x*(sin(t)^2 + cos(t)^2)", lambda x: x**2 / 2),
        ("-x/(2 + sin(t))", lambda x: 0 * x),
    ],
)
def test_what_varies_in_time_takes_nothing_else_with_it(text: str, energy: Any) -> None:
    """However the sum is written, also inside of a product; the certificate agrees, as there would be no model else."""
    x = np.array([0.7, -1.2])
    model = slide(law("x", text)) if "u" not in text else plane(law("x", text), inputs={"u": {}})
    q = x[:, None] if model.dof == 1 else np.stack([x, 0 * x], axis=-1)
    np.testing.assert_allclose(energy_and_forces(model, q, t=0.4)[0], energy(x), atol=1e-12)


def test_a_stiffness_that_depends_on_place_and_time() -> None:
    """-(4 x + sin t) (x - 0.1) has the potential of -4 x (x - 0.1)."""
    x = np.array([0.7, -1.2])
    V, _ = energy_and_forces(slide(stiffness="4*x + sin(t)", rest="0.1"), x[:, None], t=0.4)
    np.testing.assert_allclose(V, 4 * x**3 / 3 - 0.2 * x**2, atol=1e-12)


def test_a_law_of_a_joint() -> None:
    """Duffing's spring -4 x (1 + x^2), given as a load, as a stiffness, as a potential."""
    ways = [
        slide(law("x", "-4*x - 4*x^3")),
        slide(stiffness="4*(1 + x^2)"),
        slide({"type": "potential", "potential": "2*x^2 + x^4"}),
        slide({"type": "spring", "from": {"body": "base"}, "to": {"body": "b"}, "stiffness": "4*(1 + x^2)"}),
    ]
    for model in ways:
        V, Q = energy_and_forces(model, [[0.5], [-1.0]])
        np.testing.assert_allclose(V, [0.5625, 3.0])
        np.testing.assert_allclose(Q[:, 0], [-2.5, 8.0])


def test_a_spring_whose_stiffness_depends_on_the_state_counts_only_with_its_gradient() -> None:
    """k(x) (l - l0) has not the potential k(x) (l - l0)^2/2; with l0 none is found, so none is reported."""
    ends = {"type": "spring", "from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "b"}}
    V, Q = energy_and_forces(slide(ends | {"stiffness": "4*(1 + x^2)", "length": 0.3}), [[0.5]])
    length = np.sqrt(1.25)
    np.testing.assert_allclose(Q[0, 0], -5 * (1 - 0.3 / length) * 0.5)
    assert V[0] == 0
    # without l0: Q = -4 (1 + x^2) x
    V, _ = energy_and_forces(slide(ends | {"stiffness": "4*(1 + x^2)"}), [[0.5]])
    np.testing.assert_allclose(V, 2 * 0.25 + 0.0625)
    # a stiffness that varies in time alone: k (l - l0)^2 / 2 at each time
    model = slide(ends | {"stiffness": "1 + t", "length": 0.3})
    V, Q = energy_and_forces(model, [[0.5]], t=2.0)
    np.testing.assert_allclose(V, 1.5 * (length - 0.3) ** 2)
    np.testing.assert_allclose(slope(model, np.array([[0.5]]), t=2.0), -Q, atol=1e-9)


def test_what_has_no_potential_is_told() -> None:
    """In the warnings of the certificate, with the place; nothing is said of dampers, inputs and forces in time."""
    ends = {"type": "spring", "from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "b"}, "stiffness": "1 + x^2"}
    body: Plain = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"}}
    cases: list[tuple[list[Plain], list[str]]] = [
        ([law("x", "-x'"), ends], []),
        ([law("x", "sin(t) - 4*x"), ends | {"length": 1}], ["/loads/1"]),
        ([law("x", "-x/(1 + x^2)")], ["/loads"]),
    ]
    for loads, pointers in cases:
        part = derive(Definition.read({"name": "a", "bodies": [body], "loads": loads}))
        found = [w for w in part.certificate["warnings"] if w["code"] == "no-potential"]
        assert [w["pointer"] for w in found] == pointers
        assert all("without it" in w["message"] for w in found)


def test_a_stiffness_that_depends_on_a_velocity_has_no_potential() -> None:
    """Neither in a spring nor in a joint; the joint's spring at rest, k = 4, has one."""
    ends = {"type": "spring", "from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "b"}}
    V, Q = energy_and_forces(slide(ends | {"stiffness": "4 + x'^2"}), [[0.5]], qd=[[2.0]])
    assert V[0] == 0
    np.testing.assert_allclose(Q, -8 * 0.5)
    V, Q = energy_and_forces(slide(stiffness="4 + x'^2"), [[0.5]], qd=[[2.0]])
    np.testing.assert_allclose([V[0], Q[0, 0]], [2 * 0.25, -8 * 0.5])


def test_constant_forces_in_the_world_have_a_potential_on_any_host() -> None:
    """-F . x of a force on a part that is carried along; also straight from the parts. In body axes there is none."""
    arm: Plain = {
        "name": "arm",
        "bodies": [
            {
                "name": "link",
                "parent": "base",
                "mass": 1,
                "inertia": {"xx": 1, "yy": 1, "zz": 1},
                "joint": {"type": "revolute", "coordinate": "q"},
            }
        ],
        "ports": [{"name": "tip", "body": "link", "position": [1, 0, 0], "rotation": {"rpy": [0.3, 0.2, 0]}}],
    }
    load = {"type": "force", "body": "link", "at": [0.5, 0.2, 0.1], "vector": ["F", "2*F", -1], "frame": "world"}
    tip = arm | {"name": "tip", "loads": [load], "parameters": {"F": {"value": 0.7}}}
    follower = tip | {"loads": [load | {"frame": "body"}]}
    parts = {"a": derive(Definition.read(arm)), "b": derive(Definition.read(tip))}
    instances = [{"name": "a", "substructure": "arm"}, {"name": "b", "substructure": "tip", "at": "a.tip"}]
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, 0], "instances": instances})
    model = couple(spec, parts)
    q = np.random.default_rng(0).uniform(-2, 2, (3, 2))
    V, Q = energy_and_forces(model, q)
    assert np.abs(V).min() > 0.1
    np.testing.assert_allclose(slope(model, q), -Q, atol=1e-9)
    values = {"a.q": q[:, 0], "b.q": q[:, 1], "b.F": 0.7, "tau.a.q": 0.0, "tau.b.q": 0.0}
    direct = NumericTree(spec, parts).evaluate(values, ["potential_energy"])
    np.testing.assert_allclose(direct["potential_energy"], V, rtol=1e-13)
    # on two joints it is no gradient; on one alone -Q q is its potential
    turning = couple(spec, parts | {"b": derive(Definition.read(follower))})
    assert energy_and_forces(turning, [[0.3, 0.4]])[0][0] == 0
    V, Q = energy_and_forces(model_of(follower, NONE), [[0.3]])
    np.testing.assert_allclose(V, -0.3 * Q[0])


def test_a_potential_has_no_velocities() -> None:
    with pytest.raises(InvalidInput, match="not on velocities: 'x'' is one") as error:
        slide({"type": "potential", "potential": "x^2 + x'"})
    assert error.value.faults[0].pointer.endswith("/loads/0/potential")
    with pytest.raises(InvalidInput, match="unknown name 'z'"):
        slide({"type": "potential", "potential": "z"})


def test_what_a_law_names_is_no_constant() -> None:
    """A velocity in a damper does not become a name that a mass could use."""
    body: Plain = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x", "damping": "x'^2"}}
    definition = {"name": "a", "bodies": [body, {"name": "c", "parent": "b", "mass": "x'", "joint": {"type": "fixed"}}]}
    with pytest.raises(InvalidInput, match="unknown name"):
        derive(Definition.read(definition))
    with pytest.raises(InvalidInput, match="unknown name 'x'"):
        slide(armature="x^2")
