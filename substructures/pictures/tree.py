"""A picture of a tree in one pose: bodies are ellipsoids of inertia on links, joints discs, boxes or balls, ports
triads. Its colours can be told from light and from dark paper, so that it looks the same wherever it is shown."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from substructures.array import Array
from substructures.display import Picture
from substructures.part.part import Part
from substructures.part.poses import HOME
from substructures.pictures.plane import HEIGHT, WIDTH, Ellipse, Joint, Plane, plane
from substructures.pictures.pose import kinematics
from substructures.pictures.scene import scene
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

#: of instances or bodies, in their order: contrast of 3 and more with white and with dark paper
COLOURS = ("#2a78ad", "#c7663a", "#4a9149", "#8f5bad", "#a8862c", "#6b7884")
AXES = ("#d33333", "#2f9e44", "#6a78f0")
INK = "#77838e"


def picture(spec: TreeSpec, parts: Mapping[str, Part], model: Model, q: Any = None) -> Picture:
    """SVG of a tree at the state ``q``, by default at home, and the default values of parameters (1 where there is
    none), isometric view; notebooks show it.

    Raises InvalidDocument for a wrong ``q``.
    """
    shapes = _shapes(projected(spec, parts, model, q))
    title = escape(f"{spec.name}: {model.dof} coordinates {model.joints}")
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img">'
    return Picture("\n".join([head, f"<title>{title}</title>", *shapes, "</svg>\n"]))


def projected(spec: TreeSpec, parts: Mapping[str, Part], model: Model, q: Any = None) -> Plane:
    """What stands where on the picture. Raises InvalidDocument."""
    found = scene(spec, parts, model)
    return plane(found, kinematics(model, found["poses"][HOME] if q is None else q))


def _shapes(found: Plane) -> list[str]:
    shapes = [_ground(p) for p in found.grounds]
    shapes += [_line(a, b, colour) for a, b, colour in found.lines]
    shapes += [_spring(a, b) for a, b in found.springs]
    shapes += [_body(body) for body in found.bodies]
    shapes += [_joint(joint) for joint in found.joints]
    shapes += [_loop(a, b) for a, b in found.loops]
    return shapes + [_triad(origin, axes) for origin, axes in found.triads]


def colour_of(number: int) -> str:
    """The colour of an instance or a body by its number."""
    return COLOURS[number % len(COLOURS)]


def _points(a: Array, b: Array) -> str:
    return f'x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}"'


def _line(a: Array, b: Array, colour: int) -> str:
    return f'<line {_points(a, b)} stroke="{colour_of(colour)}" stroke-width="4" stroke-linecap="round" opacity="0.7"/>'


def _body(body: Ellipse) -> str:
    place = f'transform="translate({body.centre[0]:.1f} {body.centre[1]:.1f}) rotate({body.angle:.1f})"'
    paint = f'fill="{colour_of(body.colour)}" fill-opacity="0.4" stroke="{colour_of(body.colour)}"'
    title = f"<title>{escape(body.name)}</title>"
    return f'<ellipse {place} rx="{body.axes[0]:.1f}" ry="{body.axes[1]:.1f}" {paint}>{title}</ellipse>'


def _joint(joint: Joint) -> str:
    """A disc seen along its axis, a box along the direction of sliding, or a ball."""
    x, y = joint.centre
    length = float(np.linalg.norm(joint.along))
    angle = np.degrees(np.arctan2(joint.along[1], joint.along[0])) if length > 1e-9 else 0.0
    place = f'transform="translate({x:.1f} {y:.1f}) rotate({angle:.1f})"'
    colour = colour_of(joint.colour)
    paint = f'fill="{colour}" fill-opacity="0.25" stroke="{colour}" stroke-width="1.6"'
    if joint.kind == "ball":
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" {paint}/>'
    if joint.kind == "slide":
        return f'<rect {place} x="-8" y="-4" width="16" height="8" {paint}/>'
    tip = 13 * joint.along
    axis = f'<line {_points(joint.centre - tip, joint.centre + tip)} stroke="{colour}" stroke-width="1"/>'
    # a circle turned out of the picture by asin(length)
    return f'{axis}<ellipse {place} rx="{6 * max(0.2, (1 - min(length, 1.0) ** 2) ** 0.5):.1f}" ry="6" {paint}/>'


def _spring(a: Array, b: Array) -> str:
    """A zigzag between two points."""
    along = b - a
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
    turns = [a + (k + 1) / 8 * along + (-1) ** k * 4 * across for k in range(7)]
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in (a, *turns, b))
    return f'<polyline points="{points}" fill="none" stroke="{INK}" stroke-width="1.5"/>'


def _loop(a: Array, b: Array) -> str:
    """A closure: a ring where it is, and what is open in this pose."""
    ring = f'<circle cx="{b[0]:.1f}" cy="{b[1]:.1f}" r="6" fill="none" stroke="{INK}" stroke-width="1.5"/>'
    return f'<line {_points(a, b)} stroke="{INK}" stroke-dasharray="3 3"/>{ring}'


def _triad(origin: Array, axes: Array) -> str:
    """The axes of a port: x red, y green, z blue."""
    lines = zip((origin + 10 * axis for axis in axes), AXES, strict=True)
    return "".join(f'<line {_points(origin, tip)} stroke="{colour}" stroke-width="1.5"/>' for tip, colour in lines)


def _ground(p: Array) -> str:
    x, y = p
    strokes = "h20m-16 0l-4 5m9 -5l-4 5m9 -5l-4 5m9 -5l-4 5"
    return f'<path d="M{x - 10:.1f} {y + 4:.1f}{strokes}" stroke="{INK}" fill="none"/>'
