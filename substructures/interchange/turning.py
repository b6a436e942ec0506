"""Joints that turn about all axes, ``ball`` and ``free`` of files, as joints of a definition: chains with yaw, pitch,
roll (singular at pitch = +-pi/2), or without singular angles, with quaternions.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from substructures.interchange.files.wanted import Rotations
from substructures.interchange.numbers import is_zero
from substructures.interchange.report import refuse
from substructures.interchange.robot import Motion

_AXES = ("x", "y", "z")
_TURNS = ("yaw", "pitch", "roll")
#: joint types with quaternions, by the motions that they stand for
_QUATERNIONS = {"free": "floating", "spherical": "ball"}
#: gives a name that nothing has
NewName = Callable[[str], str]


def is_turning(motion: Motion) -> bool:
    """Whether it turns about all axes."""
    return motion.type in _QUATERNIONS


def turning_joint(motion: Motion, rotations: Rotations, new: NewName) -> tuple[dict[str, Any], list[dict[str, object]]]:
    """The joint of a definition, without its placement, and the loads that come with it.

    Raises InvalidDocument for what quaternions cannot say.
    """
    return _with_angles(motion, new) if rotations == "angles" else (_with_quaternion(motion, new), [])


def _with_angles(motion: Motion, new: NewName) -> tuple[dict[str, Any], list[dict[str, object]]]:
    """Slides along x, y, z of a free joint, then yaw, pitch, roll.

    Raises InvalidDocument for rotors of balls, which turn with none of these angles.
    """
    if motion.type == "spherical" and not is_zero(motion.armature):
        message = "the armature of a ball joint on a body that moves needs quaternions: take rotations=quaternions"
        raise refuse(motion.place, "no-quaternions", message)
    slides = _AXES if motion.type == "free" else ()
    names = [new(f"{motion.name}_{step}") for step in (*slides, *_TURNS)]
    joint: dict[str, Any] = {"type": motion.type, "coordinate": names}
    for law in ("stiffness", "damping", "armature"):  # of the slides; of the turns: a load, a moment of inertia
        if slides and not is_zero(getattr(motion, law)):
            joint[law] = [*(getattr(motion, law),) * 3, 0, 0, 0]
    return joint, [*motion.turning_damping(names[-3:]), *motion.turning_spring(names[-3:])]


def _with_quaternion(motion: Motion, new: NewName) -> dict[str, Any]:
    """The place x, y, z of a free joint, then the quaternion qw, qx, qy, qz; rates vx, vy, vz and wx, wy, wz.

    Raises InvalidDocument for springs, which need angles, and for rotors of slides.
    """
    slides = _AXES if motion.type == "free" else ()
    for law in ("stiffness", "armature") if slides else ("stiffness",):
        if not is_zero(getattr(motion, law)):
            message = f"the {law} of a ball or free joint needs angles: take rotations=angles"
            raise refuse(motion.place, "no-angles", message)
    positions = [*slides, *(f"q{axis}" for axis in ("w", *_AXES))]
    rates = [*(f"v{axis}" for axis in slides), *(f"w{axis}" for axis in _AXES)]
    joint: dict[str, Any] = {
        "type": _QUATERNIONS[motion.type],
        "coordinate": [new(f"{motion.name}_{step}") for step in positions],
        "velocities": [new(f"{motion.name}_{step}") for step in rates],
    }
    # -c v and -c omega are the same in all axes, and so is a |omega|^2 / 2 of a ball
    laws = {law: getattr(motion, law) for law in ("damping", "armature")}
    return joint | {law: number for law, number in laws.items() if not is_zero(number)}
