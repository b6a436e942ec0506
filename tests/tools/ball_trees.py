"""Random mechanisms with ball and floating joints, and their states in the order of another engine."""

from __future__ import annotations

from typing import Any

import numpy as np
from random_trees import GRAVITY, Kind, random_definition
from scipy.spatial.transform import Rotation

Plain = dict[str, Any]
OF = {"spherical": "ball", "free": "floating"}
JOINTS = ("revolute", "revolute", "prismatic", "spherical", "spherical", "free", "fixed")


def with_balls(definition: Plain) -> Plain:
    """With ball and floating joints in place of spherical and free ones, and without loads that name their angles."""
    bodies, gone = [], set[str]()
    for body in definition["bodies"]:
        joint = dict(body["joint"])
        if joint["type"] in OF:
            gone |= {*joint["coordinate"]}
            joint |= {"type": OF[joint["type"]], "velocities": joint.pop("coordinate")}
            for name in ("stiffness", "rest"):
                joint.pop(name, None)
            rotor = joint.pop("armature", None)
            if joint["type"] == "ball" and rotor is not None:
                joint["armature"] = rotor[0] if isinstance(rotor, list) else rotor
        bodies.append({**body, "joint": joint})

    def names(load: Plain) -> bool:
        texts = [load.get("coordinate", ""), *map(str, load.get("vector", [])), str(load.get("force", ""))]
        return any(name in text for name in gone for text in texts)

    return {**definition, "bodies": bodies, "loads": [load for load in definition["loads"] if not names(load)]}


def random_balls(seed: int, loads: int = 0, depth: int = 14) -> tuple[Plain, np.random.Generator]:
    """A random mechanism with at least one such joint."""
    rng = np.random.default_rng(seed)
    kind = Kind(int(rng.integers(2, 6)), bool(rng.integers(2)), JOINTS, loads=loads, springs=loads // 2, depth=depth)
    while True:
        definition = with_balls(random_definition(rng, kind))
        if any(body["joint"]["type"] in OF.values() for body in definition["bodies"]):
            return definition, rng


def random_position(rng: np.random.Generator, model: Any) -> np.ndarray:
    """A state q: unit quaternions in the places of ball joints."""
    q = rng.uniform(-1.2, 1.2, len(model.positions))
    for ball in model.balls:
        some = [model.positions.index(name) for name in ball["positions"][-4:]]
        turn = rng.normal(size=4)
        q[some] = turn / np.linalg.norm(turn)
    return q


def displaced(model: Any, q: np.ndarray, by: np.ndarray) -> np.ndarray:
    """A state moved by n numbers: of ball joints by a displacement and a rotation vector in the axes of the body."""
    at, moved = dict(zip(model.positions, q.tolist(), strict=True)), dict(zip(model.coordinates, by, strict=True))
    result = {name: x + moved.get(name, 0.0) for name, x in at.items()}
    for ball in model.balls:
        names, (*slide, _, _, _) = ball["positions"], ball["velocities"]
        turn = np.array([moved[name] for name in ball["velocities"][-3:]])
        old = Rotation.from_quat([at[name] for name in names[-4:]], scalar_first=True)
        new = (old * Rotation.from_rotvec(turn)).as_quat(scalar_first=True)
        result |= dict(zip(names[-4:], new.tolist(), strict=True))
        if slide:
            place = old.apply([moved[name] for name in slide]) + [at[name] for name in names[:3]]
            result |= dict(zip(names[:3], place.tolist(), strict=True))
    return np.array([result[name] for name in model.positions])


def apart(model: Any, q: np.ndarray, other: np.ndarray) -> np.ndarray:
    """By what ``other`` is displaced."""
    at, there = (dict(zip(model.positions, x.tolist(), strict=True)) for x in (q, other))
    result = {name: there[name] - at[name] for name in model.positions}
    for ball in model.balls:
        names, (*slide, _, _, _) = ball["positions"], ball["velocities"]
        old, new = (Rotation.from_quat([x[name] for name in names[-4:]], scalar_first=True) for x in (at, there))
        turned = (old.inv() * new).as_rotvec()
        result |= dict(zip(ball["velocities"][-3:], turned.tolist(), strict=True))
        if slide:
            moved = old.inv().apply([there[name] - at[name] for name in names[:3]])
            result |= dict(zip(slide, moved.tolist(), strict=True))
    return np.array([result[name] for name in model.coordinates])


def of_engine(engine: Any, model: Any, q: np.ndarray) -> np.ndarray:
    """The state of Pinocchio, whose quaternions are x, y, z, w."""
    result = np.zeros(engine.model.nq)
    balls = {name: (ball, i) for ball in model.balls for i, name in enumerate(ball["positions"])}
    for name, x in zip(model.positions, q, strict=True):
        if name not in balls:
            result[engine.model.idx_qs[engine.model.getJointId(name.removeprefix("x."))]] = x
            continue
        ball, i = balls[name]
        first = engine.starts[ball["velocities"][0].removeprefix("x.")]
        place = len(ball["positions"]) - 4
        result[first + (i if i < place else place + (i - place - 1) % 4)] = x
    return result


__all__ = ["GRAVITY", "apart", "displaced", "of_engine", "random_balls", "random_position", "with_balls"]
