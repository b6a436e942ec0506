"""Which joints of an SDF file carry no link: those that close loops, and gearboxes; and the thread of screws."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal

import numpy as np

from substructures.array import Array
from substructures.interchange.numbers import Number, value
from substructures.interchange.report import Report, refuse
from substructures.interchange.robot import Link, Loop
from substructures.interchange.rotations import from_z_axis, to_rpy
from substructures.interchange.sdf.axes import number
from substructures.interchange.sdf.frames import Frames, Pose, is_true, place_in
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


def carriers_of(ends: Sequence[tuple[str, str | None]]) -> dict[str, int]:
    """Which joint carries each child, of (child, parent): the first one; where first ones close a circle, one by which
    its links hang on what is the child of none.
    """
    first: dict[str, int] = {}
    for k, (child, _) in enumerate(ends):
        first.setdefault(child, k)
    plain = _hanging(ends, first.values(), first)
    return plain if len(plain) == len(first) else first | _hanging(ends, range(len(ends)), first)


def _hanging(
    ends: Sequence[tuple[str, str | None]], joints: Iterable[int], children: Mapping[str, int]
) -> dict[str, int]:
    """The joints on the ways from what is the child of none."""
    on: dict[str | None, list[int]] = {}
    for k in joints:
        on.setdefault(ends[k][1], []).append(k)
    found, waiting = dict[str, int](), deque(name for name in on if name not in children)
    while waiting:
        for k in on.get(waiting.popleft(), ()):
            child = ends[k][0]
            if child not in found:
                found[child] = k
                waiting.append(child)
    return found


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


def turn_of(
    ends: tuple[str | None, str | None], axis: Array, links: Mapping[str, Link], frames: Frames
) -> tuple[str, int]:
    """The joint of one angle about an axis that moves a body against a reference one, with its sign; '' for none."""
    for (name, host), sign in ((ends, 1), (ends[::-1], -1)):
        link = links.get(name or "")
        if link is None or link.parent != host or [motion.type for motion in link.motions] != ["revolute"]:
            continue
        own = frames.pose(link.name, link.place)[0] @ [value(x) for x in link.motions[0].axis]
        cosine = own @ axis / np.linalg.norm(own) / np.linalg.norm(axis)
        if abs(cosine) > 1 - _TOLERANCE:
            return link.motions[0].name, sign if cosine > 0 else -sign
    return "", 0


def lead_of(joint: Node, report: Report) -> Number:
    """Of a screw, m/rad: ``screw_thread_pitch`` is m a turn, right-handed, ``thread_pitch`` rad/m, left-handed."""
    for tag, form in (("screw_thread_pitch", "({})/(2*pi)"), ("thread_pitch", "-1/({})")):
        found = joint.one(tag)
        if found is None:
            continue
        pitch = number(joint, tag)
        if not pitch:
            raise refuse(found.place, "zero-pitch", "it is 0: make the joint revolute or prismatic")
        if tag == "thread_pitch":
            report.merged(found.place, "it is read as Gazebo Classic does: rad/m, and left-handed where it is positive")
        return form.format(pitch)
    raise refuse(joint.place, "missing-element", "<screw_thread_pitch> is needed")
