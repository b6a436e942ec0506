"""Actuators of an MJCF file: rotor inertia and damping behind gears go to the joint, forces of feedback are told.

With the gear n a rotor of moment of inertia I and damping c gives the joint n^2 I and n^2 c.
Source: https://mujoco.readthedocs.io/en/stable/XMLreference.html#actuator
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

from substructures.interchange.mjcf.settings import ACTUATOR, Defaults
from substructures.interchange.numbers import ONE, ZERO, Number, decimal_of, value
from substructures.interchange.report import Report
from substructures.interchange.xml import Node

_LAWS = ("armature", "damping")
_TYPES = ("hinge", "slide")
_NO_FEEDBACK = {"biastype": ("none",), "gaintype": ("fixed",), "dyntype": ("none",)}


def rotor_laws(root: Node, defaults: Defaults, report: Report) -> tuple[dict[str, Number], dict[str, Number]]:
    """What actuators add to the armature and to the damping of joints, by their names."""
    types = {each.attributes.get("name", ""): each.attributes.get("type", "hinge") for each in _joints(root, defaults)}
    added: tuple[dict[str, Number], dict[str, Number]] = ({}, {})
    for node in (each for actuators in root.all("actuator") for each in actuators.children):
        actuator = replace(defaults.applied(replace(node, tag=ACTUATOR), None), tag=node.tag)
        _tell(actuator, report)
        laws = {law: value(next(iter(actuator.numbers(law, None, ())), ZERO)) for law in _LAWS}
        name = actuator.attributes.get("joint", actuator.attributes.get("jointinparent", ""))
        for law, found in zip(_LAWS, added, strict=True):
            if laws[law] and types.get(name) not in _TYPES:
                message = f"the {law} of an actuator that does not drive one joint of one coordinate is left out"
                report.lost(node.place, message)
            elif laws[law]:
                gear = value(next(iter(actuator.numbers("gear", None, (ONE,))), ONE))
                found[name] = decimal_of(value(found.get(name, ZERO)) + gear**2 * laws[law])
                report.merged(node.place, f"its {law} {laws[law]:g} by the gear {gear:g} squared is that of '{name}'")
    return added


def _joints(root: Node, defaults: Defaults) -> Iterator[Node]:
    """All joints, with their classes applied."""
    waiting: list[tuple[Node, str | None]] = [(each, None) for each in root.all("worldbody")]
    while waiting:
        node, childclass = waiting.pop()
        inner = node.attributes.get("childclass", childclass)
        waiting += [(child, inner) for child in node.children]
        if node.tag == "joint":
            yield defaults.applied(node, inner)


def _tell(actuator: Node, report: Report) -> None:
    """What becomes of its force."""
    given: Mapping[str, str] = actuator.attributes
    is_plain = all(given.get(key, words[0]) in words for key, words in _NO_FEEDBACK.items())
    if actuator.tag == "motor" or (actuator.tag == "general" and is_plain):
        message = "actuators: every coordinate has the input tau.<coordinate>: no influence on the equations of motion"
        report.ignored(actuator.place, message)
    else:
        what = f"the force of an actuator <{actuator.tag[:40]}>, which depends on the state,"
        report.lost(actuator.place, f"{what} is left out: add a load for it")
