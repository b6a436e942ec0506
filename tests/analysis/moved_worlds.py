"""Closed trees in worlds that are turned and shifted anyhow, by numbers in decimals as a person or an import writes."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
from closed_trees import angles
from random_trees import Plain
from scipy.spatial.transform import Rotation

Pose = tuple[np.ndarray, np.ndarray]


def turned(rpy: Any) -> np.ndarray:
    """Rz Ry Rx of roll, pitch and yaw."""
    return np.asarray(Rotation.from_euler("xyz", rpy).as_matrix())


def pose_of(placement: Plain) -> Pose:
    return turned(placement.get("rpy", [0, 0, 0])), np.array(placement.get("position", [0, 0, 0]), dtype=float)


def placement_of(pose: Pose) -> Plain:
    R, r = pose
    yaw, pitch, roll = angles(R)
    return {"rpy": [roll, pitch, yaw], "position": r.tolist()}


def moved(document: Plain, motion: Pose) -> Plain:
    """The tree with gravity, all instances in the world, and the frames ``to`` of closures that are the world moved."""
    R, r = motion

    def carried(placed: Plain) -> Plain:
        E, p = pose_of(placed.get("placement", {}))
        return placed | {"placement": placement_of((R @ E, R @ p + r))}

    instances = [carried(i) if i.get("at", "world") == "world" else i for i in document["instances"]]
    closures = [carried(c) if c["to"] == "world" else c for c in document["closures"]]
    gravity = (R @ np.array(document.get("gravity", [0, 0, -9.81]), dtype=float)).tolist()
    return document | {"instances": instances, "closures": closures, "gravity": gravity}


def motions(seed: int, count: int) -> list[Pose]:
    """Random rigid motions, after one by right angles in decimals and one that stands a plane upright obliquely."""
    rng = np.random.default_rng(seed)
    shift = np.zeros(3)
    found = [(turned([1.5707963267948966, 0, 0.3]), shift), (turned([np.pi / 2, 0.123, 0]), shift)]
    turns = Rotation.random(count, random_state=rng).as_matrix()
    return found + [(R, rng.uniform(-2, 2, 3)) for R in turns]
