"""Motions and loads of bodies over exact numbers, beside the formulas of textbooks, and what inverse dynamics takes."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from serial_chains import IIWA, RX90, SIX, SIX14, revolute

from substructures import TreeSpec, couple, derive
from substructures.expr.graph import Expr, Graph
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import Link
from substructures.mechanics.linear3 import (
    E3,
    Matrix,
    Planar,
    Rotation,
    Scalar,
    Symmetric,
    Turn,
    Vector,
    add,
    apply,
    cross,
    dense,
    multiply,
    scale,
    skew,
)
from substructures.mechanics.newton_euler import BodyMotion, inertial_load

G = Graph()
#: the joint's own turn, and a constant one before it that takes the joint's axis out of the axes of the parent
TURN = Planar(2, G.number(Fraction(3, 5)), G.number(Fraction(4, 5)))
OBLIQUE = Planar(0, G.number(Fraction(5, 13)), G.number(Fraction(12, 13)))
ROTATIONS = {
    "parallel axes": Rotation((TURN,)),
    "axis along y": Rotation((Planar(0, 0, 1), TURN)),
    "axis against y": Rotation((Planar(0, 0, -1), TURN)),
    "axis along x": Rotation((Turn(multiply(TURN.matrix(), ((0, 1, 0), (0, 0, 1), (1, 0, 0)))),)),
    "oblique axis": Rotation((OBLIQUE, TURN)),
    "oblique axis, one matrix": Rotation((Turn(multiply(TURN.matrix(), OBLIQUE.matrix())),)),
}


def number(rng: np.random.Generator) -> Expr:
    return G.number(Fraction(int(rng.integers(-9, 10)), int(rng.integers(1, 6))))


def vector(rng: np.random.Generator) -> Vector:
    return number(rng), number(rng), number(rng)


def lifted(v: Vector) -> tuple[Expr, ...]:
    """Numbers of one graph are the same node where they are equal."""
    return tuple(G.lift(x) for x in v)


def field(motion: BodyMotion) -> Matrix:
    """skew(alpha) + skew(omega)^2."""
    square = multiply(skew(motion.omega), skew(motion.omega))
    rows = [add(*pair) for pair in zip(skew(motion.alpha), square, strict=True)]
    return rows[0], rows[1], rows[2]


@pytest.mark.parametrize("sparing", [False, True])
@pytest.mark.parametrize("s", [0, 1], ids=["revolute", "prismatic"])
@pytest.mark.parametrize("rotation", ROTATIONS.values(), ids=ROTATIONS)
def test_motion_over_a_joint(rotation: Rotation, s: int, sparing: bool) -> None:
    """J. J. Craig, Introduction to Robotics, chapter 6: velocities and accelerations from link to link."""
    rng = np.random.default_rng(3)
    parent = BodyMotion(vector(rng), vector(rng), vector(rng))
    z, rate, tau, second = vector(rng), number(rng), number(rng), number(rng)
    moved = parent.at_joint(Link(0, s, rotation, z, tau), z).moved(s, rate, tau, second, sparing)
    e = rotation.matrix()
    omega, alpha = apply(e, parent.omega), apply(e, parent.alpha)
    # of what the joint is fixed to, at B_k
    a = add(apply(e, add(parent.a, apply(field(parent), z))), scale(tau, apply(field(BodyMotion(omega, alpha)), E3)))
    if s:
        a = add(a, add(scale(2 * rate, cross(omega, E3)), scale(second, E3)))
    else:
        alpha = add(alpha, add(scale(rate, cross(omega, E3)), scale(second, E3)))
        omega = add(omega, scale(rate, E3))
    assert lifted(moved.omega) == lifted(omega)
    assert lifted(moved.alpha) == lifted(alpha)
    assert lifted(moved.a) == lifted(a)
    assert [lifted(row) for row in moved.field()] == [lifted(row) for row in field(BodyMotion(omega, alpha))]
    assert lifted(moved.third_column()) == lifted(apply(field(moved), E3))


def tensor(j: Symmetric) -> Matrix:
    """Theta = tr(J) 1 - J."""
    trace = j[0] + j[1] + j[2]
    rows: list[tuple[Scalar, ...]] = [
        tuple((trace if i == k else 0) - x for k, x in enumerate(row)) for i, row in enumerate(dense(j))
    ]
    (a, b, c), (d, e, f), (g, h, i) = rows
    return (a, b, c), (d, e, f), (g, h, i)


@pytest.mark.parametrize("still", [(), (0,), (1,), (2,), (0, 1), (0, 2), (1, 2)], ids=str)
@pytest.mark.parametrize("known", [False, True], ids=["alone", "after a joint"])
def test_load_of_a_body(known: bool, still: tuple[int, ...]) -> None:
    """f = m a + alpha x s + omega x (omega x s),   n = s x a + Theta alpha + omega x Theta omega; some omega_i zero."""
    rng = np.random.default_rng(5)
    omega = tuple(0 if i in still else x for i, x in enumerate(vector(rng)))
    motion = BodyMotion((omega[0], omega[1], omega[2]), vector(rng), vector(rng))
    if known:
        motion = BodyMotion(motion.omega, motion.alpha, motion.a, apply(field(motion), E3), sparing=True)
    xx, yy, zz, xy, xz, yz = (number(rng) for _ in range(6))
    inertia = Inertia(number(rng), vector(rng), (xx, yy, zz, xy, xz, yz))
    w, alpha, s, theta = motion.omega, motion.alpha, inertia.s, tensor(inertia.J)
    found = inertial_load(motion, inertia)
    f = add(scale(inertia.m, motion.a), add(cross(alpha, s), cross(w, cross(w, s))))
    n = add(cross(s, motion.a), add(apply(theta, alpha), cross(w, apply(theta, w))))
    assert lifted(found.f) == lifted(f)
    assert lifted(found.n) == lifted(n)


@pytest.mark.parametrize(
    ("rows", "plain", "base"),
    [(RX90, 538, 450), (IIWA, 636, 532), (SIX14, 745, 645), (SIX, 831, 731)],
    ids=["rx90", "iiwa", "6r with 14 parameters", "6r"],
)
def test_operations_of_inverse_dynamics(rows: list[dict[str, str]], plain: int, base: int) -> None:
    """Per state. Published for the RX90 in base parameters: 491 (W. Khalil, E. Dombre, 2002)."""
    definition = revolute(rows)
    tree = {
        "name": "t",
        "gravity": [0, 0, "-g"],
        "parameters": {"g": {}},
        "instances": [{"name": "x", "substructure": "chain"}],
    }
    for group, most in ((False, plain), (True, base)):
        program = couple(TreeSpec.read(tree), {"x": derive(definition)}, group=group).program
        assert program.count(["inverse_dynamics"], per_state=True)["total"] <= most


def test_first_joint_needs_its_moment_of_inertia_alone() -> None:
    """One product for all of what turns about a fixed axis: (J_xx + J_yy) q''; the products of inertia cancel."""
    definition = revolute([{}])
    tree = {
        "name": "t",
        "gravity": [0, 0, "-g"],
        "parameters": {"g": {}},
        "instances": [{"name": "x", "substructure": "chain"}],
    }
    program = couple(TreeSpec.read(tree), {"x": derive(definition)}).program
    # and - tau
    assert program.count(["inverse_dynamics"], per_state=True)["total"] == 2
