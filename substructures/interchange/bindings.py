"""Coordinates that are bound to others, q = k q_of + c: mimic joints (URDF, SDF), equality joints of MJCF.

A tree has no bound coordinates: both are free, and the binding comes along as a velocity constraint q' - k q_of' = 0.
In independent velocities it makes the metric G^T g G, G = dq/dq_of; the positions have to meet it at the start.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from substructures.errors import meant
from substructures.interchange.numbers import Number
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
    mimic = Mimic(joint, of, *factors, place)
    report.warning(place, mimic.message, "topology")
    return [mimic]
