"""A numeric definition as a Pinocchio model (J. Carpentier et al., The Pinocchio C++ library, SII 2019)."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin
from independent import inertia_of, value, values

Plain = dict[str, Any]
Array = Any

UNIT = {
    "P": (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ),
    "R": (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ),
}
#: (kind, axis) of the joints that a joint type is made of, from the parent to the body
CHAINS = {
    "revolute": ("Rz",),
    "prismatic": ("Pz",),
    "fixed": (),
    "universal": ("Rz", "Ry"),
    "spherical": ("Rz", "Ry", "Rx"),
    "cylindrical": ("Rz", "Pz"),
    "planar": ("Px", "Py", "Rz"),
    "free": ("Px", "Py", "Pz", "Rz", "Ry", "Rx"),
}
#: with quaternions, and rates in the axes of the body
WHOLE = {"ball": pin.JointModelSpherical, "floating": pin.JointModelFreeFlyer}


def turn(axis: Array, angle: float) -> Array:
    """Rotation matrix about a unit vector (Rodrigues)."""
    x, y, z = axis
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def placed(rotation: Array, p: Any = (0, 0, 0)) -> pin.SE3:
    return pin.SE3(np.asarray(rotation, dtype=float), np.asarray(p, dtype=float))


def rpy(angles: Any) -> Array:
    """Fixed-axis roll, pitch, yaw."""
    roll, pitch, yaw = values(angles)
    X, Y, Z = np.eye(3)
    return turn(Z, yaw) @ turn(Y, pitch) @ turn(X, roll)


@dataclass
class Engine:
    """Model, frames by name (joint and constant placement in it), index of every coordinate, or rate of a ball joint;
    ``starts``: by the first one of these rates, where its state begins.
    """

    model: pin.Model
    frames: dict[str, tuple[int, pin.SE3]]
    index: dict[str, int]
    starts: dict[str, int] = field(default_factory=dict)

    def order(self, coordinates: list[str]) -> list[int]:
        return [self.index[c] for c in coordinates]


def engine_of(definition: Plain, gravity: Any, floats: bool = False) -> Engine:
    """Joints are added depth first, as Pinocchio's algorithms expect; ``floats``: the base, by a free flyer."""
    model = pin.Model()
    model.gravity.linear = np.asarray(gravity, dtype=float)
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root") if floats else 0
    engine = Engine(model, {"base": (root, pin.SE3.Identity())}, {})
    waiting = [b for b in definition["bodies"] if b["parent"] == "base"]
    while waiting:
        body = waiting.pop()
        _add(engine, body)
        waiting += [b for b in definition["bodies"] if b["parent"] == body["name"]]
    for port in definition.get("ports", []):
        joint, place = engine.frames[port["body"]]
        where = placed(rpy(port.get("rotation", {}).get("rpy", [0, 0, 0])), values(port.get("position", [0, 0, 0])))
        engine.frames[port["name"]] = joint, place * where
    return engine


def _add(engine: Engine, body: Plain) -> None:
    joint = body["joint"]
    parent, place = engine.frames[body["parent"]]
    place = place * _seat(joint)
    names = joint.get("coordinate", [])
    names = [names] if isinstance(names, str) else names
    if joint["type"] in WHOLE:
        parent = engine.model.addJoint(parent, WHOLE[joint["type"]](), place, body["name"])
        first = engine.model.joints[parent]
        engine.index |= {name: first.idx_v + i for i, name in enumerate(joint["velocities"])}
        engine.starts[joint["velocities"][0]] = first.idx_q
        place = pin.SE3.Identity()
    for (letter, axis), name in zip(CHAINS.get(joint["type"], ()), names, strict=True):
        n = np.eye(3)["xyz".index(axis)]
        kind: Any = UNIT[letter]["xyz".index(axis)]()
        if "axis" in joint:
            n = values(joint["axis"])
            n = n / np.linalg.norm(n)
            kind = pin.JointModelPrismaticUnaligned(n) if letter == "P" else pin.JointModelRevoluteUnaligned(n)
        place = place * placed(turn(n, value(joint.get("phi", 0))), n * value(joint.get("tau", 0)))
        parent = engine.model.addJoint(parent, kind, place, name)
        engine.index[name] = engine.model.joints[parent].idx_v
        place = pin.SE3.Identity()
    if joint["type"] == "fixed":
        place = place * placed(turn(np.eye(3)[2], value(joint.get("phi", 0))), [0, 0, value(joint.get("tau", 0))])
    engine.frames[body["name"]] = parent, place
    m, c, theta = inertia_of(body)
    engine.model.appendBodyToJoint(parent, pin.Inertia(m, c, theta), place)


def _seat(joint: Plain) -> pin.SE3:
    """The frame before the joint moves;"""
    if "placement" in joint:
        return placed(rpy(joint["placement"]["rpy"]), values(joint["placement"]["position"]))
    psi, theta, d, sigma = (value(joint.get(x, 0)) for x in ("psi", "theta", "d", "sigma"))
    X, _, Z = np.eye(3)
    return placed(turn(Z, psi), [0, 0, sigma]) * placed(turn(X, theta), turn(X, theta) @ [d, 0, 0])
