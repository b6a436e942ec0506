"""Coordinates that are bound to others, q = k q_of + c: mimic joints (URDF, SDF), equality joints of MJCF.

A tree has no bound coordinates: both are free, and the binding comes along as a velocity constraint q' - k q_of' = 0.
In independent velocities it makes the metric G^T g G, G = dq/dq_of; the positions have to meet it at the start.
"""

from __future__ import annotations

from collections.abc import Collection

from substructures.interchange.numbers import Number
from substructures.interchange.report import Place, Report
from substructures.interchange.robot import Link, Mimic


def single_coordinates(links: Collection[Link]) -> set[str]:
    """The joints of one coordinate each."""
    return {m.name for link in links for m in link.motions if m.type in ("revolute", "prismatic")}


def mimic_of(
    joint: str, of: str, factors: tuple[Number, Number], place: Place, known: Collection[str], report: Report
) -> list[Mimic]:
    """A binding by multiplier and offset, told of; none, with a warning, but between two ``known`` joints."""
    if joint == of or joint not in known or of not in known:
        message = f"'{joint[:60]}' is bound to '{of[:60]}', which are not two joints of one coordinate: it stays free"
        report.warning(place, message, "topology")
        return []
    multiplier, offset = factors
    message = (
        f"'{joint}' = {multiplier} * '{of}' + {offset}: both coordinates are free here; add the velocity constraint "
        f"that is told in 'bindings' to simulations and velocity-equations"
    )
    report.warning(place, message, "topology")
    return [Mimic(joint, of, multiplier, offset, place)]
