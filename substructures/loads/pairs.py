"""Points of two frames, and what a force or a moment between them does to every coordinate; of parts and of trees.

A force F on the frame B at its point, a moment N on it, and the opposite ones on the frame A at the same place do for
the unit velocity q'^a = 1 the work F . (u_Ba - u_Aa - Omega_Aa x d) + N . (Omega_Ba - Omega_Aa), d from the point of A
to that of B (notation.md, section 7). Coordinates that move both frames like one body have none of it.

All vectors are in the axes of what poses are given in: of the world in a tree, of the interface frame in a part.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from substructures.expr.graph import Expr, Graph
from substructures.mechanics.composite_form import pairing
from substructures.mechanics.kinematics import Columns, Link, Pose, carrier_link, fixed_columns
from substructures.mechanics.linear3 import ZERO, Scalar, Vector, add, apply, cross, scale, sub, transpose
from substructures.mechanics.wrench import Wrench


class Carriers(Protocol):
    """What carries frames: the links of joints, columns by carrier, and poses.

    ``first``: the coordinate of joint 0.
    """

    @property
    def links(self) -> Sequence[Link]:
        """From joint to joint."""

    @property
    def columns(self) -> Mapping[int, Columns]:
        """By carrier, of all coordinates that move it."""

    @property
    def first(self) -> int:
        """Of the columns."""

    def pose(self, carrier: int) -> Pose:
        """Of a carrier's joint frame, or of the interface."""


def wrench_forces(here: Carriers, carrier: int, wrench: Wrench) -> dict[int, Scalar]:
    """Q_a of a wrench about the body frame origin of a carrier, in its axes, by coordinate."""
    # Q_a = f . (U_ka + s_a [a = k] e3) + (n + tau e3 x f) . Omega_ka
    moment = add(wrench.n, cross((0, 0, carrier_link(here.links, carrier).tau), wrench.f))
    columns = fixed_columns(here.links, here.columns, carrier, here.first)
    return {a: pairing(twist, wrench.f, moment) for a, twist in columns.items()}


@dataclass(frozen=True)
class Place:
    """A point fixed in a carrier (``carriers`` None: in the world), with the axes of a frame.

    ``pose``: of the axes and the point; ``point``: in the carrier's body frame.
    """

    carriers: Carriers | None
    carrier: int
    point: Vector
    pose: Pose

    @property
    def path(self) -> frozenset[int]:
        """The coordinates that move it."""
        return frozenset() if self.carriers is None else frozenset(self.carriers.columns[self.carrier])

    def forces(self, F: Vector, N: Vector) -> Mapping[int, Scalar]:
        """Q_a = F . u_a + N . Omega_a of a force at the point and a moment."""
        if self.carriers is None:
            return {}
        return wrench_forces(self.carriers, self.carrier, self.wrench(self.carriers, F, N))

    def wrench(self, carriers: Carriers, F: Vector, N: Vector) -> Wrench:
        """The same about the body frame origin of the carrier, in its axes."""
        R = carriers.pose(self.carrier).R
        f = apply(R, F)
        return Wrench(f, add(cross(self.point, f), apply(R, N)))


@dataclass(frozen=True)
class Acting:
    """What stands behind generalised forces: a force on B at its point and a moment on it, and the opposite ones on A
    at the same place; all of them times the product of ``factors``.
    """

    pair: Pair
    F: Vector
    N: Vector
    factors: tuple[Expr, ...] = ()

    def wrenches(self) -> list[tuple[Carriers, int, Wrench]]:
        """(carriers, carrier, wrench about its body frame origin in its axes) of what acts on A and on B."""
        F, N = self.F, self.N
        for factor in self.factors:
            F, N = scale(factor, F), scale(factor, N)
        back = Wrench(sub(ZERO, F), sub(ZERO, add(N, cross(self.pair.d, F))))
        ends = ((self.pair.B, F, N), (self.pair.A, back.f, back.n))
        return [(at.carriers, at.carrier, at.wrench(at.carriers, f, n)) for at, f, n in ends if at.carriers is not None]


class Reach(dict[int, Expr]):
    """Generalised forces by coordinate, with what acts between frames to make them (``acting``; nothing of a law that
    acts on coordinates)."""

    def __init__(self, forces: Mapping[int, Expr], acting: Iterable[Acting] = ()) -> None:
        super().__init__(forces)
        self.acting = tuple(acting)

    def times(self, factor: Expr) -> tuple[Acting, ...]:
        """What acts, all of it times a factor."""
        return tuple(replace(each, factors=(*each.factors, factor)) for each in self.acting)


@dataclass(frozen=True)
class Pair:
    """Two places A and B."""

    graph: Graph
    A: Place
    B: Place

    @property
    def d(self) -> Vector:
        """From A to B."""
        return sub(self.B.pose.r, self.A.pose.r)

    @property
    def d_A(self) -> Vector:
        """From A to B, in the axes of A."""
        return apply(self.A.pose.R, self.d)

    @property
    def axes(self) -> tuple[Vector, Vector, Vector]:
        """The axes m_j of B, in the axes of A."""
        # R_A applied to the rows of R_B, which are the axes of B
        x, y, z = (apply(self.A.pose.R, row) for row in self.B.pose.R)
        return x, y, z

    def length2(self) -> Expr:
        """d . d."""
        x, y, z = self.d
        return self.graph.lift(x * x + y * y + z * z)

    def reach(self, F: Vector = ZERO, N: Vector = ZERO) -> Reach:
        """Q_a of a force on B at its point, a moment on B, and the opposite ones on A at the same place."""
        on_B, on_A = self.B.forces(F, N), self.A.forces(F, add(N, cross(self.d, F)))
        forces = {a: self.graph.lift(on_B.get(a, 0) - on_A.get(a, 0)) for a in sorted(self.A.path ^ self.B.path)}
        return Reach(forces, [Acting(self, F, N)])

    def along(self, axis: int) -> Reach:
        """d (d_i) / d q^a, of the component of d along an axis of A."""
        return self.reach(F=self.A.pose.R[axis])

    def about(self, axis: int) -> Reach:
        """Component about an axis of A of the angular velocity of B seen from A, for q'^a = 1."""
        return self.reach(N=self.A.pose.R[axis])


def axes_in_world(place: Place, vector: Vector) -> Vector:
    """R^T v: from the axes of a place to those that poses are given in."""
    return apply(transpose(place.pose.R), vector)


def rate(graph: Graph, reach: Mapping[int, Expr], rates: Sequence[Expr]) -> Expr:
    """w_a q'^a."""
    return graph.sum(w * rates[a] for a, w in reach.items() if not w.is_zero)


def scaled(reach: Reach, factor: Expr) -> Reach:
    """factor * w_a."""
    return Reach({a: factor * w for a, w in reach.items() if not w.is_zero}, reach.times(factor))
