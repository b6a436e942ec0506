"""Rotor inertia in URDF: <transmission> with an actuator, as Drake has it, is the armature of a joint.

A rotor with moment of inertia I behind gears of ratio n turns at n q': n^2 I is seen at the joint.
Source: R. Featherstone, Rigid Body Dynamics Algorithms, 2008, section 9.6.
"""

from __future__ import annotations

from collections.abc import Mapping

from substructures.interchange.numbers import ZERO, Number, decimal_of, is_zero, number_of, value
from substructures.interchange.report import Report
from substructures.interchange.xml import Node

_RATIOS = ("gear_ratio", "mechanicalReduction", "mechanical_reduction")


def armatures(root: Node, joints: Mapping[str, bool], report: Report) -> dict[str, Number]:
    """The armature of joints by name; ``joints``: of the file, and whether they have one coordinate each.

    An inertia that cannot be seen at one joint is left out, and told.
    """
    found: dict[str, Number] = {}
    for node in root.all("transmission"):
        acting = [each for each in node.all("actuator") if not is_zero(_number(each, "rotor_inertia"))]
        moved = [each.attributes.get("name", "") for each in node.all("joint")]
        for actuator in acting:
            inertia, ratio = value(_number(actuator, "rotor_inertia")), _ratio(actuator, node)
            if len(moved) != 1 or not joints.get(moved[0]):
                which = ", ".join(f"'{name[:60]}'" for name in moved) or "no joint"
                message = (
                    f"the rotor inertia is left out: it moves with {which}, and not with one joint of one coordinate"
                )
                report.lost(actuator.place, message, "physics")
                continue
            found[moved[0]] = decimal_of(value(found.get(moved[0], ZERO)) + ratio**2 * inertia)
            message = (
                f"the rotor inertia {inertia:g} by the gear ratio {ratio:g} squared is the armature of '{moved[0]}'"
            )
            report.merged(actuator.place, message)
        if not acting:
            report.ignored(node.place, "a transmission without rotor inertia: no influence on the equations of motion")
    return found


def _ratio(actuator: Node, transmission: Node) -> float:
    """The first that is given: of the actuator, of the transmission."""
    for holder in (actuator, transmission):
        for tag in _RATIOS:
            if holder.one(tag) is not None:
                return value(_number(holder, tag))
    return 1.0


def _number(node: Node, tag: str) -> Number:
    """The number in a child, as text or as its attribute ``value``; 0 without it."""
    found = node.one(tag)
    return number_of("0" if found is None else found.attributes.get("value", found.text), node.place, tag)
