"""Mechanisms out as robot files, URDF and MJCF: all numbers bound, everything placed where all coordinates are zero."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from substructures.export.robots.mjcf import mjcf
from substructures.export.robots.rigid import Robot
from substructures.export.robots.trees import Bind, robot_of_part, robot_of_tree
from substructures.export.robots.urdf import urdf
from substructures.part.part import Part
from substructures.tree.document import TreeSpec

__all__ = ["MEDIA_TYPE", "ROBOTS", "file_of_part", "file_of_tree"]

MEDIA_TYPE = "application/xml"


@dataclass(frozen=True)
class Format:
    """``write``: of a robot, its name, reference and digest; ``angles``: whether it has no quaternions of balls."""

    suffix: str
    write: Callable[[Robot, str, str, str], bytes]
    angles: bool


#: formats of robot files
ROBOTS: Mapping[str, Format] = {"urdf": Format("urdf", urdf, True), "mjcf": Format("xml", mjcf, False)}


def file_of_part(target: str, part: Part, name: str, reference: str, digest: str, bind: Bind) -> bytes:
    """A part as it stands alone, in a format of ROBOTS. ``bind``: puts numbers in place of parameters.

    Raises InvalidArgument for numbers that are not finite, MissingValue for parameters that have none.
    """
    kind = ROBOTS[target]
    return kind.write(robot_of_part(part, bind, kind.angles), name, reference, digest)


def file_of_tree(
    target: str, spec: TreeSpec, parts: Mapping[str, Part], name: str, reference: str, digest: str, bind: Bind
) -> bytes:
    """A tree with its parts by instance, in a format of ROBOTS. Raises InvalidDocument, and as of parts."""
    kind = ROBOTS[target]
    return kind.write(robot_of_tree(spec, parts, bind, kind.angles), name, reference, digest)
