"""Joints, the frames that they carry and the kinematic base functions U and Omega (notation.md, sections 2 and 3).

A *carrier* is what a joint carries, named by the joint's index, or the interface (INTERFACE). Bodies and ports are
frames fixed in a carrier; their placements are given in its body frame, whose origin is O_k + tau_k e3. Columns and
poses are kept by carrier, those of the interface among them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from substructures.mechanics.linear3 import (
    E3,
    ZERO,
    Matrix,
    Planar,
    Rotation,
    Scalar,
    Turn,
    Vector,
    add,
    apply,
    cross,
    exactly,
    multiply,
    transpose,
)

#: the carrier of everything that is fixed to the interface frame
INTERFACE = -1


@dataclass(frozen=True, slots=True)
class OneDofJoint:
    """A one degree of freedom joint that carries body k.

    ``parent``: L(k), INTERFACE for a root. ``s``: 1 prismatic, 0 revolute. ``rotation``: E_k = Ehat(phi) A.
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
    """What leads from O_p to O_k: parent carrier, kind of the joint, E_k, Z_k in frame p, and tau_k as above.

    A frame that is fixed in its parent is a link with s = 0 and tau = 0.
    """

    parent: int
    s: int
    rotation: Rotation
    Z: Vector
    tau: Scalar = 0


#: the interface among the carriers: it does not move against itself
_AT_REST = Link(INTERFACE, 0, Rotation(), ZERO)


def carrier_link(links: Sequence[Link], carrier: int) -> Link:
    """The link whose joint moves a carrier; for the interface one that neither turns, nor slides, nor shifts.

    The one place that tells the interface from the joints: s and tau of any carrier are those of this link.
    """
    return _AT_REST if carrier == INTERFACE else links[carrier]


def links(joints: Sequence[OneDofJoint]) -> tuple[Link, ...]:
    """Z_k = offset + tau_p e3."""
    result: list[Link] = []
    for joint in joints:
        Z = _along_axis(joint.offset, carrier_link(result, joint.parent).tau)
        result.append(Link(joint.parent, joint.s, joint.rotation, Z, joint.tau))
    return tuple(result)


def fixed_link(links: Sequence[Link], carrier: int, rotation: Rotation, position: Vector) -> Link:
    """A frame fixed in a carrier, placed in its body frame, as a link from O of the carrier: z = r + tau e3."""
    return Link(carrier, 0, rotation, _along_axis(position, carrier_link(links, carrier).tau))


def from_body(links: Sequence[Link], link: Link) -> Vector:
    """Z_k - tau_p e3: from the body frame origin of the parent carrier to O_k."""
    x, y, z = link.Z
    return x, y, z - carrier_link(links, link.parent).tau


def _along_axis(v: Vector, tau: Scalar) -> Vector:
    """v + tau e3."""
    return v[0], v[1], v[2] + tau


def constant_rotation(E: Matrix) -> Rotation:
    """A constant rotation as the factors with the fewest operations."""
    return joint_rotation(E, 1, 0)


def joint_rotation(constant: Matrix, c: Scalar, s: Scalar) -> Rotation:
    """Ehat(phi) A with as few operations as possible, from A and (cos phi, sin phi).

    Parallel axes (A turns by psi about the third axis, or after a half turn about the first, which reverses it) give
    one turn by phi + psi (notation.md, section 8.4); a tilt about the first axis stays a factor of its own; any other
    A is multiplied out.
    """
    if exactly(constant[2][0], 0) and (exactly(constant[0][0], 1) or exactly(constant[2][1], 0)):
        # A = Ehat(psi) Rx(theta)^T:   first column (cos psi, -sin psi, 0),   last row (0, -sin theta, cos theta)
        c1, s1, tilt = constant[0][0], -constant[1][0], Planar(0, constant[2][2], -constant[2][1])
        turn = Planar(2, c * c1 - s * s1, s * c1 + c * s1)
        return Rotation(tuple(factor for factor in (tilt, turn) if not exactly(factor.c, 1)))
    # Ehat(phi) A
    return Rotation((Turn(multiply(Planar(2, c, s).matrix(), constant)),))


def joined(outer: Link, inner: Link) -> Link:
    """One link after the other: E = E_inner E_outer, Z = Z_outer + E_outer^T Z_inner; the outer one is constant."""
    Z = add(outer.Z, outer.rotation.back(inner.Z))
    return Link(outer.parent, inner.s, _after(outer.rotation, inner.rotation), Z, inner.tau)


def _after(outer: Rotation, inner: Rotation) -> Rotation:
    """E_inner E_outer, of which the outer one is constant, in the form with the fewest operations."""
    if not outer.factors:
        return inner
    *constant, turn = inner.factors or (Planar(2, 1, 0),)
    E = outer.matrix()
    if isinstance(turn, Planar) and turn.axis == 2:
        whole = joint_rotation(multiply(Rotation(tuple(constant)).matrix(), E), turn.c, turn.s)
    else:
        whole = constant_rotation(multiply(inner.matrix(), E))
    # axes that change places cost nothing, planar turns less than others
    renames = all(exactly(x, 0) or exactly(x, 1) or exactly(x, -1) for row in E for x in row)
    return Rotation((Turn(E), *inner.factors)) if renames and inner.is_planar and not whole.is_planar else whole


def path(chain: Sequence[OneDofJoint | Link], k: int) -> list[int]:
    """Indices from the base to k, k included; empty for the interface."""
    result = []
    while k >= 0:
        result.append(k)
        k = chain[k].parent
    return result[::-1]


@dataclass(frozen=True, slots=True)
class Twist:
    """Partial velocity U of a point [m or 1] and partial angular velocity Omega [1] for one coordinate."""

    U: Vector
    Omega: Vector


#: the twists of a frame by coordinate
Columns = dict[int, Twist]


def fixed_columns(links: Sequence[Link], columns: Mapping[int, Columns], carrier: int, first: int = 0) -> Columns:
    """U_ka + s_a [a = k] e3 and Omega_ka at O_k of what is fixed in the carrier k and slides with it.

    ``first``: the coordinate of joint 0.
    """
    # O_k stays where the axis is reached; what a prismatic joint carries slides away from it along e3
    at = columns[carrier]
    if not carrier_link(links, carrier).s:
        return at
    own = first + carrier
    return at | {own: Twist(add(at[own].U, E3), at[own].Omega)}


def carried(twist: Twist, link: Link) -> Twist:
    """Transport of one column of what is fixed in p from O_p to O_k."""
    # Omega_ka = E_k Omega_pa,   U_ka = E_k (U_pa + s_a [a = p] e3 + Omega_pa x Z_k)   (notation.md, section 3)
    u = add(twist.U, cross(twist.Omega, link.Z))
    return Twist(link.rotation.forward(u), link.rotation.forward(twist.Omega))


def columns_beyond(links: Sequence[Link], columns: Mapping[int, Columns], link: Link, first: int = 0) -> Columns:
    """The columns of the carrier on which a link hangs, carried over the link."""
    return {a: carried(twist, link) for a, twist in fixed_columns(links, columns, link.parent, first).items()}


def own_twist(s: int) -> Twist:
    """Omega_kk = (1 - s_k) e3, U_kk = 0."""
    return Twist(ZERO, ZERO if s else E3)


def base_functions(links: Sequence[Link]) -> dict[int, Columns]:
    """Columns {a: (U_ka, Omega_ka)} of every carrier k for its own coordinates a <= k; none of the interface."""
    result: dict[int, Columns] = {INTERFACE: {}}
    for k, link in enumerate(links):
        # a < k from the parent, a = k: Omega_kk = (1 - s_k) e3, U_kk = 0
        result[k] = columns_beyond(links, result, link)
        result[k][k] = own_twist(link.s)
    return result


@dataclass(frozen=True, slots=True)
class Pose:
    """Where a frame is in another one: rotation R from the axes of that one to its own, origin r there."""

    R: Matrix
    r: Vector

    def beyond(self, link: Link) -> Pose:
        """The pose of the frame to which a link leads."""
        # R_k = E_k R_p by columns,   r_k = r_p + R_p^T Z_k
        x, y, z = (link.rotation.forward(column) for column in transpose(self.R))
        return Pose(transpose((x, y, z)), add(self.r, apply(transpose(self.R), link.Z)))
