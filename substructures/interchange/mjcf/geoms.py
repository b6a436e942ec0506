"""Masses and inertia tensors of geoms: homogeneous spheres, capsules, cylinders, ellipsoids, boxes and meshes.

About its own centre, with mass m, radius r, half length h (height H = 2 h), half axes a, b, c:

    sphere      V = 4/3 pi r^3              2/5 m r^2
    capsule     V = pi r^2 H + 4/3 pi r^3   cylinder and two half spheres, whose mass is m 4 r / (4 r + 3 H)
    cylinder    V = pi r^2 H                m (3 r^2 + H^2) / 12 across, m r^2 / 2 along
    ellipsoid   V = 4/3 pi a b c            m (b^2 + c^2) / 5, ...
    box         V = 8 a b c                 m (b^2 + c^2) / 3, ...

With ``shellinertia`` the surface alone has mass, evenly, of a density in kg/m^2:

    sphere      A = 4 pi r^2                2/3 m r^2
    capsule     A = 2 pi r H + 4 pi r^2     tube and two half spheres
    cylinder    A = 2 pi r H + 2 pi r^2     tube and two discs
    box         A = 8 (a b + b c + c a)     of the faces across x: m (b^2 + c^2) / 3 and m (a^2 + b^2 / 3), ...
    tube        A = 2 pi r H                m (6 r^2 + H^2) / 12 across, m r^2 along

The surface of an ellipsoid has no closed formula. As MuJoCo has it, its area is K. Thomsen's approximation (wrong by at
most 1.1 %), and its tensor is that of a solid whose half axes are longer by 1e-6 m, without the one within:

    ellipsoid   A = 4 pi (((a b)^p + (b c)^p + (c a)^p) / 3)^(1/p), p = 1.6075

Source: MuJoCo's user_objects.cc (GetVolume, SetInertia); https://www.numericana.com/answer/ellipsoid.htm#thomsen
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction

import numpy as np

from substructures.array import Array
from substructures.interchange.mjcf.meshes import Meshes, UnknownMass
from substructures.interchange.mjcf.settings import Compiler, choice, orientation
from substructures.interchange.numbers import ORIGIN, ZERO, value
from substructures.interchange.report import refuse
from substructures.interchange.rotations import from_z_axis
from substructures.interchange.xml import Node

DENSITY = Decimal(1000)
_SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
_MASSLESS = ("plane", "hfield")
#: of shells of ellipsoids: Thomsen's exponent, and how thick they are [m]
_EXPONENT, _THICKNESS = 1.6075, Fraction(1, 10**6)


@dataclass(frozen=True)
class Mass:
    """A rigid body in the frame of another: mass, mass centre, tensor about it in the axes of that frame."""

    m: float
    com: Array
    theta: Array
    size: float = 0.0  #: of the places that the mass centre was computed of


def mass_of(geom: Node, compiler: Compiler, meshes: Meshes) -> Mass | None:
    """The mass of a geom, None where it has none. Raises UnknownMass for a mesh whose file is not here."""
    kind = geom.attributes.get("type", "mesh" if "mesh" in geom.attributes else "sphere")
    low, high = compiler.inertiagrouprange
    given = "mass" in geom.attributes
    mass, density = (value(geom.number(name, x)) for name, x in (("mass", ZERO), ("density", DENSITY)))
    if kind in _MASSLESS or not low <= value(geom.number("group", ZERO)) <= high or not (mass if given else density):
        return None
    shell = "shellinertia" in geom.attributes and choice(geom, "shellinertia", ("false", "true")) == "true"
    if shell and kind == "mesh":
        message = "shellinertia is not of mesh geoms: give the <mesh> inertia='shell'"
        raise UnknownMass(refuse(geom.place, "shell", message).faults)
    if kind == "mesh":
        found = meshes.of(geom)
        m = mass if given else density * found.volume
        R, position = orientation(geom, compiler), np.array([value(x) for x in geom.numbers("pos", 3, ORIGIN)])
        return _positive(geom, Mass(m, position + R @ found.centre, R @ found.theta @ R.T * (m / found.volume)))
    if kind not in _SIZES or "mesh" in geom.attributes:
        message = f"a {kind[:20]} fitted to a mesh is not read: give its size, or the body an <inertial>"
        raise UnknownMass(refuse(geom.place, "mesh-inertia", message).faults)
    size, centre, R = _placed(geom, kind, compiler)
    volume, unit = (_shell if shell else _shape)(kind, *size)
    m = mass if given else density * volume
    return _positive(geom, Mass(m, centre, R @ np.diag(unit) @ R.T * m))


def _positive(geom: Node, mass: Mass) -> Mass:
    if mass.m < 0:
        raise refuse(geom.place, "negative-mass", f"the mass {mass.m:g} kg is negative")
    return mass


def _placed(geom: Node, kind: str, compiler: Compiler) -> tuple[list[float], Array, Array]:
    """Sizes, centre and axes; by the ends of the third axis (fromto) or by position and orientation."""
    sizes = [value(x) for x in geom.numbers("size", None, ())]
    needed = _SIZES[kind]
    if "fromto" in geom.attributes and kind != "sphere":
        ends = np.array([value(x) for x in geom.numbers("fromto", 6)])
        start, end = ends[:3], ends[3:]
        length = float(np.linalg.norm(end - start))
        if length < 1e-12:
            raise refuse(geom.place, "zero-length", "the ends of fromto are one point")
        _require(geom, sizes[:1], 1)
        # the first size counts for both axes across
        return [sizes[0]] * (needed - 1) + [length / 2], (start + end) / 2, from_z_axis(start - end)
    _require(geom, sizes[:needed], needed)
    centre = np.array([value(x) for x in geom.numbers("pos", 3, ORIGIN)])
    return sizes[:needed], centre, orientation(geom, compiler)


def _require(geom: Node, sizes: list[float], count: int) -> None:
    if len(sizes) < count or not all(x > 0 for x in sizes):
        raise refuse(geom.place, "bad-size", f"size needs {count} positive numbers")


def _shape(kind: str, a: float, b: float = 0, c: float = 0) -> tuple[float, list[float]]:
    """Volume, and moments of inertia of a mass of 1 kg."""
    if kind == "sphere":
        return 4 / 3 * math.pi * a**3, [0.4 * a * a] * 3
    if kind == "box":
        return 8 * a * b * c, [(b * b + c * c) / 3, (a * a + c * c) / 3, (a * a + b * b) / 3]
    if kind == "ellipsoid":
        return 4 / 3 * math.pi * a * b * c, [(b * b + c * c) / 5, (a * a + c * c) / 5, (a * a + b * b) / 5]
    height = 2 * b
    across, along = (3 * a * a + height**2) / 12, a * a / 2
    if kind == "cylinder":
        return math.pi * a * a * height, [across, across, along]
    balls = 4 * a / (4 * a + 3 * height)
    ball = 0.4 * a * a
    across = (1 - balls) * across + balls * (ball + height * (3 * a + 2 * height) / 8)
    along = (1 - balls) * along + balls * ball
    return math.pi * (a * a * height + 4 / 3 * a**3), [across, across, along]


def _shell(kind: str, a: float, b: float = 0, c: float = 0) -> tuple[float, list[float]]:
    """Area, and moments of inertia of a surface of 1 kg."""
    if kind == "sphere":
        return 4 * math.pi * a**2, [2 / 3 * a * a] * 3
    if kind == "ellipsoid":
        return _ellipsoid_shell(a, b, c)
    if kind == "box":
        sides = (a, b, c)
        parts = []
        for i, side in enumerate(sides):
            squares = [x * x / 3 for x in sides]
            squares[i] *= 3
            parts.append((8 * a * b * c / side, [sum(squares) - x for x in squares]))
    else:
        tube = (a * a / 2 + b * b / 3, a * a)
        across, along = (
            (2 / 3 * a * a + b * b + a * b, 2 / 3 * a * a) if kind == "capsule" else (a * a / 4 + b * b, a * a / 2)
        )
        ends = (4 if kind == "capsule" else 2) * math.pi * a * a
        parts = [(4 * math.pi * a * b, [tube[0], tube[0], tube[1]]), (ends, [across, across, along])]
    area = sum(part for part, _ in parts)
    return area, [sum(part * moments[i] for part, moments in parts) / area for i in range(3)]


def _ellipsoid_shell(*axes: float) -> tuple[float, list[float]]:
    """Area and moments of an ellipsoid's shell of 1 kg, as MuJoCo has them, but for its rounding."""
    products = [math.prod(axes) / x for x in axes]
    area = 4 * math.pi * (sum(x**_EXPONENT for x in products) / 3) ** (1 / _EXPONENT)
    inner = [Fraction(x) for x in axes]
    outer = [x + _THICKNESS for x in inner]
    volume = math.prod(outer) - math.prod(inner)
    second = [
        (math.prod(outer) * x**2 - math.prod(inner) * y**2) / volume / 5 for x, y in zip(outer, inner, strict=True)
    ]
    return area, [float(sum(second) - x) for x in second]


def summed(masses: list[Mass]) -> Mass | None:
    """All of them as one, about the common mass centre."""
    m = sum(one.m for one in masses)
    if not m:
        return None
    com = sum((one.m * one.com for one in masses), np.zeros(3)) / m
    theta = np.zeros((3, 3))
    for one in masses:
        r = one.com - com
        theta += one.theta + one.m * ((r @ r) * np.eye(3) - np.outer(r, r))
    return Mass(m, com, theta, max(float(np.abs(one.com).max()) for one in masses))
