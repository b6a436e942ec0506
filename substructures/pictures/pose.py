"""Poses to show: those of definitions, and where there are none one in which bodies lie apart and all of them move."""

from __future__ import annotations

from collections.abc import Mapping
from math import pi
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.mechanics.state_names import resting_state
from substructures.part.part import Part
from substructures.part.poses import HOME, posed
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

#: where a joint without limits is put where 0 shows nothing
ANGLE, SLIDE = 0.4, 0.25
#: digits of places, relative to the largest, that are told apart
DIGITS = 6

Limits = Mapping[int, tuple[float, float]]


def kinematics(model: Model, q: Any) -> dict[str, Array]:
    """Places and rotations of all frames, and their velocities in their own axes, at the state ``q`` and the defaults
    of parameters, 1 where there is none. Raises InvalidDocument for a wrong ``q``.
    """
    missing = {name: 1.0 for name, p in model.parameters.items() if p["value"] is None}
    found = evaluate(model, "kinematics", q, parameters=missing)["kinematics"]
    return {name: np.nan_to_num(found[name]) for name in ("position", "rotation", "U", "Omega")}


def poses(spec: TreeSpec, parts: Mapping[str, Part], model: Model, limits: Limits) -> dict[str, list[float]]:
    """All poses by name, ``home`` first, as states q [rad or m] without turned quaternions; parts that have none of a
    name stay at home.
    """
    pose = dict(zip(model.coordinates, _first(spec, parts, model, limits), strict=True))
    given = {name: dict.fromkeys([HOME, *part.definition.poses]) for name, part in parts.items()}
    found = {}
    for pose_name in dict.fromkeys([HOME, *(each for names in given.values() for each in names)]):
        moved = dict(pose)
        for name, part in parts.items():
            values = part.definition.poses.get(pose_name, part.definition.poses.get(HOME))
            if values is not None:
                moved |= {f"{name}.{c}": default_number(values.get(c, 0)) for c in posed(part.topology)}
        found[pose_name] = state_of(model, moved)
    return found


def state_of(model: Model, values: Mapping[str, float]) -> list[float]:
    """q with the values of coordinates and of places; no quaternion turns anything."""
    resting = zip(model.positions, resting_state(model.positions, model.balls), strict=True)
    return [values.get(name, x) for name, x in resting]


def _first(spec: TreeSpec, parts: Mapping[str, Part], model: Model, limits: Limits) -> list[float]:
    """Without poses: 0 within the limits; of parts whose bodies then coincide or stand in a singular position, other
    angles or distances, of those that do less so.
    """
    kinds, places = model.joints, list(range(model.dof))
    pose = [_within(0.0, limits.get(a)) for a in places]
    loose = _loose(parts)
    apart = [pose[a] if model.coordinates[a] in loose else _apart(kinds[a] == "P", limits.get(a)) for a in places]
    slid = [apart[a] if kinds[a] == "P" else pose[a] for a in places]
    tried = [state_of(model, dict(zip(model.coordinates, each, strict=True))) for each in (pose, slid, apart)]
    shown = [kinematics(model, each) for each in tried] if model.dof else []
    for instance in spec.instances:
        own = [a for a, name in enumerate(model.coordinates) if name.partition(".")[0] == instance.name]
        if not own or HOME in parts[instance.name].definition.poses:
            continue
        frames = [k for k, name in enumerate(model.frames) if name.partition(".")[0] == instance.name]
        best = max(range(3), key=lambda k: (_freedom(shown[k], frames, own), -k))
        for a in own:
            pose[a] = (pose, slid, apart)[best][a]
    return pose


def _loose(parts: Mapping[str, Part]) -> set[str]:
    """Coordinates of free joints: what they move lies apart from nothing. And rates of balls, which have none."""
    return {
        f"{name}.{joint.coordinate}"
        for name, part in parts.items()
        for joint in part.topology.joints
        if joint.is_rate or part.definition.bodies[joint.body].joint.type == "free"
    }


def _within(value: float, limits: tuple[float, float] | None) -> float:
    """The value, or the middle of limits that it is not within."""
    if limits is None or limits[0] <= value <= limits[1]:
        return value
    return (limits[0] + limits[1]) / 2


def _apart(slides: bool, limits: tuple[float, float] | None) -> float:
    """A little beyond the middle of narrow limits; a fixed angle or distance else."""
    if limits is not None and (slides or limits[1] - limits[0] < 2 * pi / 3):
        return limits[0] + 0.6 * (limits[1] - limits[0])
    return SLIDE if slides else ANGLE


def _freedom(shown: Mapping[str, Array], frames: list[int], own: list[int]) -> tuple[int, int]:
    """How many directions velocities of frames span, and how many of these frames lie apart."""
    columns = [shown[name][frames][:, own] for name in ("U", "Omega")]
    J = np.concatenate([c.transpose(0, 2, 1).reshape(-1, len(own)) for c in columns])
    size = np.abs(J).max() or 1.0
    # rank of J^T J, whose eigenvalues are squares of the singular values of J
    squares = np.linalg.eigvalsh((J / size).T @ (J / size))
    points = shown["position"][frames]
    rounded = np.round(points / (np.abs(points).max() or 1.0), DIGITS)
    return int((squares > 1e-9 * len(J)).sum()), len(np.unique(rounded, axis=0))
