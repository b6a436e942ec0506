"""Kinematic base functions U_ka and Omega_ka by one algebraic recursion (notation.md, section 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.mechanics.joints import Link
from substructures.mechanics.linear3 import E3, ZERO, Vector, add, cross


@dataclass(frozen=True, slots=True)
class Twist:
    """Partial velocity U of a point [m or 1] and partial angular velocity Omega [1] for one coordinate."""

    U: Vector
    Omega: Vector


Columns = dict[int, Twist]


def carried(twist: Twist, link: Link, slides: bool = False) -> Twist:
    """Transport of one column from O_p to O_k: Omega_ka = E Omega_pa, U_ka = E (U_pa + Omega_pa x Z_k).

    ``slides``: the column belongs to the parent's own prismatic joint, whose e3 is added (s_a [a = p] e3).
    """
    u = add(twist.U, E3) if slides else twist.U
    u = add(u, cross(twist.Omega, link.Z))
    return Twist(link.rotation.forward(u), link.rotation.forward(twist.Omega))


def own_twist(s: int) -> Twist:
    """Omega_kk = (1 - s_k) e3, U_kk = 0."""
    return Twist(ZERO, ZERO if s else E3)


def transport(links: Sequence[Link], outside: Columns) -> list[Columns]:
    """Columns given at the interface (any keys), carried to O_k of every body."""
    result: list[Columns] = []
    for link in links:
        source = result[link.parent] if link.parent >= 0 else outside
        result.append({a: carried(twist, link) for a, twist in source.items()})
    return result


def base_functions(links: Sequence[Link]) -> list[Columns]:
    """Columns {a: (U_ka, Omega_ka)} of every body k for its own coordinates a <= k."""
    result: list[Columns] = []
    for k, link in enumerate(links):
        p = link.parent
        source = result[p] if p >= 0 else {}
        slides = p >= 0 and bool(links[p].s)
        columns = {a: carried(twist, link, slides and a == p) for a, twist in source.items()}
        columns[k] = own_twist(link.s)
        result.append(columns)
    return result
