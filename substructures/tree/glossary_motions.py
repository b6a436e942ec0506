"""What motions, forces and moments of the recursions are called (see :mod:`substructures.tree.glossary`).

The same functions as for velocity forces and inverse dynamics are run, so that every step of theirs is here, too. Of
two joints (i, k) is what belongs to i at the joint between both, in the frame of k.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from substructures.mechanics.composite_form import JointMomentum
from substructures.mechanics.kinematics import INTERFACE, Link, from_body
from substructures.mechanics.linear3 import Matrix, Scalar, Vector, negate
from substructures.mechanics.newton_euler import BodyMotion
from substructures.mechanics.velocity_forces import motions_before, transmitted
from substructures.mechanics.wrench import Wrench
from substructures.tree.forces.velocity_forces import outermost
from substructures.tree.grouping import on_carriers
from substructures.tree.inverse_dynamics import body_motions, inertial_loads, pass_back, subtract_applied
from substructures.tree.mounted_part import PlacedPart

AXES = "xyz"
#: by (letter, numbers of joints, component), in the order in which names are taken
Glossary = dict[tuple[str, tuple[int, ...], str], Scalar]


def vector(letter: str, joints: tuple[int, ...], components: Vector) -> Glossary:
    """The components of a vector."""
    return {(letter, joints, axis): x for axis, x in zip(AXES, components, strict=True)}


def matrix(letter: str, joints: tuple[int, ...], rows: Matrix) -> Glossary:
    """The elements of a matrix."""
    return {
        (letter, joints, i + j): x for i, row in zip(AXES, rows, strict=True) for j, x in zip(AXES, row, strict=True)
    }


def velocity_terms(
    placed: Sequence[PlacedPart], chain: Sequence[Link], momenta: Sequence[JointMomentum], rates: Sequence[Scalar]
) -> Glossary:
    """Of the recursion for Gamma_abc q'^b q'^c: alpha.0, A.0 and a.0 (without gravity), a.g with q'' = 0, wrenches."""
    found: Glossary = {}
    # a = -gamma
    falling = {
        here.first + c: BodyMotion(a=negate(outermost(here).gamma[INTERFACE]))
        for here in placed
        for c in range(len(here.links))
    }
    starts: tuple[tuple[str, Mapping[int, BodyMotion]], ...] = (("a.0", {}), ("a.g", falling))
    for letter, start in starts:
        before = motions_before(chain, rates, start)
        for k, (link, motion) in enumerate(zip(chain, before, strict=True)):
            names = "alpha.0", letter, "A.0"
            found |= _motion(names, (k,), motion.moved(link.s, rates[k], 0)) | _motion(names, (link.parent, k), motion)
        for k, (link, sent) in enumerate(zip(chain, transmitted(chain, momenta, rates, before), strict=True)):
            found |= _wrench("F.0", "N.0", (k,), sent.own)
            wrench = sent.beyond + sent.own
            found |= _wrench("f.0", "n.0", (k,), wrench)
            found |= _wrench("f.0", "n.0", (k, link.parent), wrench.before(link.Z, link.rotation))
    return found


def inverse_terms(
    placed: Sequence[PlacedPart], chain: Sequence[Link], rates: Sequence[Scalar], accelerations: Sequence[Scalar]
) -> Glossary:
    """Of Newton and Euler's recursion: omega, alpha, a, A of bodies, F and N that move them, f and n of joints."""
    found: Glossary = {}
    names = "alpha", "a", "A"
    inertias = on_carriers(placed)
    motions = body_motions(placed, rates, accelerations, inertias)
    for here, own in zip(placed, motions, strict=True):
        for c, link in enumerate(here.links):
            k = here.first + c
            before = own[link.parent].at_joint(link, from_body(here.links, link))
            found |= _motion(names, (k,), own[c]) | _motion(names, (chain[k].parent, k), before)
    loads = inertial_loads(inertias, motions)
    # before loads are taken off: what moves the body; afterwards, added up in place: what joints transmit
    for k, wrench in _by_joint(placed, loads):
        found |= _wrench("F", "N", (k,), wrench)
    subtract_applied(placed, loads)
    pass_back(placed, loads, len(rates))
    for here, wrenches in zip(placed, loads, strict=True):
        for c, link in enumerate(here.links):
            k, about = here.first + c, wrenches[c].about_joint(link.tau)
            parent = about.before(from_body(here.links, link), link.rotation)
            found |= _wrench("f", "n", (k,), wrenches[c]) | _wrench("f", "n", (chain[k].parent, k), about)
            found |= _wrench("f", "n", (k, chain[k].parent), parent)
    return found


def _by_joint(placed: Sequence[PlacedPart], loads: Sequence[Mapping[int, Wrench]]) -> Iterator[tuple[int, Wrench]]:
    """Index in the tree, and what belongs to the carrier of the joint."""
    for here, own in zip(placed, loads, strict=True):
        for c in range(len(here.links)):
            yield here.first + c, own[c]


def _motion(names: tuple[str, str, str], joints: tuple[int, ...], motion: BodyMotion) -> Glossary:
    """omega, and under the names angular acceleration, acceleration and the elements of A."""
    alpha, a, field = names
    found = vector("omega", joints, motion.omega) | vector(alpha, joints, motion.alpha) | vector(a, joints, motion.a)
    return found | matrix(field, joints, motion.field())


def _wrench(force: str, moment: str, joints: tuple[int, ...], wrench: Wrench) -> Glossary:
    return vector(force, joints, wrench.f) | vector(moment, joints, wrench.n)
