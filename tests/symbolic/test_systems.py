"""Equations of motion and mechanisms between this package and sympy.physics.mechanics."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy
from sympy.physics.mechanics import (
    PinJoint,
    PrismaticJoint,
    ReferenceFrame,
    RigidBody,
    SphericalJoint,
    System,
    WeldJoint,
    dynamicsymbols,
)
from sympy.physics.mechanics.models import n_link_pendulum_on_cart

from substructures import (
    InvalidArgument,
    Model,
    couple,
    derive,
    evaluate,
    linearise,
    linearizer,
    symbolic_system,
    tree_of_system,
)

Plain = dict[str, Any]
g, l, d = sympy.symbols("g l d")  # noqa: E741 -- a length


def cart_pole() -> System:
    """Of SymPy's documentation of joints."""
    ground, cart, pole = (RigidBody(name) for name in ("ground", "cart", "pole"))
    system = System.from_newtonian(ground)
    slide = PrismaticJoint("slide", ground, cart, joint_axis=ground.x)
    pin = PinJoint("pin", cart, pole, joint_axis=cart.z, child_point=l / 2 * pole.y)
    system.add_joints(slide, pin)
    system.apply_uniform_gravity(-g * ground.y)
    return system


def double_pendulum() -> System:
    """Two rods of one length, hinged short of their ends."""
    ground = RigidBody("ground")
    system = System.from_newtonian(ground)
    upper, lower = (RigidBody(name) for name in ("upper", "lower"))
    system.add_joints(
        PinJoint("shoulder", ground, upper, joint_axis=ground.z, child_point=-l * upper.x),
        PinJoint("elbow", upper, lower, joint_axis=upper.z, parent_point=d * upper.x, child_point=-l * lower.x),
    )
    system.apply_uniform_gravity(g * ground.x)
    return system


def tilted_arm() -> System:
    """In space: turned seats by numbers and by symbols, a weld, points off the mass centres."""
    ground, a, b, c, tool = (RigidBody(name) for name in ("ground", "a", "b", "c", "tool"))
    tilt, beta = ReferenceFrame("tilt"), sympy.Symbol("beta")
    tilt.orient_body_fixed(ground.frame, (0.3, -sympy.pi / 3, beta), "XYZ")
    seat = ReferenceFrame("seat")
    seat.orient_axis(b.frame, b.x + 2 * b.z, sympy.Rational(2, 5))
    upright = ReferenceFrame("upright")
    upright.orient_axis(c.frame, c.y, sympy.pi / 2)
    system = System.from_newtonian(ground)
    system.add_joints(
        PinJoint("j1", ground, a, parent_interframe=tilt, joint_axis=tilt.y, parent_point=d * ground.x),
        PrismaticJoint("j2", a, b, joint_axis=a.x + a.y, child_interframe=seat, parent_point=l * a.z),
        PinJoint("j3", b, c, joint_axis=b.z, child_point=d * c.x - l * c.y),
        WeldJoint("j4", c, tool, parent_interframe=upright, parent_point=l * c.x, child_point=d * tool.z),
    )
    system.apply_uniform_gravity(-g * ground.z + g / 2 * ground.x)
    return system


def model_of(tree: Plain) -> Model:
    (instance,) = tree["instances"]
    return couple(tree, {instance["name"]: derive(instance["definition"])})


@pytest.mark.parametrize("make", [cart_pole, double_pendulum, pytest.param(tilted_arm, marks=pytest.mark.deep)])
def test_a_system_as_a_tree_has_the_equations_of_kane(make: Any) -> None:
    system = make()
    system.form_eoms()
    model = model_of(tree_of_system(system, "x"))
    rng = np.random.default_rng(2)
    symbols = sorted(system.mass_matrix.free_symbols | system.forcing.free_symbols - {dynamicsymbols._t}, key=str)
    values = {s: float(x) for s, x in zip(symbols, rng.uniform(0.5, 1.5, len(symbols)), strict=True)}
    names = [str(each.func) for each in system.q]
    q, u = rng.uniform(-1, 1, (2, len(names)))
    state = values | dict(zip(system.q, q, strict=True)) | dict(zip(system.u, u, strict=True))
    M, forcing = (np.array(x.subs(state).evalf().tolist(), dtype=float) for x in (system.mass_matrix, system.forcing))
    place = [model.coordinates.index(f"x.{name}") for name in names]
    given = {n: values.get(sympy.Symbol(n.removeprefix("x.")), 1.0) for n in model.parameters}
    one = {key: np.zeros((1, model.dof)) for key in ("q", "qd")}
    one["q"][0, place], one["qd"][0, place] = q, u
    found = evaluate(model, ["metric", "bias", "forces"], **one, parameters=given)
    assert found["metric"][0][np.ix_(place, place)] == pytest.approx(M, rel=1e-10, abs=1e-12)
    assert (found["forces"] - found["bias"])[0][place] == pytest.approx(forcing[:, 0], rel=1e-9, abs=1e-12)


def test_the_equations_of_two_links_on_a_cart_are_those_of_sympy() -> None:
    """SymPy's own model, by Kane's method; ours from three joints."""
    kane = n_link_pendulum_on_cart(2, cart_force=False, joint_torques=False)
    bodies: list[Plain] = [
        {"name": "cart", "parent": "base", "mass": "m0",
         "joint": {"type": "prismatic", "placement": {}, "axis": [1, 0, 0], "coordinate": "q0"}},
    ]  # fmt: skip
    for k in (1, 2):
        position = [0, 0, 0] if k == 1 else [0, f"l{k - 2}", 0]
        joint = {"type": "revolute", "coordinate": f"a{k}", "placement": {"position": position}}
        parent = bodies[-1]["name"]
        bodies.append(
            {"name": f"rod{k}", "parent": parent, "joint": joint, "mass": f"m{k}", "com": [0, f"l{k - 1}", 0]}
        )
    parameters = {name: {"value": 1} for name in ("m0", "m1", "m2", "l0", "l1")}
    definition = {"name": "x", "bodies": bodies, "parameters": parameters}
    tree = {"name": "t", "gravity": [0, "-g", 0], "parameters": {"g": {"value": 9.81}},
            "instances": [{"name": "x", "definition": definition}]}  # fmt: skip
    system = symbolic_system(model_of(tree))
    t = dynamicsymbols._t
    q0, q1, q2 = dynamicsymbols("q0:3")
    # theirs are absolute angles from the upright: q1 = a1, q2 = a1 + a2
    ours = {sympy.Function("x.q0")(t): q0, sympy.Function("x.a1")(t): q1, sympy.Function("x.a2")(t): q2 - q1}
    plain = {sympy.Symbol(f"x.{name}", real=True): sympy.Symbol(name) for name in parameters}
    N = sympy.Matrix([[1, 0, 0], [0, 1, 0], [0, -1, 1]])
    u = sympy.Matrix(dynamicsymbols("u0:3"))
    ours |= {sympy.Function(f"u.x.{name}")(t): (N * u)[k] for k, name in enumerate(("q0", "a1", "a2"))}
    efforts = {sympy.Function(f"tau.x.{name}")(t): 0 for name in ("q0", "a1", "a2")}
    plain[sympy.Symbol("g", real=True)] = sympy.Symbol("g")
    pairs = (
        (N.T * system.dyn_implicit_mat * N, kane.mass_matrix),
        (N.T * system.dyn_implicit_rhs.subs(efforts), kane.forcing),
    )
    for found, expected in pairs:
        theirs = expected.subs({s: sympy.Symbol(str(s)) for s in expected.free_symbols - {t}})
        difference = found.subs(plain).subs(ours) - theirs
        assert sympy.simplify(difference.applyfunc(sympy.expand_trig)) == sympy.zeros(*expected.shape)


def test_the_linearizer_of_sympy_gives_our_linearisation() -> None:
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "x", "substructure": "cart-pendulum"}]}
    model = couple(tree, {"x": derive("cart-pendulum")})
    made = linearizer(model)
    at = dict.fromkeys([*made.q, *made.u, *made.u.diff(dynamicsymbols._t)], 0)
    A, B = made.linearize(op_point=at, A_and_B=True)
    values = {sympy.Symbol(n, real=True): float(p["value"]) for n, p in model.parameters.items()}
    ours = linearise(model, [0, 0])
    assert np.array(A.subs(values).tolist(), dtype=float) == pytest.approx(np.asarray(ours.A), abs=1e-12)
    assert np.array(B.subs(values).tolist(), dtype=float) == pytest.approx(np.asarray(ours.B), abs=1e-12)


def _with_ball() -> System:
    system = cart_pole()
    more = RigidBody("more")
    system.add_joints(SphericalJoint("ball", system.bodies[0], more))
    return system


def _in_a_loop() -> System:
    system = cart_pole()
    ground, cart, _ = system.bodies
    system.add_joints(PinJoint("again", cart, ground, coordinates=dynamicsymbols("z"), speeds=dynamicsymbols("w")))
    return system


def _pushed() -> System:
    system = cart_pole()
    cart = system.bodies[1]
    system.add_loads((cart.masscenter, dynamicsymbols("F") * cart.x))
    return system


def _alone() -> System:
    system = cart_pole()
    system.add_bodies(RigidBody("alone"))
    return system


def _tied() -> System:
    system = cart_pole()
    system.velocity_constraints = [system.u[0] - l * system.u[1]]
    return system


def _half_heavy() -> System:
    """The ground has a weight, the pole has none."""
    system = cart_pole()
    system.loads = [load for load in system.loads if load.point != system.bodies[2].masscenter]
    return system


def _in_a_field() -> System:
    """Gravity as SymPy's Lagrangian has it."""
    system = cart_pole()
    system.loads = []
    system.bodies[2].potential_energy = g * l
    return system


def _loose() -> System:
    system = System()
    system.add_joints(PinJoint("pin", RigidBody("a"), RigidBody("b")))
    return system


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (_tied, "velocity constraints are not taken over"),
        (_half_heavy, "are not the gravity of all bodies"),
        (_in_a_field, "the potential energy of body 'pole' is not taken over"),
        (_loose, "body 'a' is on no joint, and not at the fixed point"),
        (_with_ball, "joint 'ball' is a SphericalJoint"),
        (_in_a_loop, "make no tree with one root|is in a loop"),
        (_pushed, "are not the gravity of all bodies"),
        (_alone, "body 'alone' is on no joint"),
        (lambda: n_link_pendulum_on_cart(1), "a KanesMethod does not know its joints"),
    ],
)
def test_what_has_no_counterpart_is_named(make: Any, message: str) -> None:
    with pytest.raises(InvalidArgument, match=message):
        tree_of_system(make())


def test_bodies_without_mass_have_no_weight() -> None:
    ground, hub, arm = RigidBody("ground"), RigidBody("hub", mass=0), RigidBody("arm")
    system = System.from_newtonian(ground)
    system.add_joints(PinJoint("pan", ground, hub, joint_axis=ground.z), PinJoint("tilt", hub, arm))
    system.apply_uniform_gravity(-g * ground.z)
    assert tree_of_system(system)["gravity"] == [0, 0, "-g"]
