"""A part mounted in a tree, and what coupling and all that follows know of it: links, momenta, columns, poses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from substructures.mechanics.base_functions import Columns, Twist, carried
from substructures.mechanics.joints import Link, lean_rotation
from substructures.mechanics.linear3 import IDENTITY, ZERO, Matrix, Scalar, Vector, add, apply, multiply, transpose
from substructures.mechanics.metric import JointMomentum
from substructures.part.loads import wrench_about_origin
from substructures.part.outputs import Stored
from substructures.part.part import Part
from substructures.part.topology import INTERFACE

WORLD = -1


@dataclass
class Mounted:
    """A part in a tree: host (index of an earlier one, or WORLD), frame of the host, constant placement, bindings."""

    part: Part
    host: int
    frame: int
    E: Matrix
    position: Vector
    bindings: Mapping[str, Scalar]
    first: int = 0  #: index of its first coordinate in the tree


@dataclass(frozen=True, slots=True)
class Pose:
    """Rotation world -> frame, origin of the frame in the world."""

    R: Matrix
    r: Vector

    def beyond(self, link: Link) -> Pose:
        """The pose of the next frame."""
        x, y, z = (link.rotation.forward(column) for column in transpose(self.R))
        return Pose(transpose((x, y, z)), add(self.r, apply(transpose(self.R), link.Z)))


@dataclass
class State:
    """What the two passes know of a mounted part."""

    stored: Stored
    own: Stored  #: own inertia of the bodies, without what is mounted on them
    links: list[Link]
    tau: list[Scalar]
    momenta: list[JointMomentum]
    outside: Columns = field(default_factory=dict)
    columns: list[Columns] = field(default_factory=list)  #: host's and own columns at every joint
    gamma: list[Vector] = field(default_factory=list)  #: gravity in every joint frame, and last in the interface frame
    host: State | None = None
    link: Link | None = None  #: from the carrier in the host to the interface
    poses: dict[int, Pose] = field(default_factory=dict)

    def pose(self, carrier: int) -> Pose:
        """Of joint frame k or of the interface (-1), computed when it is first needed."""
        todo: list[tuple[State, int, State, Link]] = []
        state = self
        while carrier not in state.poses:
            link = state.link if carrier == INTERFACE else state.links[carrier]
            before = state.host if carrier == INTERFACE else state
            if link is None or before is None:
                break
            todo.append((state, carrier, before, link))
            state, carrier = before, link.parent
        for state, k, before, link in reversed(todo):
            state.poses[k] = before.poses[link.parent].beyond(link)
        return self.poses[todo[0][1] if todo else carrier]


def frame_link(m: Mounted, state: State, frame: int, E: Matrix = IDENTITY, position: Vector = ZERO) -> Link:
    """A frame (body or port) of a part, and a constant placement in it, as a link from O of the carrier."""
    E_f, r_f = state.stored.matrix("frame.E", frame), state.stored.vector("frame.position", frame)
    x, y, z = add(r_f, apply(transpose(E_f), position))
    carrier = m.part.frame_carriers[frame]
    tau = 0 if carrier == INTERFACE else state.tau[carrier]
    return Link(carrier, 0, lean_rotation(multiply(E, E_f), 1, 0), (x, y, z + tau))


def applied_wrenches(m: Mounted, state: State) -> Iterator[tuple[int, Vector, Vector]]:
    """(carrier, force, moment about its body frame origin) of every force and torque, in the carrier's axes."""
    for i, (carrier, moment, world) in enumerate(m.part.wrenches):
        vector = state.stored.vector("load.vector", i)
        if world:
            vector = apply(state.pose(carrier).R, vector)
        yield carrier, *wrench_about_origin(state.stored.vector("load.at", i), vector, moment)


def frame_kinematics(
    m: Mounted, state: State, frame: int, E: Matrix = IDENTITY, position: Vector = ZERO
) -> tuple[Matrix, Vector, dict[int, Twist]]:
    """Rotation world -> frame, origin in the world, columns in the axes of the frame.

    ``E``, ``position``: a constant placement in the frame.
    """
    link = frame_link(m, state, frame, E, position)
    carrier = link.parent
    source = state.outside if carrier == INTERFACE else state.columns[carrier]
    own = m.first + carrier if carrier != INTERFACE and state.links[carrier].s else None
    twists = {a: carried(twist, link, a == own) for a, twist in source.items()}
    pose = state.pose(carrier).beyond(link)
    return pose.R, pose.r, twists
