"""Entries with loops: equations of five-bar arm, pantograph and delta robot by hand; the adaptive gripper in MuJoCo."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.analysis.closed.loops import loop_state
from substructures.catalogue import load
from substructures.quantities.numbers.evaluation import evaluate

Array = Any


def five_bar() -> Model:
    tree = {
        "name": "t",
        "gravity": [0, -9.81, 0],
        "instances": [{"name": "x", "substructure": "five-bar", "level": "full"}],
    }
    return couple(TreeSpec.read(tree), {"x": shipped_part("five-bar")})


def alone(name: str, gravity: list[Any]) -> Model:
    tree = {"name": "t", "gravity": gravity, "instances": [{"name": "x", "substructure": name, "level": "full"}]}
    return couple(TreeSpec.read(tree), {"x": shipped_part(name)})


def parallelogram(q1: float, q2: float) -> list[float]:
    """Link 3 is parallel to link 1, link 4 to link 2."""
    return [q1, q2, q1 - q2, q2 - q1]


#: q1, q2 to all coordinates
N = np.array([[1, 0], [0, 1], [1, -1], [-1, 1]])


@pytest.mark.parametrize("more", [{}, {"x.m4": 2.5, "x.c3": 0.1}])
def test_the_five_bar_arm_has_the_textbook_equations(more: dict[str, float]) -> None:
    """d_11, d_22, d_12, phi_1, phi_2 of Spong, Hutchinson and Vidyasagar (2006), five-bar linkage, and of d_12 the
    velocity forces; with m3 l2 c3 = m4 l1 c4 as shipped d_12 = 0 in all positions, and they vanish.
    """
    model, rng = five_bar(), np.random.default_rng(2)
    p = {name: more.get(f"x.{name}", float(x["value"])) for name, x in load("five-bar")["parameters"].items()}
    for _ in range(4):
        q1, q2, v1, v2 = rng.uniform(-3, 3, 4)
        at = {"q": parallelogram(q1, q2), "qd": (N @ [v1, v2]).tolist(), "parameters": more}
        found = evaluate(model, ["metric", "gravity", "bias", "closure.residual", "closure.jacobian"], **at)
        assert np.abs(found["closure.residual"]).max() < 1e-15
        assert np.abs(found["closure.jacobian"] @ N).max() < 1e-15
        d11 = p["m1"] * p["c1"] ** 2 + p["m3"] * p["c3"] ** 2 + p["m4"] * p["l1"] ** 2 + p["I1"] + p["I3"]
        d22 = p["m2"] * p["c2"] ** 2 + p["m3"] * p["l2"] ** 2 + p["m4"] * p["c4"] ** 2 + p["I2"] + p["I4"]
        k = p["m3"] * p["l2"] * p["c3"] - p["m4"] * p["l1"] * p["c4"]
        d12 = k * np.cos(q2 - q1)
        np.testing.assert_allclose(N.T @ found["metric"] @ N, [[d11, d12], [d12, d22]], rtol=0, atol=1e-14)
        phi = [
            9.81 * np.cos(q1) * (p["m1"] * p["c1"] + p["m3"] * p["c3"] + p["m4"] * p["l1"]),
            9.81 * np.cos(q2) * (p["m2"] * p["c2"] + p["m3"] * p["l2"] - p["m4"] * p["c4"]),
        ]
        np.testing.assert_allclose(N.T @ -found["gravity"], phi, rtol=0, atol=1e-13)
        # Christoffel symbols of d_12: c_221 = d d_12/dq2, c_112 = d d_12/dq1; N is constant
        slope = -k * np.sin(q2 - q1)
        np.testing.assert_allclose(N.T @ found["bias"], [slope * v2**2, -slope * v1**2], rtol=0, atol=1e-12)
    assert more or k == pytest.approx(0, abs=1e-15)


def tensor(quaternion: tuple[float, ...], diagonal: tuple[float, ...]) -> dict[str, float]:
    """A published inertia tensor, to six digits as in the entry."""
    w, x, y, z = np.array(quaternion) / np.linalg.norm(quaternion)
    R = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    J = R @ np.diag(diagonal) @ R.T
    entries = {"xx": J[0, 0], "yy": J[1, 1], "zz": J[2, 2], "xy": J[0, 1], "xz": J[0, 2], "yz": J[1, 2]}
    return {name: float(f"{x:.6g}") if abs(x) > 1e-12 else 0.0 for name, x in entries.items()}


#: as published: mass, mass centre in the plane, axes and moments of inertia
BODIES: dict[str, tuple[float, tuple[float, float], tuple[float, ...], tuple[float, ...]]] = {
    "base": (0.777441, (-2.70394e-05, 0.0354675), (1, -0.00152849, 0, 0), (0.000260285, 0.000225381, 0.000152708)),
    "driver": (
        *(0.00899563, (0.0177547, 0.00107314)),
        *((0.681301, 0.732003, 0, 0), (1.72352e-06, 1.60906e-06, 3.22006e-07)),
    ),
    "coupler": (
        *(0.0140974, (0.00301209, 0.0232175)),
        *((0.705636, -0.0455904, 0.0455904, 0.705636), (4.16206e-06, 3.52216e-06, 8.88131e-07)),
    ),
    "spring_link": (
        *(0.0221642, (0.0181624, 0.0212658)),
        *((0.663403, -0.244737, 0.244737, 0.663403), (8.96853e-06, 6.71733e-06, 2.63931e-06)),
    ),
    "follower": (0.0125222, (-0.011046, 0.0124786), (1, 0.1664, 0, 0), (2.67415e-06, 2.4559e-06, 6.02031e-07)),
    "pad": (0.0035, (-0.0025, 0.0185), (0.707107, 0, 0, 0.707107), (4.73958e-07, 3.64583e-07, 1.23958e-07)),
}
ARM: dict[str, Any] = {
    "name": "arm",
    "bodies": [
        {
            "name": "upper",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "a", "axis": [0, 1, 0], "placement": {}},
            "mass": 2,
            "com": [0, 0, 0.2],
            "inertia": {"xx": 0.03, "yy": 0.03, "zz": 0.002},
        },
        {
            "name": "fore",
            "parent": "upper",
            "joint": {"type": "revolute", "coordinate": "b", "axis": [1, 1, 0], "placement": {"position": [0, 0, 0.4]}},
            "mass": 1,
            "com": [0, 0.01, 0.1],
            "inertia": {"xx": 0.01, "yy": 0.01, "zz": 0.001},
        },
    ],
    "ports": [{"name": "flange", "body": "fore", "position": [0, 0, 0.25]}],
}
#: places of MuJoCo's file: bodies in their parents; the joint of the follower is not at its origin
RIGHT = {"driver": (0.0306011, 0.054904), "spring_link": (0.0132, 0.0609)}
INNER = {"coupler": (0.0315, -0.0041), "follower": (0.055, 0.0375), "pad": (-0.0189, 0.01352)}
LAWS = {
    "driver": 'armature="0.005" damping="0.1"',
    "spring_link": 'stiffness="0.05" springref="2.62" damping="0.00125"',
    "follower": 'pos="0 -0.018 0.0065"',
}


def inertial(name: str) -> str:
    mass, (y, z), quaternion, diagonal = BODIES[name]
    found = " ".join(repr(x) for x in tensor(quaternion, diagonal).values())
    return f'<inertial mass="{mass}" pos="0 {y} {z}" fullinertia="{found}"/>'


def finger(side: str) -> str:
    """Two branches, as in the published file."""

    def body(name: str, place: tuple[float, float], inside: str, turn: str = "") -> str:
        """A body on a hinge about x; the pad is fixed."""
        hinge = "" if name == "pad" else f'<joint name="{side}_{name}" axis="1 0 0" {LAWS.get(name, "")}/>'
        at = f'pos="0 {place[0]} {place[1]}"{turn}'
        return f'<body name="{side}_{name}" {at}>{inertial(name)}{hinge}{inside}</body>'

    sign, turn = (1, "") if side == "right" else (-1, ' quat="0 0 0 1"')
    place = {name: (sign * y, z) for name, (y, z) in RIGHT.items()}
    follower = body("follower", INNER["follower"], body("pad", INNER["pad"], ""))
    driver = body("driver", place["driver"], body("coupler", INNER["coupler"], ""), turn)
    return driver + body("spring_link", place["spring_link"], follower, turn)


def in_mujoco(mujoco: Any) -> Any:
    """The gripper on the arm, its loops closed by <connect> at the places that coincide where nothing has moved."""
    fore = (
        '<inertial mass="1" pos="0 0.01 0.1" diaginertia="0.01 0.01 0.001"/><joint name="b" axis="1 1 0"/>'
        f'<body name="base" pos="0 0 0.2608">{inertial("base")}{finger("right")}{finger("left")}</body>'
    )
    upper = '<inertial mass="2" pos="0 0 0.2" diaginertia="0.03 0.03 0.002"/><joint name="a" axis="0 1 0"/>'
    arm = f'<body name="upper">{upper}<body name="fore" pos="0 0 0.4">{fore}</body></body>'
    loops = "".join(f'<connect anchor="0 0 0" body1="{s}_follower" body2="{s}_coupler"/>' for s in ("right", "left"))
    same = '<joint joint1="right_driver" joint2="left_driver" polycoef="0 1 0 0 0"/>'
    options = '<compiler angle="radian"/><option gravity="0.3 -2 -9.81" jacobian="dense"/>'
    text = f"<mujoco>{options}<worldbody>{arm}</worldbody><equality>{loops}{same}</equality></mujoco>"
    return mujoco.MjModel.from_xml_string(text)


def constrained_acceleration(mujoco: Any, m: Any, q: Array, qd: Array, tau: Array) -> tuple[Array, Array]:
    """q'' with M q'' + h = tau + J^T lambda and J q'' + J' q' = 0, and how far the constraints are open.

    MuJoCo's own M, h, and J of its constraints, which it holds by springs; J' of its points where they coincide.
    """
    data = mujoco.MjData(m)
    data.qpos[:], data.qvel[:] = q, qd
    mujoco.mj_forward(m, data)
    M = np.zeros((m.nv, m.nv))
    mujoco.mj_fullM(m, data, M)
    J, rate = np.array(data.efc_J).reshape(-1, m.nv), np.zeros((7, m.nv))
    for row, side in ((0, "right"), (3, "left")):
        bodies = [mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_BODY, f"{side}_{x}") for x in ("follower", "coupler")]
        point = data.xpos[bodies[0]]
        for sign, body in zip((1, -1), bodies, strict=True):
            each = np.zeros((3, m.nv))
            mujoco.mj_jacDot(m, data, each, None, point, body)
            rate[row : row + 3] += sign * each
    assert len(J) == 7
    K = np.block([[M, -J.T], [J, np.zeros((7, 7))]])
    right = np.concatenate([tau + data.qfrc_passive - data.qfrc_bias, -rate @ qd])
    return np.linalg.lstsq(K, right, rcond=1e-12)[0][: m.nv], np.array(data.efc_pos)


def test_the_adaptive_gripper_on_an_arm_moves_as_in_mujoco() -> None:
    """Positions, closed by us, are closed there; all accelerations agree to 1e-8 of the largest one, and so do those of
    the independent coordinates alone.
    """
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the test extra")
    tree: dict[str, Any] = {
        "name": "cell",
        "gravity": [0.3, -2, -9.81],
        "instances": [
            {"name": "arm", "substructure": "arm"},
            {"name": "hand", "substructure": "robotiq-2f85", "level": "full", "at": "arm.flange"},
        ],
    }
    parts = {"arm": derive(Definition.read(ARM)), "hand": shipped_part("robotiq-2f85")}
    model, m = couple(TreeSpec.read(tree), parts), in_mujoco(mujoco)
    del tree["instances"][1]["level"]
    light = couple(TreeSpec.read(tree), parts)
    names = [mujoco.mj_id2name(m, mujoco.mjtObj.mjOBJ_JOINT, i) for i in range(m.njnt)]
    ours = [f"{'arm' if n in 'ab' else 'hand'}.{n.replace('left_driver', 'right_driver')}" for n in names]
    place = [model.coordinates.index(name) for name in ours]
    rng = np.random.default_rng(1)
    for opening in (0.1, 0.5):
        q = dict.fromkeys(model.coordinates, 0.0) | {"arm.a": 0.4, "arm.b": -0.7, "hand.right_driver": opening}
        held = ["arm.a", "arm.b", "hand.right_driver", "hand.right_spring_link"]
        q["hand.right_spring_link"] = 0.9 * opening
        rates = dict(zip(model.coordinates, rng.uniform(-2, 2, model.dof), strict=True))
        state = loop_state(model, list(q.values()), qd=list(rates.values()), fixed=held).consistent
        tau = dict(zip(model.coordinates, rng.uniform(-0.5, 0.5, model.dof), strict=True))
        found = evaluate(
            model,
            ["forward_dynamics"],
            q=state.q.tolist(),
            qd=state.qd.tolist(),
            inputs={f"tau.{name}": x for name, x in tau.items()},
        )["forward_dynamics"]
        torque = np.array([tau[name] for name in ours])
        torque[names.index("left_driver")] = 0  # one torque on both drivers
        wanted, is_open = constrained_acceleration(mujoco, m, state.q[place], state.qd[place], torque)
        assert np.abs(is_open).max() < 1e-12
        np.testing.assert_allclose(found[place], wanted, rtol=0, atol=1e-8 * np.abs(wanted).max())
        own = [model.coordinates.index(name) for name in light.coordinates]
        torque = np.array([tau[name] if name in light.coordinates else 0.0 for name in ours])
        torque[names.index("left_driver")] = 0
        wanted, _ = constrained_acceleration(mujoco, m, state.q[place], state.qd[place], torque)
        pushed = {f"tau.{name}": tau[name] for name in light.coordinates}
        less = evaluate(light, "forward_dynamics", state.q[own], state.qd[own], inputs=pushed)["forward_dynamics"]
        for name, x in zip(light.coordinates, less, strict=True):
            assert x == pytest.approx(wanted[ours.index(name)], abs=1e-8 * np.abs(wanted).max())


def test_the_inertia_tensors_of_the_gripper_are_as_published() -> None:
    defaults = {name: float(x["value"]) for name, x in load("robotiq-2f85")["parameters"].items()}
    for name, letter in zip(BODIES, "bdcsfp", strict=True):
        mass, _, quaternion, diagonal = BODIES[name]
        assert defaults[f"m{letter}"] == mass
        found = {x: defaults.get(f"I{x}{letter}", 0.0) for x in tensor(quaternion, diagonal)}
        assert found == pytest.approx(tensor(quaternion, diagonal), rel=1e-12)


def test_the_pantograph_moves_its_end_k_times_as_far() -> None:
    """q = k p in every position, and the mass matrix in the angles of both long bars as their masses make it."""
    model, rng = alone("pantograph", [0, -9.81, 0]), np.random.default_rng(4)
    p = {name: float(x["value"]) for name, x in load("pantograph")["parameters"].items()}
    ports = [model.frames.index(f"x.{name}") for name in "pq"]
    whole = p["k"] * p["a"]
    for _ in range(4):
        q1, q2 = rng.uniform(-3, 3, 2)
        at = {"q": [q1, q2, q2, np.pi - q2]}
        found = evaluate(model, ["metric", "kinematics", "closure.residual", "closure.jacobian"], **at)
        assert np.abs(found["closure.residual"]).max() < 1e-15
        short, far = found["kinematics"]["position"][ports]
        np.testing.assert_allclose(far, p["k"] * short, atol=1e-15)
        # rates of q1 and q1 + q2
        N = np.array([[1, 0], [-1, 1], [-1, 1], [1, -1]])
        assert np.abs(found["closure.jacobian"] @ N).max() < 1e-15
        d11 = p["I1"] + p["m1"] * p["s1"] ** 2 + p["m2"] * whole**2 + p["m3"] * p["a"] ** 2
        d11 += p["I4"] + p["m4"] * (whole - p["s4"]) ** 2
        d22 = p["I2"] + p["m2"] * p["s2"] ** 2 + p["I3"] + p["m3"] * p["s3"] ** 2 + p["m4"] * p["c"] ** 2
        mixed = p["m2"] * whole * p["s2"] + p["m3"] * p["a"] * p["s3"] + p["m4"] * (whole - p["s4"]) * p["c"]
        d12 = mixed * np.cos(q2)
        np.testing.assert_allclose(N.T @ found["metric"] @ N, [[d11, d12], [d12, d22]], rtol=0, atol=1e-14)


def test_the_delta_robot_has_codoureys_equations() -> None:
    """tau = I_b q'' + J^T m_n (x'' - g) - M_b g cos q (A. Codourey 1998) with x' = J q' of rods that keep their length,
    at positions that are closed by hand.
    """
    model, rng = alone("delta-robot", [0, 0, -9.81]), np.random.default_rng(5)
    reduced = couple(
        {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "delta-robot"}]},
        {"x": shipped_part("delta-robot")},
    )
    p = {name: float(x["value"]) for name, x in load("delta-robot")["parameters"].items()}
    around = 2 * np.pi / 3 * np.arange(3)
    out, up = np.stack([np.cos(around), np.sin(around), 0 * around], axis=1), np.array([0, 0, 1])
    mass, arm = p["mp"] + p["mb"], p["Ia"] + p["Im"] + p["ma"] * p["sa"] ** 2 + 2 / 3 * p["mb"] * p["la"] ** 2
    weight = 9.81 * (p["ma"] * p["sa"] + 2 / 3 * p["mb"] * p["la"])
    for _ in range(4):
        angles = rng.uniform(-0.3, 0.6, 3)
        elbows = (p["R"] - p["r"]) * out + p["la"] * (np.cos(angles)[:, None] * out - np.sin(angles)[:, None] * up)
        place = below(elbows, p["lb"])
        state = loop_state(model, [*angles, *place])
        np.testing.assert_allclose(state.consistent.q, [*angles, *place], atol=1e-12)
        assert state.mobility.degrees_of_freedom == 3
        # s . x' = s . elbow'
        rods = place - elbows
        turned = -p["la"] * (np.sin(angles)[:, None] * out + np.cos(angles)[:, None] * up)
        J = np.linalg.solve(rods, np.diag(np.einsum("ki,ki->k", rods, turned)))
        found = evaluate(model, ["metric", "gravity"], [*angles, *place])
        N = np.vstack([np.eye(3), J])
        np.testing.assert_allclose(N.T @ found["metric"] @ N, arm * np.eye(3) + mass * J.T @ J, rtol=0, atol=1e-14)
        held = J.T @ (mass * 9.81 * up) - weight * np.cos(angles)
        np.testing.assert_allclose(N.T @ -found["gravity"], held, rtol=0, atol=1e-12)
        found = evaluate(reduced, ["metric", "gravity", "dependent"], angles)
        np.testing.assert_allclose(found["dependent"], place, rtol=0, atol=1e-14)
        np.testing.assert_allclose(found["metric"], arm * np.eye(3) + mass * J.T @ J, rtol=0, atol=1e-14)
        np.testing.assert_allclose(-found["gravity"], held, rtol=0, atol=1e-12)


def below(elbows: Array, length: float) -> Array:
    """The lower of both points at a distance from three others."""
    a, b, c = elbows
    # the centre of the circle through them, and its axis
    normal = np.cross(b - a, c - a)
    left = np.array([2 * (b - a), 2 * (c - a), normal])
    centre = np.linalg.solve(left, [b @ b - a @ a, c @ c - a @ a, normal @ a])
    height = np.sqrt(length**2 - (centre - a) @ (centre - a))
    return centre - height * normal / np.linalg.norm(normal) * np.sign(normal[2])
