"""The joint row (mathematics.md, section 2): from frame p to frame k by A(psi, theta), Z and Ehat(phi)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.mechanics.linear3 import Matrix, Planar, Rotation, Scalar, Turn, Vector, exactly, multiply


@dataclass(frozen=True, slots=True)
class OneDofJoint:
    """A one degree of freedom joint that carries body k.

    ``parent``: L(k), -1 for the interface. ``s``: 1 prismatic, 0 revolute. ``rotation``: E_k = Ehat(phi) A.
    ``offset``: (d cos psi, d sin psi, sigma), from the parent's **body frame** origin to O_k, in frame p.
    ``tau``: shift of the body frame origin along the joint axis; constant (revolute) or q + tau0 (prismatic).
    """

    parent: int
    s: int
    rotation: Rotation
    offset: Vector
    tau: Scalar


@dataclass(frozen=True, slots=True)
class Link:
    """What the base functions need of a joint: parent, kind, E_k and Z_k = from O_p to O_k in frame p."""

    parent: int
    s: int
    rotation: Rotation
    Z: Vector


def links(joints: tuple[OneDofJoint, ...]) -> tuple[Link, ...]:
    """Z_k = offset + tau_p e3."""
    result = []
    for joint in joints:
        x, y, z = joint.offset
        tau = joints[joint.parent].tau if joint.parent >= 0 else 0
        result.append(Link(joint.parent, joint.s, joint.rotation, (x, y, z + tau)))
    return tuple(result)


def lean_rotation(constant: Matrix, c: Scalar, s: Scalar) -> Rotation:
    """Ehat(phi) A with as few operations as possible, from A and (cos phi, sin phi).

    Parallel axes (A turns by psi about the third axis) give one turn by phi + psi (mathematics.md, section 8.4);
    a turn about the first axis stays a factor of its own; any other A is multiplied out.
    """
    if _turns_about(constant, 2):
        c1, s1 = constant[0][0], constant[0][1]
        if exactly(c1, 1) and exactly(c, 1):
            return Rotation(())
        return Rotation((Planar(2, c * c1 - s * s1, s * c1 + c * s1),))
    if _turns_about(constant, 0):
        return Rotation((Planar(0, constant[1][1], constant[1][2]), Planar(2, c, s)))
    return Rotation((Turn(multiply(Planar(2, c, s).matrix(), constant)),))


def _turns_about(m: Matrix, axis: int) -> bool:
    return all(exactly(m[axis][x], x == axis) and exactly(m[x][axis], x == axis) for x in range(3))


def path(chain: Sequence[OneDofJoint | Link], k: int) -> list[int]:
    """Indices from the base to k, k included; empty for the interface (-1)."""
    result = []
    while k >= 0:
        result.append(k)
        k = chain[k].parent
    return result[::-1]
