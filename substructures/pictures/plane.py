"""A scene in one pose, projected: what stands where on a picture, whatever it is drawn with."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, pi, sin
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.pictures.scene import WORLD, half_axes

WIDTH, HEIGHT, MARGIN = 320.0, 240.0, 28.0
#: isometric view: world x to the right and down, y to the right and up, z up; orthogonal rows of one length
VIEW = np.array([[cos(pi / 6), cos(pi / 6), 0.0], [sin(pi / 6), -sin(pi / 6), -1.0]])
#: into the picture
DEPTH = np.cross(VIEW[0], VIEW[1])
#: the least half axis of a body, so that rods are seen, and the radius of a point mass
LEAST, POINT = 2.5, 6.0
#: joints that hold nothing: no link is drawn across them
LOOSE = ("free", "floating")
#: joints of several axes through one point
BALLS = ("spherical", "universal", "ball")


@dataclass(frozen=True)
class Ellipse:
    """A body: centre, half axes and angle [degrees] of its outline on the picture."""

    centre: Array
    axes: tuple[float, float]
    angle: float
    colour: int
    name: str


@dataclass(frozen=True)
class Joint:
    """``kind``: ball, slide or turn; ``along``: the projected axis, of length 1 where it lies in the picture."""

    kind: str
    centre: Array
    along: Array
    colour: int


@dataclass(frozen=True)
class Plane:
    """What is drawn, points on the picture with y downwards; ``colour``: a number."""

    lines: list[tuple[Array, Array, int]]
    bodies: list[Ellipse]
    joints: list[Joint]
    triads: list[tuple[Array, Array]]
    springs: list[tuple[Array, Array]]
    loops: list[tuple[Array, Array]]
    grounds: list[Array]


def plane(scene: Mapping[str, Any], shown: Mapping[str, Array]) -> Plane:
    """``scene``: of :func:`substructures.pictures.scene.scene`; ``shown``: places and rotations of its frames."""
    return _Projection(scene, shown).plane()


def _colours(frames: Sequence[Mapping[str, Any]]) -> list[int]:
    """Of every frame: the number of its instance, or where there is only one, of its body."""
    instances = list(dict.fromkeys(frame["instance"] for frame in frames))
    if len(instances) > 1:
        return [instances.index(frame["instance"]) for frame in frames]
    bodies = [k for k, frame in enumerate(frames) if frame["kind"] == "body"]
    own = [k if frame["kind"] != "port" else frame["parent"] for k, frame in enumerate(frames)]
    return [bodies.index(k) if k in bodies else 0 for k in own]


class _Projection:
    def __init__(self, scene: Mapping[str, Any], shown: Mapping[str, Array]) -> None:
        self.scene, self.shown = scene, shown
        self.colours = _colours(scene["frames"])
        self.loose = {joint["frame"] for joint in scene["joints"] if joint["type"] in LOOSE}
        self.scale, self.shift = 1.0, np.zeros(2)
        self._fit()

    def _fit(self) -> None:
        """Everything is on the picture, and fills it in one direction."""
        outlines = [self.outline(body) for body in self.scene["bodies"]]
        points = [p for centre, spread in outlines for p in (centre - spread, centre + spread)]
        loose = self.loose | {k for k, frame in enumerate(self.scene["frames"]) if self._is_bare(k, frame)}
        points += [self.point(k) for k in range(len(self.scene["frames"])) if k not in loose or not outlines]
        points += [self.point(*end) for ends in self._loads() for end in ends]
        corners = np.array(points) if points else np.zeros((1, 2))
        low, high = corners.min(axis=0), corners.max(axis=0)
        size = np.maximum(high - low, 1e-9)
        self.scale = float(min((WIDTH - 2 * MARGIN) / size[0], (HEIGHT - 2 * MARGIN) / size[1], 1e6))
        self.shift = np.array([WIDTH, HEIGHT]) / 2 - self.scale * (low + high) / 2

    def _is_bare(self, k: int, frame: Mapping[str, Any]) -> bool:
        """Whether this is a frame of the world on which nothing but loose bodies are."""
        below = [i for i, each in enumerate(self.scene["frames"]) if each["parent"] == k]
        return frame["kind"] == "base" and frame["parent"] == WORLD and bool(below) and set(below) <= self.loose

    def place(self, k: int, at: Sequence[float] = (0, 0, 0)) -> Array:
        """A point of a frame in the world."""
        found: Array = np.array(at, float)
        return found if k == WORLD else self.shown["position"][k] + self.shown["rotation"][k] @ found

    def point(self, k: int, at: Sequence[float] = (0, 0, 0)) -> Array:
        """A point of a frame on the picture."""
        found: Array = self.scale * (VIEW @ self.place(k, at)) + self.shift
        return found

    def outline(self, body: Mapping[str, Any]) -> tuple[Array, Array]:
        """Centre of a body, and how far it reaches to the sides and up."""
        P = self._shape(body)
        return self.point(body["frame"], body["centre"]), np.sqrt(np.diag(P))

    def _shape(self, body: Mapping[str, Any]) -> Array:
        """P of the outline x P^-1 x = 1: of the ellipsoid R A diag(a^2) A^T R^T, projected."""
        C = self.scale * VIEW @ self.shown["rotation"][body["frame"]] @ np.array(body["axes"]) * half_axes(body)
        found: Array = C @ C.T
        return found

    def colour(self, k: int) -> int:
        """Of the instance of a frame."""
        return self.colours[k]

    def _loads(self) -> Iterator[tuple[tuple[int, Any], tuple[int, Any]]]:
        for load in self.scene["loads"]:
            if load["is_elastic"]:
                yield from pairwise((end["frame"], end["at"]) for end in load["ends"])

    def plane(self) -> Plane:
        """All of it; bodies from the back to the front."""
        frames = self.scene["frames"]
        pairs = [(frame["parent"], k) for k, frame in enumerate(frames) if frame["parent"] != WORLD]
        lines = [(self.point(a), self.point(b), self.colour(b)) for a, b in pairs if b not in self.loose]
        bodies = sorted(
            self.scene["bodies"], key=lambda body: -float(DEPTH @ self.place(body["frame"], body["centre"]))
        )
        held = [(body["frame"], self.point(body["frame"], body["centre"])) for body in bodies]
        lines += [(self.point(k), centre, self.colour(k)) for k, centre in held]
        closures = [[self.point(end["frame"], end["at"]) for end in each["ends"]] for each in self.scene["closures"]]
        return Plane(
            lines=[line for line in lines if np.linalg.norm(line[0] - line[1]) > 0.05],
            bodies=[self._ellipse(body) for body in bodies],
            joints=list(self._joints()),
            triads=[self._triad(k) for k, frame in enumerate(frames) if frame["kind"] == "port"],
            springs=[(self.point(*a), self.point(*b)) for a, b in self._loads()],
            loops=[(a, b) for a, b in closures],
            grounds=[
                self.point(k)
                for k, frame in enumerate(frames)
                if frame["parent"] == WORLD and frame["kind"] == "base" and not self._is_bare(k, frame)
            ],
        )

    def _ellipse(self, body: Mapping[str, Any]) -> Ellipse:
        squares, directions = np.linalg.eigh(self._shape(body))
        least = POINT if squares[1] < LEAST**2 else LEAST
        short, long = np.maximum(np.sqrt(np.maximum(squares, 0.0)), least)
        angle = float(np.degrees(np.arctan2(directions[1, 1], directions[0, 1])))
        centre = self.point(body["frame"], body["centre"])
        return Ellipse(centre, (float(long), float(short)), angle, self.colour(body["frame"]), body["name"])

    def _joints(self) -> Iterator[Joint]:
        drawn = set()
        for joint in self.scene["joints"]:
            k, is_ball = joint["frame"], joint["type"] in BALLS
            if joint["type"] in LOOSE or (is_ball and k in drawn):
                continue
            drawn.add(k)
            along = VIEW @ self.shown["rotation"][k] @ np.array(joint["axis"]) / np.linalg.norm(VIEW[0])
            kind = "ball" if is_ball else "slide" if joint["slides"] else "turn"
            yield Joint(kind, self.point(k), along, self.colour(k))

    def _triad(self, k: int) -> tuple[Array, Array]:
        return self.point(k), (VIEW @ self.shown["rotation"][k]).T
