"""An MJCF file in MuJoCo; what the reader leaves out, and says so, is switched off there."""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from engines import Numbers, Place, euler_matrix, in_our_coordinates, quaternion, velocity_map

Array = Any
mujoco.set_mju_user_warning(lambda _message: None)  # else they are written to a file here
WRAPPING = {int(getattr(mujoco.mjtWrap, f"mjWRAP_{kind}")) for kind in ("PULLEY", "SPHERE", "CYLINDER")}
KIND = {int(mujoco.mjtJoint.mjJNT_FREE): "free", int(mujoco.mjtJoint.mjJNT_BALL): "ball"}


class MujocoTwin:
    """The model that MuJoCo compiles; ``names``: of our coordinates, by the names of joints in the file."""

    def __init__(self, path: Path, names: dict[str, str], coordinates: list[str], gravity: Array) -> None:
        self.model = m = mujoco.MjModel.from_xml_path(str(path))
        m.opt.gravity[:] = gravity
        m.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_GRAVITY)
        m.tendon_armature[:] = 0
        for t in range(m.ntendon):
            path = m.wrap_type[m.tendon_adr[t] : m.tendon_adr[t] + m.tendon_num[t]]
            if set(map(int, path)) & WRAPPING:
                m.tendon_stiffness[t] = m.tendon_damping[t] = 0
        m.body_gravcomp[:] = 0
        m.opt.density = m.opt.viscosity = 0
        self.places = [self._place(j, names, coordinates) for j in range(m.njnt)]

    def _place(self, j: int, names: dict[str, str], coordinates: list[str]) -> Place:
        joint = self.model.joint(j)
        ours = [coordinates.index(c) for c in names[f"joint {joint.name or f'joint{j + 1}'}"].split(", ")]
        kind = KIND.get(int(self.model.jnt_type[j]), "one")
        return Place(kind, int(self.model.jnt_qposadr[j]), int(self.model.jnt_dofadr[j]), ours)

    def numbers(self, q: Array, qd: Array, qdd: Array) -> Numbers:
        """At a state of ours."""
        m, data = self.model, mujoco.MjData(self.model)
        T, dT = velocity_map(self.places, m.nv, q, qd, local=False)
        for j, place in enumerate(self.places):
            self._set(data, j, place, q, T)
        data.qvel[:] = T @ qd
        mujoco.mj_forward(m, data)
        M = np.zeros((m.nv, m.nv))
        mujoco.mj_fullM(m, data, M)
        both = data.qfrc_bias.copy()
        passive = data.qfrc_spring + data.qfrc_damper
        data.qvel[:] = 0
        mujoco.mj_forward(m, data)
        gravity = -data.qfrc_bias
        return in_our_coordinates(T, dT, qd, M, gravity, both + gravity, passive, qdd)

    def _set(self, data: Any, j: int, place: Place, q: Array, T: Array) -> None:
        """Positions there; a free joint is placed in the world, ours where the file puts the body."""
        if place.kind == "one":
            data.qpos[place.q] = q[place.ours[0]]
            return
        R = euler_matrix(*q[place.ours[-3:]])
        if place.kind == "ball":
            data.qpos[place.q : place.q + 4] = quaternion(R)
            return
        body = self.model.jnt_bodyid[j]
        R0 = np.zeros(9)
        mujoco.mju_quat2Mat(R0, self.model.body_quat[body])
        R0 = R0.reshape(3, 3)
        data.qpos[place.q : place.q + 3] = self.model.body_pos[body] + R0 @ q[place.ours[:3]]
        there = np.zeros(4)
        mujoco.mju_mat2Quat(there, (R0 @ R).ravel())
        data.qpos[place.q + 3 : place.q + 7] = there
        T[np.ix_(range(place.v, place.v + 3), place.ours[:3])] = R0
