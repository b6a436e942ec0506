"""Joints of a stage: L0 J(q) L1^-1 between two bodies, with frames L0 and L1 that coincide where q is zero.

Of a joint that is passed from body0 to body1 the child is placed at L0 L1^-1, and moves about the axis R1 e through the
origin of L1; the other way round at L1 L0^-1, about -R0 e. Its limits are degrees or lengths, drives [force per degree
or length] springs and dampers. Source: https://openusd.org/release/api/usd_physics_page_front.html
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from substructures.array import Array
from substructures.errors import among
from substructures.interchange.merge import ordered_limits, vector
from substructures.interchange.numbers import ROUNDING, ZERO, Number, angle, decimal_of, direction
from substructures.interchange.report import Report, refuse
from substructures.interchange.robot import Loop, Motion
from substructures.interchange.rotations import to_rpy
from substructures.interchange.usd.degrees import KINDS, Degree, Kind, degrees_of
from substructures.interchange.usd.scene import Pose, Prim, Scene, given, place_of, rotation_of, written
from substructures.interchange.usd.stage import package

_CLOSURES: dict[str, Literal["pin", "slider", "weld", "ball"]] = {
    "revolute": "pin", "prismatic": "slider", "fixed": "weld", "spherical": "ball",
}  # fmt: skip
_DEGREES = 180 / math.pi


@dataclass(frozen=True)
class Joint:
    """``ends``: paths of body0 and body1, None for what stands still; ``frames``: in them."""

    prim: Prim
    name: str
    kind: Kind
    ends: tuple[str | None, str | None]
    frames: tuple[Pose, Pose]
    degrees: tuple[Degree, ...]
    is_cut: bool  #: excludeFromArticulation

    def placed(self, child: int) -> Pose:
        """The child, which is end 0 or 1, in the other one where q is zero, without what is only rounding."""
        R, r = self.frames[1 - child].beyond(self.frames[child].inverse)
        least = ROUNDING * max(np.abs(frame.r).max() for frame in self.frames)
        return Pose(R, np.where(np.abs(r) < least, 0.0, r))

    def motions(self, child: int, scene: Scene, report: Report) -> tuple[Motion, ...]:
        """Of the child, in its axes."""
        if self.kind == "fixed":
            return ()
        place = place_of(self.prim)
        if self.kind == "free":
            return (Motion(self.name, "free", place),)
        if self.kind == "spherical":
            cones = [self.prim.GetAttribute(f"physics:coneAngle{k}Limit") for k in (0, 1)]
            if any(given(self.prim, cone.GetName(), "float") >= 0 for cone in cones if cone):
                report.lost(place, "the cone in which a ball moves is left out: add a load that acts beyond it")
            return (Motion(self.name, "spherical", place, anchor=vector(self.frames[child].r)),)
        ordered = self.degrees if child else self.degrees[::-1]
        return tuple(self._motion(degree, child, scene, report) for degree in ordered)

    def _motion(self, degree: Degree, child: int, scene: Scene, report: Report) -> Motion:
        R, r = self.frames[child]
        axis = direction((R[:, degree.axis] * (1 if child else -1)).tolist())
        anchor = vector(np.zeros(3) if degree.type == "prismatic" else r)
        laws = {**self._drive(degree, scene, report), "limits": self._limits(degree, scene, report)}
        return Motion(self.name + degree.suffix, degree.type, place_of(self.prim), axis, anchor, **laws)

    def loop(self, names: dict[str, str], report: Report) -> Loop:
        """As a joint that is cut, whose axis is the third one of its frames."""
        if any("Limit" not in schema for schema in self.prim.GetAppliedSchemas()):
            report.lost(place_of(self.prim), "what acts in a joint that closes a loop is left out: add a load for it")
        kind = self.degrees[0].type if len(self.degrees) == 1 else self.kind
        if kind not in _CLOSURES:
            message = "it closes a loop and has several degrees of freedom: cut the loop at a joint with one or none"
            raise refuse(place_of(self.prim), "not-read", f"{message} (excludeFromArticulation)")
        first, second = (0, 1) if self.ends[0] is not None else (1, 0)
        turned = Pose(_to_third(self.degrees[0].axis if self.degrees else 2), np.zeros(3))
        one, two = (self.frames[k].beyond(turned) for k in (first, second))
        ends = [None if self.ends[k] is None else names[str(self.ends[k])] for k in (first, second)]
        places = vector(one.r), to_rpy(one.R), vector(two.r), to_rpy(two.R)
        return Loop(self.name, _CLOSURES[kind], str(ends[0]), ends[1], *places)

    def _limits(self, degree: Degree, scene: Scene, report: Report) -> tuple[Number, Number] | None:
        if degree.limits is None:
            return None
        ends = [given(self.prim, name, "float") for name in degree.limits]
        if all(map(math.isinf, ends)):
            return None
        place = place_of(self.prim)
        if any(map(math.isinf, ends)):
            report.warning(place, "one limit alone is left out: give both, lower and upper")
            return None
        low, high = (written(x, place) for x in ends)
        if degree.type == "prismatic":
            return ordered_limits(place, low * scene.units.length, high * scene.units.length, report)
        low, high = (decimal_of(float(x) / _DEGREES) for x in (low, high))
        return ordered_limits(place, angle(low), angle(high), report)

    def _drive(self, degree: Degree, scene: Scene, report: Report) -> dict[str, Any]:
        """k (target - q) - d q' of the drive, as spring and damper."""
        what = degree.drive
        physics, place = package("UsdPhysics"), place_of(self.prim)
        if not self.prim.HasAPI(physics.DriveAPI, what):
            return {}
        names = ("stiffness", "damping", "targetPosition", "targetVelocity", "maxForce")
        k, d, target, speed, most = (given(self.prim, f"drive:{what}:physics:{x}", "float") for x in names)
        kind = given(self.prim, f"drive:{what}:physics:type", "str")
        if not k and not d:
            report.ignored(place, "a drive without stiffness and damping: the coordinate has its input tau anyway")
            return {}
        if kind != "force" or (d and speed):
            message = "a drive that follows a velocity, or whose forces grow with the inertia, is left out"
            report.lost(place, f"{message}: drive the coordinate in a tree, or add a load for it")
            return {}
        if not math.isinf(most):
            report.lost(
                place, f"the largest force of the drive, {most:g}, is left out: it acts as a spring without end"
            )
        report.merged(place, "its drive is a spring and a damper of the joint")
        unit = scene.units.mass * (1 if degree.type == "prismatic" else scene.units.length**2)
        k, d, target = (written(x, place) for x in (k, d, target))
        if degree.type == "prismatic":
            return {"stiffness": k * unit, "damping": d * unit, "rest": target * scene.units.length}
        laws = {"stiffness": k, "damping": d}
        found: dict[str, Any] = {law: decimal_of(float(x * unit) * _DEGREES) for law, x in laws.items()}
        return found | {"rest": angle(decimal_of(float(target) / _DEGREES)) if k else ZERO}


def joints_of(scene: Scene, report: Report) -> Iterator[Joint]:
    """Those that are enabled. Raises InvalidDocument for types that are not read, and ends that are not there."""
    prims = [prim for prim in scene.prims if prim.IsA(package("UsdPhysics").Joint)]
    names = names_of([str(prim.GetPath()) for prim in prims])
    for prim in prims:
        kind, place = str(prim.GetTypeName()), place_of(prim)
        if not given(prim, "physics:jointEnabled", "bool"):
            report.ignored(place, "a joint that is not enabled")
        elif kind == "PhysicsDistanceJoint":
            report.lost(place, "a distance between two points is left out: add a closure of the type 'rod' to a tree")
        elif kind not in KINDS:
            message = f"{kind} is none of {', '.join(KINDS)}: write joints of one degree of freedom one after the other"
            raise refuse(place, "unknown-type", message)
        else:
            joint = _joint(prim, names[str(prim.GetPath())], scene, report)
            if joint.ends[0] == joint.ends[1]:
                report.ignored(place, "a joint within one body, or between two that stand still")
            else:
                yield joint


def _joint(prim: Prim, name: str, scene: Scene, report: Report) -> Joint:
    ends, frames = [], []
    for k in (0, 1):
        at = _end(prim, k, scene)
        position, quaternion = (
            given(prim, f"physics:localPos{k}", "Vec3f"),
            given(prim, f"physics:localRot{k}", "Quatf"),
        )
        frame = scene.inside(at, position, rotation_of(quaternion, prim), place_of(prim))
        ends.append(scene.body_of(at))
        frames.append(frame if ends[-1] is not None else scene.upright(frame))
    is_cut = bool(given(prim, "physics:excludeFromArticulation", "bool"))
    kind, degrees = degrees_of(prim, report)
    return Joint(prim, name, kind, (ends[0], ends[1]), (frames[0], frames[1]), degrees, is_cut)


def _end(prim: Prim, k: int, scene: Scene) -> Prim:
    """The prim at an end; the root of the stage where there is none."""
    targets = prim.GetRelationship(f"physics:body{k}").GetTargets()
    if len(targets) > 1:
        raise refuse(place_of(prim), "several-bodies", f"body{k} is one prim: leave one")
    if not targets:
        return scene.stage.GetPseudoRoot()
    found = scene.stage.GetPrimAtPath(targets[0])
    if not found:
        said = f"there is no prim <{str(targets[0])[:60]}>{among(str(targets[0]), scene.bodies)}"
        raise refuse(place_of(prim), "unknown-link", said)
    return found


def names_of(paths: list[str]) -> dict[str, str]:
    """The last name of a path, where no other has it; else the path."""
    last = [path.rpartition("/")[2] for path in paths]
    count = Counter(last)
    return {path: name if count[name] == 1 else path[1:] for path, name in zip(paths, last, strict=True)}


def _to_third(axis: int) -> Array:
    """Axes whose third one is this axis of the frame."""
    return np.eye(3)[:, [(axis + 1) % 3, (axis + 2) % 3, axis]]
