"""Vectors and rotations in ball arithmetic: matrices of python-flint, whose entries contain the exact values.

A vector is a 3 x 1 matrix. A rotation ``A`` has the axes of a frame as its columns: from components there to components
here.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from flint import arb, arb_mat

#: an ``arb``, and an ``arb_mat``; python-flint has no types
Ball = Any
Matrix = Any


_IDENTITY = arb_mat(3, 3, [1, 0, 0, 0, 1, 0, 0, 0, 1])
_AXES = tuple(arb_mat(3, 1, [int(axis == i) for i in range(3)]) for axis in range(3))


def vector(x: Ball, y: Ball, z: Ball) -> Matrix:
    """Three components."""
    return arb_mat(3, 1, [x, y, z])


def zeros(rows: int, columns: int) -> Matrix:
    """A matrix of zeros."""
    return arb_mat(rows, columns)


def identity() -> Matrix:
    """The 3 x 3 unit matrix, which is not to be changed."""
    return _IDENTITY


def unit(axis: int) -> Matrix:
    """The first, second or third axis, which is not to be changed."""
    return _AXES[axis]


def skew(a: Matrix) -> Matrix:
    """skew(a) b = a x b."""
    x, y, z = a.entries()
    zero = arb(0)
    return arb_mat(3, 3, [zero, -z, y, z, zero, -x, -y, x, zero])


def cross(a: Matrix, b: Matrix) -> Matrix:
    """a x b."""
    return skew(a) * b


def dot(a: Matrix, b: Matrix) -> Ball:
    """a . b."""
    return (a.transpose() * b)[0, 0]


def outer(a: Matrix, b: Matrix) -> Matrix:
    """a b^T."""
    return a * b.transpose()


def side_by_side(vectors: Iterable[Matrix]) -> Matrix:
    """Vectors as the columns of one matrix."""
    some = [v.entries() for v in vectors]
    return arb_mat(3, len(some), [v[i] for i in range(3) for v in some])


_RENAMED = tuple(side_by_side(_AXES[(axis + 1 + i) % 3] for i in range(3)) for axis in range(3))


def column(matrix: Matrix, j: int) -> Matrix:
    """A column of a matrix of three rows."""
    return vector(matrix[0, j], matrix[1, j], matrix[2, j])


def turn(axis: int, angle: Ball) -> Matrix:
    """Rotation about a frame axis, right-handed."""
    c, s = angle.cos(), angle.sin()
    i, j = (axis + 1) % 3, (axis + 2) % 3
    result = arb_mat(3, 3)
    result[axis, axis] = arb(1)
    result[i, i], result[i, j], result[j, i], result[j, j] = c, -s, s, c
    return result


def roll_pitch_yaw(angles: Matrix) -> Matrix:
    """Rz(yaw) Ry(pitch) Rx(roll): turned about fixed axes, roll first (URDF); not to be changed."""
    roll, pitch, yaw = angles.entries()
    if roll == 0 and pitch == 0 and yaw == 0:
        return _IDENTITY
    return turn(2, yaw) * turn(1, pitch) * turn(0, roll)


def onto_third_axis(axis: int) -> Matrix:
    """The frame, as a rotation, whose third axis is a frame axis: the axes renamed in their cyclic order; not to be
    changed.
    """
    return _RENAMED[axis]


def with_third_axis(direction: Matrix) -> Matrix:
    """The frame, as a rotation, whose third axis has a direction.

    Along a frame axis: the axes renamed (against it: turned half round about the new first axis). Otherwise the first
    axis is e_i x direction, normalised, for the frame axis i that is least aligned with it.
    """
    given = direction.entries()
    (largest, *rest) = sorted(range(3), key=lambda i: -abs(given[i].mid()))
    if all(given[i].contains(0) for i in rest):
        renamed = onto_third_axis(largest)
        return renamed if given[largest] > 0 else renamed * arb_mat(3, 3, [1, 0, 0, 0, -1, 0, 0, 0, -1])
    # of components that are equal, however they are written, the first
    sizes = [abs(x.mid()) for x in given]
    smallest = next(i for i, size in enumerate(sizes) if not size > min(sizes) * (1 + arb(2) ** -80))
    third = direction / dot(direction, direction).sqrt()
    first = cross(unit(smallest), third)
    first = first / dot(first, first).sqrt()
    return side_by_side((first, cross(third, first), third))


def quaternion_product(p: Sequence[Ball], q: Sequence[Ball]) -> tuple[Ball, Ball, Ball, Ball]:
    """p q of quaternions (w, x, y, z)."""
    (a, b, c, d), (e, f, g, h) = p, q
    return (
        a * e - b * f - c * g - d * h,
        a * f + b * e + c * h - d * g,
        a * g - b * h + c * e + d * f,
        a * h + b * g - c * f + d * e,
    )


def turn_of(quaternion: Sequence[Ball]) -> Matrix:
    """The matrix whose columns are Q e_i Q^-1."""
    w, x, y, z = quaternion
    zero, one = arb(0), arb(1)
    norm = sum((q * q for q in quaternion), zero)
    back = w / norm, -x / norm, -y / norm, -z / norm
    axes = (zero, one, zero, zero), (zero, zero, one, zero), (zero, zero, zero, one)
    columns = [quaternion_product(quaternion_product(quaternion, e), back)[1:] for e in axes]
    return arb_mat(3, 3, [column[i] for i in range(3) for column in columns])
