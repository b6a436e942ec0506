"""The robots of the benchmark in MuJoCo: metric (mj_crb) and velocity and gravity forces (mj_rne), state by state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.robots import CALLS, Robot
from benchmarks.timing import alternating, ratio

try:
    import mujoco
except ImportError:
    mujoco = None

Array = Any
OURS = ("metric", "forces", "bias")


@dataclass(frozen=True)
class Twin:
    """The model in MuJoCo; ``order[k]``: our coordinate that is its degree of freedom k."""

    model: Any
    order: list[int]

    @classmethod
    def of(cls, robot: Robot) -> Twin:
        """From the model in Pinocchio, joint by joint."""
        model, order = robot.peer.model, list[int]()
        bodies = "".join(_body(model, j, order) for j in _children(model, 0))
        text = f"""<mujoco>
<compiler angle="radian" inertiafromgeom="false"/>
<option gravity="{_text(model.gravity.linear)}"/>
<worldbody>{bodies}</worldbody>
</mujoco>"""
        return cls(mujoco.MjModel.from_xml_string(text), [robot.peer.order.index(k) for k in order])

    def work(self, q: Array, qd: Array) -> Callable[[], None]:
        """Metric and forces of all states, one after the other."""
        model, data, bias = self.model, mujoco.MjData(self.model), np.zeros(self.model.nv)
        states = list(zip(q[:, self.order], qd[:, self.order], strict=True))

        def run() -> None:
            for x, v in states:
                data.qpos[:] = x
                data.qvel[:] = v
                mujoco.mj_kinematics(model, data)
                mujoco.mj_comPos(model, data)
                mujoco.mj_crb(model, data)
                mujoco.mj_comVel(model, data)
                mujoco.mj_rne(model, data, 0, bias)

        return run

    def check(self, robot: Robot) -> float:
        """Largest relative deviation of metric and forces from ours."""
        q, qd = robot.q[:20], robot.qd[:20]
        found = robot.kernel(OURS).evaluate(robot.numbers, columns=columns(robot, 20))
        data, metric = mujoco.MjData(self.model), np.zeros((self.model.nv, self.model.nv))
        place, worst = np.argsort(self.order), 0.0
        for i in range(20):
            data.qpos[:], data.qvel[:] = q[i][self.order], qd[i][self.order]
            mujoco.mj_forward(self.model, data)
            mujoco.mj_fullM(self.model, data, metric)
            bias = found["bias"][i] - found["forces"][i]
            pairs = ((found["metric"][i], metric[np.ix_(place, place)]), (bias, data.qfrc_bias[place]))
            worst = max(worst, *(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs))
        return worst


def columns(robot: Robot, count: int) -> list[Any]:
    """Positions and velocities of the first states."""
    names = robot.model.coordinates
    return [(names, robot.q[:count]), ([f"{name}'" for name in names], robot.qd[:count])]


def _text(numbers: Any) -> str:
    return " ".join(repr(float(x)) for x in numbers)


def _children(model: pin.Model, j: int) -> list[int]:
    return [i for i in range(1, model.njoints) if model.parents[i] == j]


def _merged(model: pin.Model, j: int) -> list[int]:
    """Joints through bodies without mass and without extent: in MuJoCo one body has them all."""
    joints = [j]
    while model.inertias[joints[-1]].mass == 0:
        (child,) = _children(model, joints[-1])
        if not model.jointPlacements[child].isIdentity():
            raise ValueError("MuJoCo has no moving bodies without mass")
        joints.append(child)
    return joints


def _body(model: pin.Model, first: int, order: list[int]) -> str:
    """The body behind a joint, and all behind it; degrees of freedom are appended to ``order``."""
    joints = _merged(model, first)
    order += (model.joints[j].idx_v for j in joints)
    placement, inertia = model.jointPlacements[first], model.inertias[joints[-1]]
    x, y, z, w = pin.Quaternion(placement.rotation).coeffs()
    tensor = inertia.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    return "\n".join(
        [
            f'<body pos="{_text(placement.translation)}" quat="{_text((w, x, y, z))}">',
            f'<inertial pos="{_text(inertia.lever)}" mass="{inertia.mass!r}" fullinertia="{_text(tensor)}"/>',
            *(_joint(model.joints[j].shortname()) for j in joints),
            *(_body(model, child, order) for child in _children(model, joints[-1])),
            "</body>",
        ]
    )


def _joint(name: str) -> str:
    """JointModelRX, ..., JointModelPZ."""
    kind = "hinge" if name[-2] == "R" else "slide"
    return f'<joint type="{kind}" axis="{_text(np.eye(3)["XYZ".index(name[-1])])}"/>'


def beside_mujoco(robot: Robot, key: str, figures: dict[str, float], rounds: int) -> None:
    """Metric, gravity and velocity forces."""
    if mujoco is None:
        print("MuJoCo is not installed (extra 'bench'): skipped")
        return
    twin, kernel = Twin.of(robot), robot.kernel(OURS)
    deviation, given = twin.check(robot), columns(robot, len(robot.q))
    blocks = kernel.blocks(robot.numbers, columns=given).array
    rows = {n: np.zeros((len(robot.q), *kernel.shape(n))) for n in OURS}
    empty = Twin(mujoco.MjModel.from_xml_string("<mujoco/>"), [])
    none = np.zeros((CALLS, 0))
    times = alternating(
        {
            "blocks": (lambda: kernel.blocks(robot.numbers, columns=given, out=blocks), len(robot.q)),
            "rows": (lambda: kernel.evaluate_into(rows, robot.numbers, columns=given, clean=True), len(robot.q)),
            "theirs": (twin.work(robot.q[:CALLS], robot.qd[:CALLS]), CALLS),
            "calls": (empty.work(none, none), CALLS),
        },
        rounds,
    )
    net = [t - e for t, e in zip(times["theirs"], times["calls"], strict=True)]
    figures[f"mujoco_{key}_ratio"] = ratio(times["theirs"], times["blocks"])
    figures[f"mujoco_{key}_ratio_rows"] = ratio(times["theirs"], times["rows"])
    figures[f"mujoco_{key}_ratio_net"] = ratio(net, times["blocks"])
    us = " ".join(f"{median(some) * 1e6:>9.3f}" for some in times.values())
    ratios = " ".join(f"{figures[f'mujoco_{key}_{form}']:>6.1f}" for form in ("ratio", "ratio_rows", "ratio_net"))
    print(f"{robot.name + ': M, Q, bias':>34} {us} {ratios}   largest relative deviation {deviation:.1e}")
