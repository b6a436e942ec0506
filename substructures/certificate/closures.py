"""Closures of loops at one state: residuals, and what one and two derivatives by time make of them (notation.md,
section 10). Everything is a product of points and directions of two frames A and B in the axes of the world."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from substructures.certificate.bodies import GROUND, NONE, Bodies, Frame
from substructures.certificate.dynamics import Motion, motions
from substructures.certificate.linear import (
    Ball,
    Matrix,
    column,
    cross,
    dot,
    identity,
    roll_pitch_yaw,
    unit,
    with_third_axis,
    zeros,
)
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs

PLACE = ("x", "y", "z")
ROWS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("pin", "revolute"), ("x", "y", "z", "rx", "ry")),
    **dict.fromkeys(("slider", "prismatic"), ("x", "y", "rx", "ry", "rz")),
    **dict.fromkeys(("ball", "spherical"), ("x", "y", "z")),
    **dict.fromkeys(("weld", "fixed"), ("x", "y", "z", "rx", "ry", "rz")),
    "cylindrical": ("x", "y", "rx", "ry"),
    "universal": ("x", "y", "z", "cross"),
    "planar": ("z", "rx", "ry"),
    "rod": ("length",),
}
#: residual = sign * (axis of B) . (axis of A), and the axis of both that a row makes parallel
TURNS = {"rx": (-1, 2, 1, 2), "ry": (1, 2, 0, 2), "rz": (1, 0, 1, 0), "cross": (1, 1, 2, None)}


@dataclass(frozen=True)
class _Vector:
    """A vector, its change for every q'^a = 1, and its second derivative by time at q'' = 0; and the first."""

    value: Matrix
    slopes: dict[int, Matrix]
    rate: Matrix
    second: Matrix

    def dot(self, other: _Vector) -> tuple[Ball, dict[int, Ball], Ball]:
        """Value, derivatives by q^a and second derivative by time of the scalar product."""
        none = zeros(3, 1)
        slopes = {
            a: dot(self.slopes.get(a, none), other.value) + dot(self.value, other.slopes.get(a, none))
            for a in {**self.slopes, **other.slopes}
        }
        second = dot(self.second, other.value) + 2 * dot(self.rate, other.rate) + dot(self.value, other.second)
        return dot(self.value, other.value), slopes, second

    def minus(self, other: _Vector) -> _Vector:
        """The difference."""
        slopes = dict(self.slopes)
        for a, u in other.slopes.items():
            slopes[a] = slopes[a] - u if a in slopes else -u
        return _Vector(self.value - other.value, slopes, self.rate - other.rate, self.second - other.second)


def closure_outputs(
    result: Outputs, bodies: Bodies, closures: Sequence[tuple[Plain, Numbers]], rates: Sequence[Ball]
) -> None:
    """The outputs ``closure.*`` of the rows of all closures in order, each with the numbers that it is given in."""
    moving = motions(bodies, rates)
    rows = [row for closure, numbers in closures for row in _rows(bodies, moving, closure, numbers)]
    m, n = len(rows), len(bodies.joints)
    for name, shape in (("residual", (m,)), ("jacobian", (m, n)), ("acceleration", (m,)), ("alignment", (m,))):
        result.array(f"closure.{name}", shape)
    for k, (residual, slopes, second, direction, alignment) in enumerate(rows):
        result["closure.residual"].entries[(k,)] = residual
        result["closure.jacobian"].entries.update({(k, a): x for a, x in slopes.items()})
        result["closure.acceleration"].entries[(k,)] = second
        result.matrix("closure.direction", (m, 3), (k,), direction)
        result["closure.alignment"].entries[(k,)] = alignment


_Row = tuple[Ball, dict[int, Ball], Ball, Matrix, Ball]


def _rows(bodies: Bodies, moving: dict[int, Motion], closure: Plain, numbers: Numbers) -> list[_Row]:
    axis = with_third_axis(numbers.vector(closure["axis"])) if "axis" in closure else identity()
    end = closure.get("to", "world")
    place = closure.get("placement", {})
    world = Frame(GROUND, identity(), zeros(3, 1))
    A = bodies.frames[closure["from"]].placed(axis, zeros(3, 1))
    B = world if end == "world" else bodies.frames[end]
    turned = roll_pitch_yaw(numbers.vector(place.get("rpy", NONE)))
    B = B.placed(turned * axis, numbers.vector(place.get("position", NONE)))
    a = [_direction(bodies, moving, A, column(A.A, i)) for i in range(3)]
    b = [_direction(bodies, moving, B, column(B.A, i)) for i in range(3)]
    D = _point(bodies, moving, B).minus(_point(bodies, moving, A))
    length = numbers.read(closure["length"]) if "length" in closure else None
    return [_row(name, a, b, D, (A.A.transpose(), axis), length) for name in ROWS[closure["type"]]]


def _row(
    name: str, a: list[_Vector], b: list[_Vector], D: _Vector, turned: tuple[Matrix, Matrix], length: Ball | None
) -> _Row:
    """A row: residual, Jacobian, G' q', direction of its multiplier in the axes of ``from``, alignment.

    ``turned``: from the world to A, whose third axis is the joint axis, and from there to the axes of ``from``.
    """
    to_A, back = turned
    if length is not None:
        # (D . D - L^2) / (2 L)
        value, slopes, second = D.dot(D)
        half = 1 / (2 * length)
        residual = (value - length * length) * half
        return residual, {c: x * half for c, x in slopes.items()}, second * half, back * to_A * D.value / length, arb(0)
    if name in PLACE:
        i = PLACE.index(name)
        return *a[i].dot(D), back * unit(i), arb(0)
    sign, j, i, aligned = TURNS[name]
    value, slopes, second = b[j].dot(a[i])
    direction = back * cross(to_A * b[j].value, unit(i)) * sign
    alignment = arb(0) if aligned is None else dot(b[aligned].value, a[aligned].value)
    return sign * value, {c: sign * x for c, x in slopes.items()}, sign * second, direction, alignment


def _direction(bodies: Bodies, moving: dict[int, Motion], frame: Frame, e: Matrix) -> _Vector:
    slopes = {c: cross(bodies.joints[c].w, e) for c in bodies.path(frame.carrier)}
    return _Vector(e, slopes, *moving[frame.carrier].turned(e))


def _point(bodies: Bodies, moving: dict[int, Motion], frame: Frame) -> _Vector:
    motion, p = moving[frame.carrier], frame.p
    slopes = {c: bodies.joints[c].v + cross(bodies.joints[c].w, p) for c in bodies.path(frame.carrier)}
    return _Vector(p, slopes, motion.velocity(p), motion.acceleration(p))
