"""Rotations and inertias of files as doubles: roll, pitch, yaw, quaternions, Euler sequences; R I R^T, Steiner.

A rotation R turns components in the placed frame into components in the frame in which it is placed (URDF, SDF, MJCF).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from substructures.array import Array
from substructures.interchange.numbers import ANGLE_TOLERANCE, Number, Triple, angle, cleaned, decimal_of, value

#: below this |cos(pitch)| only the sum or difference of yaw and roll is known
_GIMBAL = ANGLE_TOLERANCE


def turn(axis: int, by: float) -> Array:
    """The rotation about a coordinate axis."""
    c, s = math.cos(by), math.sin(by)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[i, i], R[i, j], R[j, i], R[j, j] = c, -s, s, c
    return R


def from_rpy(rpy: Triple) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll)."""
    roll, pitch, yaw = map(value, rpy)
    return turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)


def to_rpy(R: Array) -> Triple:
    """Roll, pitch, yaw of a rotation, as exact multiples of pi / 12 where they are such."""
    across = math.hypot(R[0, 0], R[1, 0])
    pitch = math.atan2(-R[2, 0], across)
    if across < _GIMBAL:  # yaw is taken as 0
        roll, yaw = math.atan2(-R[1, 2], R[1, 1]), 0.0
    else:
        roll = math.atan2(R[2, 1], R[2, 2])
        # of R Rx(-roll) = Rz(yaw) Ry(pitch): what rounding does to roll where |cos(pitch)| is small, yaw takes back
        y = math.cos(roll) * R[:, 1] - math.sin(roll) * R[:, 2]
        yaw = math.atan2(-y[0], y[1])
    return angle(decimal_of(roll)), angle(decimal_of(pitch)), angle(decimal_of(yaw))


def from_quaternion(wxyz: Sequence[float]) -> Array:
    """Of (w, x, y, z), normalised here."""
    w, x, y, z = np.asarray(wxyz, dtype=float) / np.linalg.norm(wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def from_axis_angle(axis: Sequence[float], by: float) -> Array:
    """Rodrigues' formula; the axis is normalised here."""
    n = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    K = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    return np.eye(3) + math.sin(by) * K + (1 - math.cos(by)) * (K @ K)


def from_z_axis(z: Sequence[float]) -> Array:
    """The least rotation that turns the third axis into z."""
    n = np.asarray(z, dtype=float) / np.linalg.norm(z)
    axis = (-float(n[1]), float(n[0]), 0.0)  # e3 x n
    s = math.hypot(*axis)
    if s < 1e-15:
        return np.eye(3) if n[2] > 0 else turn(0, math.pi)
    return from_axis_angle(axis, math.atan2(s, n[2]))


def tensor(six: Sequence[float]) -> Array:
    """The matrix of (xx, yy, zz, xy, xz, yz)."""
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def six_of(theta: Array) -> tuple[float, ...]:
    """(xx, yy, zz, xy, xz, yz) of a matrix."""
    return tuple(float(theta[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))


def turned_inertia(six: tuple[Number, ...], R: Array) -> tuple[Number, ...]:
    """R I R^T, both as (xx, yy, zz, xy, xz, yz); I itself where R does not turn."""
    if np.array_equal(R, np.eye(3)):
        return six
    return cleaned(six_of(R @ tensor([value(x) for x in six]) @ R.T))


def steiner(mass: float, r: Array) -> Array:
    """m (r.r 1 - r r^T): what the inertia tensor about a point at -r has more than about the mass centre."""
    return mass * (float(r @ r) * np.eye(3) - np.outer(r, r))
