"""Vectors and tensors of three-dimensional space over any scalar that can add, subtract and multiply.

A vector is a tuple of three scalars, a matrix a tuple of three rows, a symmetric tensor the six entries
``(xx, yy, zz, xy, xz, yz)``. What a scalar is, :class:`Scalar` says.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol


class Scalar(Protocol):
    """What the mechanics computes with: anything that can be added, subtracted, multiplied and negated.

    An :class:`~substructures.expr.graph.Expr`, a float, a numpy array (all states at once), the array scalars of
    :mod:`substructures.quantities.numbers.array_scalars`. Each kind takes the integers of the formulas (0, 1, 2) on
    either side and, as the result of a product, the integer 0 may stand for it: zeros and ones need no kind of their
    own, and 0 and 1 of a frame or an axis fold away. Two kinds other than integers need not go together (a formula
    takes no float), which is why operands are not checked here: a run is over one kind.
    """

    def __add__(self, other: Any, /) -> Scalar:
        """self + other."""

    def __radd__(self, other: Any, /) -> Scalar:
        """other + self."""

    def __sub__(self, other: Any, /) -> Scalar:
        """self - other."""

    def __rsub__(self, other: Any, /) -> Scalar:
        """other - self."""

    def __mul__(self, other: Any, /) -> Scalar:
        """self other."""

    def __rmul__(self, other: Any, /) -> Scalar:
        """other self."""

    def __neg__(self) -> Scalar:
        """-self."""


Vector = tuple[Scalar, Scalar, Scalar]
Matrix = tuple[Vector, Vector, Vector]
Symmetric = tuple[Scalar, Scalar, Scalar, Scalar, Scalar, Scalar]

ZERO: Vector = (0, 0, 0)
E3: Vector = (0, 0, 1)
IDENTITY: Matrix = ((1, 0, 0), (0, 1, 0), (0, 0, 1))
ZERO6: Symmetric = (0, 0, 0, 0, 0, 0)
#: position of entry (i, j) in the six entries of a symmetric tensor
SYMMETRIC_INDEX = ((0, 3, 4), (3, 1, 5), (4, 5, 2))


def exactly(x: Scalar, n: int) -> bool:
    """True when a scalar is known to be this integer (a number, or an expression that is one)."""
    value = getattr(x, "value", x)
    return isinstance(value, int) and value == n


def add(a: Vector, b: Vector) -> Vector:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def sub(a: Vector, b: Vector) -> Vector:
    """a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def negate(a: Vector) -> Vector:
    """-a."""
    return -a[0], -a[1], -a[2]


def scale(c: Scalar, a: Vector) -> Vector:
    """c a."""
    return c * a[0], c * a[1], c * a[2]


def dot(a: Vector, b: Vector) -> Scalar:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def skew(a: Vector) -> Matrix:
    """The matrix of b -> a x b."""
    return (0, -a[2], a[1]), (a[2], 0, -a[0]), (-a[1], a[0], 0)


def apply(m: Matrix, v: Vector) -> Vector:
    """m v."""
    return dot(m[0], v), dot(m[1], v), dot(m[2], v)


def transpose(m: Matrix) -> Matrix:
    """m^T."""
    return (m[0][0], m[1][0], m[2][0]), (m[0][1], m[1][1], m[2][1]), (m[0][2], m[1][2], m[2][2])


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """a b."""
    x, y, z = transpose(b)
    rows = [(dot(row, x), dot(row, y), dot(row, z)) for row in a]
    return rows[0], rows[1], rows[2]


def subtract(a: Matrix, b: Matrix) -> Matrix:
    """a - b."""
    return sub(a[0], b[0]), sub(a[1], b[1]), sub(a[2], b[2])


def dense(j: Symmetric) -> Matrix:
    """The full matrix of a symmetric tensor."""
    return (j[0], j[3], j[4]), (j[3], j[1], j[5]), (j[4], j[5], j[2])


def packed(m: Matrix) -> Symmetric:
    """The six entries of a symmetric matrix (its upper triangle)."""
    return m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]


def add6(a: Symmetric, b: Symmetric) -> Symmetric:
    """Sum of two symmetric tensors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]


@dataclass(frozen=True, slots=True)
class Planar:
    """Passive rotation about a frame axis (0, 1 or 2): v -> v', components in the frame turned by the angle."""

    axis: int
    c: Scalar
    s: Scalar

    def forward(self, v: Vector) -> Vector:
        """Components in the turned frame."""
        # v'_i = c v_i + s v_j,   v'_j = c v_j - s v_i
        i, j = (self.axis + 1) % 3, (self.axis + 2) % 3
        out = list(v)
        out[i], out[j] = self.c * v[i] + self.s * v[j], self.c * v[j] - self.s * v[i]
        return out[0], out[1], out[2]

    def back(self, v: Vector) -> Vector:
        """Components in the original frame."""
        # the same with -s
        i, j = (self.axis + 1) % 3, (self.axis + 2) % 3
        out = list(v)
        out[i], out[j] = self.c * v[i] - self.s * v[j], self.c * v[j] + self.s * v[i]
        return out[0], out[1], out[2]

    def back_tensor(self, t: Symmetric) -> Symmetric:
        """E^T t E."""
        # w = s (t_ii - t_jj) + 2 c t_ij:   ii - s w,   jj + s w,   ij -> c w - t_ij
        i, j, k = (self.axis + 1) % 3, (self.axis + 2) % 3, self.axis
        ij, ik, jk = SYMMETRIC_INDEX[i][j], SYMMETRIC_INDEX[i][k], SYMMETRIC_INDEX[j][k]
        w = self.s * (t[i] - t[j]) + self.c * (2 * t[ij])
        sw = self.s * w
        out = list(t)
        out[i], out[j], out[ij] = t[i] - sw, t[j] + sw, self.c * w - t[ij]
        out[ik], out[jk] = self.c * t[ik] - self.s * t[jk], self.c * t[jk] + self.s * t[ik]
        return out[0], out[1], out[2], out[3], out[4], out[5]

    def back_matrix(self, t: Matrix) -> Matrix:
        """E^T t E for any matrix t."""
        # w = s (t_ii - t_jj) + c (t_ij + t_ji):   ii - s w,   jj + s w,   ij -> c w - t_ji,   ji -> c w - t_ij
        i, j, k = (self.axis + 1) % 3, (self.axis + 2) % 3, self.axis
        w = self.s * (t[i][i] - t[j][j]) + self.c * (t[i][j] + t[j][i])
        cw, sw = self.c * w, self.s * w
        out = [list(row) for row in t]
        out[i][i], out[j][j], out[i][j], out[j][i] = t[i][i] - sw, t[j][j] + sw, cw - t[j][i], cw - t[i][j]
        # the row and the column of the axis are vectors
        out[i][k], out[j][k] = self.c * t[i][k] - self.s * t[j][k], self.c * t[j][k] + self.s * t[i][k]
        out[k][i], out[k][j] = self.c * t[k][i] - self.s * t[k][j], self.c * t[k][j] + self.s * t[k][i]
        x, y, z = ((row[0], row[1], row[2]) for row in out)
        return x, y, z

    def matrix(self) -> Matrix:
        """E, with v' = E v."""
        return transpose((self.forward((1, 0, 0)), self.forward((0, 1, 0)), self.forward((0, 0, 1))))


@dataclass(frozen=True, slots=True)
class Turn:
    """Any rotation by its matrix E; same methods as :class:`Planar`."""

    e: Matrix

    def forward(self, v: Vector) -> Vector:
        """E v."""
        return apply(self.e, v)

    def back(self, v: Vector) -> Vector:
        """E^T v."""
        return apply(transpose(self.e), v)

    def back_tensor(self, t: Symmetric) -> Symmetric:
        """E^T t E."""
        # columns of t E, then E^T times them, upper triangle only
        x, y, z = transpose(multiply(dense(t), self.e))
        ex, ey, ez = transpose(self.e)
        return dot(ex, x), dot(ey, y), dot(ez, z), dot(ex, y), dot(ex, z), dot(ey, z)

    def back_matrix(self, t: Matrix) -> Matrix:
        """E^T t E for any matrix t."""
        return multiply(transpose(self.e), multiply(t, self.e))

    def matrix(self) -> Matrix:
        """E."""
        return self.e


def _keeps_line_of_third_axis(factor: Planar | Turn) -> bool:
    if isinstance(factor, Planar) and factor.axis == 2:
        return True
    x, y, z = factor.back(E3)
    return exactly(x, 0) and exactly(y, 0) and (exactly(z, 1) or exactly(z, -1))


@dataclass(frozen=True, slots=True)
class Rotation:
    """A product of rotations, first factor applied first: v' = E_n ... E_1 v."""

    factors: tuple[Planar | Turn, ...] = ()

    @property
    def is_planar(self) -> bool:
        """True when all factors turn about axes of the frame."""
        return all(isinstance(factor, Planar) for factor in self.factors)

    @property
    def keeps_third_axis(self) -> bool:
        """True when all factors are known to turn about the third axis."""
        return all(isinstance(factor, Planar) and factor.axis == 2 for factor in self.factors)

    @property
    def keeps_line_of_third_axis(self) -> bool:
        """True when all factors are known to leave the third axis parallel to itself, in either direction."""
        return all(_keeps_line_of_third_axis(factor) for factor in self.factors)

    def forward(self, v: Vector) -> Vector:
        """E v: components in the child frame of a vector given in the parent frame."""
        for factor in self.factors:
            v = factor.forward(v)
        return v

    def back(self, v: Vector) -> Vector:
        """E^T v: components in the parent frame of a vector given in the child frame."""
        for factor in reversed(self.factors):
            v = factor.back(v)
        return v

    def back_tensor(self, t: Symmetric) -> Symmetric:
        """E^T t E for a symmetric tensor."""
        for factor in reversed(self.factors):
            t = factor.back_tensor(t)
        return t

    def back_matrix(self, t: Matrix) -> Matrix:
        """E^T t E for any matrix t."""
        for factor in reversed(self.factors):
            t = factor.back_matrix(t)
        return t

    def matrix(self) -> Matrix:
        """E as a matrix."""
        # row i of E is E^T e_i
        rows = [self.back(axis) for axis in IDENTITY]
        return rows[0], rows[1], rows[2]
