"""Which masses may change their link without any effect: what base parameters consist of (notation.md, section 7).

A distribution of mass that a joint does not move against its parent may be counted with either link:

* on the axis of a revolute joint: m at a point of the axis, s along it, J_33 along it;
* without m and s, a prismatic joint, which does not turn: all of J;
* what is fixed in its parent: all ten;
* where a loop of the reduced level is cut, at frames that coincide, in the same way by the joint that is cut.

These are M. Gautier's and W. Khalil's rules of regrouping, from the leaves to the root (Direct calculation of minimum
set of inertial parameters of serial robots, IEEE Transactions on Robotics and Automation 6(3), 1990), for trees with
axes and frames in any place. Every one is a relation between columns of the regressor, with constant coefficients:

    sum_i D_i Y_ki - sum_i D'_i Y_pi = 0            (D: the distribution in the frame of k, D': in that of its parent p)

where Y of the ground is zero. There may be more (axes along gravity, parallel axes): these do not belong to one joint.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from substructures.expr.graph import Expr, Graph
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import INTERFACE, carrier_link, constant_rotation, from_body
from substructures.mechanics.linear3 import Scalar, negate, transpose
from substructures.tree.cuts import Cut
from substructures.tree.mounted_part import WORLD, PlacedPart

#: columns of one link
TEN = 10
#: a part by its number, and a carrier in it
_Place = tuple[int, int]


def named_frames(here: PlacedPart) -> dict[int, int]:
    """The frame that every link of a part is named by, by carrier, in the order of the columns of the regressor."""
    frames = list(here.part.topology.carrier.values())
    found = {c: frames.index(c) for c in sorted(here.part.inertia_symbols)}
    # what is fixed to the interface, where that moves; its first frame is the base itself
    if here.columns[INTERFACE] and here.part.frame_carriers[: len(frames)].count(INTERFACE) > 1:
        found[INTERFACE] = frames.index(INTERFACE)
    return found


def relations(
    graph: Graph, placed: Sequence[PlacedPart], loops: Sequence[Cut] = ()
) -> tuple[list[dict[int, Expr]], int]:
    """Coefficients by column, parents before what they carry, and the number of all columns.

    ``placed``: the parts of a tree with all coordinates put to zero; ``loops``: closures that hold. Ten columns of
    every link, in the order of the regressor; then ten of every carrier without mass, about its body frame origin, to
    be eliminated.
    """
    found = _Regrouping(graph, placed)
    rows = [*found.result(), *(row for cut in loops for row in found.over(cut))]
    return rows, TEN * len(found.first)


class _Regrouping:
    """The columns of every carrier that moves: the first of the ten."""

    def __init__(self, graph: Graph, placed: Sequence[PlacedPart]) -> None:
        self.graph, self.placed = graph, placed
        self.frames = [named_frames(here) for here in placed]
        named = [(i, c) for i, frames in enumerate(self.frames) for c in frames]
        moving = [(i, c) for i, here in enumerate(placed) for c in (INTERFACE, *range(len(here.links)))]
        self.moving = [(i, c) for i, c in moving if c != INTERFACE or placed[i].columns[INTERFACE]]
        known = set(named)
        order = [*named, *(at for at in self.moving if at not in known)]
        self.first = {at: TEN * k for k, at in enumerate(order)}

    def result(self) -> list[dict[int, Expr]]:
        """Those over joints."""
        return [row for at in self.moving for row in self._of(at)]

    def over(self, cut: Cut) -> Iterator[dict[int, Expr]]:
        """Those over the joint of a closure."""
        for own in MEETING.get(cut.rows.type, ()):
            row: dict[int, Expr] = {}
            for end, sign in ((cut.start, 1), (cut.end, -1)):
                if end.part == WORLD:
                    continue
                here = self.placed[end.part]
                link = here.frame_link(end.frame, end.E, end.position)
                inertia = _unit(own).in_parent(link.rotation, from_body(here.links, link))
                if (end.part, link.parent) in self.first:
                    some = self._coefficients((end.part, link.parent), inertia, sign)
                    row |= {j: row[j] + x if j in row else x for j, x in some.items()}
            yield row

    def _of(self, at: _Place) -> Iterator[dict[int, Expr]]:
        """Those over the joint of one carrier."""
        i, k = at
        here = self.placed[i]
        link = here.seat if k == INTERFACE else here.links[k]
        outer = here.host if k == INTERFACE else here
        if outer is None:
            return
        host = here.mounted.host if k == INTERFACE else i
        for own in _unmoved(k, link.s):
            # from the body frame of k about O_k, and from there to the body frame of its parent
            at_joint = own.shifted((0, 0, carrier_link(here.links, k).tau))
            above = at_joint.in_parent(link.rotation, from_body(outer.links, link))
            row = self._coefficients(at, own, 1)
            if (host, link.parent) in self.first:
                row |= self._coefficients((host, link.parent), above, -1)
            yield row

    def _coefficients(self, at: _Place, inertia: Inertia, sign: int) -> dict[int, Expr]:
        """Ten parameters about the body frame origin of a carrier, in the frame that its link is named by."""
        (i, k), first = at, self.first[at]
        frame = self.frames[i].get(k)
        if frame is not None:
            outputs = self.placed[i].outputs
            E, r = outputs.matrix("frame.E", frame), outputs.vector("frame.position", frame)
            inertia = inertia.shifted(negate(r)).turned_back(constant_rotation(transpose(E)))
        lifted = (self.graph.lift(x) for x in (inertia.m, *inertia.s, *inertia.J))
        return {first + j: x * sign for j, x in enumerate(lifted) if not x.is_zero}


#: what the joint of a closure does not move, by its type: m, s_3 and J_33 on an axis, m at a point, J, or all
MEETING = {
    **dict.fromkeys(("pin", "revolute"), (0, 3, 6)),
    **dict.fromkeys(("ball", "spherical", "universal"), (0,)),
    **dict.fromkeys(("slider", "prismatic"), tuple(range(4, TEN))),
    **dict.fromkeys(("weld", "fixed"), tuple(range(TEN))),
}


def _unmoved(k: int, s: int) -> list[Inertia]:
    """Distributions in the body frame of a carrier that its joint does not move."""
    ten = [_unit(j) for j in range(TEN)]
    if k == INTERFACE:
        return ten
    # J of a prismatic joint; m, s_3, J_33 of a revolute one
    return ten[4:] if s else [ten[0], ten[3], ten[6]]


def _unit(j: int) -> Inertia:
    """One of m, s = (x, y, z), J = (xx, yy, zz, xy, xz, yz) put to one."""
    m, sx, sy, sz, xx, yy, zz, xy, xz, yz = (int(i == j) for i in range(TEN))
    s: tuple[Scalar, Scalar, Scalar] = (sx, sy, sz)
    return Inertia(m, s, (xx, yy, zz, xy, xz, yz))
