"""Joints of an SDF file that close loops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from substructures.array import Array
from substructures.interchange.report import refuse
from substructures.interchange.robot import Loop
from substructures.interchange.rotations import from_z_axis, to_rpy
from substructures.interchange.sdf.frames import Pose, is_true, place_in
from substructures.interchange.xml import Node

#: of joints that close loops the closures, and the axes that these have
CLOSURES: dict[str, tuple[Literal["ball", "weld", "pin", "slider", "universal"], tuple[str, ...]]] = {
    **dict.fromkeys(("revolute", "continuous"), ("pin", ("axis",))),
    **dict.fromkeys(("universal", "revolute2"), ("universal", ("axis", "axis2"))),
    "prismatic": ("slider", ("axis",)), "ball": ("ball", ()), "fixed": ("weld", ()),
}  # fmt: skip
#: of cosines: axes are written with some digits
_TOLERANCE = 1e-6


def is_cut(joint: Node) -> bool:
    """Whether the file says that it closes a loop, whatever carries its child."""
    return any(
        is_true(flag.text)
        for physics in joint.all("physics")
        for simbody in physics.all("simbody")
        for flag in simbody.all("must_be_loop_joint")
    )


def loop_of(
    joint: Node, name: str, ends: tuple[str, str | None], poses: tuple[Pose, Pose], frame: Pose, axes: Sequence[Array]
) -> Loop:
    """A closure between child and parent, ``poses``, whose frames are both ``frame`` at zero, turned to its axes.

    Of a universal joint the second axis is fixed in the child, third one there, and the first one in the parent.
    """
    kind, R = CLOSURES[joint.text_of("type")][0], frame[0]
    if len(axes) == 1:
        R = from_z_axis(axes[0].tolist())
    elif axes:
        first, second = (axis / np.linalg.norm(axis) for axis in axes)
        if abs(first @ second) > _TOLERANCE:
            raise refuse(joint.place, "not-read", "it closes a loop, and its axes are not at a right angle")
        R = np.column_stack([np.cross(first, second), first, second])
    one, two = ((place_in(pose, frame[1]), to_rpy(pose[0].T @ R)) for pose in poses)
    return Loop(name, kind, *ends, *one, *two)
