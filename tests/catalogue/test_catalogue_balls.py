"""Shipped substructures with quaternions: a gyrostat by its equation, and bases beside those with yaw, pitch, roll."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import random_position
from catalogue_entries import shipped_part

from substructures import Model, TreeSpec, catalogue, couple
from substructures.quantities.numbers.evaluation import evaluate

Plain = dict[str, Any]
LEGS = [("fl", "front_left"), ("fr", "front_right"), ("rl", "rear_left"), ("rr", "rear_right")]
ANGLES, RATES = ["x", "y", "z", "yaw", "pitch", "roll"], ["vx", "vy", "vz", "wx", "wy", "wz"]


def coupled(tree: Plain) -> Model:
    return couple(TreeSpec.read(tree), {i["name"]: shipped_part(i["substructure"]) for i in tree["instances"]})


def quadruped(trunk: str) -> Plain:
    legs = [{"name": leg, "substructure": "quadruped-leg", "at": f"base.{port}"} for leg, port in LEGS]
    base = {"name": "base", "substructure": trunk}
    return {"name": "quadruped", "gravity": [0, 0, "-9.81"], "instances": [base, *legs]}


def of_angles(yaw: float, pitch: float, roll: float) -> tuple[np.ndarray, np.ndarray]:
    """R = Rz(yaw) Ry(pitch) Rx(roll), and B of omega in the axes of the body = B (yaw', pitch', roll')."""
    (cy, sy), (cp, sp), (cr, sr) = ((np.cos(x), np.sin(x)) for x in (yaw, pitch, roll))
    R = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]]) @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    R = R @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return R, np.array([[-sp, 0, 1], [cp * sr, cr, 0], [cp * cr, -sr, 0]])


def quaternion_of(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """The product of three turns about single axes."""
    Q = np.array([1.0, 0, 0, 0])
    for angle, axis in ((yaw, 2), (pitch, 1), (roll, 0)):
        w, v = np.cos(angle / 2), np.sin(angle / 2) * np.eye(3)[axis]
        Q = np.array([Q[0] * w - Q[1:] @ v, *(Q[0] * v + w * Q[1:] + np.cross(Q[1:], v))])
    return Q


@pytest.mark.parametrize(
    ("with_angles", "with_quaternion", "base"),
    [
        (catalogue.load_tree("humanoid"), catalogue.load_tree("humanoid-floating"), "pelvis"),
        (quadruped("quadruped-trunk"), quadruped("quadruped-trunk-floating"), "base"),
    ],
    ids=["humanoid", "quadruped"],
)
def test_limbs_move_as_on_the_base_with_angles(with_angles: Plain, with_quaternion: Plain, base: str) -> None:
    """At the same state they have the same kinetic energy and, under gravity, the same accelerations."""
    chain, model, rng = coupled(with_angles), coupled(with_quaternion), np.random.default_rng(4)
    assert model.dof == chain.dof
    assert [c for c in model.coordinates if c.startswith(f"{base}.")] == [f"{base}.{name}" for name in RATES]
    q, qd = (dict(zip(chain.coordinates, rng.uniform(-0.7, 0.7, chain.dof), strict=True)) for _ in range(2))
    place, turn, rates, turning = (
        np.array([of[f"{base}.{name}"] for name in names]) for of in (q, qd) for names in (ANGLES[:3], ANGLES[3:])
    )
    R, B = of_angles(*turn)
    ours = {**q, **dict(zip([f"{base}.{c}" for c in ("x", "y", "z", "qw", "qx", "qy", "qz")],
                            [*place, *quaternion_of(*turn)], strict=True))}  # fmt: skip
    rated = {**qd, **dict(zip([f"{base}.{name}" for name in RATES], [*(R.T @ rates), *(B @ turning)], strict=True))}
    names = ["metric", "forward_dynamics", "kinematics"]
    theirs = evaluate(chain, names, list(q.values()), list(qd.values()))
    found = evaluate(model, names, [ours[x] for x in model.positions], [rated[x] for x in model.coordinates])
    v, w = np.array([rated[x] for x in model.coordinates]), np.array(list(qd.values()))
    assert v @ found["metric"] @ v == pytest.approx(w @ theirs["metric"] @ w, rel=1e-12)
    limbs = [(model.coordinates.index(c), chain.coordinates.index(c)) for c in q if not c.startswith(f"{base}.")]
    some, others = (list(each) for each in zip(*limbs, strict=True))
    accelerations = theirs["forward_dynamics"][others]
    np.testing.assert_allclose(found["forward_dynamics"][some], accelerations, atol=1e-11 * np.abs(accelerations).max())
    np.testing.assert_allclose(found["kinematics"]["position"], theirs["kinematics"]["position"], atol=1e-13)


def test_a_satellite_on_wheels_is_a_gyrostat() -> None:
    """I omega' + J A s'' + omega x (I omega + J A s') = 0 and J (s'' + A^T omega') = torques, axes of wheels in A."""
    tree = {"name": "t", "gravity": [0, 0, "-3"], "instances": [{"name": "x", "substructure": "satellite-wheels"}]}
    model, rng = coupled(tree), np.random.default_rng(2)
    number = {name: float(p["value"]) for name, p in catalogue.load("satellite-wheels")["parameters"].items()}
    J, beta = number["Ja"], number["beta"]
    A = np.array(
        [[np.sin(beta) * np.cos(k), np.sin(beta) * np.sin(k), np.cos(beta)] for k in np.pi / 2 * np.arange(4)]
    ).T
    I = np.diag([number["Ixx"], number["Iyy"], number["Izz"]])  # noqa: E741 -- symbol of the notation
    I = I + 4 * number["Jt"] * np.eye(3) + (J - number["Jt"]) * A @ A.T  # noqa: E741 -- symbol of the notation
    q, torques = random_position(rng, model), rng.uniform(-1, 1, 4)
    qd = np.array([*rng.uniform(-1, 1, 6), *rng.uniform(-300, 300, 4)])
    omega, spins = qd[3:6], qd[6:]
    left = np.block([[I, J * A], [J * A.T, J * np.eye(4)]])
    expected = np.linalg.solve(left, np.array([*-np.cross(omega, I @ omega + J * A @ spins), *torques]))
    inputs = {f"tau.x.spin{k + 1}": torques[k] for k in range(4)}
    found = evaluate(model, "forward_dynamics", q, qd, inputs=inputs)["forward_dynamics"]
    np.testing.assert_allclose(found[3:], expected, rtol=1e-11)
    # v' = R^T g - omega x v
    R = evaluate(model, "kinematics", q)["kinematics"]["rotation"][1]
    np.testing.assert_allclose(found[:3], R.T @ [0, 0, -3] - np.cross(omega, qd[:3]), rtol=1e-12)
