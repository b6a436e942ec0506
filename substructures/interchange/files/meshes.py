"""Triangles of mesh files (STL, OBJ, MuJoCo's MSH), and what a body of such a shape weighs.

For triangles (a, b, c), seen from outside counterclockwise, the tetrahedra from a point o to them have V = (a - o) .
((b - o) x (c - o)) / 6 and sum to a solid of even density: mass, mass centre and the second moments

    integral of x x^T dV = sum V/20 (sum over corners x x^T + (sum of corners)(sum of corners)^T),   corners o, a, b, c

of which the tensor is tr(P) 1 - P. A shell has areas in place of volumes and triangles in place of tetrahedra: the same
with 1/12 and three corners. Source: F. Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor in terms
of its vertex coordinates, J. Math. Stat. 1 (2005) 8-11.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
import scipy
from numpy.typing import NDArray

from substructures.array import Array

Mode = Literal["legacy", "exact", "convex", "shell"]
MODES: tuple[str, ...] = get_args(Mode)
#: most triangles of a file
MOST = 1_000_000
_LEAST = 1e-15  # of a volume in m^3, or an area in m^2


class BadMesh(ValueError):
    """What is wrong with the bytes or the shape of a mesh."""


@dataclass(frozen=True)
class Triangles:
    """``corners`` (n, 3) in m, ``faces`` (m, 3) of their numbers, none where there are points alone; ``others``: how
    many faces further objects of the file have.
    """

    corners: Array
    faces: NDArray[np.integer[Any]]
    others: int = 0


@dataclass(frozen=True)
class Weighed:
    """Of a body of density 1: mass (m^3; of shells m^2), mass centre, tensor about it."""

    volume: float
    centre: Array
    theta: Array


def read_mesh(name: str, data: bytes) -> Triangles:
    """The triangles of a file, by the ending of its name. Raises BadMesh."""
    ending = name.rpartition(".")[2].lower()
    if ending not in _READERS:
        raise BadMesh(f"a mesh of the type '{ending[:20]}' is not read: give STL, OBJ or MSH")
    try:
        found = _READERS[ending](data)
    except (ValueError, IndexError, struct.error) as error:
        raise BadMesh(str(error) if isinstance(error, BadMesh) else f"it cannot be read as {ending.upper()}") from None
    if len(found.faces) > MOST:
        raise BadMesh(f"it has {len(found.faces):,} triangles; the limit is {MOST:,}")
    if not len(found.corners) or not np.isfinite(found.corners).all():
        raise BadMesh("it has no corners, or some that are no numbers")
    if len(found.faces) and not 0 <= found.faces.min() <= found.faces.max() < len(found.corners):
        raise BadMesh("a triangle has a corner that is not there")
    return found


def _stl(data: bytes) -> Triangles:
    count = struct.unpack_from("<I", data, 80)[0] if len(data) >= 84 else -1
    if len(data) == 84 + 50 * count:
        rows = np.frombuffer(data, np.dtype([("normal", "<3f4"), ("corners", "<9f4"), ("more", "<u2")]), count, 84)
        corners = rows["corners"].astype(float).reshape(-1, 3)
    else:
        words = [line.split() for line in data.decode("ascii").splitlines()]
        if not words or words[0][:1] != ["solid"]:
            raise BadMesh("it is neither a binary STL file of the length that it tells, nor one of text")
        corners = np.array([line[1:4] for line in words if line[:1] == ["vertex"]], dtype=float).reshape(-1, 3)
    if len(corners) % 3:
        raise BadMesh("it ends within a triangle")
    return Triangles(corners, np.arange(len(corners)).reshape(-1, 3))


def _obj(data: bytes) -> Triangles:
    """The faces of the first object or group that has some, as MuJoCo takes them, and the corners of all."""
    corners: list[list[str]] = []
    faces: list[tuple[int, int, int]] = []
    others, is_first = 0, True
    for line in data.decode("utf-8", "replace").replace("\\\n", " ").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            corners.append(words[1:4])
        elif words[:1] in (["o"], ["g"]):
            is_first = not faces
        elif words[:1] == ["f"] and not is_first:
            others += 1
        elif words[:1] == ["f"]:
            numbers = [int(word.partition("/")[0]) for word in words[1:]]
            way = [x - 1 if x > 0 else len(corners) + x for x in numbers]
            faces += [(way[0], *pair) for pair in pairwise(way[1:])]
    return Triangles(np.array(corners, dtype=float).reshape(-1, 3), np.array(faces, dtype=int).reshape(-1, 3), others)


def _msh(data: bytes) -> Triangles:
    sizes = struct.unpack_from("<4i", data)
    corners, normals, textures, faces = sizes
    if min(sizes) < 0 or len(data) != 16 + 12 * corners + 12 * normals + 8 * textures + 12 * faces:
        raise BadMesh("it has not the length that it tells")
    found = np.frombuffer(data, "<f4", 3 * corners, 16).astype(float).reshape(-1, 3)
    numbers = np.frombuffer(data, "<i4", 3 * faces, len(data) - 12 * faces)
    return Triangles(found, np.array(numbers, dtype=int).reshape(-1, 3))


_READERS = {"stl": _stl, "obj": _obj, "msh": _msh}


def weighed(mesh: Triangles, mode: str = "exact") -> Weighed:
    """A body of even density of this shape.

    ``mode`` as in MJCF: ``exact`` for a closed surface whose triangles are seen from outside, ``convex`` for the hull
    of the corners, ``shell`` for the surface alone, ``legacy`` as MuJoCo did it first: every tetrahedron to the centre
    counts as if it were filled, so that hollows are too heavy. Points without triangles have their hull. Raises BadMesh
    for what has no volume, and for surfaces that are not closed.
    """
    if mode == "convex" or not len(mesh.faces):
        mesh, mode = _hull(mesh), "exact"
    a, b, c = (mesh.corners[mesh.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    areas = np.linalg.norm(normals, axis=1) / 2
    if areas.sum() < _LEAST:
        raise BadMesh("its triangles have no area")
    middle = areas @ ((a + b + c) / 3) / areas.sum()
    if mode == "shell":
        return _summed(areas, [a - middle, b - middle, c - middle], middle)
    if mode == "exact":
        _require_closed(mesh, areas)
        return _summed(_volumes(a - middle, normals, signed=True), [a - middle, b - middle, c - middle], middle, True)
    rough = _summed(_volumes(a - middle, normals), [a - middle, b - middle, c - middle], middle, True)
    at = rough.centre  # the tetrahedra to it, and all of them as they are filled
    found = _summed(_volumes(a - at, normals), [a - at, b - at, c - at], at, True)
    about = found.theta + found.volume * _parallel(found.centre - at)  # MuJoCo keeps the first centre
    return Weighed(found.volume, at, about)


def _volumes(a: Array, normals: Array, *, signed: bool = False) -> Array:
    found: Array = np.einsum("ij,ij->i", a, normals) / 6
    return found if signed else np.abs(found)


def _summed(weights: Array, corners: list[Array], origin: Array, is_solid: bool = False) -> Weighed:
    """Of simplices: triangles, or tetrahedra whose fourth corner is the origin."""
    total = float(weights.sum())
    if total < _LEAST:
        raise BadMesh("it has no volume, or its triangles are seen from inside" if is_solid else "it has no area")
    count = 4 if is_solid else 3
    sums = sum(corners[1:], corners[0])
    centre = weights @ sums / count / total
    second = sum(np.einsum("i,ij,ik->jk", weights, x, x) for x in (*corners, sums)) / (count * (count + 1))
    theta = np.trace(second) * np.eye(3) - second - total * _parallel(centre)
    return Weighed(total, centre + origin, theta)


def _parallel(r: Array) -> Array:
    found: Array = (r @ r) * np.eye(3) - np.outer(r, r)
    return found


def _require_closed(mesh: Triangles, areas: Array) -> None:
    """Every edge belongs to two triangles that pass along it in opposite ways; corners at one place are one."""
    _, numbers = np.unique(mesh.corners, axis=0, return_inverse=True)
    faces = numbers.reshape(-1)[mesh.faces][areas > 0]
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    there = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ways = there[:, 0] * (faces.max() + 1) + there[:, 1]
    back = there[:, 1] * (faces.max() + 1) + there[:, 0]
    if not np.array_equal(np.sort(ways), np.sort(back)) or len(np.unique(ways)) != len(ways):
        raise BadMesh("its surface is not closed, or not seen from outside everywhere: take inertia='convex'")


def _hull(mesh: Triangles) -> Triangles:
    """The convex hull, seen from outside."""
    try:
        hull = scipy.spatial.ConvexHull(mesh.corners)
    except (scipy.spatial.QhullError, ValueError):
        raise BadMesh("its points have no convex hull with a volume") from None
    a, b, c = (hull.points[hull.simplices[:, k]] for k in range(3))
    is_inside = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces = np.where(is_inside[:, None], hull.simplices[:, ::-1], hull.simplices)
    return Triangles(hull.points, faces)


def changed(mesh: Triangles, scale: Array, position: Array, R: Array) -> Triangles:
    """Corners S R^T (x - r): in the frame at r with axes R, then scaled; mirrored triangles are turned round."""
    corners = (mesh.corners - position) @ R * scale
    faces = mesh.faces[:, ::-1] if float(np.prod(scale)) < 0 else mesh.faces
    return Triangles(corners, faces)


def paths_of(file: str, *folders: str) -> Iterator[str]:
    """Where a file may lie among those given beside: in a folder that is told, as it is written, or flat."""
    name = file.replace("\\", "/")
    for folder in folders:
        if folder:
            yield f"{folder.replace(chr(92), '/').rstrip('/')}/{name}"
    yield name
    yield name.rpartition("/")[2]
