"""Coordinates that are bound to others, q = k q_of + c: mimic joints (URDF, SDF), equality joints of MJCF.

Within a part they are relations of its definition: the joint that follows has no coordinate. Between two parts, and
where joints are bound more often than they can be, both coordinates are free, and the binding comes along as a velocity
constraint q' - k q_of' = 0; the positions have to meet it at the start.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from substructures.errors import meant
from substructures.interchange.numbers import Number, is_zero
from substructures.interchange.report import Place, Report
from substructures.interchange.robot import Link, Mimic


def joints_of(links: Collection[Link]) -> dict[str, bool]:
    """The joints of a file, and whether they have one coordinate each."""
    compound = {link.joint: False for link in links if link.joint}
    return compound | {m.name: m.type in ("revolute", "prismatic") for link in links for m in link.motions}


def mimic_of(
    joint: str, of: str, factors: tuple[Number, Number], place: Place, joints: Mapping[str, bool], report: Report
) -> list[Mimic]:
    """A binding by multiplier and offset, told of; none, with a warning, but between two joints of one coordinate."""
    for each in (joint, of):
        if each not in joints:
            message = f"'{joint[:60]}' stays free: there is no joint '{each[:60]}'{meant(each, joints)}"
            report.lost(place, message, "topology")
            return []
    if joint == of or not (joints[joint] and joints[of]):
        message = f"'{joint[:60]}' is bound to '{of[:60]}', which are not two joints of one coordinate: it stays free"
        report.lost(place, message, "topology")
        return []
    return [Mimic(joint, of, *factors, place)]


def relations_of(
    mimics: Collection[Mimic], names: Mapping[str, str], report: Report
) -> tuple[list[dict[str, object]], list[Mimic]]:
    """Bindings as relations of a definition, and those that are none, told of; ``names``: its coordinates by joints.

    A joint that follows another already is let lead the one that it is bound to, if that is free.
    """
    before: dict[str, str] = {}
    found: list[dict[str, object]] = []
    left: list[Mimic] = []
    for mimic in mimics:
        relation = None
        if {mimic.joint, mimic.of} <= names.keys():
            relation = _relation(mimic, before)
        if relation is None:
            report.warning(mimic.place, mimic.message, "topology")
            left.append(mimic)
            continue
        follower, leader = str(relation["coordinate"]), str(relation["of"])
        before[follower] = leader
        report.merged(mimic.place, f"a relation: '{follower[:60]}' moves with '{leader[:60]}' and has no coordinate")
        found.append(relation | {"coordinate": names[follower], "of": names[leader]})
    return found, left


def _relation(mimic: Mimic, before: Mapping[str, str]) -> dict[str, object] | None:
    """In the names of joints; None where both follow others, or each other. ``before``: what joints follow."""
    if _leads(before, mimic.joint, mimic.of):
        return {"coordinate": mimic.joint, "of": mimic.of, "multiplier": mimic.multiplier, "offset": mimic.offset}
    if is_zero(mimic.multiplier) or not _leads(before, mimic.of, mimic.joint):
        return None
    # q_of = q / k - c / k
    k, c = f"({mimic.multiplier})", f"({mimic.offset})"
    return {"coordinate": mimic.of, "of": mimic.joint, "multiplier": f"1/{k}", "offset": f"-{c}/{k}"}


def _leads(before: Mapping[str, str], follower: str, leader: str) -> bool:
    """Whether a joint may follow another one: it follows none, and the other does not follow it."""
    if follower in before:
        return False
    while leader in before:
        leader = before[leader]
    return leader != follower
