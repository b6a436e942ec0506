"""Points of the frames of a tree."""

from __future__ import annotations

from collections.abc import Sequence

from substructures.loads.pairs import Place
from substructures.mechanics.kinematics import INTERFACE, Pose, from_body
from substructures.mechanics.linear3 import IDENTITY, ZERO, Vector
from substructures.tree.mounted_part import WORLD, PlacedPart


def place(placed: Sequence[PlacedPart], part: int, frame: int, at: Vector = ZERO) -> Place:
    """A point of a frame; ``part``: index of a part, or WORLD."""
    if part == WORLD:
        return Place(None, INTERFACE, at, Pose(IDENTITY, at))
    return place_of(placed[part], frame, at)


def place_of(here: PlacedPart, frame: int, at: Vector = ZERO) -> Place:
    """A point of a frame of a part."""
    link = here.frame_link(frame, IDENTITY, at)
    return Place(here, link.parent, from_body(here.links, link), here.pose(link.parent).beyond(link))
