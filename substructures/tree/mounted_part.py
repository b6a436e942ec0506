"""A part in a tree, in the order in which one learns of it: mounted, evaluated, placed.

:class:`MountedPart`: where the tree document puts it. :class:`EvaluatedPart`: what its stored formulas are with all
that is mounted on it, whatever its own host does. :class:`PlacedPart`: what it knows of the way from the root to it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from substructures.expr.graph import Expr, Graph
from substructures.expr.laws.formulas import magnitude, maximum, minimum
from substructures.loads.pairs import Place
from substructures.mechanics.balls import BallJoint
from substructures.mechanics.composite_form import Inertia, JointMomentum
from substructures.mechanics.kinematics import (
    INTERFACE,
    Columns,
    Link,
    Pose,
    columns_beyond,
    fixed_link,
    from_body,
    joined,
)
from substructures.mechanics.linear3 import (
    IDENTITY,
    ZERO,
    Matrix,
    Scalar,
    Vector,
    apply,
)
from substructures.mechanics.ratios import Ratios
from substructures.mechanics.wrench import Wrench
from substructures.part.forces.wrenches import wrench_about_origin
from substructures.part.outputs import PartOutputs, Run, frame_placement, over_formulas
from substructures.part.part import Part
from substructures.part.relations import MULTIPLIER, OFFSET

#: the host of what is not mounted on a part
WORLD = -1


@dataclass(frozen=True)
class MountedPart:
    """A part in a tree: host (index of an earlier one, or WORLD), frame of the host, constant placement, bindings.

    ``first``: index of its first joint in the tree.
    """

    part: Part
    host: int
    frame: int
    E: Matrix
    position: Vector
    bindings: Mapping[str, Scalar]
    first: int


def ratios_of(run: Run, mounted: Sequence[MountedPart]) -> Ratios:
    """The coordinates of a tree that move its joints, over the scalars of ``run``."""
    of: list[int] = []
    movers: list[int] = []
    multipliers: list[Scalar] = []
    for m in mounted:
        # the coordinates of all parts before, of which this one's are not yet counted
        of += [len(movers) + i for i in m.part.topology.moved_by]
        movers += [m.first + c for c in m.part.topology.movers]
        if m.part.topology.is_related:
            found = run(m.part, m.bindings, (MULTIPLIER,))
            multipliers += [found.scalar(MULTIPLIER, a) for a in range(m.part.joint_count)]
        else:
            multipliers += [1] * m.part.joint_count
    return Ratios(tuple(of), tuple(multipliers), tuple(movers))


def balls_of(mounted: Sequence[MountedPart], names: Sequence[str] = ()) -> tuple[BallJoint, ...]:
    """The ball and floating joints of a tree; ``names``: of the instances, for those of their positions."""
    prefixes = [f"{name}." for name in names] or [""] * len(mounted)
    pairs = zip(mounted, prefixes, strict=True)
    return tuple(ball.mounted(m.first, prefix) for m, prefix in pairs for ball in m.part.topology.balls)


def balls_in(placed: Sequence[PlacedPart]) -> tuple[BallJoint, ...]:
    """The ball and floating joints of parts that have their places."""
    return balls_of([here.mounted for here in placed])


def joint_position(graph: Graph, m: MountedPart, c: int) -> Expr:
    """q of a joint of a mounted part: its coordinate, or what a relation makes of another one."""
    name = m.part.coordinates[m.part.topology.moved_by[c]]
    bound = m.bindings.get(name)
    q: Expr = graph.symbol(name) if bound is None else graph.lift(bound)
    if c in m.part.topology.movers:
        return q
    found = over_formulas(graph)(m.part, m.bindings, (MULTIPLIER, OFFSET))
    return q * graph.lift(found.scalar(MULTIPLIER, c)) + graph.lift(found.scalar(OFFSET, c))


def limits_of_movers(run: Run, m: MountedPart, limits: Mapping[int, tuple[Expr, Expr]]) -> dict[int, tuple[Expr, Expr]]:
    """What the limits of joints, by joint, leave of the ranges of the coordinates that move them; over formulas."""
    if not m.part.topology.is_related:
        return dict(limits)
    relations, result = run(m.part, m.bindings, (MULTIPLIER, OFFSET)), dict[int, tuple[Expr, Expr]]()
    for c, (low, high) in limits.items():
        k = m.part.topology.movers[m.part.topology.moved_by[c]]
        mu, delta = (low.graph.lift(relations.scalar(name, c)) for name in (MULTIPLIER, OFFSET))
        if mu.is_zero:
            # q^d = delta whatever q is: its limits bound nothing
            continue
        # q = (q^d - delta) / mu, between the smaller and the larger one of the ends
        ends = low if k == c else (low - delta) / mu, high if k == c else (high - delta) / mu
        least, most = ends if k == c else (minimum(*ends), maximum(*ends))
        known = result.get(k)
        result[k] = (maximum(known[0], least), minimum(known[1], most)) if known else (least, most)
    return result


def friction_of_movers(
    run: Run, m: MountedPart, laws: Mapping[int, tuple[Expr, Expr, Expr, Expr]]
) -> tuple[dict[int, tuple[Expr, Expr, Expr, Expr]], bool]:
    """F_c, F_s, v_s, v_0 by joint as those of the coordinates that move them, |mu| F at the rate |mu| q', and whether
    those of one coordinate are one law: of the same velocities.
    """
    if not m.part.topology.is_related:
        return dict(laws), True
    relations, result, is_one = run(m.part, m.bindings, (MULTIPLIER,)), dict[int, tuple[Expr, Expr, Expr, Expr]](), True
    for c, law in laws.items():
        k = m.part.topology.movers[m.part.topology.moved_by[c]]
        mu = magnitude(law[0].graph.lift(relations.scalar(MULTIPLIER, c)))
        if mu.is_zero:
            continue
        # mu F(mu q') = |mu| F(|mu| q') of an odd law: forces times |mu|, its velocities by |mu|
        F, S, v, w = law[0] * mu, law[1] * mu, law[2] / mu, law[3] / mu
        known = result.get(k)
        if known is not None:
            # the law is linear in both forces: with the same velocities a sum is one of its kind
            is_one = is_one and (known[2] - v).is_zero and (known[3] - w).is_zero
            F, S = known[0] + F, known[1] + S
        result[k] = F, S, v, w
    return result, is_one


@dataclass(frozen=True)
class EvaluatedPart:
    """The stored formulas of a part: ``outputs`` with what is mounted on its bodies, ``own`` values without it.

    ``carried``: everything that its joints carry, about O_c in frame c, and ``momenta`` of it; ``inertias``: what its
    carriers and its interface have of their own, as :mod:`.grouping` counts it.
    """

    mounted: MountedPart
    outputs: PartOutputs
    own: PartOutputs
    links: tuple[Link, ...]
    carried: tuple[Inertia, ...] = ()
    inertias: Mapping[int, Inertia] = field(default_factory=dict)
    momenta: tuple[JointMomentum, ...] = ()


@dataclass(frozen=True)
class PlacedPart:
    """An evaluated part on its host, or on the world (None).

    Everything is by joint here; where relations move some, coordinates come at the end (:func:`ratios_of`).

    ``seat``: the link from the carrier in the host, or from the world, to the interface. By carrier: ``columns`` of the
    host's and own coordinates, by index in the tree (of the interface only the host's), and ``gamma``, gravity in its
    axes.
    """

    evaluated: EvaluatedPart
    host: PlacedPart | None
    seat: Link
    columns: Mapping[int, Columns]
    gamma: Mapping[int, Vector]
    #: poses that were asked for, by carrier
    _poses: dict[int, Pose] = field(default_factory=dict, init=False, repr=False, compare=False)

    @property
    def mounted(self) -> MountedPart:
        """Where the tree document puts it."""
        return self.evaluated.mounted

    @property
    def part(self) -> Part:
        """The stored part."""
        return self.evaluated.mounted.part

    @property
    def first(self) -> int:
        """Index of its first joint in the tree."""
        return self.evaluated.mounted.first

    @property
    def outputs(self) -> PartOutputs:
        """The stored formulas, with what is mounted on the bodies."""
        return self.evaluated.outputs

    @property
    def links(self) -> tuple[Link, ...]:
        """Of its joints."""
        return self.evaluated.links

    def pose(self, carrier: int) -> Pose:
        """In the world, of joint frame k or of the interface; formed when it is first asked for, and kept."""
        # inwards to a pose that is known, and out again: trees may be deeper than recursion goes
        part, k, way = self, carrier, []
        while k not in part._poses:
            if k == INTERFACE and part.host is None:
                part._poses[k] = Pose(part.mounted.E, part.mounted.position)
                break
            link = part.seat if k == INTERFACE else part.links[k]
            way.append((part, k, link))
            part, k = (part.host or part) if k == INTERFACE else part, link.parent
        pose = part._poses[k]
        for part, k, link in reversed(way):
            pose = part._poses[k] = pose.beyond(link)
        return pose

    def from_carrier(self, link: Link) -> tuple[PlacedPart, Link]:
        """A link of this part over interfaces: the part of the carrier from which it leads, and the way from there.

        What is fixed to the world leads from the interface of the part that is mounted there.
        """
        part = self
        while link.parent == INTERFACE and part.host is not None:
            part, link = part.host, joined(part.seat, link)
        return part, link

    def frame_link(self, frame: int, E: Matrix = IDENTITY, position: Vector = ZERO) -> Link:
        """A frame (body or port), and a constant placement in it, as a link from O of its carrier."""
        placed = frame_placement(self.outputs, frame, E, position)
        return fixed_link(self.links, self.part.frame_carriers[frame], *placed)

    def place(self, frame: int, at: Vector = ZERO) -> Place:
        """A point of a frame."""
        link = self.frame_link(frame, IDENTITY, at)
        return Place(self, link.parent, from_body(self.links, link), self.pose(link.parent).beyond(link))

    def columns_beyond(self, link: Link) -> Columns:
        """Columns at the end of a link from one of its carriers, by index in the tree, in the axes there."""
        return columns_beyond(self.links, self.columns, link, self.first)

    def frame_kinematics(self, frame: int, E: Matrix = IDENTITY, position: Vector = ZERO) -> tuple[Pose, Columns]:
        """Pose in the world, and columns in the axes of a frame; ``E``, ``position``: a constant placement in it."""
        link = self.frame_link(frame, E, position)
        twists = self.columns_beyond(link)
        return self.pose(link.parent).beyond(link), twists

    def applied_wrenches(self) -> Iterator[tuple[int, Wrench]]:
        """The carrier of every force and torque, and its wrench about the body frame origin in the carrier's axes."""
        for i, (carrier, moment, world) in enumerate(self.part.wrenches):
            vector = self.outputs.vector("load.vector", i)
            if world:
                # R_k v: from the axes of the world to those of the carrier
                vector = apply(self.pose(carrier).R, vector)
            yield carrier, wrench_about_origin(self.outputs.vector("load.at", i), vector, moment)


def place(placed: Sequence[PlacedPart], part: int, frame: int, at: Vector = ZERO) -> Place:
    """A point of a frame; ``part``: index of a part, or WORLD."""
    return Place(None, INTERFACE, at, Pose(IDENTITY, at)) if part == WORLD else placed[part].place(frame, at)
