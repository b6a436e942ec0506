"""Loops of a part in a plane: the joints around a closure that no one knows yet, their places, and what it demands.

Everything is seen from the last carrier that both ends have in common; the plane is across the axis of a joint.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from substructures.expr.graph import Expr, Graph
from substructures.expr.walk import transfer
from substructures.mechanics.kinematics import INTERFACE, Link, Pose, fixed_link
from substructures.mechanics.linear3 import E3, IDENTITY, ZERO, Matrix, Vector, apply, sub, transpose
from substructures.part.frames import CutFrames
from substructures.part.outputs import PartOutputs, frame_placement, links_of
from substructures.part.part import Part
from substructures.tree.given.loops.dependent import NotReduced
from substructures.tree.given.loops.triangle import Closing, Complex, Motion, conjugate, cross, over, plus, times

#: types of closures in a plane, by how many of the three numbers of a motion in it they leave free
TURNING = ("pin", "revolute", "ball", "spherical", "cylindrical")
SLIDING, FIXED, ROD = ("slider", "prismatic"), ("weld", "fixed"), "rod"


@dataclass(frozen=True)
class Unknown:
    """A joint around a loop: coordinate, and how its motion in the plane is that by it: q = sign * the motion's."""

    coordinate: str
    sign: int


@dataclass(frozen=True)
class Loop:
    """Three motions, of which the first ones are of ``unknown`` joints and the others of what is cut, and where they
    have to lead; ``known``: places of joints that are known, beside; ``rows``: what is zero where it is closed, as
    formulas of all coordinates.
    """

    unknown: tuple[Unknown, ...]
    motions: tuple[Motion, ...]
    K: Closing
    known: tuple[Complex, ...]
    rows: tuple[Expr, ...]


class Chains:
    """The links of a part as formulas of its own symbols, and the carriers on the way to each."""

    def __init__(self, graph: Graph, part: Part, outputs: PartOutputs) -> None:
        self.graph, self.part, self.outputs, self.links = graph, part, outputs, links_of(part, outputs)

    def path(self, carrier: int) -> list[int]:
        """Carriers from the interface, which is not among them, to this one."""
        found: list[int] = []
        while carrier != INTERFACE:
            found.append(carrier)
            carrier = self.links[carrier].parent
        return found[::-1]

    def end(self, frame: str, E: Matrix = IDENTITY, position: Vector = ZERO) -> Link:
        """A frame with a placement in it, as a link from its carrier."""
        place = self.part.frames.index(frame)
        placed = frame_placement(self.outputs, place, E, position)
        return fixed_link(self.links, self.part.frame_carriers[place], *placed)

    def pose(self, way: Sequence[int], end: Link | None = None) -> Pose:
        """Of what carriers, one after the other, lead to."""
        found = Pose(IDENTITY, ZERO)
        for link in (*(self.links[k] for k in way), *(() if end is None else (end,))):
            found = found.beyond(link)
        return found

    def ways(self, from_: str, to: str, cut: CutFrames) -> tuple[tuple[list[int], list[int]], tuple[Link, Link]]:
        """Carriers on the ways to both ends of a closure from the last one that they have in common; the ends."""
        ends = self.end(from_, cut.start), self.end(to, cut.end, cut.position)
        first, other = (self.path(end.parent) for end in ends)
        while first and other and first[0] == other[0]:
            # what carries both ends moves neither against the other
            first, other = first[1:], other[1:]
        return (first, other), ends


def loop_of(chains: Chains, closure: tuple[str, str, str], cut: CutFrames, known: Collection[str]) -> Loop:
    """The loop of a closure (type, from, to). ``known``: coordinates that move by themselves, or that were found.

    Raises NotReduced.
    """
    return _Reader(chains, closure, cut, known).loop()


class _Reader:
    """One closure of a part."""

    def __init__(self, chains: Chains, closure: tuple[str, str, str], cut: CutFrames, known: Collection[str]) -> None:
        self.chains, self.type, self.cut, self.graph = chains, closure[0], cut, chains.graph
        self.ways, self.ends = chains.ways(closure[1], closure[2], cut)
        first, other = self.ways
        topology = chains.part.topology
        names = [chains.part.coordinates[i] for i in topology.moved_by]
        moved = [k for k in (*first, *other) if names[k] not in known]
        if any(k not in topology.movers for k in moved):
            raise NotReduced("relations move a joint of the loop with one that depends on others")
        self.names, self.moved = names, frozenset(moved)

    def loop(self) -> Loop:
        """Where all unknown coordinates are zero, and as it is."""
        first, other = self.ways
        # from B back to the common carrier and out to A: on the way back a joint moves by -q
        order = [*((k, 1, -1) for k in reversed(other)), *((k, 0, 1) for k in first)]
        open_ = [(k, side, sign) for k, side, sign in order if k in self.moved]
        # motions in the plane that the cut joint leaves: with the unknown joints there have to be three
        cuts = {**dict.fromkeys(TURNING, 1), **dict.fromkeys(SLIDING, 1), **dict.fromkeys(FIXED, 0), ROD: 2}
        if self.type not in cuts:
            raise NotReduced(f"its type '{self.type}' is none of a loop in a plane")
        if len(open_) + cuts[self.type] != 3:
            raise NotReduced(f"of the coordinates around it {len(open_)} are unknown")
        places = {k: self._at_zero(self.chains.pose(self._way(k))) for k, _, _ in open_}
        poses = [self._at_zero(self.chains.pose(way, end)) for way, end in zip(self.ways, self.ends, strict=True)]
        plane = self._plane([places[k] for k, _, _ in open_ if not self.chains.links[k].s] + poses[:1])
        motions, unknown = list[Motion](), list[Unknown]()
        for k, _, sign in open_:
            motion, turned = self._motion(plane, places[k], k)
            motions.append(motion)
            unknown.append(Unknown(self.names[k], sign * turned))
        ends = [plane.point(pose.r) for pose in poses]
        self._require_in_plane(plane, poses)
        turn = self._turn(plane, poses)
        motions += self._of_cut(plane, poses, ends[0])
        # the far end of a rod is what has to come to B
        start = motions[-1].at if self.type == ROD else ends[0]
        motions = [replace(motion, length2=self._length2(open_, i)) for i, motion in enumerate(motions)]
        # turns that are known: one of them may be the fourth corner of a parallelogram
        fixed = [k for way in self.ways for k in way if k not in self.moved and not self.chains.links[k].s]
        known = tuple(plane.point(self._at_zero(self.chains.pose(self._way(k))).r) for k in fixed)
        return Loop(tuple(unknown), tuple(motions), Closing(turn, start, ends[1]), known, self._rows(plane))

    def _way(self, k: int) -> list[int]:
        """From the carrier that both ends have in common to k."""
        way = next(way for way in self.ways if k in way)
        return way[: way.index(k) + 1]

    def _at_zero(self, pose: Pose) -> Pose:
        zeros = {self.names[k]: self.graph.zero for k in self.moved}
        given = [self.graph.lift(x) for row in (*pose.R, pose.r) for x in row]
        x = transfer(given, self.graph, zeros)
        return Pose(((x[0], x[1], x[2]), (x[3], x[4], x[5]), (x[6], x[7], x[8])), (x[9], x[10], x[11]))

    def _plane(self, poses: Sequence[Pose]) -> _Plane:
        """Across the axis of the first turn; along axes of the carrier, where they are in it."""
        # R: common carrier -> joint frame, so that its third row is the joint axis in the carrier
        axis = [self.graph.lift(x) for x in poses[0].R[2]]
        for i in range(3):
            for sign in (1, -1):
                if all((x - sign * (i == j)).is_zero for j, x in enumerate(axis)):
                    # right-handed for both senses of the axis
                    j, k = ((i + 1) % 3, (i + 2) % 3)[::sign]
                    return _Plane(self.graph, (IDENTITY[j], IDENTITY[k], tuple(sign * x for x in IDENTITY[i])))  # type: ignore[arg-type]
        return _Plane(self.graph, poses[0].R)

    def _motion(self, plane: _Plane, pose: Pose, k: int) -> tuple[Motion, int]:
        """Of a joint, and 1 or -1 by the sense of its axis."""
        x, y, z = plane.all(apply(transpose(pose.R), E3))
        if self.chains.links[k].s:
            if not z.is_zero:
                raise NotReduced(f"'{self.names[k]}' slides out of the plane of the loop")
            return Motion(False, (x, y)), 1
        for sign in (1, -1):
            if (z - sign).is_zero:
                return Motion(True, plane.point(pose.r)), sign
        raise NotReduced(f"the axis of '{self.names[k]}' is not across the plane of the loop")

    def _require_in_plane(self, plane: _Plane, poses: Sequence[Pose]) -> None:
        """Raises NotReduced unless the ends can meet."""
        # along its axis, which is across the plane, it slides as it has to
        is_free = self.type == "cylindrical"
        if not is_free and not plane.all(sub(poses[1].r, poses[0].r))[2].is_zero:
            raise NotReduced("its ends are not in one plane")
        if self.type in TURNING and self.type not in ("ball", "spherical"):
            across = [plane.all(apply(transpose(pose.R), E3))[2] for pose in poses]
            if not any(all((z - sign).is_zero for z in across) for sign in (1, -1)):
                raise NotReduced("the axis of the joint that is cut is not across the plane of the loop")
        elif self.type in (*SLIDING, *FIXED):
            for axis in IDENTITY:
                a, b = (plane.all(apply(transpose(pose.R), axis))[2] for pose in poses)
                if not (a - b).is_zero:
                    raise NotReduced("its ends are turned against each other")

    def _turn(self, plane: _Plane, poses: Sequence[Pose]) -> Complex:
        """e^(i kappa), the turn from the axes of A to those of B; 1 where the cut joint turns."""
        if self.type not in (*SLIDING, *FIXED):
            # the total turn is free, as the cut joint turns by itself: 1 fixes it
            return self.graph.one, self.graph.zero
        axes = [[plane.all(apply(transpose(pose.R), axis)) for axis in IDENTITY] for pose in poses]
        flat = [(a[:2], b[:2]) for a, b in zip(*axes, strict=True) if a[2].is_zero]
        if flat:
            # an axis in the plane has length 1 there: b a* is the turn
            return times(flat[0][1], conjugate(flat[0][0]))
        # b_i = k a_i for the shadows of all three axes, and sum of |a_i|^2 = 2, the trace of the projection
        total: Complex = self.graph.zero, self.graph.zero
        for a, b in zip(*axes, strict=True):
            total = plus(total, times(b[:2], conjugate(a[:2])))
        return over(total, self.graph.number(2))

    def _of_cut(self, plane: _Plane, poses: Sequence[Pose], end: Complex) -> Iterator[Motion]:
        """The motions of the joint that is cut, at A."""
        if self.type in SLIDING:
            x, y, z = plane.all(apply(transpose(poses[0].R), E3))
            if not z.is_zero:
                raise NotReduced("the joint that is cut slides out of the plane of the loop")
            yield Motion(False, (x, y))
        elif self.type not in FIXED:
            yield Motion(True, end)
            if self.type == ROD:
                # where all is at zero the rod may point anywhere: along the first axis of the plane
                yield Motion(True, plus(end, (self.cut.length, self.graph.zero)))

    def _length2(self, open_: Sequence[tuple[int, int, int]], i: int) -> Expr | None:
        """The square of the distance of motion i from the next one, of the last from the first, where one chain without
        the common carrier holds both: as seen from the joint that comes first there.
        """
        if self.type == ROD and i == 1:
            return self.cut.length * self.cut.length
        count, is_cut = len(open_), self.type in (*TURNING, ROD)
        if i + 1 < count:
            (k, side, _), (other, beside, _) = open_[i : i + 2]
            way = self.ways[side]
            if side != beside or self.chains.links[other].s:
                return None
            first, last = sorted((way.index(k), way.index(other)))
            beyond, end = way[first + 1 : last + 1], None
        elif is_cut and i in (count - 1, 2):
            # from the last joint to A, from B to the first one
            k, side, _ = open_[i if i < count else 0]
            way = self.ways[side]
            beyond, end = way[way.index(k) + 1 :], self.ends[side]
            if side != (i >= count):
                return None
        else:
            return None
        if self.chains.links[k].s:
            return None
        # in the frame of a joint whose axis is across the plane the plane is that of its first two axes
        x, y = (self.graph.lift(c) for c in self._at_zero(self.chains.pose(beyond, end)).r[:2])
        return x * x + y * y

    def _rows(self, plane: _Plane) -> tuple[Expr, ...]:
        """Along the axes of the plane; the angle between axes of both ends."""
        A, B = (self.chains.pose(way, end) for way, end in zip(self.ways, self.ends, strict=True))
        x, y, z = plane.all(sub(B.r, A.r))
        if self.type == ROD:
            return ((x * x + y * y + z * z) / 2,)
        if self.type in TURNING:
            return x, y
        axes = [[plane.all(apply(transpose(pose.R), axis)) for axis in IDENTITY] for pose in (A, B)]
        # sines of the angle, each times a constant: any that is not zero for all coordinates will do
        turned = [cross(a[:2], b[:2]) for a, b in zip(*axes, strict=True)]
        angle = next((t for t in turned if not t.is_zero), self.graph.zero)
        return (cross(axes[0][2][:2], (x, y)), angle) if self.type in SLIDING else (x, y, angle)


@dataclass(frozen=True)
class _Plane:
    """``E``: to two axes in the plane and one across it."""

    graph: Graph
    E: Matrix

    def all(self, v: Vector) -> tuple[Expr, Expr, Expr]:
        """Components of a vector."""
        x, y, z = (self.graph.lift(c) for c in apply(self.E, v))
        return x, y, z

    def point(self, v: Vector) -> Complex:
        """Those in the plane."""
        return self.all(v)[:2]
