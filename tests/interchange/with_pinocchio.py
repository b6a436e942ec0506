"""A URDF file in Pinocchio, whose own parser reads it."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from engines import Numbers, Place, euler_matrix, in_our_coordinates, quaternion, velocity_map

Array = Any


class PinocchioTwin:
    """The model that Pinocchio reads; ``coordinates``: ours, by the names of joints in the file."""

    def __init__(self, path: Path, names: dict[str, str], coordinates: list[str], gravity: Array) -> None:
        self.model = pin.buildModelFromUrdf(str(path))
        self.model.gravity.linear = np.asarray(gravity, dtype=float)
        self.places = [self._place(j, names, coordinates) for j in range(1, self.model.njoints)]
        damping = np.array(self.model.damping)
        self.damping = damping if len(damping) == self.model.nv else np.zeros(self.model.nv)

    def _place(self, j: int, names: dict[str, str], coordinates: list[str]) -> Place:
        joint = self.model.joints[j]
        ours = [coordinates.index(c) for c in names[f"joint {self.model.names[j]}"].split(", ")]
        return Place("free" if joint.nv == 6 else "one", joint.idx_q, joint.idx_v, ours)

    def numbers(self, q: Array, qd: Array, qdd: Array) -> Numbers:
        """At a state of ours."""
        model, data = self.model, self.model.createData()
        x = pin.neutral(model)
        for place in self.places:
            if place.kind == "free":
                w, *v = quaternion(euler_matrix(*q[place.ours[3:]]))
                x[place.q : place.q + 7] = [*q[place.ours[:3]], *v, w]
            elif self._is_circle(place):
                x[place.q : place.q + 2] = np.cos(q[place.ours[0]]), np.sin(q[place.ours[0]])
            else:
                x[place.q] = q[place.ours[0]]
        T, dT = velocity_map(self.places, model.nv, q, qd, local=True)
        v = T @ qd
        M = np.triu(pin.crba(model, data, x))
        M = M + np.triu(M, 1).T
        gravity = -pin.computeGeneralizedGravity(model, data, x).copy()
        bias = pin.nonLinearEffects(model, data, x, v).copy() + gravity
        return in_our_coordinates(T, dT, qd, M, gravity, bias, -self.damping * v, qdd)

    def _is_circle(self, place: Place) -> bool:
        following = [p.q for p in self.places if p.q > place.q]
        return min(following, default=self.model.nq) - place.q == 2
