"""Poses and columns of everything in a part, in its interface frame (notation.md, section 3)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from substructures.loads.pairs import Place
from substructures.mechanics.kinematics import (
    INTERFACE,
    Columns,
    Link,
    Pose,
    fixed_columns,
    fixed_link,
    from_body,
)
from substructures.mechanics.linear3 import IDENTITY, ZERO, Rotation, Turn, Vector, add, apply, cross, transpose
from substructures.part.frames import Frame


@dataclass(frozen=True)
class Kinematics:
    """Recursion results: links; columns and poses in the interface frame, by carrier.

    ``first``: the coordinate of joint 0.
    """

    links: tuple[Link, ...]
    columns: dict[int, Columns]
    poses: dict[int, Pose]
    first: int = 0

    def pose(self, carrier: int) -> Pose:
        """Of a carrier's joint frame."""
        return self.poses[carrier]


@dataclass(frozen=True)
class PointKinematics:
    """Position r [m] and own partial velocities u_a [m or 1] of a point, in the interface frame."""

    position: Vector
    u: Mapping[int, Vector]


def kinematics(chain: tuple[Link, ...], columns: dict[int, Columns]) -> Kinematics:
    """R_c = E_c R_p and r_c = r_p + R_p^T Z_c of all carriers, beside the base functions."""
    poses = {INTERFACE: Pose(IDENTITY, ZERO)}
    for c, link in enumerate(chain):
        # parents have lower numbers: their poses are known
        poses[c] = poses[link.parent].beyond(link)
    return Kinematics(chain, columns, poses)


def frame_link(k: Kinematics, frame: Frame) -> Link:
    """A frame as a link without degree of freedom, from O of its carrier."""
    return fixed_link(k.links, frame.carrier, Rotation((Turn(frame.E),)), frame.position)


def point_kinematics(k: Kinematics, carrier: int, at: Vector) -> PointKinematics:
    """Position and own partial velocities of a point (carrier's body frame) in the interface frame."""
    z = frame_link(k, Frame(carrier, IDENTITY, at)).Z
    back = transpose(k.poses[carrier].R)
    # u_a = R^T (U_ka + s_a [a = k] e3 + Omega_ka x z)
    u = {
        a: apply(back, add(twist.U, cross(twist.Omega, z)))
        for a, twist in fixed_columns(k.links, k.columns, carrier).items()
    }
    return PointKinematics(add(k.poses[carrier].r, apply(back, z)), u)


def own_place(k: Kinematics, frame: Frame) -> Place:
    """The origin of a frame of the part, with its axes, in the interface frame."""
    link = frame_link(k, frame)
    return Place(k, link.parent, from_body(k.links, link), k.pose(link.parent).beyond(link))
