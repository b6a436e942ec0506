"""Frames and units of a stage: rigid bodies and what hangs on them, in metres and kilograms.

A prim is placed by x_world = A x + r, A = R diag(s) with a rotation R and scales s: a point x that is given in it is at
s x times ``metersPerUnit`` in the frame of its rigid body. Of numbers of single precision the shortest decimals count
that they are the nearest ones of: what a text file says.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from decimal import Decimal
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np

from substructures.array import Array
from substructures.interchange.numbers import ZERO
from substructures.interchange.report import Place, Report, refuse
from substructures.interchange.rotations import from_quaternion, turn
from substructures.interchange.usd.stage import package
from substructures.interchange.xml import SHOWN

#: of axes that are to be at right angles, or of quaternions
_RIGHT = 1e-6
_LARGE, _WHOLE = 1e30, 1e15
Prim = Any  #: Usd.Prim


class Pose(NamedTuple):
    """Axes in columns, and origin [m]."""

    R: Array
    r: Array

    def beyond(self, other: Pose) -> Pose:
        """A pose that is given in it."""
        return Pose(self.R @ other.R, self.r + self.R @ other.r)

    @property
    def inverse(self) -> Pose:
        """Of the frame in which it is given, in it."""
        return Pose(self.R.T, -self.R.T @ self.r)


HERE = Pose(np.eye(3), np.zeros(3))


def place_of(prim: Prim) -> Place:
    """The path of a prim."""
    return Place(0, f"<{str(prim.GetPath())[: 3 * SHOWN]}>")


def given(prim: Prim, name: str, kind: Literal["float", "Vec3f", "Quatf", "str", "bool"]) -> Any:
    """The value of an attribute, at the earliest time. Raises InvalidDocument for one of another type, and for none."""
    found = prim.GetAttribute(name).Get(package("Usd").TimeCode.EarliestTime())
    plain: dict[str, Any] = {"float": (float, int), "str": str, "bool": (bool, int)}
    if not isinstance(found, plain.get(kind) or getattr(package("Gf"), kind)):
        raise refuse(place_of(prim), "bad-value", f"{name} is {str(found)[:40]}, and has to be of the type {kind}")
    return found


def written(x: float, place: Place) -> Decimal:
    """A number of a stage, of magnitudes from 1e-30 to 1e30, or zero. Raises InvalidDocument."""
    if not abs(x) < _LARGE:
        raise refuse(place, "bad-number", f"{x} is no number of a mechanism")
    if abs(x) < 1 / _LARGE:
        return ZERO
    if x == int(x) and abs(x) < _WHOLE:
        return Decimal(int(x))
    single = np.float32(x)
    return Decimal(str(single) if float(single) == x else repr(float(x)))


@dataclass(frozen=True)
class Units:
    """``length``: metres of a unit; ``mass``: kilograms; ``up``: axes of the stage in those whose third one is up."""

    length: Decimal
    mass: Decimal
    up: Array

    @classmethod
    def of(cls, stage: Any, report: Report) -> Units:
        """What the root layer says, or else the format: centimetres, and y is up."""
        geom, physics = package("UsdGeom"), package("UsdPhysics")
        length, mass = geom.GetStageMetersPerUnit(stage), physics.GetStageKilogramsPerUnit(stage)
        if not (0 < length < math.inf and 0 < mass < math.inf):
            raise refuse(Place(0, "metersPerUnit"), "bad-value", "metersPerUnit and kilogramsPerUnit are positive")
        if not geom.StageHasAuthoredMetersPerUnit(stage):
            message = f"a length of 1 is {length:g} m, as the format has it where nothing is said"
            report.warning(Place(0, "metersPerUnit"), message)
        up = str(geom.GetStageUpAxis(stage))
        if up not in ("Y", "Z"):
            raise refuse(Place(0, "upAxis"), "bad-value", f"'{up[:20]}' is none of Y, Z")
        is_y = up == "Y"
        if is_y:
            report.merged(Place(0, "upAxis"), "y is up in the file, and z in the part: all is turned about x")
        here = Place(0, "metersPerUnit")
        return cls(written(length, here), written(mass, here), turn(0, math.pi / 2).round() if is_y else np.eye(3))

    def lengths(self, xyz: Iterable[float], place: Place) -> list[float]:
        """In metres."""
        return [float(written(x, place) * self.length) for x in xyz]


class Scene:
    """The prims of a stage, with the rigid body that each of them hangs on."""

    def __init__(self, stage: Any, units: Units) -> None:
        self._usd, self._geom, self._physics = package("Usd"), package("UsdGeom"), package("UsdPhysics")
        self.stage, self.units = stage, units
        self._cache = self._geom.XformCache(self._usd.TimeCode.EarliestTime())
        everything = self._usd.PrimRange.Stage(stage, self._usd.TraverseInstanceProxies())
        self.prims: list[Prim] = list(everything)
        self.bodies = {str(prim.GetPath()): prim for prim in self.prims if self._is_body(prim)}
        self._frames: dict[str, tuple[Pose, Array]] = {}

    def _is_body(self, prim: Prim) -> bool:
        if not prim.HasAPI(self._physics.RigidBodyAPI):
            return False
        return bool(given(prim, "physics:rigidBodyEnabled", "bool"))

    def body_of(self, prim: Prim) -> str | None:
        """The path of the body that a prim is or hangs on; None for what stands still."""
        while prim and not prim.IsPseudoRoot():
            if str(prim.GetPath()) in self.bodies:
                return str(prim.GetPath())
            if self._geom.Xformable(prim) and self._geom.Xformable(prim).GetResetXformStack():
                return None
            prim = prim.GetParent()
        return None

    def frame(self, prim: Prim) -> tuple[Pose, Array]:
        """Where a prim is in the stage, and its scales. Raises InvalidDocument for what is no frame."""
        key = str(prim.GetPath())
        if key not in self._frames:
            M = np.array(self._cache.GetLocalToWorldTransform(prim))
            A, r = M[:3, :3].T, M[3, :3] * float(self.units.length)
            scales = np.linalg.norm(A, axis=0)
            R = A / np.where(scales > 0, scales, 1)
            if not np.abs(M).max() < _LARGE or np.abs(R.T @ R - np.eye(3)).max() > _RIGHT or np.linalg.det(R) < 0:
                message = "its frame is sheared, mirrored or flat: a body needs axes at right angles, right-handed"
                raise refuse(place_of(prim), "no-frame", message)
            self._frames[key] = Pose(_orthonormal(R), r), scales
        return self._frames[key]

    def inside(self, prim: Prim, position: Iterable[float], rotation: Array, place: Place) -> Pose:
        """A frame that is given in a prim, in the body that this hangs on, or in the stage where it stands still.

        ``place``: of what gives it.
        """
        at, scales = self.frame(prim)
        local = Pose(rotation, scales.round(12) * np.array(self.units.lengths(position, place)))
        body = self.body_of(prim)
        if body == str(prim.GetPath()):
            return local
        there = at.beyond(local)
        return there if body is None else self.frame(self.bodies[body])[0].inverse.beyond(there)

    def upright(self, pose: Pose) -> Pose:
        """Of the stage, in the axes of the part."""
        return Pose(self.units.up @ pose.R, self.units.up @ pose.r)

    def below(self, body: str) -> list[Prim]:
        """The prims that hang on a body, itself among them."""
        return self._hanging[body]

    @cached_property
    def _hanging(self) -> dict[str | None, list[Prim]]:
        found: dict[str | None, list[Prim]] = {}
        for prim in self.prims:
            found.setdefault(self.body_of(prim), []).append(prim)
        return found


def rotation_of(quaternion: Any, prim: Prim) -> Array:
    """R of a quaternion as it is written, normalised here. Raises InvalidDocument for zero."""
    wxyz = [float(written(x, place_of(prim))) for x in (quaternion.GetReal(), *quaternion.GetImaginary())]
    if not any(wxyz):
        raise refuse(place_of(prim), "zero-axis", "the quaternion of a frame is zero: (1, 0, 0, 0) does not turn it")
    return from_quaternion(wxyz)


def _orthonormal(R: Array) -> Array:
    """The nearest rotation."""
    U, _, V = np.linalg.svd(R)
    found: Array = U @ V
    return found if np.abs(found - R).max() > 1e-15 else R
