"""A picture of a tree in one pose: bodies are lines, joints discs (revolute) or boxes (prismatic), ports triads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin
from typing import Any
from xml.sax.saxutils import escape

import numpy as np

from substructures.array import Array
from substructures.display import Picture
from substructures.documents.fields import in_si
from substructures.part.part import Part
from substructures.part.topology import BASE
from substructures.quantities.evaluation import evaluate
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

WIDTH, HEIGHT, MARGIN = 320.0, 240.0, 28.0
#: pose when none is given, so that nothing lies on top of each other
ANGLE, SLIDE = 0.4, 0.25
COLOURS = ("#1f5f8b", "#b4552d", "#3d7a3d", "#7a4b94", "#8a6d1f", "#4a5560")
#: isometric view: world x to the right and down, y to the right and up, z up
VIEW = np.array([[cos(pi / 6), cos(pi / 6), 0.0], [sin(pi / 6), -sin(pi / 6), -1.0]])


@dataclass(frozen=True)
class Scene:
    """Frames of the tree in the pose, and what has to be drawn between them."""

    position: Mapping[str, Array]
    rotation: Mapping[str, Array]
    lines: list[tuple[str, str, int]]
    joints: list[tuple[str, bool, Array, int]]
    ports: list[tuple[str, int]]
    springs: list[tuple[str, str]]


def picture(spec: TreeSpec, parts: Mapping[str, Part], model: Model, q: Any = None) -> Picture:
    """SVG of a tree at ``q`` (n,) and the default values of parameters (1 where there is none), isometric view;
    notebooks show it.

    Raises InvalidDocument for a wrong ``q``.
    """
    scene = scene_of(spec, parts, model, q)
    project = projection(scene)
    shapes = [_line(project(scene.position[a]), project(scene.position[b]), i) for a, b, i in scene.lines]
    shapes += [_spring(project(scene.position[a]), project(scene.position[b])) for a, b in scene.springs]
    shapes += [_joint(scene, project, *joint) for joint in scene.joints]
    shapes += [_triad(scene, project, frame) for frame, _ in scene.ports]
    shapes += [_ground(project(scene.position[f"{i.name}.{BASE}"])) for i in spec.instances if i.at == "world"]
    title = escape(f"{spec.name}: {model.dof} coordinates {model.joints}")
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img">'
    return Picture("\n".join([head, f"<title>{title}</title>", *shapes, "</svg>\n"]))


def scene_of(spec: TreeSpec, parts: Mapping[str, Part], model: Model, q: Any = None) -> Scene:
    """What there is to draw at ``q`` (n,), or in a pose that shows the joints. Raises InvalidDocument."""
    return _scene(spec, parts, model, _pose(parts, model) if q is None else q)


def _pose(parts: Mapping[str, Part], model: Model) -> list[float]:
    """A little beyond the middle of the limits; a fixed angle or distance for joints without limits."""
    pose = {}
    for name, part in parts.items():
        for joint in part.topology.joints:
            limits: Any = part.definition.bodies[joint.body].joint.limits
            if limits and isinstance(limits[0], tuple):
                limits = limits[joint.step]
            pose[f"{name}.{joint.coordinate}"] = _middle(limits, bool(joint.s))
    return [pose[name] for name in model.coordinates]


def _middle(limits: Any, slides: bool) -> float:
    ends = [in_si(limit) for limit in limits or ()]
    if ends and not any(isinstance(limit, str) for limit in ends):
        low, high = map(float, ends)
        if slides or high - low < 2 * pi / 3:
            return low + 0.6 * (high - low)
    return SLIDE if slides else ANGLE


def _scene(spec: TreeSpec, parts: Mapping[str, Part], model: Model, q: Any) -> Scene:
    missing = {name: 1.0 for name, p in model.parameters.items() if p["value"] is None}
    kinematics = evaluate(model, "kinematics", q, parameters=missing)["kinematics"]
    index = {name: i for i, name in enumerate(model.frames)}
    position = {name: np.nan_to_num(kinematics["position"][i]) for name, i in index.items()}
    rotation = {name: np.nan_to_num(kinematics["rotation"][i]) for name, i in index.items()}
    lines = [load.line() for load in spec.loads]
    for each in spec.instances:
        within = parts[each.name].definition.loads
        lines += [tuple(f"{each.name}.{frame}" for frame in load.line()) for load in within]
    springs = [ends for line in lines for ends in pairwise(line)]
    if any("world" in ends for ends in springs):
        position["world"] = np.zeros(3)
    scene = Scene(position, rotation, [], [], [], springs)
    for colour, instance in enumerate(spec.instances):
        part, name = parts[instance.name], instance.name
        if instance.at != "world":
            scene.lines.append((instance.at, f"{name}.{BASE}", colour))
        for body in part.definition.bodies:
            scene.lines.append((f"{name}.{body.parent}", f"{name}.{body.name}", colour))
        for port in part.definition.ports:
            scene.lines.append((f"{name}.{port.body}", f"{name}.{port.name}", colour))
            scene.ports.append((f"{name}.{port.name}", colour))
        for joint in part.topology.joints:
            frame = f"{name}.{part.definition.bodies[joint.body].name}"
            a = model.coordinates.index(f"{name}.{joint.coordinate}")
            column = kinematics["U" if joint.s else "Omega"][index[frame], a]
            scene.joints.append((frame, bool(joint.s), rotation[frame] @ np.nan_to_num(column), colour))
    return scene


def projection(scene: Scene) -> Any:
    """World point -> picture point, scaled so that everything fits."""
    points = np.array([VIEW @ p for p in scene.position.values()]) if scene.position else np.zeros((1, 2))
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.maximum(high - low, 1e-9)
    scale = min((WIDTH - 2 * MARGIN) / size[0], (HEIGHT - 2 * MARGIN) / size[1], 1e6)
    shift = np.array([WIDTH, HEIGHT]) / 2 - scale * (low + high) / 2

    def project(p: Array) -> Array:
        """A point of the world to the picture, with its depth."""
        return scale * (VIEW @ p) + shift

    return project


def _colour(i: int) -> str:
    return COLOURS[i % len(COLOURS)]


def _line(a: Array, b: Array, colour: int) -> str:
    return (
        f'<line x1="{a[0]:.1f}" y1="{a[1]:.1f}" x2="{b[0]:.1f}" y2="{b[1]:.1f}" '
        f'stroke="{_colour(colour)}" stroke-width="5" stroke-linecap="round" opacity="0.75"/>'
    )


def _joint(scene: Scene, project: Any, frame: str, slides: bool, axis: Array, colour: int) -> str:
    """A disc seen along its axis, or a box along the direction of sliding."""
    centre = project(scene.position[frame])
    along = VIEW @ axis
    angle = np.degrees(np.arctan2(along[1], along[0])) if np.linalg.norm(along) > 1e-9 else 0.0
    place = f'transform="translate({centre[0]:.1f} {centre[1]:.1f}) rotate({angle:.1f})"'
    paint = f'fill="white" stroke="{_colour(colour)}" stroke-width="2"'
    if slides:
        return f'<rect {place} x="-9" y="-5" width="18" height="10" {paint}/>'
    foreshortened = 8 * max(0.25, 1 - min(float(np.linalg.norm(along)), 1.0))
    return f'<ellipse {place} rx="{foreshortened:.1f}" ry="8" {paint}/>'


def _spring(a: Array, b: Array) -> str:
    """A zigzag between two points."""
    along = b - a
    across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-9)
    turns = [a + (k + 1) / 8 * along + (-1) ** k * 4 * across for k in range(7)]
    points = " ".join(f"{x:.1f},{y:.1f}" for x, y in (a, *turns, b))
    return f'<polyline points="{points}" fill="none" stroke="#555" stroke-width="1.5"/>'


def _triad(scene: Scene, project: Any, frame: str) -> str:
    """The axes of a port: x red, y green, z blue."""
    origin = project(scene.position[frame])
    lines = []
    for i, colour in enumerate(("#d33", "#2a2", "#33d")):
        tip = origin + 12 * (VIEW @ scene.rotation[frame][:, i])
        points = f'x1="{origin[0]:.1f}" y1="{origin[1]:.1f}" x2="{tip[0]:.1f}" y2="{tip[1]:.1f}"'
        lines.append(f'<line {points} stroke="{colour}" stroke-width="1.5"/>')
    return "".join(lines)


def _ground(p: Array) -> str:
    x, y = p
    strokes = "h20m-16 0l-4 5m9 -5l-4 5m9 -5l-4 5m9 -5l-4 5"
    return f'<path d="M{x - 10:.1f} {y + 4:.1f}{strokes}" stroke="#555" fill="none"/>'
