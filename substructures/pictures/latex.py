"""The picture of a tree in LaTeX's own picture environment, which needs no packages but ``color``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.part.part import Part
from substructures.part.topology import BASE
from substructures.pictures.tree import COLOURS, HEIGHT, WIDTH, projection, scene_of
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

#: points that a line is drawn of, so that the memory of TeX is enough
DOTS = 120


def latex_picture(spec: TreeSpec, parts: Mapping[str, Part], model: Model, q: Any = None) -> str:
    """A ``picture`` environment, 320 x 240 points: bodies are lines, joints circles or squares, as in the SVG.

    Needs the package ``color``. Raises InvalidDocument for a wrong ``q``.
    """
    scene = scene_of(spec, parts, model, q)
    project = projection(scene)

    def at(frame: str) -> Array:
        """A frame on the page, y upwards."""
        x, y = project(scene.position[frame])
        return np.array([x, HEIGHT - y])

    lines = [rf"\begin{{picture}}({WIDTH:g},{HEIGHT:g})"]
    lines += [rf"\definecolor{{part{i}}}{{rgb}}{{{_rgb(colour)}}}" for i, colour in enumerate(COLOURS)]
    for a, b, i in scene.lines:
        lines.append(rf"{{\color{{part{i % len(COLOURS)}}}\linethickness{{2pt}}{_line(at(a), at(b))}}}")
    lines += [rf"\thinlines {_line(at(a), at(b))}" for a, b in scene.springs]
    lines += [_joint(at(frame), slides) for frame, slides, _, _ in scene.joints]
    lines += [_ground(at(f"{each.name}.{BASE}")) for each in spec.instances if each.at == "world"]
    return "\n".join([*lines, r"\end{picture}"])


def _rgb(colour: str) -> str:
    return ",".join(f"{int(colour[k : k + 2], 16) / 255:.2f}" for k in (1, 3, 5))


def _line(a: Array, b: Array) -> str:
    """A straight line as a curve, since lines of LaTeX have few slopes."""
    if float(np.linalg.norm(b - a)) < 0.05:
        return ""
    middle = (a + b) / 2
    return rf"\qbezier[{DOTS}]" + "".join(f"({p[0]:.1f},{p[1]:.1f})" for p in (a, middle, b))


def _joint(p: Array, slides: bool) -> str:
    x, y = p
    if slides:
        return rf"\put({x - 4:.1f},{y - 4:.1f}){{\framebox(8,8){{}}}}"
    return rf"\put({x:.1f},{y:.1f}){{\circle{{8}}}}\put({x:.1f},{y:.1f}){{\circle*{{2}}}}"


def _ground(p: Array) -> str:
    x, y = p
    strokes = "".join(rf"\put({x - 8 + 5 * k:.1f},{y - 6:.1f}){{\line(-1,-1){{4}}}}" for k in range(4))
    return rf"\put({x - 10:.1f},{y - 6:.1f}){{\line(1,0){{20}}}}{strokes}"
