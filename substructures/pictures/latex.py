"""The picture of a tree in LaTeX's own picture environment, which needs no packages but ``color``."""

from __future__ import annotations

from collections.abc import Mapping
from math import cos, pi, radians, sin
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.part.part import Part
from substructures.pictures.plane import HEIGHT, WIDTH, Ellipse
from substructures.pictures.tree import COLOURS, projected
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

#: points that a line and a piece of an outline are drawn of, so that the memory of TeX is enough
DOTS, ARC = 120, 40
#: pieces of the outline of a body
PIECES = 8


def latex_picture(spec: TreeSpec, parts: Mapping[str, Part], model: Model, q: Any = None) -> str:
    """A ``picture`` environment, 320 x 240 points: bodies are outlines of ellipsoids of inertia on links, joints
    circles or squares, as in the SVG.

    Needs the package ``color``. Raises InvalidDocument for a wrong ``q``.
    """
    found = projected(spec, parts, model, q)
    lines = [rf"\begin{{picture}}({WIDTH:g},{HEIGHT:g})"]
    lines += [rf"\definecolor{{part{i}}}{{rgb}}{{{_rgb(colour)}}}" for i, colour in enumerate(COLOURS)]
    for a, b, i in found.lines:
        lines.append(_coloured(i, rf"\linethickness{{2pt}}{_line(_up(a), _up(b))}"))
    lines += [_coloured(body.colour, rf"\thinlines {_outline(body)}") for body in found.bodies]
    lines += [rf"\thinlines {_line(_up(a), _up(b))}" for a, b in (*found.springs, *found.loops)]
    lines += [_joint(_up(joint.centre), joint.kind == "slide") for joint in found.joints]
    lines += [_ground(_up(p)) for p in found.grounds]
    return "\n".join([*lines, r"\end{picture}"])


def _up(p: Array) -> Array:
    """A point on the page, y upwards."""
    return np.array([p[0], HEIGHT - p[1]])


def _coloured(number: int, drawn: str) -> str:
    return rf"{{\color{{part{number % len(COLOURS)}}}{drawn}}}"


def _rgb(colour: str) -> str:
    return ",".join(f"{int(colour[k : k + 2], 16) / 255:.2f}" for k in (1, 3, 5))


def _line(a: Array, b: Array) -> str:
    """A straight line as a curve, since lines of LaTeX have few slopes."""
    if float(np.linalg.norm(b - a)) < 0.05:
        return ""
    return _curve(DOTS, a, (a + b) / 2, b)


def _curve(dots: int, *points: Array) -> str:
    return rf"\qbezier[{dots}]" + "".join(f"({p[0]:.1f},{p[1]:.1f})" for p in points)


def _outline(body: Ellipse) -> str:
    """An ellipse of parabolas that have its tangents where they meet."""
    step, turn = 2 * pi / PIECES, radians(body.angle)
    axes = np.array([[cos(turn), -sin(turn)], [sin(turn), cos(turn)]]) * body.axes

    def at(angle: float, out: float = 1.0) -> Array:
        """A point of the outline, or beyond it."""
        return _up(body.centre + axes @ (out * np.array([cos(angle), sin(angle)])))

    # tangents at both ends of a piece meet at 1 / cos(step / 2)
    pieces = [(at(k * step), at((k + 0.5) * step, 1 / cos(step / 2)), at((k + 1) * step)) for k in range(PIECES)]
    return "".join(_curve(ARC, *points) for points in pieces)


def _joint(p: Array, slides: bool) -> str:
    x, y = p
    if slides:
        return rf"\put({x - 4:.1f},{y - 4:.1f}){{\framebox(8,8){{}}}}"
    return rf"\put({x:.1f},{y:.1f}){{\circle{{8}}}}\put({x:.1f},{y:.1f}){{\circle*{{2}}}}"


def _ground(p: Array) -> str:
    x, y = p
    strokes = "".join(rf"\put({x - 8 + 5 * k:.1f},{y - 6:.1f}){{\line(-1,-1){{4}}}}" for k in range(4))
    return rf"\put({x - 10:.1f},{y - 6:.1f}){{\line(1,0){{20}}}}{strokes}"
