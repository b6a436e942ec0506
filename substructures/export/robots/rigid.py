"""Links, the joints that carry them and the loops between them, in numbers where all coordinates are zero."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from substructures.array import Array

#: x_parent = R x + r
Pose = tuple[Array, Array]

NOWHERE: Pose = (np.eye(3), np.zeros(3))


@dataclass(frozen=True)
class Drive:
    """The joint of a link: its coordinate, the axis in the link's frame, limits [rad or m] and laws, in SI units."""

    coordinate: str
    is_slide: bool
    axis: Array
    limits: tuple[float, float] | None = None
    damping: float = 0.0
    stiffness: float = 0.0
    rest: float = 0.0
    armature: float = 0.0
    mimic: tuple[str, float, float] | None = None  #: the coordinate that moves it, multiplier and offset


@dataclass(frozen=True)
class RigidLink:
    """A link on its parent (None: the root); mass [kg], mass centre [m], tensor about it in the link's axes.

    ``ball``: the type of a joint with a quaternion, ``ball`` or ``floating``, else empty; ``damping``: of its rates;
    ``armature``: of a ball;
    ``is_between``: whether it is within a compound joint, massless, with one link on it.
    """

    name: str
    parent: str | None
    pose: Pose = NOWHERE
    drive: Drive | None = None
    ball: str = ""
    damping: tuple[float, ...] = ()
    armature: float = 0.0
    is_between: bool = False
    mass: float = 0.0
    com: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))

    @property
    def is_massless(self) -> bool:
        """Whether it has neither mass nor moments of inertia."""
        return not self.mass and not self.inertia.any()


@dataclass(frozen=True)
class Loop:
    """A closure of a type of the documents between frames of two links, whose third axes are its axis."""

    name: str
    type: str
    start: str
    start_pose: Pose
    end: str
    end_pose: Pose


@dataclass(frozen=True)
class Robot:
    """Parents first; ``left_out``: what no robot file says; ``gravity`` [m/s^2]: None of a part alone."""

    links: tuple[RigidLink, ...]
    loops: tuple[Loop, ...] = ()
    left_out: tuple[str, ...] = ()
    gravity: Array | None = None


def beyond(outer: Pose, inner: Pose) -> Pose:
    """The pose of what is placed in something placed."""
    return outer[0] @ inner[0], outer[1] + outer[0] @ inner[1]


def between(outer: Pose, inner: Pose) -> Pose:
    """The pose in ``outer`` of what is placed beside it."""
    return outer[0].T @ inner[0], outer[0].T @ (inner[1] - outer[1])
