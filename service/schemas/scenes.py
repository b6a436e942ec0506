"""The shape of what there is to draw of a part or a tree."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from service.schemas.shapes import Shape

Vector = list[float]
#: coordinate that is drawn [rad, m]
LARGEST = 1e6


class FrameOfScene(Shape):
    """Frames are numbers in the order of the kinematic outputs; -1 is the world."""

    name: str
    parent: int
    instance: str
    kind: Literal["base", "body", "port"]


class JointOfScene(Shape):
    """One coordinate."""

    coordinate: str
    type: str = Field(description="of the whole joint, as in the definition")
    slides: bool
    frame: int = Field(description="that it moves")
    axis: Vector = Field(description="in this frame; of a joint with several axes at home")
    limits: Vector | None
    unit: Literal["rad", "m"]
    home: float = Field(description="0 of rates of ball and floating joints")


class BodyOfScene(Shape):
    """A body with a mass or an inertia, at the default values of parameters (1 where there is none), in SI."""

    frame: int
    name: str
    mass: float
    centre: Vector = Field(description="in the frame")
    moments: Vector = Field(description="principal moments of inertia about the mass centre, kg m^2")
    axes: list[Vector] = Field(description="of these moments in the frame, in columns")


class EndOfScene(Shape):
    """A point of a frame, in m."""

    frame: int
    at: Vector


class LoadOfScene(Shape):
    """A load between frames."""

    name: str
    type: str
    is_elastic: bool
    ends: list[EndOfScene]


class ClosureOfScene(Shape):
    """A joint that is cut."""

    name: str
    type: str
    ends: list[EndOfScene]


class Sphere(Shape):
    """Around all frames and ellipsoids of inertia at home."""

    centre: Vector
    radius: float


class SceneView(Shape):
    """What there is to draw, with numbers at the default values of parameters."""

    frames: list[FrameOfScene]
    joints: list[JointOfScene]
    bodies: list[BodyOfScene]
    loads: list[LoadOfScene]
    closures: list[ClosureOfScene]
    gravity: Vector
    sphere: Sphere
    positions: list[str] = Field(
        description="what the numbers of a pose are: coordinates, of balls place and quaternion"
    )
    poses: dict[str, Vector] = Field(description="values of all positions, `home` first")
