"""Rotation, position and partial velocities of frames of a coupled tree."""

from __future__ import annotations

from substructures.mechanics.base_functions import Twist, carried
from substructures.mechanics.linear3 import IDENTITY, ZERO, Matrix, Vector
from substructures.mounted import Mounted, State, frame_link
from substructures.skeleton import INTERFACE


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
