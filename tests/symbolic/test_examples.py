"""Examples of PyDy and of SymPy's documentation: their equations of motion, and ours, of the same mechanism."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy
from rolling_bodies import FLOOR, disc
from sympy import cos, sin, tan
from sympy.core.function import AppliedUndef
from sympy.physics.mechanics import (
    Force,
    KanesMethod,
    LinearDamper,
    LinearPathway,
    LinearSpring,
    Particle,
    PinJoint,
    Point,
    PrismaticJoint,
    ReferenceFrame,
    RigidBody,
    System,
    TorqueActuator,
    dynamicsymbols,
    inertia,
)
from sympy.physics.mechanics.models import n_link_pendulum_on_cart

from substructures import Model, couple, derive, from_sympy, symbolic_system, to_sympy, tree_of_system
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations

Plain = dict[str, Any]
t = dynamicsymbols._t
g, l = sympy.symbols("g l")  # noqa: E741 -- a length


def model_of(tree: Plain) -> Model:
    (instance,) = tree["instances"]
    return couple(tree, {instance["name"]: derive(instance["definition"])})


def in_their_names(expression: Any, called: Plain) -> Any:
    """``x.l`` as l, ``x.q1(t)`` and its derivative as they are in ``called``, which has the rest by name."""
    given = {}
    for each in expression.free_symbols - {t}:
        given[each] = called.get(str(each), sympy.Symbol(str(each).removeprefix("x.")))
    for each in expression.atoms(sympy.Function):
        if each.args == (t,):
            given[each] = called[str(each.func)]
    return expression.subs(given)


def same(ours: Any, theirs: Any) -> bool:
    """Whether all elements are the same functions, for SymPy."""
    difference = (sympy.Matrix(ours) - theirs).applyfunc(lambda x: sympy.simplify(sympy.expand_trig(x)))
    return bool(difference == sympy.zeros(*theirs.shape))


def require_same_numbers(pairs: list[tuple[Any, Any]]) -> None:
    """At random states; symbols are paired by name, since SymPy takes real ones for others."""
    rng = np.random.default_rng(5)
    free = [x for pair in pairs for each in pair for x in each.free_symbols | each.atoms(AppliedUndef)]
    names = sorted({str(x) for x in free} - {"t"})
    for _ in range(3):
        numbers = dict(zip(names, rng.uniform(0.3, 1.4, len(names)), strict=True))
        state = {x: numbers[str(x)] for x in free if str(x) in numbers}
        ours, theirs = (
            np.array([x.subs(state).evalf() for pair in pairs for x in pair[k]], dtype=float) for k in (0, 1)
        )
        assert ours == pytest.approx(theirs, rel=1e-12, abs=1e-12)


def test_the_chaos_pendulum() -> None:
    """PyDy, examples/chaos_pendulum: a rod on a pin with a plate that turns about it; its equations as they are shown
    there, in closed form.
    """
    mA, mB, lA, lB, IAxx, IBxx, IByy, IBzz = sympy.symbols("mA mB lA lB IAxx IBxx IByy IBzz")
    theta, phi, omega, alpha = dynamicsymbols("theta phi omega alpha")
    ceiling, rod, plate = RigidBody("ceiling"), RigidBody("rod", mass=mA), RigidBody("plate", mass=mB)
    rod.central_inertia = inertia(rod.frame, IAxx, IAxx, 0)
    plate.central_inertia = inertia(plate.frame, IBxx, IByy, IBzz)
    system = System.from_newtonian(ceiling)
    system.add_joints(
        PinJoint("J1", ceiling, rod, theta, omega, child_point=-lA * rod.z, joint_axis=ceiling.y),
        PinJoint("J2", rod, plate, phi, alpha, parent_point=(lB - lA) * rod.z, joint_axis=rod.z),
    )
    system.apply_uniform_gravity(g * ceiling.z)
    ours = symbolic_system(model_of(tree_of_system(system, "x")))
    called = {"x.theta": theta, "x.phi": phi, "u.x.theta": omega, "u.x.phi": alpha}
    called |= {"tau.x.theta": 0, "tau.x.phi": 0}
    M, forcing = (in_their_names(x, called) for x in (ours.dyn_implicit_mat, ours.dyn_implicit_rhs))
    turning = 2 * (IByy - IBxx) * sin(phi) * cos(phi) * omega * alpha - g * (lA * mA + lB * mB) * sin(theta)
    held = IAxx + IBxx * sin(phi) ** 2 + IByy * cos(phi) ** 2 + lA**2 * mA + lB**2 * mB
    published = sympy.Matrix([turning / held, (IBxx - IByy) * sin(phi) * cos(phi) * omega**2 / IBzz])
    require_same_numbers([(M.LUsolve(forcing), published)])


def holonomic(loaded: bool) -> System:
    """SymPy's documentation, "Multi Degree of Freedom Holonomic System": a block on a wall, a compound pendulum on it,
    and a simple one on that; ``loaded``: with spring, damper, angular spring, force and torque.
    """
    k, c, kT, ma, mb, mc, IBzz = sympy.symbols("k c kT ma mb mc IBzz")
    (q1, q2, q3), (u1, u2, u3) = dynamicsymbols("q1:4"), dynamicsymbols("u1:4")
    wall, block, bob = RigidBody("N"), Particle("A", mass=ma), Particle("C", mass=mc)
    rod, block_frame, bob_frame = RigidBody("B", mass=mb), ReferenceFrame("A"), ReferenceFrame("C")
    rod.central_inertia = inertia(rod.frame, 0, 0, IBzz)
    block.masscenter.set_vel(block_frame, 0)
    bob.masscenter.set_vel(bob_frame, 0)
    system = System.from_newtonian(wall)
    seat = {"joint_axis": wall.z, "parent_interframe": block_frame, "child_point": l * 2 / 3 * rod.y}
    hinge = {"joint_axis": rod.z, "parent_point": -l / 3 * rod.y, "child_interframe": bob_frame}
    system.add_joints(
        PrismaticJoint("J1", wall, block, q1, u1, child_interframe=block_frame),
        PinJoint("J2", block, rod, q2, u2, **seat),
        PinJoint("J3", rod, bob, q3, u3, child_point=l * bob_frame.y, **hinge),
    )
    system.apply_uniform_gravity(-g * wall.y)
    if loaded:
        path = LinearPathway(wall.masscenter, block.masscenter)
        system.add_loads(Force(block, dynamicsymbols("F") * wall.x))
        system.add_actuators(
            LinearSpring(k, path),
            LinearDamper(c, path),
            TorqueActuator(dynamicsymbols("T"), wall.z, rod, wall),
            TorqueActuator(kT * q3, wall.z, rod, bob_frame),
        )
    return system


def test_the_multi_degree_of_freedom_holonomic_system() -> None:
    """The mechanism is taken over, its loads are given as texts of SymPy's expressions."""
    k, c, kT = sympy.symbols("k c kT")
    (q1, q2, q3), (u1, u2, u3) = dynamicsymbols("q1:4"), dynamicsymbols("u1:4")
    F, T = dynamicsymbols("F T")
    tree = tree_of_system(holonomic(loaded=False), "x")
    definition = tree["instances"][0]["definition"]
    definition["parameters"] |= {"k": {}, "c": {}, "kT": {}}
    definition["inputs"] = {"F": {"unit": "N"}, "T": {"unit": "N*m"}}
    forces = {"q1": F - k * q1 - c * u1, "q2": T, "q3": -kT * q3}
    definition["loads"] = [
        {"type": "joint", "coordinate": name, "force": from_sympy(x, {u1: "q1'"})} for name, x in forces.items()
    ]
    ours = symbolic_system(model_of(tree))
    called = {f"x.q{n}": q for n, q in enumerate((q1, q2, q3), 1)} | {"x.F": F, "x.T": T}
    called |= {f"u.x.q{n}": u for n, u in enumerate((u1, u2, u3), 1)} | {f"tau.x.q{n}": 0 for n in (1, 2, 3)}
    theirs = holonomic(loaded=True)
    theirs.form_eoms(explicit_kinematics=True)
    assert same(in_their_names(ours.dyn_implicit_mat, called), theirs.mass_matrix)
    assert same(in_their_names(ours.dyn_implicit_rhs, called), theirs.forcing.doit())


def test_links_on_a_cart_with_their_drives() -> None:
    """PyDy, examples/npendulum, by SymPy's model of it: three links, the force on the cart, torques in the joints."""
    n = 3
    kane = n_link_pendulum_on_cart(n, cart_force=True, joint_torques=True)
    bodies: list[Plain] = [
        {"name": "cart", "parent": "base", "mass": "m0",
         "joint": {"type": "prismatic", "placement": {}, "axis": [1, 0, 0], "coordinate": "q0"}},
    ]  # fmt: skip
    for k in range(1, n + 1):
        seat = {"position": [0, 0 if k == 1 else f"l{k - 2}", 0]}
        joint = {"type": "revolute", "coordinate": f"q{k}", "placement": seat}
        parent = bodies[-1]["name"]
        bodies.append({"name": f"b{k}", "parent": parent, "joint": joint, "mass": f"m{k}", "com": [0, f"l{k - 1}", 0]})
    parameters: Plain = {f"m{k}": {} for k in range(n + 1)} | {f"l{k}": {} for k in range(n)}
    definition = {"name": "x", "bodies": bodies, "parameters": parameters}
    tree = {"name": "t", "gravity": [0, "-g", 0], "parameters": {"g": {}},
            "instances": [{"name": "x", "definition": definition}]}  # fmt: skip
    ours = symbolic_system(model_of(tree))
    # their angles are from the upright, ours from link to link: q' = N (theirs)
    N = sympy.eye(n + 1) - sympy.Matrix(n + 1, n + 1, lambda i, j: 1 if i == j + 1 and j > 0 else 0)
    q, u = (sympy.Matrix(dynamicsymbols(f"{x}0:{n + 1}")) for x in ("q", "u"))
    efforts = [dynamicsymbols("F"), *dynamicsymbols(f"T1:{n + 1}")]
    named = zip(range(n + 1), N * q, N * u, efforts, strict=True)
    called = {
        name: x for k, *each in named for name, x in zip((f"x.q{k}", f"u.x.q{k}", f"tau.x.q{k}"), each, strict=True)
    }
    M, forcing = (in_their_names(x, called) for x in (ours.dyn_implicit_mat, ours.dyn_implicit_rhs))
    require_same_numbers([(N.T * M * N, kane.mass_matrix), (N.T * forcing, kane.forcing)])


def test_the_rolling_disc() -> None:
    """SymPy's documentation, "A rolling disc, with Kane's method": yaw, lean and spin, whose speeds are the angular
    velocities along the axes that lean; ours has five coordinates more than speeds, and rolls by velocity constraints.
    """
    (q1, q2, q3), (u1, u2, u3) = dynamicsymbols("q1:4"), dynamicsymbols("u1:4")
    m, r, ground = sympy.Symbol("m"), sympy.Symbol("r"), ReferenceFrame("N")
    yawed = ground.orientnew("Y", "Axis", [q1, ground.z])
    lean = yawed.orientnew("L", "Axis", [q2, yawed.x])
    wheel = lean.orientnew("R", "Axis", [q3, lean.y])
    wheel.set_ang_vel(ground, u1 * lean.x + u2 * lean.y + u3 * lean.z)
    contact = Point("C")
    contact.set_vel(ground, 0)
    centre = contact.locatenew("Dmc", r * lean.z)
    centre.v2pt_theory(contact, ground, wheel)
    moments = inertia(lean, m * r**2 / 4, m * r**2 / 2, m * r**2 / 4)
    rates = [q1.diff() - u3 / cos(q2), q2.diff() - u1, q3.diff() - u2 + u3 * tan(q2)]
    kane = KanesMethod(ground, q_ind=[q1, q2, q3], u_ind=[u1, u2, u3], kd_eqs=rates)
    kane.kanes_equations([RigidBody("disc", centre, wheel, m, (moments, centre))], [(centre, -m * g * yawed.z)])

    # our third axis is that of the disc: nutation th = q2 - pi/2, so that sin th = -cos q2, cos th = sin q2
    speeds = {"u1": "s.th'", "u2": "s.ph' + cos(s.th)*s.psi'", "u3": "-sin(s.th)*s.psi'"}
    equations = quasi_velocity_equations(disc(), [FLOOR], velocities=speeds)
    called = {"s.psi": q1, "s.th": q2 - sympy.pi / 2, "s.ph": q3, "s.m": m, "s.r": r, "u1": u1, "u2": u2, "u3": u3}
    called |= {f"tau.s.{name}": 0 for name in ("x", "y", "z", "psi", "th", "ph")}
    metric, forces, bias = (to_sympy(equations.program, x, symbols=called) for x in ("metric", "forces", "bias"))
    forcing = kane.forcing.subs(g, sympy.Rational("9.81"))
    require_same_numbers([(metric, kane.mass_matrix), (forces - bias, forcing)])


def test_atwoods_machine() -> None:
    """SymPy's documentation, "Atwood Machine Example": q'' = g (m1 - m2)/(m1 + m2), of a rope that is a relation."""
    sides = [
        {"name": f"p{k}", "parent": "base", "mass": f"m{k}", "joint": {"type": "prismatic", "coordinate": f"q{k}",
         "placement": {"position": [0, y, "-h"]}, "axis": [0, 0, -1]}}
        for k, y in ((1, "r"), (2, "-r"))
    ]  # fmt: skip
    definition = {"name": "x", "bodies": sides, "parameters": {name: {} for name in ("m1", "m2", "h", "r")},
                  "relations": [{"coordinate": "q2", "of": "q1", "multiplier": -1}]}  # fmt: skip
    tree = {"name": "t", "gravity": [0, 0, "-g"], "parameters": {"g": {}},
            "instances": [{"name": "x", "definition": definition}]}  # fmt: skip
    model = model_of(tree)
    m1, m2, gravity = (sympy.Symbol(name, real=True) for name in ("x.m1", "x.m2", "g"))
    metric, forces = (to_sympy(model, name, symbols={"tau.x.q1": 0}) for name in ("metric", "forces"))
    assert to_sympy(model, "bias") == sympy.zeros(1, 1)
    assert sympy.simplify(forces[0] / metric[0, 0] - gravity * (m1 - m2) / (m1 + m2)) == 0
