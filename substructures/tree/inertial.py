"""Metric and Christoffel symbols of a tree of parts, in evaluation frames (notation.md, sections 5 and 6).

Frames are chosen for the tree as a whole, as they would be for the same joints in one piece. Where the frames of a part
are those of its stored formulas its own entries are taken over as they are; where its momenta are carried on into a
host, a component of theirs gives its own entries as well, with fewer operations. Trees of parallel axes have theirs by
absolute angles (:mod:`substructures.mechanics.parallel_axes`), over the borders of parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from substructures.expr.graph import Graph
from substructures.mechanics.composite_form import about_one_direction
from substructures.mechanics.evaluation_frames import Entries, Frames, InertialEntries
from substructures.mechanics.frame_choice import evaluation_frames
from substructures.mechanics.kinematics import INTERFACE, Link, constant_rotation
from substructures.mechanics.linear3 import ZERO, Rotation
from substructures.mechanics.parallel_axes import ByAngles, absolute
from substructures.part.outputs import Run, links_of, over_formulas
from substructures.tree.mounted_part import WORLD, EvaluatedPart, MountedPart, PlacedPart

#: stored outputs that make up the links of a part
LINKS = ("E.tilt", "E.turn", "E.full", "Z", "tau")
#: constant placements of its frames
FRAMES = ("frame.E", "frame.position")
EQUATIONS = ("metric", "christoffel")


@dataclass(frozen=True)
class Plan:
    """The links of a tree and e(c), by index there; of every part, which of EQUATIONS are taken over as stored.

    ``outlined``: links and seats of the parts, where they were looked at; ``by_angles``: the joints whose entries are
    by absolute angles.
    """

    chain: Sequence[Link]
    frames: Frames
    stored: Sequence[Sequence[str]]
    outlined: Sequence[PlacedPart] = ()
    by_angles: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Inertial:
    """g_ab for a <= b and Gamma_abc for a < c, b <= c, by indices of the tree's joints."""

    metric: Entries
    christoffel: Entries | None


def planned(run: Run, mounted: Sequence[MountedPart], christoffel: bool, chosen: bool) -> Plan:
    """Frames for the fewest operations; not ``chosen``: every joint in its own frame and all own entries as stored."""
    # where relations move joints, what is stored is of the coordinates, and of rates where there are ball joints
    kinds = [
        ()
        if m.part.topology.is_related or m.part.topology.balls
        else EQUATIONS
        if christoffel and m.part.has_christoffel
        else EQUATIONS[:1]
        for m in mounted
    ]
    if not chosen:
        # where nothing is carried from joint to joint, links are only of some kind
        kind_only = [Link(j.parent, j.s, Rotation(), ZERO) for m in mounted for j in m.part.topology.joints]
        return Plan(kind_only, range(len(kind_only)), kinds)
    outlined = _outlined(run, mounted)
    chain = _tree_links(outlined)
    frames, by_angles = evaluation_frames(chain, christoffel), absolute(chain)
    sums = _moments_summed(chain)
    is_same = [_is_as_stored(m, frames, by_angles, sums) for m in mounted]
    stored = [some if same else () for some, same in zip(kinds, is_same, strict=True)]
    return Plan(chain, frames, stored, outlined, by_angles)


def _moments_summed(chain: Sequence[Link]) -> set[tuple[int, int]]:
    """Joints p, c: the moment of inertia about the axis of p is a sum of moments about axes, that of c among them."""
    axes = {link.parent for link, parallel in zip(chain, about_one_direction(chain), strict=True) if parallel}
    return {(link.parent, c) for c, link in enumerate(chain) if link.parent in axes}


def _is_as_stored(m: MountedPart, frames: Frames, by_angles: frozenset[int], sums: set[tuple[int, int]]) -> bool:
    """Whether the tree wants the entries of a part as they are stored: in the same frames, from the same ``sums`` of
    moments, and not by absolute angles, which the tree has from the links and what is fixed in the carriers.
    """
    # what is stored is right in any case, but may take more operations than what the tree would form itself
    links = links_of(m.part, over_formulas(Graph())(m.part, {}, LINKS))
    if m.part.topology.is_related or absolute(links) or by_angles.intersection(_joints(m)):
        return False
    stored, own = evaluation_frames(links, m.part.has_christoffel), _moments_summed(links)
    if {(m.first + p, m.first + c) for p, c in own} != {pair for pair in sums if pair[0] in _joints(m)}:
        return False
    return [m.first + e for e in stored] == [frames[c] for c in _joints(m)]


def _joints(m: MountedPart) -> range:
    """Indices of the joints of a part in the tree."""
    return range(m.first, m.first + m.part.joint_count)


def inertial_entries(plan: Plan, placed: Sequence[PlacedPart], christoffel: bool, by_angles: ByAngles) -> Inertial:
    """Of all parts; hosts come before what is mounted on them. ``by_angles``: what is known of joints of the plan."""
    columns = {here.first + c: here.columns[c] for here in placed for c in range(len(here.links))}
    entries = InertialEntries(plan.chain, columns, plan.frames)
    g_ab, gamma_abc = dict(by_angles.metric), dict(by_angles.christoffel)
    for here, names in zip(placed, plan.stored, strict=True):
        first = here.first
        # a, b <= c in the part: as stored, with all that it carries by its inertia symbols, armature included
        for name, all_of in ((name, g_ab if name == "metric" else gamma_abc) for name in names):
            stored = here.outputs.entries(name)
            all_of |= {tuple(first + a for a in index): x for index, x in stored.items()}
        for c, momentum in enumerate(here.evaluated.momenta, first):
            if c not in by_angles.joints:
                g_ab |= entries.metric(c, momentum, first if "metric" in names else None)
            if "metric" not in names:
                # the rotor of joint c turns with q'^c alone
                g_ab[c, c] = g_ab[c, c] + here.evaluated.own.scalar("armature", c - first)
            if christoffel and c not in by_angles.joints:
                gamma_abc |= entries.christoffel(c, momentum, first if "christoffel" in names else None)
    return Inertial(g_ab, gamma_abc if christoffel else None)


def _outlined(run: Run, mounted: Sequence[MountedPart]) -> list[PlacedPart]:
    """Links and seats of all parts, without columns and momenta."""
    result: list[PlacedPart] = []
    for m in mounted:
        outputs = run(m.part, m.bindings, (*LINKS, *FRAMES))
        host = None if m.host == WORLD else result[m.host]
        seat = Link(INTERFACE, 0, constant_rotation(m.E), m.position)
        if host is not None:
            seat = host.frame_link(m.frame, m.E, m.position)
        result.append(PlacedPart(EvaluatedPart(m, outputs, outputs, links_of(m.part, outputs)), host, seat, {}, {}))
    return result


def _tree_links(placed: Sequence[PlacedPart]) -> list[Link]:
    """What leads from joint to joint in the tree, by index there: the way over an interface is part of it."""
    result: list[Link] = []
    for here in placed:
        for link in here.links:
            part, whole = here.from_carrier(link)
            index = INTERFACE if whole.parent == INTERFACE else part.first + whole.parent
            result.append(Link(index, whole.s, whole.rotation, whole.Z, whole.tau))
    return result
